# hexagons.awk - hexagons.csv with millions of triangles a second behind it.
FNR == 1 {
    csv_header($0, at)
    print $0 ",mtriangles"
    next
}
/./ {
    csv_split($0, f)
    ms = f[at["frame_ms"]] + 0
    print $0 "," (ms > 0 ? f[at["triangles"]] / ms / 1000 : "")
}

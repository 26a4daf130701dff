# hillshades.awk - pictures of hillshades.csv, a line each, for the shell: TERRAIN|SPACING|SIDE|FILE|CAPTION.
BEGIN {
    split("true synthesised gaussian smooth", kind)
    caption["true"] = "true"
    caption["synthesised"] = "synthesised"
    caption["gaussian"] = "one Gaussian a level (LH04)"
    caption["smooth"] = "smooth: U alone"
}
NR == 1 { csv_header($0, at) }
NR > 1 {
    csv_split($0, f)
    terrain = f[at["terrain"]]
    gsub(/[|\\]/, " ", terrain)
    for (i = 1; i <= 4; i++) {
        added = f[at[kind[i] "_rms_m"]]
        print terrain "|" f[at["spacing_m"]] "|" f[at["side"]] "|" f[at[kind[i]]] "|" caption[kind[i]] \
            (added + 0 > 0 ? sprintf("; adds %.1f m rms", added) : "")
    }
}

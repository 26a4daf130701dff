# scenes.awk - a table whose first column is a scene (NAME-30m, NAME-30m-no-morph) with columns terrain and height
# before it, and loss = 1 - ssim behind it where it has that.
FNR == 1 {
    csv_header($0, at)
    print "terrain,height," $0 ",loss"
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    terrain = f[1]
    more = sub(/-no-morph/, "", terrain) ? " no morph" : ""
    more = more (sub(/-1080p$/, "", terrain) ? " 1080p" : "")
    height = ""
    if (match(terrain, /-[0-9.]+k?m$/)) {
        height = substr(terrain, RSTART + 1)
        terrain = substr(terrain, 1, RSTART - 1)
        sub(/[km]/, " &", height)
    }
    gsub(/"/, "\"\"", terrain)
    loss = ("ssim" in at) && is_number(f[at["ssim"]]) ? 1 - f[at["ssim"]] : ""
    print "\"" terrain "\",\"" height more "\"," $0 "," loss
}

# compare.awk - a paper's figures beside ours: awk -v paper=NAME -v table=NAME -v papers=FILE -f csv.awk -f compare.awk
# CSV... papers.csv. Prints row,value,unit,ours,remark,where. What is not known is said to be not at hand.

function note(key, value, remark) {
    if (is_number(value) && !(key in ours)) {
        ours[key] = value
        from[key] = remark
    }
}

function quoted(text) {
    gsub(/"/, "\"\"", text)
    return "\"" text "\""
}

FNR == 1 {
    split("", at)
    csv_header($0, at)
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    if (FILENAME == papers) {
        paper_row(f[1], f[2], f[3], f[4], f[5], f[6])
    } else if ("copy_ratio" in at) {
        step = f[1]; ms = f[at["us"]] / 1000; where = "processor time: " step
        note(step, ms, where)
        if (step ~ /^decompression.*coarser/) {
            note("decompression", ms, where)
            note("decompression (on the CPU)", ms, where)
        }
        if (step ~ /^normal map.*from/) {
            note("normal map", ms, where)
            note("normal map on the GPU", ms, where)
        }
        if (step ~ /^upload/) note("upload", ms, where)
        if (step == "U") note("U on the GPU", ms, where)
    } else if ("err_p999_px" in at) {
        if (f[at["scheme"]] != "square" || f[at["scene"]] ~ /no-morph|1080p/ || f[at["frame_ms"]] <= 0)
            next
        ms = f[at["frame_ms"]]; where = f[at["scene"]] ", n = " f[at["n"]] ", " grouped(f[at["triangles"]]) " triangles"
        if (f[at["n"]] == 255) {
            note("frames a second (L = 11; n = 255; 640 x 480)", 1000 / ms, where)
            note("frames a second (L = 11; n = 255; 1024 x 768)", 1000 / ms, where ", 640 x 480")
            note("triangles a second", f[at["triangles"]] / ms / 1000, where)
        }
        if (f[at["n"]] == 127)
            note("frames a second at n = 127", 1000 / ms, where)
    } else if ("to_horizon" in at && ("paper" in at)) {
        if (f[at["scheme"]] == "rings")
            note("triangles " f[at["paper"]], f[at["to_horizon"]],
                 f[at["scene"]] ": down to a pixel and to the horizon; of them drawn " grouped(f[at["drawn"]]))
    }
}

function paper_row(name, of_table, row, value, unit, where,    key, remark) {
    if (name != paper || of_table != table)
        return
    key = row
    if (table == "section 5.2")
        key = "triangles " value
    remark = key in ours ? from[key] : "not measured here"
    if (row ~ /synthesis/)
        remark = "synthesis is not in this version"
    if (table == "table 3" || table == "table 2")
        remark = "our terrains: the table above; the paper's data is not at hand"
    if (table == "figure 12")
        remark = "our curves of the paper's own transform: the plots above"
    if (paper == "BN08")
        remark = "no hexagons in this version"
    if (!is_number(value))
        value = "not at hand"
    lines[++count] = quoted(row) "," quoted(value) "," quoted(unit) "," (key in ours ? ours[key] : "") "," \
        quoted(remark) "," quoted(where)
}

END {
    print "row,value,unit,ours,remark,where"
    for (i = 1; i <= count; i++)
        print lines[i]
}

# compare.awk - a paper's figures beside ours, one by one: awk -v paper=NAME -v table=NAME -v papers=FILE -f csv.awk
# -f compare.awk CSV... papers.csv. Prints row,value,unit,ours,remark,where. What is not known is said to be not at hand.

# The first one that is found counts.
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
    if (FILENAME == papers) paper_row(f[1], f[2], f[3], f[4], f[5], f[6])
    else if ("copy_ratio" in at) update_row(f[1], f[at["us"]] / 1000, "processor time: " f[1])
    else if ("triangles_levels" in at) view_row()
    else if ("frames_per_s" in at) hexagon_row()
    else if ("err_p999_px" in at) error_row()
    else if ("update_ms" in at && f[1] == "speed" && f[at["value"]] + 0 == 16 && f[at["frame_ms"]] + 0 > 0)
        note("frames a second in flight (nearly)", 1000 / f[at["frame_ms"]],
             "default terrain of 1025 x 1025, 16 samples a frame, unlit")
    else if ("texture_normal_bytes" in at) space_row()
    else if ("err_over_radius" in at && f[at["variant"]] == "exact" && is_number(f[at["err_over_radius"]])) {
        # bench_precision's planet is as large as the Earth; the last row is the finest level's.
        ours["resolution of single floats at an Earth's radius"] = f[at["err_over_radius"]] * 6371000
        from["resolution of single floats at an Earth's radius"] = "worst vertex of level " f[at["level"]] \
            ", the finest measured; exact transform"
    }
}

function update_row(step, ms, where) {
    note(step, ms, where)
    if (step ~ /^decompression.*coarser/) {
        note("decompression", ms, where)
        note("decompression (on the CPU)", ms, where)
    }
    if (step ~ /^normal map.*from/) {
        note("normal map", ms, where)
        note("normal map on the GPU", ms, where)
    }
    if (step ~ /^synthesis.*first/) {
        note("synthesis", ms, where)
        note("synthesis on the GPU", ms, where)
    }
    if (step ~ /^upload/) note("upload", ms, where)
    if (step ~ /^whole.*file/) note("in all with decompression", ms, where)
    if (step ~ /^whole.*synthesised/) note("in all with synthesis", ms, where)
    if (step == "U") note("U on the GPU", ms, where)
}

function view_row(    ms, size, where) {
    ms = f[at["frame_ms"]]; size = f[at["width"]] " x " f[at["height"]]
    where = f[at["scene"]] ", lit, " size ", " grouped(f[at["triangles"]]) " triangles"
    if (ms <= 0)
        return
    if (f[at["scheme"]] == "square" && f[at["samples"]] == 1) {
        note("frames a second (L = 11; n = 255; 640 x 480)", 1000 / ms, where)
        note("triangles a second", f[at["triangles"]] / ms / 1000, where)
        note("squares of 255 over Puget Sound: frames a second", 1000 / ms, where)
        note("fewer triangles by culling at 90 degrees", f[at["triangles_levels"]] / f[at["triangles"]], where)
    }
    if (f[at["scheme"]] == "square" && f[at["samples"]] == 4)
        note("frames a second with 4 samples a pixel", 1000 / ms, where)
    if (f[at["scheme"]] == "rings" && f[at["fov_deg"]] == 90)
        note("fewer triangles by culling at 90 degrees (expected)", f[at["triangles_levels"]] / f[at["triangles"]], where)
}

# Squares of 255 and hexagons in turns, from the lowest height.
function hexagon_row(    where) {
    where = "n = " f[at["n"]] ", lit, 640 x 480, " grouped(f[at["triangles"]]) " triangles, in turns"
    note(f[at["scheme"]] == "square" ? "squares of 255 over Puget Sound: frames a second" \
         : "hexagons of 257 over a sphere of four Puget Sounds: frames a second", f[at["frames_per_s"]], where)
}

function error_row(    ms, where) {
    ms = f[at["frame_ms"]]
    if (f[at["scheme"]] != "square" || f[at["scene"]] ~ /no-morph|1080p/ || ms <= 0)
        return
    where = f[at["scene"]] ", n = " f[at["n"]] ", unlit, 640 x 480, " grouped(f[at["triangles"]]) " triangles"
    if (f[at["n"]] == 255)
        note("frames a second (L = 11; n = 255; 1024 x 768)", 1000 / ms, where)
    if (f[at["n"]] == 127)
        note("frames a second at n = 127", 1000 / ms, where)
}

# Of the terrain with the most levels: megabytes, and bytes a sample of a level.
function space_row(    heights, geometry, normals, samples, where) {
    if (f[at["levels"]] + 0 <= most_levels + 0)
        return
    most_levels = f[at["levels"]]
    split("", memory)
    geometry = f[at["geometry_bytes"]] + f[at["texture_height_bytes"]]
    heights = f[at["clipmap_height_bytes"]]
    normals = f[at["texture_normal_bytes"]] + f[at["clipmap_normal_bytes"]]
    samples = most_levels * 255 * 255
    where = f[at["terrain"]] " (m = " most_levels "): "
    memory["clipmap geometry"] = geometry / 1e6 SUBSEP where "height textures and the mesh that all levels share"
    memory["heights once more"] = heights / 1e6 SUBSEP where "z and z_c in the clipmap"
    memory["normals"] = normals / 1e6 SUBSEP where "textures, and once more in the clipmap"
    memory["clipmap geometry: a sample of a level"] = geometry / samples SUBSEP where "height textures and the mesh"
    memory["normals: a sample of a level"] = normals / samples SUBSEP where "textures and clipmap"
}

function paper_row(name, of_table, row, value, unit, where,    key, remark, part) {
    if (name != paper || of_table != table)
        return
    for (key in memory) {
        split(memory[key], part, SUBSEP)
        note(key, part[1], part[2])
    }
    remark = row in ours ? from[row] : "not measured here"
    if (row ~ /et al\.|and Pascucci/)
        remark = "another scheme's, as the paper quotes it"
    if (table == "figure 12")
        remark = "our curves of the paper's own transform: the plots above"
    if (!is_number(value))
        value = "not at hand"
    lines[++count] = quoted(row) "," quoted(value) "," quoted(unit) "," (row in ours ? ours[row] : "") "," \
        quoted(remark) "," quoted(where)
}

END {
    print "row,value,unit,ours,remark,where"
    for (i = 1; i <= count; i++)
        print lines[i]
}

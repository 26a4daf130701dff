# levels.awk - LH04's table 2 and ours: awk -v paper=LH04 -v table="table 2" -v papers=FILE -v form=list|wide -f csv.awk
# -f paper.awk -f levels.awk papers.csv lod_error.csv. list: a row a level, the paper's terrains first, as lod_error.csv
# has them. wide: a row a figure, so that levels as far from the finest one stand below each other.
FNR == 1 {
    split("", at)
    csv_header($0, at)
    if (FILENAME != papers)
        for (name in at)
            ours[name] = at[name]
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    if (FILENAME == papers)
        of_paper(f)
    else if (("terrain" in ours) && ("p999_px" in ours))
        add(f[ours["terrain"]], f[ours["level"]], f[ours["spacing_m"]], f[ours["rms_m"]], f[ours["p999_m"]],
            f[ours["max_m"]], f[ours["rms_px"]], f[ours["p999_px"]], f[ours["max_px"]])
}

function add(terrain, level, spacing, rms_m, p999_m, max_m, rms, p999, largest) {
    if (!(terrain in levels))
        terrain_of[++terrains] = terrain
    if (level > levels[terrain] + 0) {
        levels[terrain] = level + 0
        spacing_of[terrain] = spacing / 2 # of the finest one, which has no error and no row
    }
    px[terrain, level, 1] = rms; px[terrain, level, 2] = p999; px[terrain, level, 3] = largest
    line[++lines] = as_field(terrain) "," level "," spacing "," rms_m "," p999_m "," max_m "," rms "," p999 "," largest
}

# The paper's rows, in front of ours.
function add_paper(    i, l, name, count, g, own, k) {
    for (k = 1; k <= lines; k++)
        own[k] = line[k]
    count = lines
    lines = 0
    for (k = 1; k <= terrains; k++)
        own_terrain[k] = terrain_of[k]
    own_terrains = terrains
    terrains = 0
    for (i = 1; i <= paper_subjects; i++) {
        name = paper_subject[i]
        if (!((name, "levels") in paper_value))
            continue
        for (l = 1; l < paper_value[name, "levels"] + 0; l++) {
            g = paper_value[name, "spacing of the finest level"] * 2 ^ (paper_value[name, "levels"] - l)
            add(paper ": " name, l, g, "", "", "", paper_value[name " " l, "rms"],
                paper_value[name " " l, "99.9th percentile"], paper_value[name " " l, "maximum"])
        }
    }
    for (k = 1; k <= count; k++)
        line[++lines] = own[k]
    for (k = 1; k <= own_terrains; k++)
        terrain_of[++terrains] = own_terrain[k]
}

function wide(    t, i, k, text, most) {
    for (t = 1; t <= terrains; t++)
        most = levels[terrain_of[t]] > most ? levels[terrain_of[t]] : most
    text = "figure,terrain,spacing_m"
    for (k = 1; k <= most; k++)
        text = text ",c" k
    print text
    for (i = 1; i <= 3; i++)
        for (t = 1; t <= terrains; t++) {
            text = (i == 1 ? "rms" : i == 2 ? "99.9 %" : "largest") "," as_field(terrain_of[t]) "," \
                spacing_of[terrain_of[t]]
            for (k = 1; k <= most; k++)
                text = text "," px[terrain_of[t], levels[terrain_of[t]] + 1 - k, i]
            print text
        }
}

END {
    add_paper()
    if (form == "wide") {
        wide()
        exit
    }
    print "terrain,level,spacing_m,rms_m,p999_m,max_m,rms_px,p999_px,max_px"
    for (i = 1; i <= lines; i++)
        print line[i]
}

# views.awk - CH06's views and ours like them: awk -v paper=CH06 -v table=views -v papers=FILE -f csv.awk -f paper.awk
# -f views.awk papers.csv views.csv. Prints view,scheme,levels,triangles,drawn,rate,scene.
BEGIN {
    like["ground (Lake Garda)"] = "-2m$"
    like["aircraft"] = "-10km$"
    like["space"] = "-10000km$"
}
FNR == 1 {
    split("", at)
    csv_header($0, at)
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    if (FILENAME == papers)
        of_paper(f)
    else if (("triangles_levels" in at) && f[at["scheme"]] ~ /^rings/ && f[at["fov_deg"]] == 60 && f[at["frame_ms"]] > 0) {
        scene[++count] = f[at["scene"]]
        own[count] = f[at["scheme"]] "," f[at["first_level"]] " to " f[at["last_level"]] "," \
            f[at["triangles_levels"]] "," f[at["triangles"]] "," 1000 / f[at["frame_ms"]] "," as_field(scene[count])
    }
}
END {
    print "view,scheme,levels,triangles,drawn,rate,scene"
    for (i = 1; i <= paper_subjects; i++) {
        name = paper_subject[i]
        print as_field(name) "," paper "," paper_value[name, "first level"] " to " paper_value[name, "last level"] "," \
            paper_value[name, "triangles"] ",," paper_value[name, "frames a second"] ","
        for (k = 1; k <= count; k++)
            if ((name in like) && scene[k] ~ like[name])
                print as_field(name) "," own[k]
    }
}

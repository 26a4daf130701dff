# schemes.awk - schemes.csv for plots and tables: awk -v form=NAME -f csv.awk -f schemes.awk schemes.csv. form:
#   plots   a row as it is, behind it `what`, planet and view
#   equal   what each scheme has at one number of triangles: the geometric middle of those that all schemes of a planet
#           and view were measured at, between its two nearest sizes in logarithms; views without such a number are left
#           out
#   stored  samples of the planet on each scheme's charts, and their share of the first scheme's
FNR == 1 {
    csv_header($0, at)
    if (form == "plots")
        print $0 ",what"
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    what = f[at["planet"]] ", " f[at["view"]]
    if (form == "plots") {
        print $0 ",\"" what "\""
        next
    }
    if (!(what in number)) {
        number[what] = ++whats
        planet[whats] = f[at["planet"]]
        view[whats] = f[at["view"]]
    }
    w = number[what]
    if (!((w, f[at["scheme"]]) in known)) {
        known[w, f[at["scheme"]]] = 1
        scheme[w, ++schemes[w]] = f[at["scheme"]]
        stored[w, schemes[w]] = f[at["map_samples"]]
    }
    i = ++sizes[w, f[at["scheme"]]]
    for (column in at)
        value[w, f[at["scheme"]], i, column] = f[at[column]]
}

function least(w, s,    i, v) {
    v = value[w, s, 1, "triangles"] + 0
    for (i = 2; i <= sizes[w, s]; i++)
        v = value[w, s, i, "triangles"] + 0 < v ? value[w, s, i, "triangles"] + 0 : v
    return v
}
function most(w, s,    i, v) {
    for (i = 1; i <= sizes[w, s]; i++)
        v = value[w, s, i, "triangles"] + 0 > v ? value[w, s, i, "triangles"] + 0 : v
    return v
}

# A column at that many triangles.
function at_triangles(w, s, triangles, column,    i, t, above, below, t0, t1, v0, v1) {
    for (i = 1; i <= sizes[w, s]; i++) {
        t = value[w, s, i, "triangles"] + 0
        if (t >= triangles && (!above || t < value[w, s, above, "triangles"] + 0))
            above = i
        if (t <= triangles && (!below || t > value[w, s, below, "triangles"] + 0))
            below = i
    }
    t0 = value[w, s, below, "triangles"]; t1 = value[w, s, above, "triangles"]
    v0 = value[w, s, below, column]; v1 = value[w, s, above, column]
    if (t0 == t1 || v0 <= 0 || v1 <= 0)
        return v0
    return exp(log(v0) + (log(v1) - log(v0)) * (log(triangles) - log(t0)) / (log(t1) - log(t0)))
}

function equal(w,    k, s, low, high, triangles, count, column, c, line) {
    for (k = 1; k <= schemes[w]; k++) {
        s = scheme[w, k]
        if (k == 1 || least(w, s) > low)
            low = least(w, s)
        if (k == 1 || most(w, s) < high)
            high = most(w, s)
    }
    if (low > high || low <= 0)
        return
    triangles = sqrt(low * high)
    count = split("err_rms_px err_p999_px err_max_px own_p999_px samples_held bytes_per_km update_ms frame_ms " \
                  "memory_bytes", column, " ")
    for (k = 1; k <= schemes[w]; k++) {
        line = planet[w] "," view[w] "," sprintf("%.0f", triangles) "," scheme[w, k]
        for (c = 1; c <= count; c++)
            line = line "," sprintf("%.6g", at_triangles(w, scheme[w, k], triangles, column[c]))
        print line
    }
}

END {
    if (form == "equal") {
        print "planet,view,triangles,scheme,err_rms_px,err_p999_px,err_max_px,own_p999_px,samples_held,bytes_per_km," \
            "update_ms,frame_ms,memory_bytes"
        for (w = 1; w <= whats; w++)
            equal(w)
    }
    if (form == "stored") {
        print "planet,scheme,samples,share"
        for (w = 1; w <= whats; w++)
            if (!(planet[w] in told) && planet[w] !~ /-detail$/) {
                told[planet[w]] = 1
                for (k = 1; k <= schemes[w]; k++)
                    if (stored[w, 1] + 0 > 0)
                        printf "%s,%s,%.0f,%.4f\n", planet[w], scheme[w, k], stored[w, k], stored[w, k] / stored[w, 1]
            }
    }
}

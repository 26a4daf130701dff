# curves.awk - curves out of a table: awk -v group=COLUMN -v series=COLUMN[+COLUMN^] -v x=COLUMN -v y=COLUMN
# -v out=PREFIX [-v positive=1]; COLUMN^ is its first word. For each value of `group` ("": one plot of all) PREFIX.N has
# its curves as curves.gp wants them, sorted by x; PREFIX.list says N|number of curves|largest over smallest x|the same
# of y|value. Rows without both numbers, or, positive, not above 0, are left out.
FNR == 1 {
    csv_header($0, at)
    parts = split(series, part, "+")
    for (i = 1; i <= parts; i++) {
        column = part[i]
        if (sub(/\^$/, "", column) && (column in at))
            first_word[part[i]] = column
    }
    if (!((x in at) && (y in at) && (group == "" || (group in at)))) {
        print "no column " (x in at ? (y in at ? group : y) : x) >"/dev/stderr"
        exit 1
    }
    next
}
{
    split("", f)
    csv_split($0, f)
    a = f[at[x]]; b = f[at[y]]
    if (!is_number(a) || !is_number(b) || (positive && (a + 0 <= 0 || b + 0 <= 0)))
        next
    g = group == "" ? "" : f[at[group]]
    s = ""
    for (i = 1; i <= parts; i++)
        if (part[i] in at)
            s = s (s == "" ? "" : " ") f[at[part[i]]]
        else if (part[i] in first_word) {
            split(f[at[first_word[part[i]]]], word, " ")
            s = s (s == "" ? "" : " ") word[1]
        }
    gsub(/["\\]/, " ", s)
    if (!(g in number)) {
        number[g] = ++groups
        value[groups] = g
    }
    k = number[g]
    if (!((k, s) in curve)) {
        curve[k, s] = ++curves[k]
        name[k, curves[k]] = s
    }
    c = curve[k, s]
    i = ++points[k, c]
    for (; i > 1 && px[k, c, i - 1] > a + 0; i--) {
        px[k, c, i] = px[k, c, i - 1]
        py[k, c, i] = py[k, c, i - 1]
    }
    px[k, c, i] = a + 0
    py[k, c, i] = b + 0
}

# How many times the smallest number of a plot the largest one is.
function spread(p, k,    c, i, low, high) {
    low = high = p[k, 1, 1]
    for (c = 1; c <= curves[k]; c++)
        for (i = 1; i <= points[k, c]; i++) {
            low = p[k, c, i] < low ? p[k, c, i] : low
            high = p[k, c, i] > high ? p[k, c, i] : high
        }
    return low > 0 ? high / low : 0
}

END {
    printf "" >(out ".list")
    for (k = 1; k <= groups; k++) {
        file = out "." k
        for (c = 1; c <= curves[k]; c++) {
            print (c > 1 ? "\n\n" : "") "\"" name[k, c] "\"" >file
            for (i = 1; i <= points[k, c]; i++)
                print px[k, c, i], py[k, c, i] >file
        }
        close(file)
        print k "|" curves[k] "|" spread(px, k) "|" spread(py, k) "|" value[k] >(out ".list")
    }
}

# wide.awk - figures beside each other, a case a row: awk -v figures="NAME NAME ..." -f csv.awk -f wide.awk gpu.csv.
# Of gpu.csv's rows, a figure each; the verdict of a row is the worst of its figures.
function rank(verdict) { return verdict == "" ? 0 : verdict == "same" ? 1 : verdict == "differs" ? 2 : 3 }
FNR == 1 { csv_header($0, at); count = split(figures, name, " "); next }
{
    csv_split($0, f)
    key = f[at["scheme"]] "," f[at["view"]] "," f[at["size"]]
    for (i = 1; i <= count && name[i] != f[at["figure"]]; i++)
        ;
    if (i > count)
        next
    if (!(key in row)) {
        order[++rows] = key
        row[key] = 1
    }
    value[key, i] = f[at["value"]] ~ /^-?[0-9]+$/ ? f[at["value"]] : sprintf("%.4g", f[at["value"]])
    worst = f[at["verdict"]] == "wrong" ? "failed" : f[at["verdict"]]
    if (rank(worst) > rank(verdict[key]))
        verdict[key] = worst
    renderer[key] = f[at["renderer"]]
}
END {
    line = "scheme,view,size"
    for (i = 1; i <= count; i++)
        line = line "," name[i]
    print line ",verdict,renderer"
    for (r = 1; r <= rows; r++) {
        line = order[r]
        for (i = 1; i <= count; i++)
            line = line "," value[order[r], i]
        print line "," verdict[order[r]] ",\"" renderer[order[r]] "\""
    }
}

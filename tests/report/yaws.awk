# yaws.awk - triangle_size.csv for plots and tables: awk -v form=NAME -f csv.awk -f yaws.awk triangle_size.csv. form:
#   plots    a row as it is, behind it `what`, the view, and `curve`, scheme and n
#   summary  a row a view, scheme and n, of all yaws: mean of the triangles, of their mean size and of its spread within
#            a yaw; the largest mean size over the smallest, and the same of the numbers of triangles
FNR == 1 {
    csv_header($0, at)
    print form == "plots" ? $0 ",what,curve" : "view,scheme,n,yaws,triangles,mean_px,spread,mean_ratio,count_ratio"
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    key = f[at["view"]] "," f[at["scheme"]] "," f[at["n"]]
    mean = f[at["mean_px"]] + 0
    count = f[at["triangles"]] + 0
    if (form == "plots")
        print $0 "," f[at["view"]] "," f[at["scheme"]] " " f[at["n"]]
    else {
        if (!(key in yaws))
            keys[++number] = key
        yaws[key]++
        counts[key] += count
        means[key] += mean
        spreads[key] += f[at["spread"]]
        if (yaws[key] == 1 || mean < low[key]) low[key] = mean
        if (mean > high[key]) high[key] = mean
        if (yaws[key] == 1 || count < few[key]) few[key] = count
        if (count > many[key]) many[key] = count
    }
}
END {
    for (i = 1; i <= number; i++) {
        key = keys[i]
        n = yaws[key]
        ratio = low[key] > 0 ? sprintf("%.4f", high[key] / low[key]) : ""
        count_ratio = few[key] > 0 ? sprintf("%.4f", many[key] / few[key]) : ""
        printf "%s,%d,%.0f,%.4f,%.4f,%s,%s\n", key, n, counts[key] / n, means[key] / n, spreads[key] / n, ratio, count_ratio
    }
}

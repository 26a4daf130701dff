# wrong.awk - the runs that failed or are missing, in words.
FNR > 1 {
    split("", f)
    csv_split($0, f)
    if (f[2] == "failed" || f[2] == "missing")
        printf "%s%s %s", count++ ? ", " : "", html(f[1]), f[2]
}

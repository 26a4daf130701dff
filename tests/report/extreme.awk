# extreme.awk - the rows of all families in one table: failures, then what was skipped, then the rest.
FNR == 1 {
    if (NR == 1)
        print
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    rank = f[6] == "FAILED" ? 1 : f[6] == "skipped" ? 2 : 3
    row[rank, ++count[rank]] = $0
}
END {
    for (rank = 1; rank <= 3; rank++)
        for (i = 1; i <= count[rank]; i++)
            print row[rank, i]
}

# text.awk - a CSV file as a table of text: awk -f csv.awk -f text.awk FILE. Numbers stand to the right.
{
    fields = csv_split($0, f)
    for (i = 1; i <= fields; i++) {
        cell[NR, i] = f[i] ~ /^[0-9.]*$/ && f[i] !~ /\./ && f[i] != "" ? grouped(f[i]) : f[i]
        right[NR, i] = is_number(f[i])
        if (length(cell[NR, i]) > width[i])
            width[i] = length(cell[NR, i])
    }
}
END {
    for (r = 1; r <= NR; r++) {
        line = " "
        for (i = 1; i <= fields; i++)
            line = line sprintf(" %" (right[r, i] ? "" : "-") width[i] "s", cell[r, i])
        sub(/ +$/, "", line)
        print line
    }
}

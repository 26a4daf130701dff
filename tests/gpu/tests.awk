# tests.awk - the tests among the rows of gpu.csv, as a table: awk -f csv.awk -f tests.awk gpu.csv.
FNR == 1 { print "test,result,verdict,renderer"; next }
{
    csv_split($0, f)
    if (f[4] == "test")
        printf "%s,%s,%s,\"%s\"\n", f[1], f[5], f[8], f[9]
}

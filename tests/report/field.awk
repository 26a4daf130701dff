# field.awk - one field of the row of a table whose first column is `name`: awk -v name=NAME -v want=COLUMN.
FNR == 1 {
    csv_header($0, at)
    next
}
{
    split("", f)
    csv_split($0, f)
    if (f[1] == name && (want in at)) {
        print f[at[want]]
        exit
    }
}

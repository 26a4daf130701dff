# pairs.awk - a table of keys and values as a list of terms.
FNR > 1 && csv_split($0, f) >= 2 { print "<dt>" html(f[1]) "</dt><dd>" html(f[2]) "</dd>" }

# precision.awk - rows "level exact ch06" of one column of precision.csv.
FNR == 1 { csv_header($0, at); next }
{
    split("", f)
    csv_split($0, f)
    level = f[at["level"]] + 0
    value[level, f[at["variant"]]] = f[at[column]]
    if (level > last)
        last = level
}
END {
    for (level = 0; level <= last; level++)
        if ((level, "exact") in value || (level, "ch06") in value)
            print level, of("exact"), of("ch06")
}
function of(variant) { return (level, variant) in value && value[level, variant] + 0 > 0 ? value[level, variant] : "?" }

# unlike.awk - the rows of gpu.csv that are not as they are in software: awk -f csv.awk -f unlike.awk gpu.csv.
{ csv_split($0, f) }
FNR == 1 || f[8] ~ /^(differs|wrong|failed|skipped)$/

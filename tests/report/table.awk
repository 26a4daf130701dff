# table.awk - a CSV file as an HTML table: awk -v columns=LIST -f csv.awk -f table.awk FILE.
#
# columns: NAME=LABEL[:FORMAT] separated by ";" (shown() has the formats); "": all columns as they are called.
# only: NAME=REGEX, rows to take. group: how many leading columns are not said again where they are those of the row
# above. limits: NAME<BOUND separated by ";": cells at or above their bound are marked. Rows are marked by what a
# column called `verdict` says. Columns that the file does not have are named below the table, never dropped in silence.

function plan(    list, count, i, part, label) {
    shown_columns = 0
    if (columns == "") {
        for (i = 1; i <= fields; i++) {
            label = header[i]
            gsub(/_/, " ", label)
            add_column(i, label, "4")
        }
    }
    count = split(columns, list, /; */)
    for (i = 1; i <= count; i++) {
        split(list[i], part, "=")
        label = substr(list[i], length(part[1]) + 2)
        format = ""
        if (match(label, /:[a-z0-9]+$/)) {
            format = substr(label, RSTART + 1)
            label = substr(label, 1, RSTART - 1)
        }
        if (part[1] in at)
            add_column(at[part[1]], label, format)
        else
            absent = absent (absent == "" ? "" : ", ") part[1]
    }
    count = split(limits, list, /; */)
    for (i = 1; i <= count; i++) {
        split(list[i], part, "<")
        if (part[1] in at)
            bound[at[part[1]]] = part[2]
    }
}

function add_column(number, label, format) {
    column[++shown_columns] = number
    label_of[shown_columns] = label
    format_of[shown_columns] = format
}

function row_class(verdict) {
    if (verdict ~ /^(FAILED|failed|missed|missing)$/)
        return " class=\"bad\""
    if (verdict ~ /^(skipped|old)/)
        return " class=\"grey\""
    return ""
}

function put_row(    i, c, text, same, class, line) {
    same = 1
    line = "<tr" row_class(("verdict" in at) ? field[at["verdict"]] : "") ">"
    for (i = 1; i <= shown_columns; i++) {
        c = column[i]
        text = field[c]
        class = is_number(text) ? "n" : ""
        if ((c in bound) && is_number(text) && text + 0 >= bound[c] + 0)
            class = class " over"
        same = same && rows > 0 && i <= group && text == last[i]
        last[i] = text
        line = line "<td" (class == "" ? "" : " class=\"" class "\"") ">" \
            (same ? "" : shown(text, format_of[i])) "</td>"
    }
    body[++rows] = line "</tr>"
    for (i = 1; i <= shown_columns; i++)
        numbers[i] += is_number(field[column[i]])
}

FNR == 1 {
    delete_all(at)
    fields = csv_header($0, at)
    csv_split($0, header)
    if (NR == 1)
        plan()
    next
}
/./ {
    delete_all(field)
    csv_split($0, field)
    if (only != "") {
        split(only, part, "=")
        if (field[at[part[1]]] !~ part[2])
            next
    }
    put_row()
}
function delete_all(array) { split("", array) }

END {
    if (rows == 0) {
        print "<p class=\"grey\">No rows.</p>"
        exit
    }
    print "<div class=\"scroll\"><table><thead><tr>"
    for (i = 1; i <= shown_columns; i++)
        print "<th" (numbers[i] * 2 > rows ? " class=\"n\"" : "") ">" html(label_of[i]) "</th>"
    print "</tr></thead><tbody>"
    for (i = 1; i <= rows; i++)
        print body[i]
    print "</tbody></table></div>"
    if (absent != "")
        print "<p class=\"fault\">The file has no column " html(absent) ".</p>"
}

# csv.awk - what the other awk files here share: lines of CSV with quoted fields in, HTML out.

# Splits a line into field[1] .. field[n] and returns n.
function csv_split(line, field,    n, i, c, value, quoted, length_of) {
    sub(/\r$/, "", line)
    if (index(line, "\"") == 0)
        return split(line, field, ",")
    length_of = length(line)
    n = 0; value = ""; quoted = 0
    for (i = 1; i <= length_of; i++) {
        c = substr(line, i, 1)
        if (quoted) {
            if (c != "\"")
                value = value c
            else if (substr(line, i + 1, 1) == "\"") {
                value = value "\""
                i++
            } else
                quoted = 0
        } else if (c == "\"")
            quoted = 1
        else if (c == ",") {
            field[++n] = value
            value = ""
        } else
            value = value c
    }
    field[++n] = value
    return n
}

# For a first line: at[NAME] is the number of the column called NAME.
function csv_header(line, at,    field, n, i) {
    n = csv_split(line, field)
    for (i = 1; i <= n; i++)
        at[field[i]] = i
    return n
}

function html(text) {
    gsub(/&/, "\\&amp;", text)
    gsub(/</, "\\&lt;", text)
    gsub(/>/, "\\&gt;", text)
    gsub(/"/, "\\&quot;", text)
    gsub(/'/, "\\&#39;", text)
    gsub(/[\001-\010\013-\037]/, "?", text)
    return text
}

function is_number(text) {
    return text ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/
}

# Digits in groups of three.
function grouped(number,    text, sign, out) {
    number += 0
    sign = number < 0 ? "-" : ""
    text = sprintf("%.0f", number < 0 ? -number : number)
    out = ""
    while (length(text) > 3) {
        out = "," substr(text, length(text) - 2) out
        text = substr(text, 1, length(text) - 3)
    }
    return sign text out
}

# A number with so many significant digits, never in powers of ten between 1e-4 and 1e6.
function digits(number, count,    size, decimals) {
    number += 0
    size = number < 0 ? -number : number
    if (size == 0)
        return "0"
    if (size < 1e-4 || size >= 1e6)
        return size >= 1e6 && size < 1e15 ? grouped(number) : sprintf("%." (count - 1) "e", number)
    decimals = count - 1 - int(log(size) / log(10) + (size >= 1 ? 1e-9 : -1 + 1e-9))
    return decimals <= 0 ? grouped(number) : sprintf("%." decimals "f", number)
}

function byte_size(number) {
    number += 0
    if (number >= 1e9)
        return sprintf("%.2f GB", number / 1e9)
    if (number >= 1e6)
        return sprintf("%.2f MB", number / 1e6)
    return number >= 1e4 ? sprintf("%.1f kB", number / 1e3) : sprintf("%d B", number)
}

# A field as a person reads it. format: "" as it is, given: but for large whole numbers, int, bytes, or how many
# significant digits.
function shown(text, format) {
    if (!is_number(text) || format == "")
        return html(text)
    if (format == "given")
        return text ~ /^[0-9]+$/ && length(text) > 4 ? grouped(text) : html(text)
    if (format == "int")
        return grouped(text)
    if (format == "bytes")
        return byte_size(text)
    return digits(text, format)
}

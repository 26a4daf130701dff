# man.awk - a manual page from what a program's --help prints, so that the two cannot differ.
#
#   PROGRAM --help | awk -v name=PROGRAM -v version=X.Y -f docs/man.awk
#
# Help is: "Usage: SYNOPSIS", a description, headings "Words:", and under them options or keys, each with its text from
# column 30 on or after two blanks.
function roff(text) {
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    sub(/^\./, "\\\\\\&.", text)
    return text
}
function item(head, text) {
    print ".TP"
    print ".B " roff(head)
    if (text != "")
        print roff(text)
}
NR == 1 {
    sub(/^[Uu]sage: */, "")
    printf ".TH %s 1 \"\" \"Terraclip %s\" \"User Commands\"\n", toupper(name), version
    printf ".SH NAME\n%s \\- %s\n.SH SYNOPSIS\n.B %s\n.SH DESCRIPTION\n", roff(name), what, roff($0)
    next
}
/^[^ ].*:$/ {
    if (!options++)
        print ".SH OPTIONS"
    sub(/:$/, "")
    print ".SS " roff($0)
    next
}
/^ +-/ {
    if (!options++)
        print ".SH OPTIONS"
    head = $0
    text = ""
    if (match($0, /[^ ]  +[^ ]/)) {
        # The blanks before the option do not count.
        sub(/^ +/, "", head)
        if (match(head, /  +/)) {
            text = substr(head, RSTART + RLENGTH)
            head = substr(head, 1, RSTART - 1)
        }
    } else
        sub(/^ +/, "", head)
    item(head, text)
    next
}
/^                  / {
    sub(/^ +/, "")
    print roff($0)
    next
}
/^  [^ ]/ {
    head = substr($0, 3)
    text = ""
    if (match(head, /  +/)) {
        text = substr(head, RSTART + RLENGTH)
        head = substr(head, 1, RSTART - 1)
    }
    item(head, text)
    next
}
/^$/ {
    next
}
{
    print roff($0)
}

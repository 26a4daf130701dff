#!/bin/sh
# The page-making half of the report: page.sh FOLDER. Makes FOLDER/index.html of what measure.sh left there; a table
# that is missing, or whose program failed, is shown as that. Needs awk, base64 and gnuplot.
set -u
here=${0%/*} out=$1
command -v gnuplot >/dev/null 2>&1 || { echo "report: gnuplot is not installed" >&2; exit 1; }
work=$(mktemp -d "${TMPDIR:-/tmp}/terraclip-report-XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
export LC_ALL=C

table() { # FILE [NAME=VALUE...]: table.awk's settings, which may go over several lines
    file=$1
    shift
    for setting; do
        shift
        set -- "$@" -v "$(printf '%s' "$setting" | tr -s ' \n' ' ')"
    done
    awk "$@" -f "$here/csv.awk" -f "$here/table.awk" "$file"
}

escaped() { # of the standard input
    awk -f "$here/csv.awk" -f "$here/escape.awk"
}

# One field of runs.csv; empty where there is none.
run_field() { # NAME FIELD
    awk -v name="$1" -v want="$2" -f "$here/csv.awk" -f "$here/field.awk" "$out/runs.csv" 2>/dev/null
}

# How a table came to be: its command, how long that took, and what went wrong.
ran() { # NAME
    state=$(run_field "$1" state) reason=$(run_field "$1" reason)
    printf '<p class="command">Again: <code>%s</code>' "$(run_field "$1" command | escaped)"
    [ -z "$state" ] || printf ' &middot; took %s s, %s s of processor' \
        "$(run_field "$1" seconds | escaped)" "$(run_field "$1" cpu_seconds | escaped)"
    renderer=$(run_field "$1" renderer | escaped)
    [ -z "$renderer" ] || printf ' &middot; OpenGL: %s' "$renderer"
    echo '</p>'
    case $state in
    'done') ;;
    '') echo '<p class="fault">Not measured.</p>' ;;
    failed | missing) printf '<p class="fault">%s: %s</p>\n' "$state" "$(printf '%s\n' "$reason" | escaped)" ;;
    *) printf '<div class="grey">%s: %s</div>\n' "$state" "$(printf '%s\n' "$reason" | escaped)" ;;
    esac
}

has_rows() { # FILE
    [ -f "$1" ] && [ "$(wc -l <"$1")" -gt 1 ]
}

# True where a table is there to be shown; says so where it is not. Rows that a failed program left are shown.
measured() { # NAME FILE
    ran "$1"
    has_rows "$out/$2" && return
    case $(run_field "$1" state) in
    failed | missing | skipped) ;;
    *) printf '<p class="fault">There is no %s.</p>\n' "$2" ;;
    esac
    return 1
}

section() { # ID TITLE
    printf '<h2 id="%s">%s</h2>\n' "$1" "$2"
}

# A plot, inline. Names within it get the figure's own before them, since there are many on the page.
figure() { # ID TITLE CAPTION WIDTH HEIGHT PLOT [NAME=VALUE...]; values are gnuplot's
    name=$1 title=$2 caption=$3 svg=$work/$1.svg plot=$6
    settings="out = '$svg'; width = $4; height = $5"
    shift 6
    for setting; do settings="$settings; $setting"; done
    echo '<figure>'
    if gnuplot -e "$settings" "$here/style.gp" "$here/$plot" >"$work/plot.log" 2>&1 && [ -s "$svg" ]; then
        sed -e '1,/^<svg/{/^<svg/!d;}' -e '/^<desc>/d' -e "s|<title>Gnuplot</title>|<title>$title</title>|" \
            -e 's|<title>gnuplot_plot_[0-9]*</title>||' \
            -e "s| id=\([\"']\)| id=\1${name}_|g" -e "s|href=\([\"']\)#|href=\1#${name}_|g" \
            -e "s|url(#|url(#${name}_|g" "$svg"
    else
        printf '<p class="fault">No plot: %s</p>\n' "$(grep -v '^[[:space:]]*$' "$work/plot.log" | tail -n 1 | escaped)"
    fi
    [ -z "$caption" ] || printf '<figcaption>%s</figcaption>\n' "$caption"
    echo '</figure>'
}

# A picture that lies beside the tables, inline, a pixel of it a pixel of the page.
picture() { # FILE SIDE CAPTION
    echo '<figure>'
    if [ -f "$out/$1" ]; then
        printf '<img alt="%s" width="%s" height="%s" src="data:image/png;base64,' "$3" "$2" "$2"
        base64 <"$out/$1" | tr -d '\n'
        echo '">'
    else
        printf '<p class="fault">There is no %s.</p>\n' "$(printf '%s\n' "$1" | escaped)"
    fi
    printf '<figcaption>%s</figcaption></figure>\n' "$3"
}

. "$here/sections.sh"

{
    head_of_page
    for part in $parts; do "part_$part"; done
    printf '</main></body></html>\n'
} >"$out/index.html.new" && mv "$out/index.html.new" "$out/index.html"

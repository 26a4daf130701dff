#!/bin/sh
# The house is as it says: every include goes from a room to itself or to one that data has passed before, no two rooms
# include each other, and what is common knows neither schemes nor kinds of bodies. From the sources alone.
. "${0%/*}/lib.sh"
cd "$root" || exit 99

# Each room, and the rooms that it may include beside itself. The order is that of the data: a room stands below all that
# it includes, so there is no cycle. What is read of the world (input) knows nothing of what is made of it.
cat >"$work/rooms" <<'end'
base
input            base
field            base
synthesis        base field
codec/entropy    base
codec/lifting    base field codec/entropy
codec/exact      base codec/entropy codec/lifting
codec/lh04       base codec/entropy codec/lifting
codec/mask       base codec/entropy codec/lifting
chart            base field
packed/file      base field synthesis codec/entropy codec/lifting codec/exact codec/lh04 codec/mask chart
packed/read      base field codec/entropy codec/lifting codec/exact codec/lh04 codec/mask chart packed/file
packed/write     base field synthesis codec/entropy codec/lifting codec/exact codec/lh04 codec/mask chart packed/file packed/read
map              base field synthesis chart packed/file packed/read
imagery          base field chart packed/file packed/read map
view             base chart map
window           base field view
content          base field window
blocks           base chart
measure          base field chart map view window content
gl               base
render           base field chart map imagery view window content gl
planar           base field chart map view window content blocks render
spherical        base field chart map view window content blocks render
app              base input field chart packed/file packed/read map imagery view window content measure gl render
data             base input field chart packed/file packed/read packed/write map view app
end

list_includes() { # "ROOM INCLUDED-ROOM FILE" of every include of another folder
    find common planar spherical data \( -name '*.[ch]' -o -name '*.cpp' \) ! -path common/terraclip.h \
        ! -path common/terraclip_draw.h -exec grep -H '^#include "' {} + |
        sed -E 's|^([^:]*)/([^/:]*):#include "(.*)/([^/"]*)".*|\1 \3 \1/\2|' | grep -v '#include' |
        sed -E 's|(^\| )common/|\1|g' | awk '$2 != "common" && $1 != $2'
}

# The table is in order: nothing is included by a room above it.
cases=$((cases + 1))
wrong=$(awk '{ for (i = 2; i <= NF; i++) if (!($i in seen)) print $1 " before " $i; seen[$1] = 1 }' "$work/rooms")
[ -z "$wrong" ] || fail "the table of rooms: $wrong"

list_includes >"$work/includes"
[ "$(wc -l <"$work/includes")" -gt 200 ] || fail 'too few includes were found to be all'
against_flow() { # INCLUDES
    awk 'NR == FNR { room[$1] = 1; for (i = 2; i <= NF; i++) may[$1, $i] = 1; next }
        !($1 in room) { print "  " $3 ": in no room" }
        ($1 in room) && !(($1, $2) in may) && $3 !~ /main\.c$/ { print "  " $3 ": includes " $2 }' \
        "$work/rooms" "$1"
}
cases=$((cases + 2))
wrong=$(against_flow "$work/includes")
[ -z "$wrong" ] || fail "includes against the flow:
$wrong"
printf 'window content common/window/a.c\nattic base common/attic/b.c\n' >"$work/wrong" # which would be found
[ "$(against_flow "$work/wrong" | wc -l)" = 2 ] || fail 'includes against the flow are not found'

# Programs' main files alone join a scheme and the application.
cases=$((cases + 1))
wrong=$(awk '$3 ~ /main\.c$/ && $2 == "packed/write" { print $3 }' "$work/includes" | grep -v '^data')
[ -z "$wrong" ] || fail "a viewer packs: $wrong"

# ---- What common/ does not know

# Code without comments.
code() { # FILE...
    for file; do
        sed -e 's|//.*||' "$file" | awk -v name="$file" '{ line = $0
            while (1) {
                if (inside) { end = index(line, "*/"); if (!end) { line = ""; break } line = substr(line, end + 2); inside = 0 }
                start = index(line, "/*"); if (!start) break
                rest = substr(line, start + 2); stop = index(rest, "*/")
                if (stop) line = substr(line, 1, start - 1) substr(rest, stop + 2)
                else { out = substr(line, 1, start - 1); inside = 1; line = out; break }
            }
            print name ": " line }'
    done
}
find common -name '*.[ch]' -o -name '*.cpp' >"$work/files"
code $(cat "$work/files") >"$work/code"
names() { # REGEX WHAT: no identifier and no string of common/ matches
    cases=$((cases + 1))
    wrong=$(grep -E -- "$1" "$work/code" | head -n 8)
    [ -z "$wrong" ] || fail "$2:
$wrong"
}
names '\<rings|\<tc_(square|hex|cube)_|"square' 'common/ names a scheme'
names '^common/([^c]|c[^h]).*"(hex|cube)' 'common/ names a scheme' # charts and atlases of them are data, with names
names '(if|while) *\(.*[>.](is_)?(sphere|planet|globe)\b|[>.](is_)?sphere *(\?|&&|\|\|)|[(!] *(is_)?sphere\b' \
    'common/ asks whether a body is a sphere'
# The core draws nothing and opens no plugin.
cases=$((cases + 1))
wrong=$(for file in $(make -s --no-print-directory print-core); do
    grep -lE '#include <(GL/|EGL/|GLFW|dlfcn)|\bgl->' "$file"
done)
[ -z "$wrong" ] || fail "the core has OpenGL or plugins: $wrong"

finish

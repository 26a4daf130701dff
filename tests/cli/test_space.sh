#!/bin/sh
# From space to the street and back: planet-viewer flies to a named view 2 m above the ground by its key, and back, in
# seconds, and on the way there always is something to be seen. Then what else the keys of views do.
. "${0%/*}/lib.sh"
. "$root/tests/cli/window.sh"
on_own_display "$0"
viewer=$globe

$terraclip synth --kind planet --size 512 -o globe.tif -q
ground=$($terraclip height globe.tif 20 30 | awk '{ print $NF }')
street=20,30,$(awk "BEGIN { printf \"%.3f\", $ground + 2 }"),250,0
printf '%s # the street\n40,-20,3000000,0,-60 # the south\n' "$street" >views.txt

# A view in whole thousandths, as V writes it.
same_view() { # VIEW VIEW
    [ "$(echo "$1" | awk -F, '{ printf "%.5f %.5f %.3f %.3f %.3f", $1, $2, $3, $4, $5 }')" = \
        "$(echo "$2" | awk -F, '{ printf "%.5f %.5f %.3f %.3f %.3f", $1, $2, $3, $4, $5 }')" ]
}
seconds() { date +%s.%N; }

# Looks on until the picture has come to rest; $empty counts those that are of one colour, $looks all, $took is the time
# from then to the first of those that are all alike.
watch() { # XDOTOOL_ARGUMENT...
    still=0 before= empty=0 looks=0
    from=$(seconds)
    xdotool "$@"
    while [ $still -lt 4 ] && [ $looks -lt 2000 ]; do
        colours=$(shown colours)
        looks=$((looks + 1))
        [ "${colours:-0}" -gt 1 ] || empty=$((empty + 1))
        now=$(tail -c $((320 * 240 * 4)) window.xwd | cksum) # less the title
        if [ "$now" = "$before" ] && [ $looks -gt 12 ]; then
            [ $still -gt 0 ] || took=$(awk "BEGIN { print $(seconds) - $from }")
            still=$((still + 1))
            sleep 0.3
        else
            still=0
        fi
        before=$now
    done
}
# There, and the view is this; where one is given.
flies() { # KEY WHAT VIEW
    cases=$((cases + 2))
    watch key "$1"
    [ $still = 4 ] || fail "$2: does not come to rest"
    [ $empty = 0 ] || fail "$2: $empty of $looks pictures on the way are of one colour"
    lines=$(wc -l <views.txt)
    xdotool key v
    await sh -c "[ \$(wc -l <views.txt) -gt $lines ]" || fail "$2: V adds no view"
    at=$(tail -n 1 views.txt | sed 's/ *#.*//')
    [ -z "$3" ] || same_view "$at" "$3" || fail "$2: at $at instead of $3"
}

if start globe.tif --size 320x240 --views views.txt --no-display --samples 1; then
    xdotool key t # what frames take, every second
    flies 0 'at first' ''
    first=$at
    told=$(wc -l <stderr.txt)
    flies 1 'to the street' "$street"
    said '^view 1: the street$' || report 'the street is not told'
    down=$took
    flies r 'back to space' "$first"
    up=$took
    # 10 s, or longer where frames take more than 30 ms, which is the machine's affair.
    cases=$((cases + 1))
    frame=$(sed -n "1,${told}d; s/^\([0-9.]*\) ms a frame.*/\1/p" stderr.txt | sort -n |
        awk '{ ms[NR] = $1 } END { print ms[int((NR + 1) / 2)] }') # the median: at rest there are few or none
    awk "BEGIN { f = ${frame:-0} / 30; exit !($down + $up <= 10 * (f > 1 ? f : 1)) }" ||
        fail "there in $down s and back in $up s, at frames of ${frame:-?} ms"
    echo "there in $down s, back in $up s, frames of ${frame:-?} ms"

    # The other keys; a view that V has added, at once; 0 is the first one.
    key 2 '^view 2: the south$'
    key 9 '^planet-viewer: views.txt: no view 9$'
    flies 2 'to the south' 40,-20,3000000,0,-60
    xdotool key Right
    printf '10,10,5000000,20,-80\n' >>views.txt
    number=$(grep -c . views.txt)
    flies "$number" 'to a view without a name' 10,10,5000000,20,-80
    said "^view $number\$" || report "view $number is not told"
    flies 3 'to a view that V added' "$first"
    xdotool key Right
    flies 0 'to the first view' "$first"
    rm views.txt
    key 1 '^planet-viewer: views.txt: cannot be opened: '
    xdotool key Escape
    ends 'after flying'
fi
# The settings list them: the row and its second line are where they are drawn at a scale of 1 (plugin_display.cpp).
printf '%s # the street\n40,-20,3000000,0,-60 # the south\n' "$street" >views.txt
if start globe.tif --size 640x480 --views views.txt; then
    watch key Tab
    watch mousemove --window "$id" 230 89
    watch click 1
    watch mousemove --window "$id" 230 147
    cases=$((cases + 1))
    xdotool click 1
    await said '^view 2: the south$' || report 'the settings do not fly to a view'
    kill -TERM $pid
    ends 'settings'
fi
if start globe.tif --size 320x240 --no-display; then
    key 1 '^planet-viewer: --views FILE has views to fly to'
    xdotool key Escape
    ends 'without views'
fi

finish

#!/bin/sh
# The mouse moves the view as it should, in both viewers: a red dot is draped on the ground, and what the window shows of
# it is read from the screen.
. "${0%/*}/lib.sh"
. "$root/tests/cli/window.sh"
on_own_display "$0"

dot_picture() { # FILE WIDTH HEIGHT X Y RADIUS: red on dark green
    LC_ALL=C awk -v w="$2" -v h="$3" -v cx="$4" -v cy="$5" -v r="$6" 'BEGIN {
        printf "P6\n%d %d\n255\n", w, h
        for (y = 0; y < h; y++)
            for (x = 0; x < w; x++)
                if ((x - cx) ^ 2 + (y - cy) ^ 2 <= r * r)
                    printf "%c%c%c", 255, 1, 1
                else
                    printf "%c%c%c", 1, 60 + 40 * ((int(x / 8) + int(y / 8)) % 2), 1
    }' >"$1"
}

# The view as the viewer tells it.
view() {
    lines=$(wc -l <stdout.txt)
    xdotool key v
    await sh -c "[ \$(wc -l <stdout.txt) -gt $lines ]"
    sed -n 's/^--view //p' stdout.txt | tail -n 1
}
# The dot's place, in $x and $y, whole pixels, and its size in $dot, once the view has come to rest.
look() {
    seen=
    until now=$(view) && [ "$now" = "$seen" ]; do
        seen=$now
    done
    sleep 0.2
    set -- $(shown middle ff0000)
    x=${1%.*} y=${2%.*} dot=$3
}
# It is seen at a place, to 3 pixels: 2 of them what a user may see, one for whole pixels and for the disc's own slant.
near() { # X Y PIXELS
    look
    [ "${dot:-0}" -gt 20 ] && [ $(((x - $1) * (x - $1) + (y - $2) * (y - $2))) -le $(($3 * $3)) ]
}
at() { # WHAT X Y [PIXELS]
    cases=$((cases + 1))
    tries=0
    until near "$2" "$3" "${4:-3}"; do
        tries=$((tries + 1))
        [ $tries -lt 4 ] && continue
        fail "$program: $1: the dot ($dot pixels) is at $x $y instead of $2 $3"
        break
    done
}
pointer() { xdotool mousemove --window "$id" "$1" "$2"; }
# From where the pointer is, in steps.
drag_to() { # X Y FROM_X FROM_Y
    for part in 1 2 3 4 5; do
        pointer $(($3 + ($1 - $3) * part / 5)) $(($4 + ($2 - $4) * part / 5))
        sleep 0.05
    done
    sleep 0.3
}
north_up() { [ "$(view | cut -d, -f4)" = 0.0000 ]; }
differs() { # WHAT FIELD VIEW VIEW: numbers of two views, by at least a degree
    cases=$((cases + 1))
    echo "$3,$4" | awk -F, -v k="$2" '{ d = $k - $(k + 5); exit !(d * d > 1) }' || fail "$program: $1: $3 and $4"
}

moves() { # PROGRAM FILE PICTURE VIEW
    viewer=$1 program=${1##*/}
    start "$2" --imagery "$3" --size 480x360 --view "$4" --unlit --background 000000 --samples 1 --no-display || return
    look
    cases=$((cases + 1))
    [ "${dot:-0}" -gt 20 ] || fail "$program: no dot is seen at first"
    first="$x $y"

    # Pulled: it stays under the pointer.
    for to in '300 120' '150 250' '330 240'; do
        to_x=${to% *} to_y=${to#* }
        pointer "$x" "$y"
        xdotool mousedown 1
        drag_to "$to_x" "$to_y" "$x" "$y"
        at 'pulled' "$to_x" "$to_y"
        xdotool mouseup 1
        at 'let go' "$to_x" "$to_y"
    done
    # The wheel: nearer to it, farther from it.
    before=$dot x0=$x y0=$y
    pointer "$x" "$y"
    xdotool click 4 click 4 click 4
    at 'three notches nearer' "$x0" "$y0"
    cases=$((cases + 1))
    [ "$dot" -gt $((before * 2)) ] || fail "$program: three notches make $dot pixels of $before"
    near=$dot
    xdotool click 5 click 5 click 5
    at 'and back' "$x0" "$y0"
    cases=$((cases + 1))
    { [ "$dot" -lt $((near * 2 / 3)) ] && [ "$dot" -gt $((before * 2 / 3)) ]; } ||
        fail "$program: three notches back make $dot pixels of $near, $before before"
    # Twice: it comes to the middle, nearer.
    sleep 0.5
    before=$dot
    xdotool click 1 click 1
    at 'flown to' 240 180 9 # four times as near, so is what the click was off
    cases=$((cases + 1))
    [ "$dot" -gt $((before * 3)) ] || fail "$program: flown to, there are $dot pixels of $before"
    look
    pointer "$x" "$y"
    xdotool mousedown 1
    drag_to 240 180 "$x" "$y"
    xdotool mouseup 1 click 5 click 5 click 5 click 5
    at 'farther again' 240 180
    # The right button turns and tilts about it.
    old=$(view)
    pointer 200 200
    xdotool mousedown 3
    drag_to 280 200 200 200
    new=$(view)
    at 'turned about' 240 180
    differs 'turned about' 4 "$old" "$new"
    drag_to 280 160 280 200
    old=$new new=$(view)
    at 'tilted about' 240 180
    differs 'tilted about' 5 "$old" "$new"
    xdotool mouseup 3
    # North.
    xdotool key n
    cases=$((cases + 1))
    await north_up || fail "$program: N leaves the view $(view)"
    at 'north up' 240 180
    # Let go in motion it runs on, and a click stops it.
    pointer 240 180
    xdotool mousedown 1
    for step in 1 2 3 4 5 6 7 8; do
        pointer $((240 + 14 * step)) 180
        sleep 0.03
    done
    xdotool mousemove --window "$id" 366 180 mouseup 1
    look
    cases=$((cases + 1))
    [ "${dot:-0}" = 0 ] || [ "$x" -gt 371 ] || # perhaps out of the window fail "$program: let go in motion the dot comes to rest at $x $y"
    # Over the edge and away: the view is never lost.
    pointer 240 180
    xdotool mousedown 1
    drag_to 20 20 240 180
    xdotool mouseup 1
    xdotool key r
    at 'flown back' "${first% *}" "${first#* }"
    xdotool windowfocus "$id"
    xdotool key Escape
    ends "$program"
}

$make_file tiff hills.tif size=513x513 metres=30
dot_picture dot.ppm 256 256 110 150 3
moves "$viewer" hills.tif dot.ppm 6600,-2500,7000,0,-40
moves "$viewer" hills.tif dot.ppm 6600,6300,9000,30,-90
$terraclip synth --kind planet --size 512 -o globe.tif -q
dot_picture dots.ppm 512 256 300 100 4
moves "$globe" globe.tif dots.ppm 29,15,9000000,0,-90
dot_picture dots.ppm 1024 512 601 201 2
moves "$globe" globe.tif dots.ppm 31,16,2000000,20,-75

finish

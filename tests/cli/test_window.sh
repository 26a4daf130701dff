#!/bin/sh
# The viewer in a window, on a display of its own: it opens, draws, does what its keys say, and closes.
. "${0%/*}/lib.sh"

. "$root/tests/cli/window.sh"
on_own_display "$0"

$make_file tiff hills.tif size=513x513 metres=30

# ---- Keys

if start hills.tif --size 320x240 --view 2000,1500,2500,30,-15 --stats stats.json --no-display; then
    title=$(xdotool getwindowname "$id")
    echo "$title" | grep -Eq '^hills.tif - [0-9.]+ ms, [0-9]+ triangles, [1-9][0-9]* levels - planar-viewer$' ||
        fail "the title is '$title'"
    [ "$(echo $(xdotool getwindowgeometry "$id" | sed -n 's/.*Geometry: //p'))" = 320x240 ] || fail 'wrong size'
    if command -v xprop >/dev/null 2>&1; then # as share/applications has it
        cases=$((cases + 2))
        xprop -id "$id" WM_CLASS | grep -q '= "planar-viewer", "planar-viewer"$' || fail "$(xprop -id "$id" WM_CLASS)"
        xprop -id "$id" -notype -f _NET_WM_ICON 32c _NET_WM_ICON | grep -q '= 32, 32, 0, ' || fail 'the window has no icon'
    fi
    key v '^--view 2000(\.000)?,1500(\.000)?,2500(\.000)?,30(\.0000)?,-15(\.0000)?$'
    key p '^terraclip-0001.png'
    key g '^wireframe on'
    key p '^terraclip-0002.png'
    key g '^wireframe off'
    key l '^level colours on'
    key p '^terraclip-0003.png'
    key l '^level colours off'
    key m '^morph off'
    key m '^morph on'
    key c '^frozen culling on'
    key c '^frozen culling off'
    key h 'Keys of the window'
    key t 'ms a frame .* triangles, .* draws, .* levels; .* samples updated'
    xdotool key t
    key p '^terraclip-0004.png'
    # Flown forward, and back to the first view.
    xdotool keydown w && sleep 0.4 && xdotool keyup w
    key p '^terraclip-0005.png'
    xdotool key r
    sleep 2 # it flies there
    key p '^terraclip-0006.png'
    for number in 1 2 3 4 5 6; do
        is_png terraclip-000$number.png || fail "terraclip-000$number.png is no picture"
    done
    different terraclip-0001.png terraclip-0002.png 'wireframe'
    different terraclip-0001.png terraclip-0003.png 'level colours'
    same terraclip-0001.png terraclip-0004.png 'everything off again'
    different terraclip-0001.png terraclip-0005.png 'flown forward'
    same terraclip-0001.png terraclip-0006.png 'reset'
    # The printed view gives the same picture without a window.
    view=$(sed -n 's/^--view //p' stdout.txt | head -n 1)
    accepts '' $viewer hills.tif --view "$view" -o out/picture.png --size 320x240
    same terraclip-0006.png last.png 'the window and the printed view'
    xdotool key F11
    await sh -c "xdotool getwindowgeometry $id | grep -q 800x600" || fail 'F11 does not fill the screen'
    xdotool key F11
    await sh -c "xdotool getwindowgeometry $id | grep -q 320x240" || fail 'F11 does not leave the full screen'
    xdotool windowfocus "$id"
    xdotool key Escape
    ends Escape
    grep -q '"backend": "window"' stats.json || fail '--stats of a window'
fi

# ---- Views that are kept: a file of views, which the flight is read from, too; whatever becomes of it, none is lost

rm -f views.txt
printf '2000,1500,2500,30,-15 # view 1\n2500,1500,2500,30,-15' >views.txt
if start hills.tif --size 320x240 --views views.txt --view '@view 1'; then
    key v '^views.txt: view 2$'
    key v '^views.txt: view 3$'
    cases=$((cases + 1))
    cat >expected.txt <<VIEWS
2000,1500,2500,30,-15 # view 1
2500,1500,2500,30,-15
2000.000,1500.000,2500.000,30.0000,-15.0000 # view 2
2000.000,1500.000,2500.000,30.0000,-15.0000 # view 3
VIEWS
    cmp -s views.txt expected.txt || fail "kept views: $(cat views.txt)"
    echo 'nonsense' >>views.txt
    key v '^planar-viewer: warning: views.txt: line 5: expected X,Y,Z,HEADING,PITCH, found .nonsense.$'
    key v '^views.txt: view 5$'
    rm views.txt
    key v '^views.txt: view 1$'
    rm views.txt && mkdir views.txt
    key v '^planar-viewer: views.txt: cannot be'
    key v '^--view 2000(\.000)?,1500(\.000)?,2500(\.000)?,30(\.0000)?,-15(\.0000)?$'
    rmdir views.txt && cp hills.tif views.txt
    key v '^planar-viewer: views.txt: expected text, found zero bytes'
    cases=$((cases + 1))
    cmp -s views.txt hills.tif || fail 'a view was added to what is no text'
    xdotool key Escape
    ends 'after keeping views'
fi
# A file that does not exist yet; and an eye that was put under the ground, which is said once.
rm -f views.txt
if start hills.tif --size 320x240 --views views.txt --view 2000,1500,10,30,-15; then
    key v '^views.txt: view 1$'
    xdotool key Escape
    ends 'after keeping a view'
    cases=$((cases + 1))
    [ "$(grep -c 'the eye was [0-9.]* m under the ground: lifted above it' stderr.txt)" = 1 ] ||
        report 'an eye under the ground in a window'
fi
printf '2000,1500,9000,30,-35\n2000,1500,10,30,-35\n' >views.txt
if start hills.tif --size 320x240 --views views.txt --path views.txt --frames 400 --backend window; then
    key v '^views.txt: view 1$'
    xdotool key Escape
    ends 'after a flight through kept views'
    cases=$((cases + 1))
    [ "$(grep -c 'the eye was [0-9.]* m under the ground: lifted above it' stderr.txt)" = 1 ] ||
        report 'a path under the ground in a window'
fi
refuses 2 'views.txt' $viewer views.txt --views views.txt
ln -s hills.tif link.tif
refuses 2 'hills.tif' $viewer hills.tif --views link.tif
printf '2000,1500,9000,30,-35\nnonsense\n' >views.txt
refuses 1 'views.txt: line 2: expected X,Y,Z,HEADING,PITCH, found .nonsense' $viewer hills.tif --views views.txt
refuses 1 'nowhere/views.txt: ' $viewer hills.tif --views nowhere/views.txt
refuses 2 'stats.json' $viewer hills.tif --views stats.json --stats stats.json

# ---- Sizes: the picture fills the window on the next frames, whichever way its size changes. Looking at the sky all of it
# is background.

filled() { # WxH: the window has this size, and shows nothing else
    [ "$(shown 20c040)" = "0 of $(($1))" ]
}
fills() { # WHAT WIDTH*HEIGHT
    cases=$((cases + 1))
    await filled "$2" || fail "$1: the picture does not fill the window: $(shown 20c040)"
}
resizing() { # PROGRAM FILE VIEW
    viewer_before=$viewer
    viewer=$1
    if start "$2" --size 320x240 --background 20c040 --view "$3" --no-display; then
        fills 'at first' '320*240'
        for size in '640 400' '200 500' '700 90' '320 240'; do
            xdotool windowsize "$id" $size
            fills "made $size" "$(echo "$size" | tr ' ' '*')"
        done
        xdotool windowfocus "$id"
        xdotool key F11
        fills 'full screen' '800*600'
        xdotool key F11
        fills 'full screen left' '320*240'
        xdotool windowfocus "$id"
        xdotool key Escape
        ends 'after resizing'
    fi
    viewer=$viewer_before
}
$terraclip synth --kind planet --size 64 -o globe.tif -q
resizing "$viewer" hills.tif 2000,1500,20000,30,80
resizing "$globe" globe.tif 0,0,2e7,0,80

# Schemes change at the same view: their pictures, of one planet, are alike.
viewer_before=$viewer viewer=$globe
$terraclip synth --kind planet --size 512 -o globe.tif -q
rm -f terraclip-*.png
if start globe.tif --size 320x240 --view 20,30,3000000,40,-50; then
    key p '^terraclip-0001.png'
    number=1
    for scheme in rings-ch06 hex cube cube-pt rings; do
        key x "^$scheme\$"
        number=$((number + 1))
        sleep 0.5
        key p "^terraclip-000$number.png"
        key v '^--view 20(\.0*)?,30(\.0*)?,3000000(\.000)?,40(\.0000)?,-50(\.0000)?$'
        cases=$((cases + 1))
        off=$("$make_picture" differ terraclip-0001.png "terraclip-000$number.png") && awk "BEGIN { exit !($off <= 3) }" ||
            fail "$scheme: its picture is $off of 255 off that of rings"
    done
    xdotool key Escape
    ends 'after changing schemes'
fi
# A packed planet is drawn by those that have its charts; why others do not is told.
$terraclip pack --planet globe.tif -o globe.tclip -q
if start globe.tclip --size 320x240; then
    key x '^rings-ch06$'
    key x '^rings$'
    cases=$((cases + 1))
    [ "$(grep -c 'expected a planet packed with --atlas' stderr.txt)" = 3 ] || fail 'a packed planet: not told why'
    key p '^terraclip-'
    xdotool key Escape
    ends 'after changing schemes of a packed planet'
fi
viewer=$viewer_before

# The mesh follows: cells cover as many pixels as before.
if start hills.tif --size 150x100 --explain; then
    cases=$((cases + 1))
    xdotool windowsize "$id" 700 500
    await sh -c "xdotool getwindowgeometry $id | grep -q 700x500" || fail 'cannot be made larger'
    sleep 2
    xdotool windowfocus "$id"
    xdotool key Escape
    ends 'after growing'
    grep -q 'texture: heights: RG32F, 512 x 512' stdout.txt || fail 'the mesh of a window made larger is that of the small one'
fi

# ---- Other ends

if start hills.tif --size 320x240 --wireframe --level-colours; then
    # F takes the mouse, the first Escape lets it go, the second ends.
    key f '^the mouse turns the view'
    xdotool mousemove --window "$id" 100 100 click 1 mousemove_relative 40 0 key Escape
    sleep 0.3
    gone && fail 'Escape ends although it was to let the mouse go'
    # A slow frame brings several keys: each does what it does alone.
    cases=$((cases + 5))
    slowly() { # KEY...
        kill -STOP $pid
        xdotool key "$@"
        kill -CONT $pid
    }
    slowly f f
    await said '^the mouse moves the ground' || fail 'F, twice at once: the mouse is not let go'
    slowly f Escape
    await sh -c '[ $(grep -c "the mouse turns the view" stderr.txt) = 3 ]' || fail 'F and Escape: F is lost'
    sleep 0.3
    gone && fail 'F and Escape at once: ends'
    key f '^the mouse turns the view'
    await sh -c '[ $(grep -c "the mouse turns the view" stderr.txt) = 4 ]' || fail 'F after Escape does not take the mouse'
    slowly Escape f Escape
    sleep 0.3
    gone && fail 'Escape, F and Escape at once: ends'
    xdotool key Escape
    ends 'the Escape after those that let the mouse go'
fi
if start hills.tif --size 320x240 -q; then
    xdotool key g
    kill -TERM $pid
    ends SIGTERM
    [ ! -s stderr.txt ] || fail '-q says something'
fi
run $viewer hills.tif --size 320x240 --frames 20 --json
{ [ $rc = 0 ] && grep -q '"frames": 20,' stdout.txt && grep -q '"backend": "window"' stdout.txt; } ||
    report 'a window with --frames' --frames 20
# Throttled: no frame is as short as that. The picture is drawn coarser, and it is told.
$terraclip synth --size 513 -o land.tif -q
run $viewer land.tif --size 320x240 --frames 60 --json --target-ms 0.01 --view 5000,5000,3000,45,-15
{ [ $rc = 0 ] && [ ! -s stderr.txt ] && grep -Eq '"throttle": {"median": [0-9.]+, "max": (0\.[5-9]|[1-9])' stdout.txt; } ||
    report 'a throttled window' --target-ms
echo 2000,1500,2500,30,-15 >views.txt && echo 9000,8000,4000,90,-25 >>views.txt
run $viewer hills.tif --size 320x240 --backend window --path views.txt --frames 20 --json
{ [ $rc = 0 ] && grep -q '"frames": 20,' stdout.txt; } || report 'a flight in a window' --path
# A display serves pictures, too, and then shows no window.
accepts '' $viewer hills.tif --backend window $picture
mv last.png window.png
accepts '' $viewer hills.tif $picture

finish

#!/bin/sh
# What a window tells, and what is set in it: the display by its pixels, the panel by what it changes, files that fall on
# the window. The panel's rows are where they are drawn at a scale of 1 (plugin_display.cpp).
. "${0%/*}/lib.sh"
. "$root/tests/cli/window.sh"
on_own_display "$0"

said() { grep -Eq -- "$1" told.txt printed.txt; }

start() { # ARGUMENT...
    rm -f terraclip-*.png
    number=0
    "$viewer" "$@" >printed.txt 2>told.txt </dev/null & # not where others write meanwhile
    pid=$!
    if ! await has_window 'ms, .* triangles, .* levels'; then
        report 'no window that draws' "$@"
        kill -9 $pid
        wait $pid
        return 1
    fi
    id=$(window 'ms, .* triangles')
    xdotool windowfocus --sync "$id" 2>/dev/null || xdotool windowfocus "$id"
}
ends() { # WHAT
    cases=$((cases + 1))
    xdotool windowfocus "$id"
    xdotool key Escape
    await gone || { fail "$1: does not end"; kill -9 $pid; }
    wait $pid
    rc=$?
    [ $rc = 0 ] || report "$1: exit code $rc"
}

# Pixels of the window that are not of the background.
marks() { shown 20c040 | sed 's/ of.*//'; }
between() { [ "$(marks)" -ge "$1" ] && [ "$(marks)" -le "$2" ]; }
shows() { # WHAT LEAST MOST: so many pixels, by and by
    cases=$((cases + 1))
    await between "$2" "$3" || fail "$1: expected $2 to $3 pixels of a display, found $(marks)"
}

# Waits for some frames: a window that shows what it should says nothing of them.
settle() { sleep 1; }

# The pointer goes there and does what is to be done, each seen by a frame of its own.
at() { # X Y XDOTOOL...
    xdotool mousemove --window "$id" "$1" "$2"
    settle
    shift 2
    if [ "$*" = 'click 1' ]; then
        xdotool mousedown 1
        settle
        xdotool mouseup 1
        settle
    elif [ $# -gt 0 ]; then
        xdotool "$@"
        settle
    fi
}
picture() { # the next one, as shot.png
    number=$((number + 1))
    file=$(printf 'terraclip-%04d.png' $number)
    xdotool key p
    await said "^$file" && cp "$file" shot.png || fail "no $file"
}

$make_file tiff hills.tif size=513x513 metres=30
sky='--size 640x480 --background 20c040 --view 2000,1500,20000,30,80'

# ---- Over nothing but a background

if start hills.tif $sky; then
    shows 'at first' 500 60000
    xdotool key o
    shows 'turned off' 0 0
    key h 'Keys of the window' # printed, since it is not shown
    xdotool key o
    shows 'turned on' 500 60000
    xdotool key h
    shows 'help' 120000 300000
    xdotool key F1
    shows 'help closed' 500 60000
    xdotool key Tab
    shows 'panel' 110000 300000
    picture
    accepts '' $viewer hills.tif -o out/picture.png $sky
    same shot.png last.png 'with panel and texts on the screen'
    xdotool key Escape
    shows 'panel closed by Esc' 500 60000
    # Whatever becomes of the window.
    for size in '1 1' '30 300' '320 240' '640 480'; do
        xdotool windowsize "$id" $size
        sleep 0.3
        gone && fail "made $size: ends"
    done
    shows 'made large again' 500 60000
    xdotool windowminimize "$id"
    sleep 0.5
    xdotool windowmap "$id"
    xdotool windowfocus "$id"
    xdotool key F11
    await sh -c "xdotool getwindowgeometry $id | grep -q 800x600" || fail 'F11 does not fill the screen'
    shows 'full screen' 500 60000
    xdotool key F11
    await sh -c "xdotool getwindowgeometry $id | grep -q 640x480" || fail 'F11 does not leave the full screen'
    ends 'a display'
    [ ! -e imgui.ini ] || fail 'imgui.ini is written'
fi
if start hills.tif $sky --no-display; then
    shows '--no-display' 0 0
    xdotool key Tab
    key h 'Keys of the window'
    shows '--no-display and its keys' 0 0
    ends '--no-display'
fi

# Whose the terrain is, in its own words, below its name.
sed 's/@/(c) Somebody, somewhere, who took great pains over every single height in this file/' >credited.vrt <<'end'
<VRTDataset rasterXSize="513" rasterYSize="513"><Metadata><MDI key="COPYRIGHT">@</MDI></Metadata>
<VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename relativeToVRT="1">hills.tif</SourceFilename>
<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>
end
if start hills.tif $sky; then
    sleep 12 # the hint is gone
    before=$(marks)
    ends 'a terrain that does not say whose it is'
fi
if start credited.vrt $sky --spacing 30; then
    sleep 12
    shows 'whose the terrain is' $((before + 5000)) $((before + 20000))
    ends 'a terrain that says whose it is'
fi

# ---- Compass and panel

if start hills.tif --size 640x480 --view 2000,1500,2500,30,-15; then
    settle
    xdotool key Tab
    picture && cp shot.png first.png
    # Neither a click nor a drag in the panel moves the view.
    at 200 20 mousedown 1
    at 120 60 mouseup 1
    at 500 430
    key v '^--view 2000(\.000)?,1500(\.000)?,2500(\.000)?,30(\.0000)?,-15(\.0000)?$'
    # Switches, which keys know of.
    at 25 385 click 1
    key g '^wireframe off'
    at 25 408 click 1
    key l '^level colours off'
    at 25 181 click 1
    key m '^morph on'
    picture
    same shot.png first.png 'switches and keys'
    at 25 248 click 1
    picture
    different shot.png first.png 'light off'
    at 25 248 click 1
    # The sun.
    for slider in 'azimuth 271' 'elevation 293'; do
        y=${slider#* }
        at 150 $y mousedown 1
        at 170 $y mouseup 1
        picture
        different shot.png first.png "sun's ${slider% *}"
    done
    at 200 271 keydown Control mousedown 1
    at 200 271 mouseup 1 keyup Control
    at 200 271 type 310
    at 200 271 key Return
    at 200 293 keydown Control mousedown 1
    at 200 293 mouseup 1 keyup Control
    at 200 293 type 38
    at 200 293 key Return
    picture
    same shot.png first.png 'the usual sun typed'
    # A slider is moved; its value typed.
    at 200 89 mousedown 1
    at 190 89 mouseup 1
    picture
    different shot.png first.png 'exaggeration'
    at 200 89 keydown Control mousedown 1
    at 200 89 mouseup 1 keyup Control
    at 200 89 key 1 Return
    picture
    same shot.png first.png 'exaggeration typed'
    at 320 112 mousedown 1
    at 160 112 mouseup 1
    picture
    different shot.png first.png 'levels'
    at 160 112 mousedown 1
    at 328 112 mouseup 1
    settle
    picture
    same shot.png first.png 'all levels again'
    for slider in 'synthesis 135' 'error 158' 'contours 316'; do
        y=${slider#* }
        at 144 $y mousedown 1
        at 240 $y mouseup 1
        settle
        picture
        different shot.png first.png "${slider% *}"
        at 240 $y mousedown 1
        at 130 $y mouseup 1
        settle
        picture
        same shot.png first.png "no ${slider% *}"
    done
    # Choices: another name, and the one that there was, so far below.
    while read -r choice y other was; do
        at 235 $y click 1
        at 235 $((y + other)) click 1
        settle
        picture
        different shot.png first.png "$choice"
        at 235 $y click 1
        at 235 $((y + was)) click 1
        settle
        picture
        same shot.png first.png "$choice as before"
    done <<'end'
shade 225 41 24
sea 339 58 24
samples 362 24 58
end
    # The compass.
    at 604 36 click 1
    cases=$((cases + 1))
    await sh -c "xdotool key v; sleep 0.3; tail -n 1 printed.txt | grep -Eq -- ',(0|360)(\.0000)?,-15(\.0000)?\$'" ||
        fail "the compass does not turn north up: $(tail -n 1 printed.txt)"
    xdotool key Tab
    at 320 240
    ends 'a panel'
    cases=$((cases + 1))
    ! grep -v '^wireframe\|^level colours\|^morph\|^terraclip-' told.txt || fail 'the panel: something else is said'
fi

# ---- Files

$terraclip synth --size 257 -o land.tif -q
$make_picture make colours.png driver=PNG size=64x64
echo 'no picture' >words.txt
drop() { # FILE REGEX
    cases=$((cases + 1))
    "$build/tests/drop-file" "$id" "$1" || fail "$1: the window does not take it"
    await said "$2" || fail "$1: does not say '$2'"
}
if start hills.tif --size 640x560 --view 2000,1500,2500,30,-15; then
    settle
    picture && cp shot.png first.png
    # What is none is told, and changes nothing.
    drop words.txt '^planar-viewer: .*words.txt: expected an elevation file'
    cases=$((cases + 2))
    w=words.txt
    "$build/tests/drop-file" "$id" $w $w $w $w $w $w $w $w $w $w || fail 'ten files: the window does not take them'
    await said '^planar-viewer: expected at most 8 files dropped at once, found 10: drop the last 2 again' ||
        fail 'ten files: that two are left out is not told'
    [ "$(grep -c 'words.txt: expected an elevation file' told.txt)" = 9 ] || fail 'ten files: eight are not tried'
    key v '^--view 2000(\.000)?,1500(\.000)?,2500(\.000)?,30(\.0000)?,-15(\.0000)?$'
    picture
    same shot.png first.png 'a file that is neither'
    drop colours.png '^colours.png: laid over the terrain'
    settle
    picture && cp shot.png draped.png
    different shot.png first.png 'a picture'
    # It is taken off and laid on again.
    xdotool key Tab
    at 25 475 click 1
    settle
    picture
    same shot.png first.png 'a picture taken off'
    at 25 475 click 1
    settle
    picture
    same shot.png draped.png 'a picture laid on again'
    # Another terrain, as a whole.
    drop land.tif '^land.tif: opened'
    await sh -c "xdotool getwindowname $id | grep -q '^land.tif '" || fail 'another terrain: not in the title'
    settle
    settle
    picture
    accepts '' $viewer land.tif -o out/picture.png --size 640x560
    same shot.png last.png 'a terrain that was dropped'
    # Typed, by names full of letters that are keys.
    at 235 66 click 1
    xdotool type "$PWD/hills.tif"
    at 235 66 key Return
    await said '^hills.tif: opened' || fail 'a terrain that was typed is not opened'
    at 235 452 click 1
    xdotool type nowhere.png
    at 235 452 key Return
    await said '^planar-viewer: nowhere.png: ' || fail 'a picture that is not there is not told'
    xdotool key Tab
    at 320 240
    ends 'files'
    cases=$((cases + 1))
    ! grep -E '^(wireframe|level colours|morph|frozen)' told.txt || fail 'what is typed into the panel is taken for keys'
fi

# Whose pictures are is told no longer once they are gone.
{
    echo '<VRTDataset rasterXSize="64" rasterYSize="64"><Metadata><MDI key="COPYRIGHT">(c) A. Person</MDI></Metadata>'
    for band in 1 2 3; do
        echo "<VRTRasterBand dataType=\"Byte\" band=\"$band\"><SimpleSource>"
        echo "<SourceFilename relativeToVRT=\"1\">colours.png</SourceFilename><SourceBand>$band</SourceBand>"
        echo '</SimpleSource></VRTRasterBand>'
    done
    echo '</VRTDataset>'
} >whose.vrt
while read -r told dropped; do
    if start hills.tif --size 320x240 --imagery whose.vrt --explain; then
        [ -z "$dropped" ] || drop $dropped "^$dropped: opened"
        ends 'whose pictures are'
        cases=$((cases + 1))
        [ "$(grep -c '^credit: imagery: (c) A. Person$' printed.txt)" = $told ] ||
            fail "whose pictures are, then ${dropped:-nothing}: $(cat printed.txt)"
    fi
done <<'end'
1
0 land.tif
end

# ---- Planets

viewer_before=$viewer viewer=$globe
$terraclip synth --kind planet --size 256 -o globe.tif -q
if start globe.tif --size 640x480 --background 20c040 --view 20,30,2e7,0,80; then
    shows 'a planet' 500 60000
    xdotool key Tab
    at 235 89 click 1
    at 235 147 click 1 # the third
    key x '^cube$'
    drop globe.tif '^globe.tif: opened'
    xdotool key Tab
    ends 'a planet'
fi
viewer=$viewer_before

# ---- A screen of twice as many dots: texts are twice as large, the picture has a pixel of its own for each of the window's

measured() { # sets texts, picture_colours: the display's pixels; colours of a terrain without it
    start hills.tif $sky || return
    sleep 12 # the hint is gone
    texts=$(marks)
    ends 'a scaled display'
    start hills.tif --size 640x480 --view 2000,1500,2500,30,-15 --no-display || return
    sleep 3
    picture_colours=$(shown colours)
    ends 'a scaled picture'
}
if command -v xrdb >/dev/null 2>&1; then
    cases=$((cases + 2))
    measured
    texts_before=$texts colours_before=$picture_colours
    echo 'Xft.dpi: 192' | xrdb -merge
    measured
    { [ "$texts" -gt $((3 * texts_before)) ] && [ "$texts" -lt $((5 * texts_before)) ]; } ||
        fail "texts of $texts pixels at twice the scale, of $texts_before at once"
    { [ "$picture_colours" = "$colours_before" ] && [ "$colours_before" -gt 300 ]; } ||
        fail "a picture of $picture_colours colours at twice the scale, of $colours_before at once"
    xrdb -remove
else
    skip 'xrdb is not installed'
fi

# ---- A display that goes away

if command -v Xvfb >/dev/null 2>&1; then
    cases=$((cases + 1))
    other=$((200 + $$ % 1000))
    Xvfb :$other -screen 0 640x480x24 >/dev/null 2>&1 &
    server=$!
    await xdpyinfo -display :$other || sleep 2
    DISPLAY=:$other "$viewer" hills.tif --size 320x240 >stdout.txt 2>stderr.txt </dev/null &
    pid=$!
    sleep 4
    kill -9 $server
    wait $server 2>/dev/null
    await gone || { fail 'the display goes away: does not end'; kill -9 $pid; }
    wait $pid
    rc=$?
    { [ $rc = 1 ] && [ "$(grep -c . stderr.txt)" -le 2 ]; } || report "the display goes away: exit code $rc"
fi

finish

#!/bin/sh
# What takes long to load, in a window: it is there meanwhile, tells how far it is, can be made larger and closed; what
# then cannot be loaded is told as ever.
. "${0%/*}/lib.sh"
. "$root/tests/cli/window.sh"
on_own_display "$0"

slow_vrt() { # FILE SOURCES: some twenty of them are read in a second
    {
        echo '<VRTDataset rasterXSize="1000" rasterYSize="9000"><GeoTransform>0,30,0,0,0,-30</GeoTransform>'
        echo '<VRTRasterBand dataType="Float32" band="1" subClass="VRTDerivedRasterBand">'
        echo '<PixelFunctionType>sum</PixelFunctionType><SourceTransferType>Float32</SourceTransferType>'
        for source in $(seq "$2"); do
            echo '<SimpleSource resampling="lanczos"><SourceFilename relativeToVRT="1">hills.tif</SourceFilename>'
            echo '<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="513" ySize="513"/>'
            echo '<DstRect xOff="0" yOff="0" xSize="1000" ySize="9000"/></SimpleSource>'
        done
        echo '</VRTRasterBand></VRTDataset>'
    } >"$1"
}
$make_file tiff hills.tif size=513x513 metres=30
slow_vrt slow.vrt 40
slow_vrt endless.vrt 2000
# Opening it waits until someone writes into the pipe, and then fails.
mkfifo pipe.tif
sed 's/hills.tif/pipe.tif/' slow.vrt >blocked.vrt

# Waits until something holds, and lets the pipe be opened as often as it is tried.
await_unblocked() { # COMMAND...
    : >unblocking
    while [ -e unblocking ]; do
        timeout 0.2 sh -c ': >pipe.tif'
        sleep 0.02
    done 2>/dev/null &
    unblocking=$!
    await "$@"
    awaited=$?
    rm unblocking
    wait $unblocking
    return $awaited
}

# Starts the viewer and waits until it tells that.
begins() { # TITLE ARGUMENT...
    cases=$((cases + 1))
    title=$1
    shift
    "$viewer" "$@" >stdout.txt 2>stderr.txt </dev/null &
    pid=$!
    await has_window "$title" || { report "no window that tells '$title'" "$@"; kill -9 $pid; return 1; }
    id=$(window "$title")
}
closes() { # WHAT
    "$build/tests/drop-file" "$id"
    ends "$1"
    ! grep '^planar-viewer\|^planet-viewer' stderr.txt || report "$1: something is said"
}
# Pixels that are not as empty as before the first picture: the progress' own.
others() { shown 1a1a1f | sed 's/ of.*//'; }
progress() { [ "$(others)" -gt 8000 ] && [ "$(others)" -lt 60000 ]; }

# ---- From the beginning to the end

if begins '^slow.vrt - reading [0-9]+ % - planar-viewer$' slow.vrt --size 640x480 --stats stats.json; then
    cases=$((cases + 3))
    await progress || fail "no progress in the window: $(others) pixels of it"
    await has_window '^slow.vrt - [0-9.]+ ms, .* triangles' || report 'no picture once it is loaded'
    xdotool windowfocus "$id"
    xdotool key Escape
    ends 'loaded'
    grep -q '"backend": "window"' stats.json || fail '--stats of a window that told how far it was'
fi
run $viewer slow.vrt --size 320x240 --frames 5 --json --no-display
{ [ $rc = 0 ] && grep -q '"frames": 5,' stdout.txt; } || report 'frames after loading'

# ---- Closed meanwhile

begins ' - reading ' endless.vrt --size 320x240 && closes 'closed while it is read'
begins ' - opening ' blocked.vrt --size 320x240 && closes 'closed while it is opened'
begins ' - opening ' blocked.vrt --size 320x240 && xdotool windowfocus "$id" key Escape && ends 'Escape while it is opened'
begins ' - reading ' endless.vrt --size 320x240 --no-display && closes 'closed without a display'
viewer_before=$viewer viewer=$globe
begins ' - opening ' blocked.vrt --size 320x240 && closes 'a planet closed'
viewer=$viewer_before
# Figures that were asked for, of which there are none then.
rm -f stats.json
for file in endless.vrt blocked.vrt; do
    if begins ' - (reading|opening) ' $file --size 320x240 --stats stats.json; then
        "$build/tests/drop-file" "$id"
        ends "closed before there are figures: $file"
        { [ "$(cat stderr.txt)" = 'planar-viewer: warning: closed before anything was drawn: there are no figures' ] &&
            [ ! -e stats.json ]; } || report "closed before there are figures: $file"
    fi
done

# ---- Without a display that is told long before the file is read

refuses 1 'no display.*-o FILE.png writes a picture without a display' timeout 20 env -u DISPLAY $viewer endless.vrt
refuses 1 'no display.*-o FILE.png writes a picture without a display' timeout 20 env -u DISPLAY $viewer blocked.vrt

# ---- What fails meanwhile

if begins ' - opening ' blocked.vrt --size 320x240; then
    cases=$((cases + 1))
    await_unblocked gone || { fail 'a file that cannot be read: does not end'; kill -9 $pid; }
    wait $pid
    rc=$?
    { [ $rc = 1 ] && [ "$(grep -c '^planar-viewer: blocked.vrt: ' stderr.txt)" = 1 ]; } ||
        report "a file that cannot be read: exit code $rc"
fi

# ---- Files that fall on the window

drop() { # FILE
    cases=$((cases + 1))
    "$build/tests/drop-file" "$id" "$1" || fail "$1: the window does not take it"
}
if start hills.tif --size 640x480 --view 2000,1500,2500,30,-15; then
    sleep 1
    key p '^terraclip-0001.png'
    drop blocked.vrt
    await has_window ' - opening ' || fail 'blocked.vrt: its progress is not told'
    drop slow.vrt # in vain
    await said '^planar-viewer: slow.vrt: cannot be opened while another file is loaded' || fail 'slow.vrt: lost'
    xdotool windowsize "$id" 500 400
    await sh -c "xdotool getwindowgeometry $id | grep -q 500x400" || fail 'cannot be made smaller meanwhile'
    xdotool windowsize "$id" 640 480
    sleep 0.5
    await_unblocked said '^planar-viewer: .*blocked.vrt: ' || fail 'blocked.vrt: that it cannot be read is not told'
    sleep 1
    xdotool windowfocus "$id"
    key p '^terraclip-0002.png'
    same terraclip-0001.png terraclip-0002.png 'after what could not be opened'
    drop slow.vrt
    cases=$((cases + 2))
    await has_window '^slow.vrt - reading ' || fail 'slow.vrt: its progress is not told'
    await said '^slow.vrt: opened' || fail 'slow.vrt is not opened'
    drop endless.vrt
    await has_window '^endless.vrt - reading ' || fail 'endless.vrt: its progress is not told'
    "$build/tests/drop-file" "$id"
    ends 'closed while a file is loaded that fell on it'
fi

# ---- Ended while a file is loaded that fell on the window, whether or not that can be stopped: what was drawn before is
# reported

end_by() { # HOW
    case $1 in
    closing) "$build/tests/drop-file" "$id" ;;
    *) kill -s "$1" $pid ;;
    esac
}
while read -r how file; do
    rm -f stats.json
    if start hills.tif --size 320x240 --stats stats.json --explain; then
        drop $file
        await has_window "^$file - (reading|opening) " || fail "$file: its progress is not told"
        end_by $how
        ends "$how while $file is loaded"
        cases=$((cases + 1))
        { grep -Eq '"frames": [1-9]' stats.json && grep -q '^uses: ' stdout.txt; } || report "$how while $file is loaded"
    fi
done <<'end'
closing endless.vrt
closing blocked.vrt
INT endless.vrt
INT blocked.vrt
TERM blocked.vrt
end

finish

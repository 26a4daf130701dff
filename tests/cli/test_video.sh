#!/bin/sh
# Films of flights: as long and as large as they should be, and what they show is what the frames beside them show.
. "${0%/*}/lib.sh"

command -v ffprobe >/dev/null 2>&1 || { skip 'ffprobe is not installed'; finish; }

$make_file tiff hills.tif size=257x257 metres=30
printf '2000,1500,2500,30,-25\n5000,4000,2500,120,-25\n' >path.txt
flight="$viewer hills.tif --path path.txt --size 320x240"

probe() { # FILE ENTRY
    ffprobe -v error -count_frames -select_streams v -show_entries "stream=$2" -of csv=p=0 "$1"
}
film() { # FILE CODECS RATE OPTION...
    file=$1 codecs=$2 rate=$3
    shift 3
    run $flight --frames 12 --video "$file" "$@"
    [ $rc = 0 ] || { report 'a film' "$file" "$@"; return; }
    cases=$((cases + 3))
    case " $codecs " in *" $(probe "$file" codec_name) "*) ;; *) fail "$file is $(probe "$file" codec_name)" ;; esac
    [ "$(probe "$file" width,height,nb_read_frames)" = 320,240,12 ] || fail "$file is $(probe "$file" width,height,nb_read_frames)"
    [ "$(probe "$file" r_frame_rate)" = "$rate/1" ] || fail "$file has $(probe "$file" r_frame_rate) frames a second"
}
# Frame i of the film is frame i of the pictures, and no other.
agrees() { # FILE
    ffmpeg -v error -y -i "$1" shown-%d.png
    for frame in 0 5 11; do
        cases=$((cases + 2))
        own=$("$make_picture" differ "frame-$frame.png" "shown-$((frame + 1)).png")
        other=$("$make_picture" differ "frame-$frame.png" "shown-$(((frame + 6) % 12 + 1)).png")
        awk "BEGIN { exit !($own <= 4) }" || fail "$1: frame $frame is $own of 255 off its picture"
        awk "BEGIN { exit !($other > 2 * $own) }" || fail "$1: frame $frame is $own off its picture, another one $other"
    done
    rm -f shown-*.png
}
film out/a.webm 'vp9 vp8' 30 -o frame-%d.png
agrees out/a.webm
film out/b.mp4 'h264 mpeg4' 24 --rate 24
agrees out/b.mp4
film out/c.MP4 'h264 mpeg4' 30 -q
# A film alone takes as many samples a pixel as pictures do, and odd sizes are told.
run $viewer hills.tif --path path.txt --frames 2 --size 101x51 --video out/odd.mp4
{ [ $rc = 0 ] && grep -q 'the last row and column is left out' stderr.txt && [ "$(probe out/odd.mp4 width,height)" = 100,50 ]; } ||
    report 'a film of an odd size'
rm -f out/*

refuses 2 '--video: expected a name that ends in .mp4 or .webm, found' $flight --frames 2 --video out/a.avi
refuses 2 '--video: expected a name that ends' $flight --frames 2 --video mp4
refuses 2 '--video: expected --path FILE with it, found none' $viewer hills.tif --video out/a.mp4
refuses 2 '--video: expected --backend' $flight --frames 2 --video out/a.mp4 --backend window
refuses 2 '--rate: expected --video' $flight --frames 2 --rate 25
for rate in 0 -1 241 x 25.5; do
    refuses 2 '--rate: expected 1..240' $flight --frames 2 --video out/a.mp4 --rate "$rate"
done
refuses 1 'out/none/a.mp4: ' $flight --frames 2 --video out/none/a.mp4
refuses 1 'expected at least 2 x 2 pixels' $viewer hills.tif --path path.txt --frames 2 --size 1x9 --video out/a.mp4 -q
cp hills.tif hills.mp4
refuses 2 'hills.mp4' $viewer hills.mp4 --path path.txt --frames 2 --video hills.mp4
cmp -s hills.tif hills.mp4 || fail 'the terrain was overwritten'
ln -s path.txt path.webm
refuses 2 'path' $flight --frames 2 --video path.webm
# Without the libraries: one line; other flights go on.
mkdir bare && cp -P "$build"/planar-viewer "$build"/terraclip-gdal.so "$build"/terraclip-oiio.so bare/ 2>/dev/null
refuses 1 'video' bare/planar-viewer hills.tif --path path.txt --frames 2 --video out/a.mp4
accepts '' bare/planar-viewer hills.tif $picture
# Ended before its time, there is no film, and nothing beside it.
$flight --frames 100000 --video out/long.mp4 >/dev/null 2>&1 &
pid=$!
sleep 2
kill -TERM $pid
wait $pid
cases=$((cases + 1))
rm -f out/picture.png
[ -z "$(ls out)" ] || fail "an interrupted film leaves $(ls out)"

finish

#!/bin/sh
# Where the viewers look from, and how steep what they look at is: --exaggeration, --lookat, --views.
. "${0%/*}/lib.sh"

$make_file tiff globe.tif size=128x64 globe=-180,128,64 area=1
$make_file tiff metres.tif size=257x257 metres=30
$make_file tiff degree.tif place=-112,37 size=121x121
$make_file tiff holes.tif place=-112,37 heights=voids nodata=-32768 size=121x121
$terraclip pack metres.tif -o metres.tclip -q || fail 'pack'
$terraclip pack degree.tif -o degree.tclip -q --lossless || fail 'pack'
$terraclip pack --planet globe.tif -o globe.tclip -q || fail 'pack --planet'
printf '0%% 10 20 200\n100%% 250 240 30\n' >shares.txt

# ---- Exaggeration

# A terrain drawn twice as high looks as a file of twice the heights does, but for what is told of heights; these colours
# tell shares of them.
alike() { # PROGRAM FILE OPTION...
    accepts '' "$@" -q $picture --colours shares.txt --shade height --exaggeration 2 && cp last.png drawn.png
    accepts '' "$@" -q $picture --colours shares.txt --shade height --unit 2
    same drawn.png last.png "--exaggeration 2 and twice the heights: $*"
}
alike $viewer metres.tif
alike $viewer metres.tif --view 3000,1000,6000,20,-40
alike $viewer metres.tif --view 3000,1000,6000,20,-40 --synthesis 3
alike $viewer holes.tif --voids hole
alike $globe globe.tif --view 10,20,200000,30,-40
alike $globe degree.tif --view=-111.5,37.2,40000,10,-30
for scheme in hex cube cube-pt rings-ch06; do
    alike $globe globe.tif --view 10,20,200000,30,-40 --scheme $scheme
done
# Contours and colours of heights tell true heights; so do slopes.
accepts '' $viewer metres.tif -q $picture --colours shares.txt --shade height --exaggeration 2 --contours 100
mv last.png drawn.png
accepts '' $viewer metres.tif -q $picture --colours shares.txt --shade height --unit 2 --contours 200
same drawn.png last.png 'lines of 100 m'
printf '1000 10 20 200\n1100 250 240 30\n' >metres.txt
printf '2000 10 20 200\n2200 250 240 30\n' >twice.txt
accepts '' $viewer metres.tif -q $picture --colours metres.txt --shade none --exaggeration 2 && mv last.png drawn.png
accepts '' $viewer metres.tif -q $picture --colours twice.txt --shade none --unit 2
same drawn.png last.png 'colours of 1000 m'
down='--view 3840,3840,60000,0,-90'
accepts '' $viewer metres.tif -q $picture $down --shade slope && mv last.png plain.png
accepts '' $viewer metres.tif -q $picture $down --shade slope --exaggeration 1.02
cases=$((cases + 1))
$make_picture differ plain.png last.png | awk '{ exit !($1 < 1) }' || fail 'slopes are not the true ones'
# One is none.
accepts '' $viewer metres.tif $picture && mv last.png plain.png
accepts '' $viewer metres.tif $picture --exaggeration 1
same plain.png last.png '--exaggeration 1'
for factor in 0.01 1000; do
    accepts '' $viewer metres.tclip $picture --exaggeration $factor --error 2
done
for factor in 0.01 100; do
    accepts '' $globe globe.tclip $picture --exaggeration $factor --synthesis 2
    accepts '' $globe globe.tif $picture --exaggeration $factor --error 1
done
run $viewer metres.tif --size 96x64 -o out/picture.png --exaggeration 2.5 --explain --stats stats.json
[ $rc = 0 ] && grep -q '^uses: exaggeration: heights are drawn 2.5 times as high' stdout.txt &&
    grep -q '"exaggeration": 2.5$' stats.json || report '--exaggeration is not told' $viewer
run $viewer metres.tif --size 96x64 -o out/picture.png --explain --stats stats.json
[ $rc = 0 ] && grep -q '^left out: exaggeration: ' stdout.txt && grep -q '"exaggeration": 1$' stats.json ||
    report 'no exaggeration is not told' $viewer
rm -f out/*
for factor in 0 -1 0.001 1001 nan inf 2x '' x; do
    refuses 2 '--exaggeration: expected a factor of 0.01..1000, found' $globe globe.tif $picture --exaggeration "$factor"
done
refuses 1 'exaggeration: expected one that leaves heights small beside the radius' $globe globe.tif $picture \
    --radius 30000 --exaggeration 20
# The ground that the eye is lifted above is the one drawn.
accepts 'the eye was .* m under the ground' $viewer metres.tif $picture --view 3840,3840,3000,0,0 --exaggeration 10
accepts '' $viewer metres.tif $picture --view 3840,3840,3000,0,0

# ---- A place to look at

# On a globe, straight down, and north from a distance.
accepts '' $globe degree.tif $picture --lookat=-111.5,37.5,0 --distance 60000 --pitch -90 && mv last.png looked.png
accepts '' $globe degree.tif $picture --view=-111.5,37.5,60000,0,-90
same looked.png last.png 'a place from above, on a globe'
accepts '' $globe degree.tif $picture --lookat 248.5,37.5,0 --distance 60000 --pitch -90
same looked.png last.png 'once more around'
accepts '' $globe degree.tclip $picture --lookat=-111.5,37.5,0 --distance 60000 --pitch -90
same looked.png last.png 'a packed map'
accepts '' $globe degree.tif $picture --lookat=-111.5,37.5 --distance 60000 && mv last.png north.png
accepts '' $globe degree.tif $picture --lookat=-111.5,37.5 --distance 60000 --heading 360 --pitch -30
same north.png last.png 'north, 30 degrees down'
for file in globe.tif globe.tclip; do
    for place in -180,90 17.5,-90,3000; do
        accepts '' $globe $file $picture --lookat=$place --distance 1e7 --heading 120 --pitch -60
    done
done
accepts '' $globe globe.tif $picture --lookat 10,20 --scheme hex
# On a plane: in degrees, and in metres of a zone of UTM, whose middle meridian is 9 degrees east.
down='--distance 20000 --pitch -90'
spacing=$($viewer degree.tif -v -o out/picture.png --size 96x64 2>&1 | sed -n 's/.*samples every \([^ ]*\) x \([^ ]*\) m.*/\1 \2/p')
rm -f out/*
set -- $spacing
middle=$(awk "BEGIN { printf \"%.6f,%.6f\", 60 * $1, 60 * $2 }")
accepts '' $viewer degree.tif $picture --lookat=-111.5,37.5,0 $down --background 000000 && mv last.png looked.png
accepts '' $viewer degree.tif $picture --view $middle,20000,0,-90 --background 000000
cases=$((cases + 1))
$make_picture differ looked.png last.png | awk '{ exit !($1 < 0.5) }' || fail "not the middle, $middle"
accepts '' $viewer metres.tif $picture --lookat 9.05,46.91,0 $down && mv last.png looked.png
accepts '' $viewer metres.tclip $picture --lookat 9.05,46.91,0 $down
cases=$((cases + 1))
$make_picture differ looked.png last.png | awk '{ exit !($1 < 1) }' || fail 'a packed map looks different'
accepts '' $viewer metres.tif $picture --lookat 9.05,46.91 --exaggeration 3
for end in 1 40; do # degrees east: near the side of the map; far outside of the zone
    refuses 1 '--lookat: expected a place on metres.tif, found one beside it, at ' $viewer metres.tif $picture --lookat $end,46.91
done
refuses 1 '--lookat: expected a place on degree.tif, found one beside it, at 7,37.5' $globe degree.tif $picture --lookat 7,37.5
refuses 1 '--lookat: expected a place on degree.tif, found one beside it, at -111.5,38.1' $viewer degree.tif $picture \
    --lookat=-111.5,38.1
$make_file tiff plain.tif size=65x65 metres=0
refuses 2 '--lookat: expected a map that says where on a globe it lies, found plain.tif without a georeference' \
    $viewer plain.tif $picture --lookat 1,2
for place in 1 1, 1,91 361,0 1,2,3,4 1,2, nan,0 0,inf 0,0,1e10 ' 1,2' 1,2x ''; do
    refuses 2 '--lookat: expected LON,LAT.,HEIGHT. in degrees' $globe globe.tif $picture --lookat "$place"
done
refuses 2 '--lookat: expected a height above the middle of globe.tif, found -7000000 m' $globe globe.tif $picture --lookat 1,2,-7e6
for distance in 0 -5 nan inf 1e13 5km ''; do
    refuses 2 '--distance: expected metres above 0, up to 1e12' $globe globe.tif $picture --lookat 1,2 --distance "$distance"
done
refuses 2 '--heading: expected -360..360' $globe globe.tif $picture --lookat 1,2 --heading 361
refuses 2 '--pitch: expected -90..90' $globe globe.tif $picture --lookat 1,2 --pitch 91
refuses 2 '--lookat: expected either it or --view, found both' $globe globe.tif $picture --lookat 1,2 --view 1,2,3,4,5
refuses 2 '--lookat: expected either it or --path, found both' $globe globe.tif --lookat 1,2 --path x --frames 2
for alone in distance heading pitch; do
    refuses 2 "--$alone: expected --lookat LON,LAT with it, found none" $globe globe.tif $picture --$alone 5
done
# Over what stands in its way the eye is lifted; and so it is, and told by how much, wherever it was asked to be.
accepts 'the eye was .* m under the ground' $viewer metres.tif $picture --lookat 9.05,46.91,0 --distance 2000 --pitch -5
for file in metres.tif metres.tclip; do
    accepts 'the eye was [0-9.]+ m under the ground: lifted above it' $viewer $file $picture --view 3840,3840,10,0,0
    accepts '' $viewer $file -q $picture --view 3840,3840,10,0,0
done
printf '3840,3840,9000,0,-50\n3840,3840,10,0,0\n' >down.txt
for file in metres.tif metres.tclip; do
    run $viewer $file --path down.txt --frames 4 --size 96x64
    [ $rc = 0 ] && [ "$(grep -c 'm under the ground: lifted' stderr.txt)" = 1 ] || report 'a path under the ground' $viewer
done

# ---- Views that were meant otherwise

refers='warning: --view: .* look like longitude and latitude, which are on the terrain: --lookat -111.5,37.5 looks at'
accepts "$refers" $viewer degree.tif $picture --view=-111.5,37.5,9000,0,-30
accepts 'warning: --view: .*: --lookat 9.05,46.91 looks' $viewer metres.tif $picture --view=9.05,46.91,9000,0,-30 \
    --spacing 300 # within the terrain, in a corner of it
accepts 'warning: --view: .* coordinates of its own system, .*: there it is --view 3000,3000,\.\.\.' \
    $viewer metres.tif $picture --view 503000,5195320,9000,0,-30
for view in 10,20,9000,0,-30 -111.5,30,9000,0,-30 -5000,-5000,9000,45,-30 1e6,5e6,1e6,0,-60; do
    accepts '' $viewer metres.tif $picture "--view=$view"
done
accepts '' $viewer degree.tif -q $picture --view=-111.5,37.5,9000,0,-30
accepts '^planar-viewer: warning: no georeference' $viewer plain.tif $picture --view=9,46,9000,0,-30
accepts '' $globe degree.tif $picture --view=-111.5,37.5,9000,0,-30

# ---- Files of views

printf '%s\n' '# mine' '' '3000,1000,6000,20,-40 # over the hills' '100,100,9000,45,-60' \
    '3000,3000,6000,20,-40 # over the hills' '4000,1000,6000,0,-40 # other' >views.txt
accepts '' $viewer metres.tif $picture --views views.txt --view '@over the hills' && mv last.png named.png
accepts '' $viewer metres.tif $picture --view 3000,1000,6000,20,-40
same named.png last.png 'a view by its name'
accepts '' $viewer metres.tif $picture --view @other --views views.txt
different named.png last.png 'another view'
accepts '' $viewer metres.tif $picture --views views.txt # which nobody asks for
accepts '' $viewer metres.tif $picture --view @other --view 3000,1000,6000,20,-40 # the last one counts
same named.png last.png 'a view that counts'
run $viewer metres.tif --size 96x64 --path views.txt --frames 4 -o frame-%d.png
same frame-0.png named.png 'the first view of a path'
printf '10,20,2e6,30,-60 # there\n' >globe.txt
accepts '' $globe globe.tif $picture --views globe.txt --view @there && mv last.png named.png
accepts '' $globe globe.tif $picture --view 10,20,2e6,30,-60
same named.png last.png 'a view of a globe by its name'
cp views.txt before.txt
refuses 2 '--view: expected --views FILE with @other, found none' $viewer metres.tif $picture --view @other
refuses 2 "views.txt: expected a view named 'lake', found none" $viewer metres.tif $picture --views views.txt --view @lake
refuses 2 '--view: expected X,Y,Z' $viewer metres.tif $picture --views views.txt --view @
refuses 1 'missing.txt: cannot be opened' $viewer metres.tif $picture --views missing.txt --view @other
refuses 1 'views.txt: line 3: expected LON,LAT,ALT' $globe globe.tif $picture --views views.txt --view @other
refuses 1 'metres.tif: expected text, found zero bytes' $viewer metres.tif $picture --views metres.tif --view @other
cp views.txt views.png
refuses 2 'views.png' $viewer metres.tif -o views.png --views views.png --view @other
refuses 2 'views.txt' $viewer metres.tif $picture --stats views.txt --views views.txt --view @other
cases=$((cases + 1))
cmp -s views.txt before.txt || fail 'a file of views has changed'

finish

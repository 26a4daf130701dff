#!/bin/sh
# Where the viewers look from, and how steep what they look at is: --exaggeration, --lookat, --views.
. "${0%/*}/lib.sh"

$make_file tiff globe.tif size=128x64 globe=-180,128,64 area=1
$make_file tiff metres.tif size=257x257 metres=30
$make_file tiff degree.tif place=-112,37 size=121x121
$make_file tiff holes.tif place=-112,37 heights=voids nodata=-32768 size=121x121
$terraclip pack metres.tif -o metres.tclip -q || fail 'pack'
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
for factor in 0.01 0.5 3.5 1000; do
    accepts '' $viewer metres.tif $picture --exaggeration $factor
    accepts '' $viewer metres.tclip $picture --exaggeration $factor --error 2
done
for factor in 0.01 0.5 3.5 100; do
    accepts '' $globe globe.tif $picture --exaggeration $factor
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
    refuses 2 '--exaggeration: expected a factor of 0.01..1000, found' $viewer metres.tif $picture --exaggeration "$factor"
    refuses 2 '--exaggeration: expected a factor of 0.01..1000, found' $globe globe.tif $picture --exaggeration "$factor"
done
refuses 1 'exaggeration: expected one that leaves heights small beside the radius' $globe globe.tif $picture \
    --radius 30000 --exaggeration 20
# The ground that the eye is lifted above is the one drawn.
accepts 'the eye was .* m under the ground' $viewer metres.tif $picture --view 3840,3840,3000,0,0 --exaggeration 10
accepts '' $viewer metres.tif $picture --view 3840,3840,3000,0,0

finish

#!/bin/sh
# Where the sea is: --sea.
. "${0%/*}/lib.sh"

$make_file tiff globe.tif size=128x64 globe=-180,128,64 area=1
$make_file tiff metres.tif size=257x257 metres=30
$make_file tiff degree.tif place=-112,37 size=121x121
$make_file tiff holes.tif place=-112,37 heights=voids nodata=-32768 size=121x121
$terraclip pack metres.tif -o metres.tclip -q --lossless || fail 'pack'
$terraclip pack --planet globe.tif -o globe.tclip -q || fail 'pack --planet'
printf '0%% 10 200 20\n100%% 10 200 20\n' >one.txt
middle=1000 # some of these files' ground is below that

# ---- At a height

for file in metres.tif metres.tclip degree.tif holes.tif; do
    for level in $middle 0 -3000 9000; do
        accepts '' $viewer $file -q $picture --sea=$level
        accepts '' $viewer $file -q $picture --sea=$level --no-surroundings --shade height --contours 100
    done
done
for file in metres.tif holes.tif; do
    accepts '' $viewer $file -q $picture && mv last.png plain.png
    accepts '' $viewer $file -q $picture --sea $middle
    different plain.png last.png "--sea, $file"
done
# Of a sea over all of it nothing else is seen, whatever it is coloured by: against a background of its colour there is
# nothing to be seen at all.
water='--background 28547a --no-surroundings --sea 9000 -q'
blue() { # ASIDE COMMAND...
    aside=$1
    shift
    accepts '' "$@" $picture $water && mv last.png drawn.png
    accepts '' "$@" $picture $water --view $aside
    cases=$((cases + 1))
    $make_picture differ drawn.png last.png | awk '{ exit !($1 < 1) }' || report 'something else is seen than water' "$@"
}
for more in '--unlit' '--shade none' '--shade slope' '--shade aspect' '--colours one.txt --unlit' '--error 1 --unlit' \
    '--samples 1 --unlit' '--no-morph --unlit'; do
    blue 3840,3840,20000,0,80 $viewer metres.tif $more
done
for scheme in rings hex cube; do
    blue 10,20,200000,0,80 $globe globe.tif --unlit --view 10,20,200000,0,-80 --scheme $scheme
    accepts '' $globe globe.tif -q $picture --scheme $scheme && mv last.png plain.png
    accepts '' $globe globe.tif -q $picture --scheme $scheme --sea $middle
    different plain.png last.png "--sea, $scheme"
    accepts '' $globe globe.tif -q $picture --scheme $scheme --sea $middle --synthesis 1
done
accepts '' $globe globe.tif -q $picture --scheme hex --sea $middle --error 1
accepts '' $globe globe.tclip -q $picture --sea=-200
for level in -500 0 1200 9000; do
    accepts '' $globe degree.tif -q $picture --sea=$level
    accepts '' $globe degree.tif -q $picture --sea=$level --no-surroundings
done
# A true height, however high heights are drawn; and the eye is above it.
accepts '' $viewer metres.tif -q $picture --sea $middle --exaggeration 3
accepts 'the eye was .* m under the ground' $viewer metres.tif $picture --sea 2000 --view 3840,3840,1900,0,0
accepts '' $viewer metres.tif $picture --sea 2000 --view 3840,3840,4100,0,-20 --exaggeration 2
accepts 'the eye was .* m under the ground' $viewer metres.tif $picture --sea 2000 --view 3840,3840,3900,0,-20 --exaggeration 2
accepts 'the eye was .* m under the ground' $viewer metres.tif $picture --sea 1200 --view=-3000,-3000,500,45,-5 # beside it, too
accepts '' $viewer metres.tif $picture --sea 1200 --view=-3000,-3000,500,45,-5 --background 000000
# Also over what is not known.
blue 3840,3840,20000,0,80 $viewer holes.tif --view 3840,3840,20000,0,-80 --unlit --voids hole
# Small terrains have shores, too.
small='metres.tif --unit 0.00001 --spacing 0.0003 -q --shade none --no-surroundings --background 28547a'
accepts '' $viewer $small $picture --sea 0.012 && mv last.png drawn.png
accepts '' $viewer $small $picture --sea 9 && mv last.png wet.png
different drawn.png wet.png '--sea, a small terrain'
# The sea's edge is no line.
accepts '' $viewer metres.tif -q $picture --sea 9000 --shade none && mv last.png plain.png
accepts '' $viewer metres.tif -q $picture --sea 9000 --shade none --contours 100
same plain.png last.png 'lines on the sea'
# The first view is of the ground, however far below it the sea is.
accepts '' $viewer metres.tif -q $picture --no-surroundings --sea=-1e9 && mv last.png drawn.png
accepts '' $viewer metres.tif -q $picture --no-surroundings --sea=-1e8
same drawn.png last.png 'a sea far below'

# ---- None

accepts '' $viewer metres.tif -q $picture --sea none
accepts '' $viewer metres.tif -q $picture --offset=-900 && mv last.png plain.png
accepts '' $viewer metres.tif -q $picture --offset=-900 --sea none
different plain.png last.png '--sea none'
accepts '' $globe globe.tif -q $picture --sea none

# ---- What is told

run $viewer metres.tif --sea 150.5 --size 96x64 -o out/picture.png --explain --stats stats.json
[ $rc = 0 ] && grep -q '^uses: sea: at 150.5 m, over all ground below it$' stdout.txt && grep -q '"sea": 150.5,$' stats.json ||
    report '--sea is not told' $viewer
run $viewer metres.tif --sea none --size 96x64 -o out/picture.png --json
[ $rc = 0 ] && grep -q '"sea": "none",$' stdout.txt && grep -q '"water: no sea is asked for"' stdout.txt ||
    report '--sea none is not told' $viewer
run $viewer metres.tif --size 96x64 -o out/picture.png --explain --stats stats.json
[ $rc = 0 ] && ! grep -q '^uses: sea: ' stdout.txt && grep -q '"sea": "auto",$' stats.json || report 'no --sea is told of' $viewer
rm -f out/*

# ---- What cannot be

for level in -1e9 1e9 -6.4e6; do
    refuses 2 '--sea: expected a level that is small beside the radius, found' $globe globe.tif $picture --sea=$level
done
for level in 1e9 -1e9; do
    accepts '' $viewer metres.tif $picture --sea=$level -q
    refuses 1 'exaggeration: expected one that leaves (heights|the sea) small' $viewer metres.tif $picture --sea=$level \
        --exaggeration 2
done

finish

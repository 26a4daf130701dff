#!/bin/sh
# The light of natural colours: --sun and --date.
. "${0%/*}/lib.sh"

$make_file tiff globe.tif size=128x64 globe=-180,128,64 area=1
$make_file tiff metres.tif size=257x257 metres=30
$make_file tiff degree.tif place=-112,37 size=121x121
$make_file tiff plain.tif size=65x65 metres=0
$terraclip pack degree.tif -o degree.tclip -q --lossless || fail 'pack'
$terraclip pack --planet globe.tif -o globe.tclip -q || fail 'pack --planet'

# ---- What is given

for file in metres.tif degree.tclip plain.tif; do
    accepts '' $viewer $file -q $picture && mv last.png usual.png
    accepts '' $viewer $file -q $picture --sun 310,38
    same usual.png last.png "the usual light, $file"
    accepts '' $viewer $file -q $picture --sun=-50,38
    same usual.png last.png "the usual light, $file"
    accepts '' $viewer $file -q $picture --sun 130,38
    different usual.png last.png "--sun 130,38, $file"
    accepts '' $viewer $file -q $picture --sun 310,-20
    different usual.png last.png "--sun 310,-20, $file"
done
for scheme in rings hex cube; do
    accepts '' $globe globe.tif $picture --scheme $scheme && mv last.png usual.png
    accepts '' $globe globe.tif $picture --scheme $scheme --sun 310,38
    same usual.png last.png "the usual light, $scheme"
    accepts '' $globe globe.tif $picture --scheme $scheme --sun 130,-10
    different usual.png last.png "--sun 130,-10, $scheme"
done
for sun in 360,90 -360,-90 0,0; do
    accepts '' $viewer metres.tif $picture --sun=$sun
    accepts '' $globe globe.tclip $picture --sun=$sun
done

# ---- Where it stands

# By sums that are made by hand: noon is 4 minutes a degree from Greenwich's and off by the equation of time, and then the
# sun stands as far from overhead as the place is from the latitude over which it stands. Degrees.
stands() { # AZIMUTH ELEVATION COMMAND...
    azimuth=$1 elevation=$2
    shift 2
    run "$@" -q --json -o out/picture.png --size 96x64
    sed -n 's/.*"sun": {"azimuth": \([^,]*\), "elevation": \([^}]*\)}.*/\1 \2/p' stdout.txt |
        awk "{ found = 1; ok = (\$1 - $azimuth) ^ 2 < 0.1 && (\$2 - $elevation) ^ 2 < 0.1 }
            END { exit !(found && ok) }" || report "the sun, expected at $azimuth, $elevation: $(grep '"sun"' stdout.txt)" "$@"
    rm -f out/*
}
stands 310 38 $viewer metres.tif
stands 200 -5 $viewer metres.tif --sun=-160,-5
for file in degree.tif degree.tclip; do # 111.5 degrees west, 37.5 north, in winter: the 1.9 minutes early
    stands 180 29.06 $viewer $file --date 2024-12-21T19:24Z
    stands 180 29.06 $globe $file --date 2024-12-21T19:24Z --view=-111.5,37.5,60000,0,-90
done
# At an equinox: 7.4 minutes late, and four hours earlier and later, when it is 0.3 and 0.4 degrees north of the equator.
for file in globe.tif globe.tclip; do
    stands 90 30 $globe $file --date 2024-03-20T15:33Z --view=-111.5,0,60000,0,-90
    stands 270.39 30 $globe $file --date 2024-03-20T23:33Z --view=-111.5,0,60000,0,-90
    stands 270.46 -30 $globe $file --date 2024-03-21T03:33Z --view=-111.5,0,60000,0,-90
done
# Around a pole maps have north in another direction: these columns go south, but for 5.6 degrees.
$make_file tiff polar.tif size=257x257 metres=30 epsg=3413
stands 5.58 45.7 $viewer polar.tif --date 2024-03-20T03:30Z
# Also where the pole is less than a sample from the middle, and where it is the middle: from its columns, which go along
# the meridians of 45 degrees west and 135 east, the sun is at the same angle everywhere.
for side in 64 65; do
    $make_file tiff pole.tif size=${side}x$side metres=1000 from=-532,5168 epsg=3413
    stands 186.5 0.2 $viewer pole.tif --date 2024-03-20T15:33Z
done
# What the sun does not light is told of none.
for unlit in --unlit '--shade height'; do
    run $viewer metres.tif $unlit --json --size 96x64 -o out/picture.png
    [ $rc = 0 ] && grep -q '"sun": null,$' stdout.txt || report "--json: a sun with $unlit" $viewer
done
# A globe's sun stays where it is, and one that is given follows the eye.
run $viewer degree.tif --date 2024-12-21T19:24Z --explain --size 96x64 -o out/picture.png
[ $rc = 0 ] && grep -Eq '^uses: sun: azimuth (179|180)[.0-9]*, elevation 29[.0-9]* degrees, at 2024-12-21T19:24Z$' stdout.txt ||
    report "--explain: $(grep sun: stdout.txt)" $viewer --date
run $viewer degree.tif --sun 10,20 --explain --size 96x64 -o out/picture.png
[ $rc = 0 ] && grep -q '^uses: sun: azimuth 10, elevation 20 degrees$' stdout.txt || report '--explain' $viewer --sun
run $viewer degree.tif --explain --size 96x64 -o out/picture.png
[ $rc = 0 ] && ! grep -q '^uses: sun:' stdout.txt || report '--explain tells of a sun that nobody gave' $viewer
rm -f out/*
accepts '' $globe degree.tif $picture --date 2024-06-20T08:00Z --background 000000

# ---- What cannot be

date='--date 2024-06-20T12:00Z'
refuses 2 '--date: expected a map that says where on a globe it lies, found plain.tif without a georeference' $viewer plain.tif \
    $picture $date
refuses 2 '--date: expected a map of the Earth, whose days are known, found globe.tif of another body' $globe globe.tif $picture \
    $date --radius 1737400
refuses 2 '--date: expected either it or --sun, found both' $viewer metres.tif $picture $date --sun 1,2
refuses 2 '--sun: expected no --unlit with it' $globe globe.tif $picture --sun 1,2 --unlit
for shade in slope aspect height none; do
    refuses 2 "--date: expected natural colours, whose light it is, found --shade $shade" $viewer metres.tif $picture $date \
        --shade $shade
done

finish

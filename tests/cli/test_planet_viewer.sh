#!/bin/sh
# planet-viewer as its users see it: which maps of planets it shows, from where, and what it refuses.
. "${0%/*}/lib.sh"

# ---- Maps that are shown

$make_file tiff globe.tif size=128x64 globe=-180,128,64 area=1
$make_file tiff east.tif size=128x64 globe=0,128,64 area=1
$make_file tiff points.tif size=129x65 globe=-180,129,65
accepts '' $globe globe.tif $picture
accepts '' $globe globe.tif $picture
cp last.png first.png
accepts '' $globe globe.tif $picture
same first.png last.png 'the same planet, twice'
accepts '' $globe points.tif $picture
for view in 0,90,1e6,0,-90 0,-90,1e6,0,-90 180,0,1e6,0,-90 360,45,2000,0,-10 10,20,6e7,0,-90 10,20,1e12,0,-90; do
    accepts '' $globe globe.tif $picture "--view=$view"
done
# An eye under the ground is lifted above it, and that is said.
for view in -180,0,5,90,0 17,89.9999999,3,0,10 10,20,-1e6,0,0 0,0,0,0,90; do
    accepts 'warning: the eye was .* m under the ground' $globe globe.tif $picture "--view=$view"
    accepts '' $globe globe.tif $picture "--view=$view" -q
done
# Longitudes 360 degrees apart are one place.
accepts '' $globe globe.tif $picture --view 170,10,2e6,30,-60 && cp last.png first.png
accepts '' $globe globe.tif $picture --view=-190,10,2e6,30,-60
same first.png last.png 'once more around'
for option in --unlit --level-colours --wireframe --no-morph '--n 128' '--n 1024' '--steps 8' '--levels 3' \
    '--scheme rings-ch06' '--background ff00ff' '--radius 1737400' '--radius 20000' '--radius 1e8' '--voids hole'; do
    accepts '' $globe globe.tif $picture $option
done
accepts '' $globe globe.tif $picture --backend osmesa
# A picture without a place, twice as wide as high.
$make_file png map.png size=128x64 type=u16
accepts 'taken for the whole globe|warning' $globe map.png $picture
# Parts of a globe.
$make_file hgt N46E008.hgt
accepts '' $globe N46E008.hgt $picture
accepts '' $globe N46E008.hgt $picture --view 8.5,46.5,4000,90,-10
accepts '' $globe N46E008.hgt $picture --view=-171.5,-46.5,4e6,90,-80
$make_file tiff degree.tif place=-112,37 heights=voids nodata=-32768 size=121x121
accepts '' $globe degree.tif $picture --voids hole
# A map that goes around but not to the poles: no background shows through beside it.
$make_file tiff band.tif size=128x40 globe=-180,128,64 from=0,12 area=1 lift=3000
accepts '' $globe band.tif $picture --background ff00ff --view 10,80,2000,0,-89 && cp last.png first.png
accepts '' $globe band.tif $picture --background 00ff00 --view 10,80,2000,0,-89
same first.png last.png 'beside a band around the globe'
accepts '' $globe band.tif $picture
# An eye that is below what coarse levels show is lifted, on a flight as in a picture.
accepts 'under the ground' $globe globe.tif $picture --levels 1 --view 31,17,-3000,0,0 && cp last.png first.png
printf '%s\n' -60,-40,4e6,0,-90 31,17,-3000,0,0 >far.txt
run $globe globe.tif --levels 1 --path far.txt --frames 2 -o frame-%d.png --size 96x64
same first.png frame-1.png 'a picture and the frame of a flight'
# Packed.
$terraclip pack --planet globe.tif -o globe.tclip -q || fail 'pack --planet'
accepts '' $globe globe.tclip $picture
accepts '' $viewer globe.tclip $picture
$terraclip pack degree.tif -o degree.tclip -q || fail 'pack'
accepts '' $globe degree.tclip $picture
accepts '' $globe degree.tclip $picture --radius 1e6
# On an ellipsoid by default, that of the coordinate system, packed flat or not; on others, and on a sphere.
view='--view=-111.5,37.5,90000,20,-40'
accepts '' $globe degree.tif $picture $view && cp last.png ellipsoid.png
accepts '' $globe degree.tif $picture $view --ellipsoid wgs84
same ellipsoid.png last.png 'the ellipsoid of the file, and its name'
accepts '' $globe degree.tif $picture $view --ellipsoid 6378137,298.257223563
same ellipsoid.png last.png 'the ellipsoid of the file, and its numbers'
accepts '' $globe degree.tif $picture $view --ellipsoid sphere && cp last.png sphere.png
accepts '' $globe degree.tif $picture $view --radius 6378137
same sphere.png last.png 'a sphere, and a sphere of that radius'
accepts '' $globe degree.tif $picture $view --radius 6378137 --ellipsoid sphere
same sphere.png last.png 'a sphere of that radius, said twice'
for body in 6378137,inf 6378137,1e10; do
    accepts '' $globe degree.tif $picture $view --ellipsoid $body
    same sphere.png last.png "an ellipsoid that is a sphere: $body"
done
cases=$((cases + 1))
cmp -s ellipsoid.png sphere.png && fail 'an ellipsoid looks like a sphere'
accepts '' $globe degree.tclip $picture $view --ellipsoid sphere && cp last.png sphere.png
accepts '' $globe degree.tclip $picture $view && cp last.png ellipsoid.png
accepts '' $globe degree.tclip $picture $view --ellipsoid wgs84
same ellipsoid.png last.png 'the ellipsoid of a file that is packed flat'
cases=$((cases + 1))
cmp -s ellipsoid.png sphere.png && fail 'an ellipsoid looks like a sphere, packed'
for body in 1000,1.05 1,2 6378137,10; do
    accepts '' $globe globe.tif $picture --unit 1e-5 --ellipsoid $body
done
accepts '' $globe globe.tif $picture --scheme rings-ch06 --ellipsoid 6378137,50
accepts 'taken to be on the ellipsoid of its coordinate system, 6378137 m and 1/298.2572236; --ellipsoid sphere takes' \
    $globe degree.tif $picture -v
accepts 'taken to be on a sphere of 6371000 m; --ellipsoid wgs84 or A,1/F takes' $globe map.png $picture -v
for body in wgs72 '' 6378137 6378137, 6378137,0 6378137,-300 6378137,1 6378137,nan -1,300 0,300 6378137,300x; do
    refuses 2 '--ellipsoid: expected wgs84, sphere or A,1/F: metres of .* above 1 or inf, found' \
        $globe globe.tif $picture --ellipsoid "$body"
done
refuses 2 '--radius: expected no --ellipsoid but sphere with it' $globe globe.tif $picture --radius 5 --ellipsoid wgs84
refuses 1 'radii of curvature' $globe globe.tif $picture --ellipsoid 1000,300
# All of it, but packed flat.
$terraclip pack globe.tif -o map.tclip -q || fail 'pack'
accepts 'warning: map.tclip: packed flat: .* pack it with --planet' $globe map.tclip $picture
accepts 'packed flat' $globe map.tclip $picture --radius 1737400

# ---- A flight, figures

printf '170,10,2e6,0,-60\n-170,20,1e6,30,-50 # over the antimeridian\n-150,89,5e5,0,-40\n' >path.txt
run $globe globe.tif --path path.txt --frames 5 --size 96x64 --json
[ $rc = 0 ] && grep -q '"frames": 5' stdout.txt || report 'a flight' $globe
run $globe globe.tif --size 96x64 -o out/picture.png --explain
[ $rc = 0 ] && grep -q 'left out: .* triangles: beyond the horizon' stdout.txt || report '--explain' $globe
grep -Eq '^uses: rings: [0-9]+ of [0-9]+ drawn' stdout.txt && grep -Eq '^uses: sectors: ' stdout.txt &&
    grep -q '^uses: shaders: sky: .*globe_sky.frag' stdout.txt && grep -q '^uses: chart 2: [1-9]' stdout.txt ||
    fail "--explain: $(cat stdout.txt)"
# Near the ground the caps are out of sight, on a pole all but one of them.
for place in '10,5,200,30,-5 1 2' '10,89.9,200,30,-5 0 2' '10,-89.9,200,30,-5 0 1'; do
    set -- $place
    run $globe globe.tif --size 96x64 -o out/picture.png --explain "--view=$1"
    [ $rc = 0 ] && grep -q '^left out: 2 of 3 charts: not in sight so far' stdout.txt &&
        [ $(grep -Ec "^uses: chart [$2$3]: 0 of" stdout.txt) = 2 ] || fail "--explain at $1: $(cat stdout.txt)"
done
rm -rf out && mkdir out

# ---- What is refused

for view in nan,0,1,0,0 0,91,1,0,0 0,-90.1,1,0,0 361,0,1,0,0 0,0,inf,0,0 0,0,1,0 0,0,1,0,91 0,0,1,361,0 a; do
    refuses 2 '--view: expected LON,LAT,ALT,HEADING,PITCH' $globe globe.tif $picture "--view=$view"
done
refuses 2 '--radius: expected metres' $globe globe.tif $picture --radius 0
refuses 2 '--radius: expected metres' $globe globe.tif $picture --radius=-5
refuses 2 '--radius: expected metres' $globe globe.tif $picture --radius nan
refuses 2 '--n: expected a multiple of 32' $globe globe.tif $picture --n 255
refuses 2 '--steps: expected an even number' $globe globe.tif $picture --steps 7
refuses 2 '--scheme: expected rings' $globe globe.tif $picture --scheme octahedron
accepts '' $globe globe.tif -q $picture --size 64x48 --n 2048 --steps 64
refuses 2 '--n: expected a number of 64..4096' $globe globe.tif $picture --n 4128
refuses 2 '--steps: expected an even number' $globe globe.tif $picture --steps 130
refuses 2 '--scheme' $viewer globe.tif $picture --scheme rings
refuses 2 '--radius: expected none for globe.tclip, a packed planet' $globe globe.tclip $picture --radius 1e6
refuses 1 'small beside the radius of 900 m' $globe degree.tclip $picture --radius 900
refuses 2 '--spacing: expected none' $globe globe.tif $picture --spacing 30
refuses 1 'No such file' $globe missing.tif $picture
$make_file png square.png size=65x65 type=u16
refuses 1 'twice as wide|2:1|longitude' $globe square.png $picture
$make_file tiff metres.tif size=65x65 metres=30
accepts '' $globe metres.tif $picture # warped to longitude and latitude
$terraclip pack square.png -o flat.tclip -q || fail 'pack'
refuses 1 'longitude and latitude, or one packed with --planet' $globe flat.tclip $picture
refuses 1 'radius|relief|centre' $globe globe.tif $picture --radius 1000
printf '0,91,1,0,0\n' >beyond.txt
refuses 1 'line 1: expected LON,LAT,ALT,HEADING,PITCH' $globe globe.tif --path beyond.txt --frames 3

# ---- Rings that are told: all that are drawn, from the far side to the innermost, also on bodies with more of them than
# windows have levels

for radius in 1e6 6.4e6 1e9 1e12; do
    for view in '--fov 60' '--view=10,45,300,0,-5'; do
        accepts '' $globe globe.tif -q $picture --radius $radius $view --json
        told=$(sed -n 's/.*"blocks_by_level": \[\(.*\)\].*/\1/p' stdout.txt | tr -d ',' | awk '{ for (i = 1; i <= NF; i++) n += $i } END { print n + 0 }')
        drawn=$(sed -n 's/.*"draws": \([0-9]*\).*/\1/p' stdout.txt)
        [ "$told" = "$drawn" ] && [ "$told" -gt 0 ] || fail "--radius $radius $view: $told sectors are told, $drawn are drawn"
    done
done

# ---- Real data

if [ -n "${TERRACLIP_DATA:-}" ]; then
    for file in moon_gld100_global_5760x2880.tif earth_etopo20_1080x540_f32.tif N46E008.tif N37W119.hgt; do
        [ ! -f "$TERRACLIP_DATA/$file" ] || accepts '' $globe "$TERRACLIP_DATA/$file" -q $picture
    done
else
    skip 'TERRACLIP_DATA is not set: real planets'
fi

finish

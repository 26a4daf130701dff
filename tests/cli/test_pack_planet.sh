#!/bin/sh
# Packed planets by way of the programs.
. "${0%/*}/lib.sh"

holds() { # REGEX FILE
    cases=$((cases + 1))
    grep -Eq -- "$1" "$2" || fail "$2 does not match '$1': $(head -c 2000 "$2")"
}

# The height at a point, within so much of another one.
height() { # FILE LON LAT
    does '' $terraclip height "$1" -- "$2" "$3"
}

near() { # A B WITHIN WHAT
    cases=$((cases + 1))
    awk "BEGIN { d = $1 - $2; exit !(d <= $3 && -d <= $3) }" || fail "expected $1 near $2: $4"
}

pack="$terraclip pack -o out/a.tclip --planet"
$make_file tiff hills.tif size=300x200 metres=30
$make_file tiff placed.tif size=120x90 place=8,46
$make_file tiff beyond.tif size=100x100 place=8,89.5
$make_file tiff area.tif size=320x160 globe=-180,320,160 area=1
$make_file tiff belt.tif size=320x156 globe=-180,320,160 from=0,2 area=1
$make_file tiff short.tif size=384x191 globe=0,384,193 from=0,1
$make_file tiff points.tif size=384x193 globe=0,384,193
$make_file tiff repeated.tif size=385x193 globe=0,384,193
$make_file tiff odd.tif size=514x257 globe=0,514,257 type=f32 heights=plane
$make_file tiff tall.tif size=100x1500 globe=0,100,1500 area=1
$make_file tiff few.tif size=4x2 globe=0,4,2 area=1
$make_file png square.png size=200x200
$make_file png globe.png size=320x160

# ---- What is not a globe is refused

refuses 2 'hills.tif: expected a map of all 360 degrees of longitude' $pack hills.tif
refuses 2 'placed.tif: expected a map of all 360 degrees' $pack placed.tif
refuses 1 'beyond.tif: expected latitudes from -90 to 90' $pack beyond.tif
refuses 1 'few.tif: expected at least 4 x 4 samples' $pack few.tif
refuses 1 'square.png: expected a georeference .*twice as wide as high' $pack square.png
refuses 1 'odd.tif: lossless: expected a number of columns' $pack odd.tif --lossless
refuses 2 '--spacing: expected none for a planet' $pack area.tif --spacing 30
refuses 1 'expected heights that are small beside the radius of 900 m' $pack area.tif --radius 900
refuses 2 '--atlas: expected lonlat with --lossless, found hex' $pack area.tif --atlas hex --lossless
refuses 2 'hills.tif: expected a map of all 360 degrees of longitude' $pack hills.tif --atlas hex
refuses 1 '--atlas cube: expected a planet as a whole, .*, found a part of one' $pack belt.tif --atlas cube

# ---- What is comes back

for file in area points; do
    does '' $terraclip pack $file.tif -o $file.tclip --planet --lossless
    does '' $terraclip extract $file.tclip -o $file.out.tif
    equal $file.tif $file.out.tif stored
    does '' $terraclip info $file.tclip --json
    holds '"atlas": "lonlat",' stdout.txt
    holds '"radius_m": 6378137,' stdout.txt
    holds '"flattening": 0.0033528106' stdout.txt
    holds '"chart": "south cap", "width": [0-9]+, "height": [0-9]+, "bytes": [0-9]+,' stdout.txt
    does '' $terraclip info $file.tclip
    holds 'planet +semi-major axis 6378137 m, flattening 1/298.2572236, once around' stdout.txt
    does '' $viewer $file.tclip -o picture.png --size 96x64
done
does '' $terraclip pack area.tif -o moon.tclip --planet --radius 1737400 --rms 5 --json
holds '"mode": "rms",' stdout.txt
does '' $terraclip info moon.tclip --json
holds '"radius_m": 1737400,' stdout.txt
holds '"flattening": 0,' stdout.txt
does '' $terraclip pack area.tif -o flat.tclip --planet --ellipsoid 6378137,100 --rms 5
does '' $terraclip info flat.tclip
holds 'planet +semi-major axis 6378137 m, flattening 1/100, once around' stdout.txt
does '' $terraclip pack area.tif -o round.tclip --planet --ellipsoid sphere --rms 5
does '' $terraclip pack area.tif -o as_round.tclip --planet --radius 6378137 --rms 5
same round.tclip as_round.tclip 'a sphere, and a sphere of that radius'
does '' $terraclip info round.tclip
holds 'planet +radius 6378137 m' stdout.txt
refuses 2 '--ellipsoid: expected none for flat.tclip, a packed planet' $globe flat.tclip --ellipsoid wgs84 -o out/picture.png
refuses 2 '--radius: expected none for flat.tclip, a packed planet' $globe flat.tclip --radius 5 -o out/picture.png
refuses 2 '--ellipsoid: expected --planet with it' $terraclip pack -o out/a.tclip area.tif --ellipsoid wgs84
refuses 2 '--radius: expected no --ellipsoid but sphere' $pack area.tif --ellipsoid wgs84 --radius 1737400
for body in wgs72 '' 6378137 6378137, 6378137,0 6378137,-300 6378137,1 6378137,nan -1,300 0,300 6378137,300x 6378137,300,1; do
    refuses 2 '--ellipsoid: expected wgs84, sphere or A,1/F: metres of .* above 1 or inf, found' $pack area.tif --ellipsoid "$body"
done
refuses 1 'expected heights that are small beside the radii of curvature of 9.70493e-05 to 99.99 m' $pack area.tif --ellipsoid 0.99,1.01
does 'twice|whole globe' $terraclip pack globe.png -o globe.tclip --planet --atlas lonlat
does '' $terraclip info globe.tclip
holds 'radius 6371000 m' stdout.txt
does '' $terraclip pack area.tif -o paper.tclip --planet --rms 5 --codec lh04
does '' $terraclip pack area.tif -o bound.tclip --planet --max-error 3
does '' $terraclip extract bound.tclip -o bound.tif
equal area.tif bound.tif within=3

# ---- Other atlases

refuses 1 'belt.tif: expected a planet as a whole' $globe belt.tif --scheme hex -o out/picture.png

cat >credited.vrt <<end
<VRTDataset rasterXSize="320" rasterYSize="160"><Metadata><MDI key="COPYRIGHT">A. Person</MDI></Metadata>
<SRS>EPSG:4326</SRS><GeoTransform>-180, 1.125, 0, 90, 0, -1.125</GeoTransform>
<VRTRasterBand dataType="Int16" band="1"><SimpleSource><SourceFilename relativeToVRT="1">area.tif</SourceFilename>
<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>
end
for atlas in lonlat hex cube; do
    does '' $terraclip pack credited.vrt -o credited.tclip --planet --atlas $atlas --rms 1
    does '' $terraclip info credited.tclip
    holds '^  credit +A. Person$' stdout.txt
done
for atlas in hex cube; do
    does '' $terraclip pack area.tif -o $atlas.tclip --planet --atlas $atlas --rms 1
    holds 'resampled to [0-9]+ samples on' stdout.txt
    does '' $terraclip info $atlas.tclip
    holds "on each of [46] faces \\($atlas\\)" stdout.txt
    holds 'place +longitude -180 to 180, latitude -90 to 90, area-registered' stdout.txt
    holds 'resampled +from 320 x 160 samples, which are rms ' stdout.txt
    does '' $terraclip info $atlas.tclip --json
    holds "\"atlas\": \"$atlas\"," stdout.txt
    holds '"source_width": 320,' stdout.txt
    holds '"resampling_rms_m": [0-9]' stdout.txt
    does '' $terraclip pack area.tif -o again.tclip --planet --atlas $atlas --rms 1 --json
    same $atlas.tclip again.tclip 'packed twice'
    holds '"resampling_max_error_m": [0-9]' stdout.txt
    does '' $terraclip extract $atlas.tclip -o $atlas.tif
    for at in '0 0' '-179.9 40' '33 -77' '180 10' '0 90' '137 90' '50 -90' '45 35.264'; do
        height area.tclip ${at% *} ${at#* }
        one=$out
        height $atlas.tclip ${at% *} ${at#* }
        near "$out" "$one" 40 "$atlas at $at" # samples of 125 km
        two=$out
        height $atlas.tif ${at% *} ${at#* }
        near "$out" "$two" 40 "$atlas extracted, at $at"
    done
    refuses 1 'found one outside' $terraclip height $atlas.tclip 0 90.01
    does '' $terraclip height $atlas.tclip 540 10
    one=$out
    does '' $terraclip height $atlas.tclip 180 10
    near "$out" "$one" 0.001 "$atlas: turns"
    refuses 1 "$atlas.tclip: expected a planet packed with --atlas lonlat, found one with --atlas $atlas; 'terraclip pack --planet --atlas lonlat INPUT" \
        $globe $atlas.tclip --scheme rings -o out/picture.png
    does '' $globe $atlas.tclip -o picture.png --size 96x64 # by the scheme that draws such charts
    refuses 1 "$atlas.tclip: expected a flat terrain or a planet in longitude and latitude, found one packed with --atlas $atlas" \
        $viewer $atlas.tclip -o out/picture.png
    does '' $globe $atlas.tclip --scheme $atlas -o picture.png --size 96x64
    does '' $globe area.tif --scheme $atlas -o picture.png --size 96x64
    refuses 1 "area.tclip: expected a planet packed with --atlas $atlas, found one with --atlas lonlat" \
        $globe area.tclip --scheme $atlas -o out/picture.png
    does '' $terraclip pack short.tif -o again.tclip --planet --atlas $atlas --rms 5 # a row short of either pole
    does '' $terraclip pack odd.tif -o again.tclip --planet --atlas $atlas --rms 5 --synthesis-fit
    does '' $terraclip extract again.tclip --synthesis 1 -o again.tif
done

# ---- Columns that come round again, rows of several files, widths that cannot be halved

does '' $terraclip pack repeated.tif -o repeated.tclip --planet --lossless
does '' $terraclip info repeated.tclip --json
holds '"width": 384,' stdout.txt
$make_file tiff west.tif size=157x257 globe=0,514,257 type=f32 heights=plane
$make_file tiff east.tif size=357x257 globe=0,514,257 from=157,0 type=f32 heights=plane
does '' $terraclip pack odd.tif -o odd.tclip --planet --rms 5
does '' $terraclip pack west.tif east.tif -o two.tclip --planet --rms 5
does '' $terraclip info odd.tclip --json
holds '"width": 516,' stdout.txt
same odd.tclip two.tclip 'one file and two'

does '' $terraclip pack tall.tif -o tall.tclip --planet --rms 5
does '' $terraclip info tall.tclip --json
holds '"width": 104,' stdout.txt
does '' $globe tall.tclip -o picture.png --size 96x64

# ---- Heights

for at in '0 0' '-179.9 40' '33 -77'; do
    height area.tclip ${at% *} ${at#* }
    one=$out
    for turn in 360 -360 1080; do
        height area.tclip "$(awk "BEGIN { print ${at% *} + $turn }")" ${at#* }
        near "$out" "$one" 0.01 "a turn of $turn at $at"
    done
done
height area.tclip 180 10
one=$out
height area.tclip 179.9999 10
near "$out" "$one" 0.1 'across the seam'
for latitude in 90 -90; do
    height area.tclip 0 $latitude
    one=$out
    height area.tclip 137 $latitude
    near "$out" "$one" 0.01 "a pole is one point: $latitude"
done
refuses 1 'found one outside' $terraclip height area.tclip 0 90.01

# Maps that were not packed, or packed flat, answer much like the planet.
does '' $terraclip pack area.tif -o flat.tclip --lossless
for file in area.tif flat.tclip; do
    for at in '180 10' '179.9999 10' '-180 10' '-179.7 -33' '539.6 0' '0 90' '137 90' '50 -90'; do
        height area.tclip ${at% *} ${at#* }
        one=$out
        height $file ${at% *} ${at#* }
        near "$out" "$one" 2 "$file at $at"
    done
    for latitude in 90 -90; do
        height $file 0 $latitude
        one=$out
        height $file 137 $latitude
        near "$out" "$one" 0 "a pole is one point: $latitude of $file"
    done
    refuses 1 'found one outside' $terraclip height $file 0 90.01
done
for file in repeated points odd; do
    height $file.tif -0.0001 40
    one=$out
    height $file.tif 0 40
    near "$out" "$one" 1 "across the seam of $file.tif"
    height $file.tif 360.0001 -40
done
does '' $terraclip height area.tif --level 5 -- -179.9 10

# ---- Files cut short

head -c $(($(stat -c %s moon.tclip) - 1)) moon.tclip >cut.tclip
does 'cut short: .*its levels are whole' $terraclip info cut.tclip
height moon.tclip 0 90
whole=$out
does 'cut short' $terraclip height cut.tclip -- 0 90
[ "$out" = "$whole" ] || fail "without the last byte of its errors the pole is at $out, not $whole"
head -c $(($(stat -c %s moon.tclip) * 4 / 5)) moon.tclip >cut.tclip
does 'cut short: .*missing: the finest [12] of its levels' $terraclip info cut.tclip --json
cases=$((cases + 1))
[ "$(grep -c '"chart":' stdout.txt)" = 3 ] || fail "charts of a coarser planet: $(grep chart stdout.txt)"
does 'cut short' $terraclip height cut.tclip 0 90
does 'cut short' $viewer cut.tclip -o picture.png --size 96x64

finish

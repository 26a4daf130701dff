#!/bin/sh
# --imagery of both viewers: pictures in any coordinate system lie where they belong, holes show the heights' colours;
# what cannot be shown is refused in a line; the cache is made whole or not at all, whatever ends a program.
. "${0%/*}/lib.sh"

export XDG_CACHE_HOME="$work/cache"
unset HOME
limit=$((limit * 3))
paint() { # FILE [NAME=VALUE]...
    "$make_picture" make "$@" || fail "no picture: $*"
}
cached() { # how many files the cache holds
    ls -A "$XDG_CACHE_HOME/terraclip" 2>/dev/null | wc -l
}
near() { # FILE FILE LIMIT WHAT: their colours differ by so much at most
    cases=$((cases + 1))
    d=$("$make_picture" differ "$1" "$2") && awk "BEGIN { exit !($d <= $3) }" || fail "$4: colours differ by $d of 255"
}
far() { # FILE FILE LIMIT WHAT: by so much at least
    cases=$((cases + 1))
    d=$("$make_picture" differ "$1" "$2") && awk "BEGIN { exit !($d >= $3) }" || fail "$4: colours differ by only $d of 255"
}
is_colour() { # FILE X,Y RED,GREEN,BLUE WHAT: to 3
    cases=$((cases + 1))
    found=$("$make_picture" at "$1" "${2%,*}" "${2#*,}")
    echo "$found $3" | awk '{ split($4, c, ","); for (k = 1; k <= 3; k++) if ($k > c[k] + 3 || $k < c[k] - 3) exit 1 }' ||
        fail "$4: found $found at $2 instead of $3"
}
three_bands() { # FILE.vrt WIDTH HEIGHT WHERE SOURCE: a VRT of a picture, placed by its XML
    {
        echo "<VRTDataset rasterXSize=\"$2\" rasterYSize=\"$3\">$4"
        for band in '1 Red' '2 Green' '3 Blue'; do
            echo "<VRTRasterBand dataType=\"Byte\" band=\"${band% *}\"><ColorInterp>${band#* }</ColorInterp><SimpleSource>" \
                "<SourceFilename relativeToVRT=\"1\">$5</SourceFilename><SourceBand>${band% *}</SourceBand>" \
                "</SimpleSource></VRTRasterBand>"
        done
        echo "</VRTDataset>"
    } >"$1"
}

$make_file tiff dem.tif size=121x121 place=8,46
$make_file tiff utm.tif size=161x141 metres=400 # from 9 degrees east, 46.95 north on
$make_file tiff globe.tif size=256x128 globe=-180,256,128 area=1
$make_file tiff nowhere.tif size=121x121 metres=0
paint lonlat.tif crs=EPSG:4326 at=8,47,0.002,0.002 size=500x500
paint plain.png driver=PNG size=240x120
paint red.tif crs=EPSG:4326 at=8,47,0.1,0.1 size=10x10 colour=ff0000
seen='-o out/picture.png --size 120x90 --unlit --background 808080'
down="$seen --view 38000,55000,110000,0,-90" # all of dem.tif

# ---- In their places

accepts '' $viewer dem.tif $down --imagery lonlat.tif && mv last.png lonlat.png
accepts '' $viewer dem.tif $down && far last.png lonlat.png 10 'no imagery' && mv last.png heights.png
while read -r name about; do
    paint $name.tif $about
    accepts '' $viewer dem.tif $down --imagery $name.tif
    near last.png lonlat.png 0.7 "$name, over longitude and latitude"
done <<end
zone crs=EPSG:32632 at=420000,5210000,180,180 size=480x640
mercator crs=EPSG:3857 at=890000,5950000,220,220 size=510x760
turned crs=EPSG:32632 at=380000,5180000,180,180 turn=25 size=900x900
points crs=EPSG:4326 at=8,47,0.002,0.002 size=500x500 gcp=1
end
three_bands beside.vrt 500 500 '<SRS>EPSG:4326</SRS><GeoTransform>8.02,0.002,0,47,0,-0.002</GeoTransform>' lonlat.tif
accepts '' $viewer dem.tif $down --imagery beside.vrt
far last.png lonlat.png 5 'a fiftieth of a degree beside it'

across='--view 32000,28000,75000,0,-90' # all of utm.tif
paint own.tif crs=EPSG:32632 at=499800,5200200,200,200 size=322x282
accepts '' $viewer utm.tif $seen $across --imagery own.tif && mv last.png own.png
while read -r name about; do
    paint $name.tif $about
    accepts '' $viewer utm.tif $seen $across --imagery $name.tif
    near last.png own.png 1 "$name, over UTM"
done <<end
degrees crs=EPSG:4326 at=8.99,46.96,0.002,0.002 size=450x270
grads-of-paris crs=EPSG:4807 at=7.3,52.2,0.002,0.002 size=500x320
end

# Over a globe, and over a part of one.
above="$seen --view 8.5,46.5,40000,0,-90"
accepts '' $globe globe.tif $above --imagery lonlat.tif && mv last.png on-globe.png
accepts '' $globe globe.tif $above --imagery zone.tif && near last.png on-globe.png 0.7 'UTM on the globe'
accepts '' $globe dem.tif $above --imagery mercator.tif && near last.png on-globe.png 6 'Mercator on a part of a globe'
accepts '' $globe globe.tif $seen --view 8.5,46.5,4e5,0,-90 --imagery red.tif && is_colour last.png 60,45 255,0,0 'one degree of red'
is_colour last.png 110,45 "$("$make_picture" at last.png 10 45 | tr ' ' ,)" 'heights around it'
# Packed terrains have the same places.
$terraclip pack dem.tif -o dem.tclip -q --max-error 0.5 && accepts '' $viewer dem.tclip $down --imagery zone.tif
near last.png lonlat.png 0.7 'over a packed terrain'
$terraclip pack --planet globe.tif -o globe.tclip -q && accepts '' $globe globe.tclip $above --imagery zone.tif
near last.png on-globe.png 0.7 'over a packed planet'

# Without a place: all of the terrain, all of the globe.
accepts '' $viewer dem.tif $down --imagery plain.png && far last.png heights.png 10 'a plain picture'
accepts '' $globe globe.tif $seen --view 0,90,2e7,0,-90 --imagery plain.png
accepts 'warning: lonlat.tif: says where it lies, but the terrain does not' $viewer nowhere.tif $picture --imagery lonlat.tif
# Neither names its system: it is one.
printf 'ncols 40\nnrows 40\nxllcorner 500000\nyllcorner 5100000\ncellsize 1000\n' >grid.asc
awk 'BEGIN { for (i = 0; i < 1600; i++) printf "%d ", 100 + i % 40 }' >>grid.asc
paint unnamed.tif crs=EPSG:32632 at=500000,5140000,100,100 size=400x400 named=0 colour=00ff00
accepts '' $viewer grid.asc $seen --view 20000,20000,9000,0,-90 --imagery unnamed.tif && is_colour last.png 60,45 0,255,0 'no names'

# ---- Holes, and one over the other

paint hole.tif crs=EPSG:4326 at=8,47,0.004,0.004 size=250x250 hole=1 colour=00ff00
paint nodata.tif crs=EPSG:4326 at=8,47,0.004,0.004 size=250x250 nodata=7 colour=00ff00
paint sparse.png driver=PNG size=250x250 hole=1 colour=00ff00
under=$("$make_picture" at heights.png 60 45 | tr ' ' ,)
for file in hole.tif nodata.tif sparse.png; do
    accepts '' $viewer dem.tif $down --imagery $file
    is_colour last.png 60,45 $under "$file: its hole"
    is_colour last.png 41,30 0,255,0 "$file: beside the hole"
done
accepts '' $viewer dem.tif $down --imagery red.tif --imagery sparse.png
is_colour last.png 60,45 255,0,0 "the hole of a picture over another"
is_colour last.png 41,30 0,255,0 "a picture over another"
accepts '' $viewer dem.tif $down --imagery hole.tif --imagery red.tif
is_colour last.png 41,30 255,0,0 "the other way round"

# ---- Told

does '' $viewer dem.tif $picture --imagery lonlat.tif --explain
echo "$out" | grep -Eq '^uses: imagery: [1-9][0-9]* of [0-9]+ levels hold colours$' &&
    echo "$out" | grep -q '^uses: library: GDAL' || fail "--explain: $out"
does '' $viewer dem.tif $picture --explain
echo "$out" | grep -q '^left out: imagery: none given$' || fail "--explain without imagery: $out"
for program in "$viewer dem.tif" "$globe globe.tif"; do
    does '' $program $picture --imagery plain.png --json
    echo "$out" | grep -Eq '"imagery_levels": [1-9]' && echo "$out" | grep -Eq '"imagery": [1-9][0-9]{4}' || fail "--json: $out"
done
does '' $viewer dem.tif $picture --json
echo "$out" | grep -q '"imagery_levels": 0' && echo "$out" | grep -q '"imagery": 0' || fail "--json: $out"
rm -rf out && mkdir out

# ---- What is no picture, or not here

on_dem() { # REGEX FILE
    refuses 1 "$1" $viewer dem.tif $picture --imagery "$2"
}
on_dem 'missing.tif: .*No such file' missing.tif
on_dem "$work: expected a picture, found a directory" "$work"
on_dem 'found a device or pipe' /dev/zero
mkfifo pipe && on_dem 'pipe: .*found a device or pipe' pipe
: >empty.tif && on_dem 'empty.tif: expected a picture, found an empty file' empty.tif
echo 'no picture' >text.txt && on_dem 'text.txt: ' text.txt
echo 'no picture' >text.png && on_dem 'text.png: ' text.png
head -c 5000 /dev/urandom >noise.jpg && on_dem 'noise.jpg: ' noise.jpg
refuses 1 'dem.tif: expected colours of 8 or 16 bits, found samples of type Int16' $viewer dem.tif $picture --imagery dem.tif
refuses 2 '--imagery: expected a file name, at most 64 times' $viewer dem.tif $picture --imagery=
many() { # COUNT: so many times
    for i in $(seq "$1"); do printf -- '--imagery red.tif '; done
}
accepts '' $viewer dem.tif $picture $(many 64)
refuses 2 '--imagery: expected a file name, at most 64 times' $viewer dem.tif $picture $(many 65)

paint elsewhere.tif crs=EPSG:4326 at=18,47,0.01,0.01 size=100x100
on_dem 'elsewhere.tif: expected a picture of the terrain, found one of another place' elsewhere.tif
refuses 1 'elsewhere.tif: expected a picture of the terrain' $globe dem.tif $picture --imagery elsewhere.tif
refuses 1 'elsewhere.tif: ' $viewer dem.tif $picture --imagery lonlat.tif --imagery elsewhere.tif
paint unnamed.tif crs=EPSG:4326 at=8,47,0.002,0.002 named=0
on_dem 'unnamed.tif: expected a coordinate system with its transform, found none' unnamed.tif
paint moon.tif 'crs=+proj=longlat +R=1737400 +no_defs' at=8,47,0.002,0.002
on_dem 'moon.tif: cannot be brought to .*celestial body' moon.tif
refuses 1 'moon.tif: cannot be brought to .*celestial body' $globe globe.tif $picture --imagery moon.tif
while read -r name regex where; do
    three_bands $name.vrt 500 500 "$where" lonlat.tif
    on_dem "$name.vrt: $regex" $name.vrt
done <<end
site cannot.be.brought <SRS>LOCAL_CS["site",UNIT["metre",1]]</SRS><GeoTransform>8,0.002,0,47,0,-0.002</GeoTransform>
works cannot.be.brought <SRS>ENGCRS["a",EDATUM["b"],CS[Cartesian,2],AXIS["e",east],AXIS["n",north],LENGTHUNIT["metre",1]]</SRS><GeoTransform>8,0.002,0,47,0,-0.002</GeoTransform>
nonsense expected.a.coordinate.system <SRS>nonsense</SRS><GeoTransform>8,0.002,0,47,0,-0.002</GeoTransform>
point cannot.be.brought <SRS>EPSG:4326</SRS><GeoTransform>8,0,0,47,0,0</GeoTransform>
nan expected.a.picture.of.the.terrain <SRS>EPSG:4326</SRS><GeoTransform>nan,0.002,0,nan,0,-0.002</GeoTransform>
endless expected.a.picture.of.the.terrain <SRS>EPSG:4326</SRS><GeoTransform>1e300,0.002,0,1e300,0,-0.002</GeoTransform>
end

# ---- Cut short, damaged, and larger than any machine

while read -r name keep about; do
    paint whole.$name size=400x300 $about
    head -c $keep whole.$name >short.$name
    on_dem "short.$name: .*damaged or truncated" short.$name
done <<end
png 20000 driver=PNG
jpg 5000 driver=JPEG
tif 200000
tiled.tif 200000 co=TILED=YES
lzw.tif 100000 co=COMPRESS=LZW
jpeg.tif 6000 co=COMPRESS=JPEG co=PHOTOMETRIC=YCBCR
end
if "$make_picture" make whole.jp2 driver=JP2OpenJPEG size=400x300 2>/dev/null; then
    head -c 3000 whole.jp2 >short.jp2 && on_dem 'short.jp2: ' short.jp2
fi
where='<SRS>EPSG:4326</SRS><GeoTransform>8,0.002,0,47,0,-0.002</GeoTransform>'
three_bands parts.vrt 400 300 "$where" short.tif && on_dem 'parts.vrt: .*damaged or truncated' parts.vrt
three_bands gone.vrt 400 300 "$where" nothing.tif && on_dem 'gone.vrt: .*No such file' gone.vrt
three_bands huge.vrt 2147483647 2147483647 "$where" lonlat.tif && on_dem 'huge.vrt: expected at most 4194304 columns' huge.vrt
three_bands tall.vrt 1000 2147483647 "$where" lonlat.tif && on_dem 'tall.vrt: expected room for levels' tall.vrt
cp whole.png huge.png && printf '\177\377\377\377\177\377\377\377' | dd of=huge.png bs=1 seek=16 conv=notrunc 2>/dev/null
on_dem 'huge.png: ' huge.png
[ $(cached) = 0 ] || fail "small pictures, and such as cannot be shown, have left $(cached) files in the cache"

# Tiles that are damaged where nobody looks, and where somebody does.
paint tiles.tif crs=EPSG:4326 at=8,47,0.0002,0.0004 size=5000x2500 co=TILED=YES co=COMPRESS=DEFLATE overviews=4
"$make_picture" spoil tiles.tif 2500 1500
accepts '' $viewer dem.tif $seen --view 38000,105000,3000,0,-90 --imagery tiles.tif
on_dem_near() { # REGEX FILE OPTION...
    regex=$1 file=$2
    shift 2
    refuses 1 "$regex" $viewer dem.tif --size 160x120 --imagery $file "$@"
}
printf '38000,45000,3000,0,-90\n38000,44000,3000,0,-90\n' >near.txt
on_dem_near 'tiles.tif: cannot be read, damaged' tiles.tif -o out/picture.png --view 38000,45000,3000,0,-90
on_dem_near 'tiles.tif: cannot be read, damaged' tiles.tif -o out/frame-%d.png --path near.txt --frames 3
[ $(cached) = 0 ] || fail "a picture with tiles and overviews has left $(cached) files in the cache"

# ---- A picture is no output

never() { # NAME COMMAND...
    name=$1
    shift
    before=$(cksum <$name)
    refuses 2 "expected another file than the (in|out)put .*, found the same" "$@"
    [ "$(cksum <$name)" = "$before" ] || fail "$name is changed: $*"
}
mkdir links && ln -s ../plain.png links/soft.png && ln plain.png links/hard.png
cp plain.png frame-0003.png && cp lonlat.tif part.png
three_bands over.vrt 500 500 "$where" part.png
three_bands again.vrt 500 500 "$where" over.vrt
never plain.png $viewer dem.tif --size 96x64 --imagery plain.png -o plain.png
never plain.png $viewer dem.tif --size 96x64 --imagery links/soft.png -o plain.png
never plain.png $viewer dem.tif --size 96x64 --imagery plain.png -o links/soft.png
never plain.png $viewer dem.tif --size 96x64 --imagery red.tif --imagery plain.png -o links/hard.png
never plain.png $viewer dem.tif $picture --imagery plain.png --stats ./plain.png
never part.png $viewer dem.tif --size 96x64 --imagery over.vrt -o part.png
never part.png $viewer dem.tif --size 96x64 --imagery again.vrt -o part.png
never over.vrt $viewer dem.tif $picture --imagery again.vrt --stats over.vrt
never frame-0003.png $viewer dem.tif --size 96x64 --imagery frame-0003.png --path near.txt --frames 6 -o frame-%04d.png
never part.png $globe globe.tif --size 96x64 --imagery again.vrt -o part.png

# ---- The cache

paint large.tif crs=EPSG:4326 at=8,47,0.00024,0.00047 size=4200x2130 co=COMPRESS=DEFLATE co=ZLEVEL=1
show="$viewer dem.tif $picture -q --imagery large.tif"
refuses 1 'large.tif: expected .XDG_CACHE_HOME or .HOME, .* found neither' env -u XDG_CACHE_HOME $show
refuses 1 'large.tif: expected .XDG_CACHE_HOME or .HOME, .* found neither' env XDG_CACHE_HOME=not/absolute $show
refuses 1 'large.tif: its levels cannot be kept in /proc/nothing: ' env XDG_CACHE_HOME=/proc/nothing $show
refuses 1 'large.tif: its levels cannot be kept in .*Not a directory' env XDG_CACHE_HOME="$work/dem.tif" $show
refuses 1 'large.tif: its levels cannot be kept in .*Not a directory' env -u XDG_CACHE_HOME HOME="$work/dem.tif" $show
accepts '' env -u XDG_CACHE_HOME $viewer dem.tif $picture --imagery lonlat.tif # a small one needs none

# Three programs make it at once.
for i in 1 2 3; do $show -o out/$i.png & done
wait
for i in 1 2 3; do is_png out/$i.png || fail "the cache made three times at once: no picture $i"; done
same out/1.png out/2.png 'made at once' && same out/1.png out/3.png 'made at once'
cp out/1.png made.png && rm -rf out && mkdir out
files=$(cached)
[ $files = 5 ] || fail "$files files in the cache, $(ls -A cache/terraclip)"
# It is used, and mended where it is not whole.
file=$(ls cache/terraclip/*-1.tif)
head -c 30000 $file >cut.tmp && mv cut.tmp $file
echo nonsense >$(ls cache/terraclip/*-2.tif)
rm cache/terraclip/*-0.tif
accepts '' $show && same last.png made.png 'a cache that was mended'
[ $(cached) = $files ] || fail "a cache that was mended: $(cached) files"
for file in cache/terraclip/*; do
    dd if=/dev/urandom of=$file bs=1000 count=3 seek=$(($(wc -c <$file) / 2000)) conv=notrunc 2>/dev/null
done
rm -rf out && mkdir out
run $show
[ $rc = 0 ] || [ $(wc -l <stderr.txt) = 1 ] || report 'a damaged cache' $show
run $show # what was damaged is gone by now, unless nothing of it was seen
[ $rc = 0 ] || report 'a damaged cache, again' $show
rm -rf out cache && mkdir out

# Interrupted: nothing is left, whatever the moment.
begun=0
for moment in 0.2 0.4 0.6 0.8 1.1; do
    for signal in INT TERM KILL; do
        [ $signal = INT ] || [ $moment = 0.6 ] || continue
        cases=$((cases + 1))
        rm -rf cache out && mkdir out
        $show 2>stderr.txt &
        program=$!
        sleep $moment
        kill -$signal $program 2>/dev/null && begun=$((begun + 1))
        wait $program 2>/dev/null
        [ $(cached) = 0 ] || [ $(cached) = $files ] || fail "SIG$signal after $moment s leaves $(ls -A cache/terraclip)"
        [ $(wc -l <stderr.txt) -le 1 ] || fail "SIG$signal after $moment s: $(cat stderr.txt)"
    done
done
[ $begun -gt 0 ] || fail 'no signal came in time'
rm -rf cache out && mkdir out

# No room.
cases=$((cases + 1))
{ (ulimit -f 100 && exec $show) >/dev/null 2>stderr.txt; rc=$?; } 2>/dev/null
[ $rc = 1 ] && grep -q 'large.tif: its levels cannot be kept in .*' stderr.txt && [ $(wc -l <stderr.txt) = 1 ] ||
    report "a limit on the size of files: exit code $rc" $show
[ $(cached) = 0 ] || fail "a limit on the size of files leaves $(ls -A cache/terraclip)"
rm -rf out && mkdir out full
if mount -t tmpfs -o size=12m tmpfs full 2>/dev/null; then
    trap 'umount "$work/full"; rm -rf "$work"' EXIT
    refuses 1 'large.tif: expected room for levels of 4200 x 2130 pixels, up to 48 MB, in .*, found 13 MB' env XDG_CACHE_HOME="$work/full" $show
    [ -z "$(ls -A full/terraclip)" ] || fail "a full disk: $(ls -A full/terraclip)"
    umount full
    trap 'rm -rf "$work"' EXIT
else
    skip 'no disk can be mounted here that is full'
fi

# ---- Memory, and what is read

# Three times as many pixels as are held in memory: read once, and by the next program hardly at all
# (extreme_imagery.c has a larger one).
paint wide.tif size=7000x3600 co=COMPRESS=DEFLATE co=ZLEVEL=1
size=$(($(wc -c <wide.tif) / 1000000))
read_by() { # COMMAND...: sets $read, MB
    does '' "$used" used.txt "$@" -o out/picture.png --size 96x64 -q --imagery wide.tif
    read=$(cut -d ' ' -f 2 used.txt)
}
read_by $viewer dem.tif && first=$read
read_by $globe dem.tif
echo "7000 x 3600 pixels, a file of $size MB: $first MB read, then $read MB"
[ $first -ge $size ] && [ $first -le $((size * 11 / 10 + 8)) ] || fail "$first MB were read of a file of $size MB"
[ $read -le 8 ] || fail "$read MB were read once its levels are in the cache"

# ---- Whose it is: in the words of the files, as short lines without control characters

credited() { # FILE ITEM TEXT SIZE TYPE MEANING...: a virtual one of that file, with bands, that says so
    echo "<VRTDataset rasterXSize=\"$4\" rasterYSize=\"$4\"><Metadata><MDI key=\"$2\">$3</MDI></Metadata>"
    of=$1 type=$5 band=0
    shift 5
    for meaning; do
        band=$((band + 1))
        echo "<VRTRasterBand dataType=\"$type\" band=\"$band\"><ColorInterp>$meaning</ColorInterp><SimpleSource>"
        echo "<SourceFilename relativeToVRT=\"1\">$of</SourceFilename><SourceBand>$band</SourceBand>"
        echo '</SimpleSource></VRTRasterBand>'
    done
    echo '</VRTDataset>'
}
$make_file tiff whose.tif size=65x65 metres=30
$make_picture make whose.png driver=PNG size=64x64
credited whose.tif TIFFTAG_COPYRIGHT "(c) A. Person&#10;&#27;[31mand   others" 65 Float32 Gray >whose.vrt
credited whose.png attribution "$(seq 400 | tr '\n' ' ')" 64 Byte Red Green Blue >picture.vrt
does '' $viewer whose.vrt --spacing 30 --imagery picture.vrt $picture --explain
echo "$out" | grep -Fqx 'credit: terrain: (c) A. Person [31mand others' || fail "whose the terrain is: $out"
echo "$out" | grep -Eqx 'credit: imagery: 1 2 3 4 [0-9 ]{100,150} \.\.\.' || fail "whose the picture is: $out"
does '' $viewer whose.tif --imagery whose.png $picture --explain
echo "$out" | grep -q '^credit:' && fail "files that do not say whose they are: $out"
rm -rf out && mkdir out

finish

#!/bin/sh
# What cannot be shown is refused: one line that says why, exit code 1 (the file, the machine) or 2 (the command line),
# and nothing left behind.
. "${0%/*}/lib.sh"

cut() { # FILE BYTES: the first BYTES of it
    head -c "$2" "$1" >cut.tmp && mv cut.tmp "$1"
}
poke() { # FILE OFFSET BYTES (as printf takes them)
    printf "$3" | dd of="$1" bs=1 seek="$2" conv=notrunc 2>/dev/null
}

$make_file tiff hills.tif size=65x65

# ---- Not a file of heights

refuses 1 'missing.tif: .*No such file' $viewer missing.tif $picture
refuses 1 'No such file' $viewer '' $picture
mkdir nothing && refuses 1 'nothing: expected a folder of elevation files, found none' $viewer nothing $picture
refuses 1 'found a device or pipe' $viewer /dev/zero $picture
: >empty.tif && refuses 1 'empty file' $viewer empty.tif $picture
: >N46E008.hgt && refuses 1 'empty file' $viewer N46E008.hgt $picture
printf 'not heights\n' >text.xyzzy && refuses 1 'text.xyzzy: .*neither GDAL nor OpenImageIO' $viewer text.xyzzy $picture
printf 'II*\0' >four.tif && refuses 1 'damaged or truncated' $viewer four.tif $picture
head -c 5000 /dev/urandom >noise.bin && refuses 1 'noise.bin' $viewer noise.bin $picture
head -c 5000 /dev/urandom >noise.tif && refuses 1 'noise.tif' $viewer noise.tif $picture
cp hills.tif hills.png && accepts '' $viewer hills.png $picture # a file is what it holds, not what it is called
cp hills.tif hills.xyzzy && accepts '' $viewer hills.xyzzy $picture
refuses 1 'a\?b.tif|a b.tif' $viewer "$(printf 'a\nb.tif')" $picture
if [ "$(id -u)" != 0 ]; then
    cp hills.tif locked.tif && chmod 0 locked.tif && refuses 1 'Permission denied' $viewer locked.tif $picture
fi

# ---- Truncated

$make_file tiff strips.tif size=300x300 && cut strips.tif 90000
refuses 1 'strips.tif: damaged or truncated' $viewer strips.tif $picture
$make_file tiff tiles.tif size=300x300 tile=64 && cut tiles.tif 90000
refuses 1 'tiles.tif: damaged or truncated' $viewer tiles.tif $picture
$make_file tiff tail.tif size=300x300 && cut tail.tif $(($(wc -c <tail.tif) - 1))
refuses 1 'tail.tif: damaged or truncated' $viewer tail.tif $picture
# As libraries write them: the directory first, so that what is cut off is samples.
$terraclip synth --size 257 -o synth.tif -q && cut synth.tif 150000
refuses 1 'synth.tif: .*damaged or truncated' $viewer synth.tif $picture
$make_file png short.png size=300x300 && cut short.png 90000
refuses 1 'short.png: .*damaged or truncated' $viewer short.png $picture
$make_file hgt N46E009.hgt && cut N46E009.hgt 2000002
refuses 1 'N46E009.hgt: expected a square .* found 2000002 bytes; it may be truncated' $viewer N46E009.hgt $picture
cut N46E009.hgt 2000001
refuses 1 'N46E009.hgt: damaged or truncated' $viewer N46E009.hgt $picture
cut N46E009.hgt 2000000 # 1000 x 1000 samples, as luck has it
accepts 'warning: 1000 x 1000 samples .* may be truncated' $viewer N46E009.hgt $picture
$make_file pgm short.pgm size=300x300 && cut short.pgm 90000
refuses 1 'short.pgm: ' $viewer short.pgm $picture
$make_file jp2 short.jp2 && cut short.jp2 300
refuses 1 'short.jp2: ' $viewer short.jp2 $picture
$make_file exr short.exr size=300x300 && cut short.exr 90000
refuses 1 'short.exr: ' $viewer short.exr $picture
$make_file tiff part.tif size=65x65 && cut part.tif 5000
cat >part.vrt <<end
<VRTDataset rasterXSize="65" rasterYSize="65"><VRTRasterBand dataType="Int16" band="1"><SimpleSource>
<SourceFilename relativeToVRT="1">part.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>
end
refuses 1 'part.tif: damaged or truncated' $viewer part.vrt $picture

# ---- Corrupt

$make_file png corrupt.png size=300x300 && poke corrupt.png 60 '\377\377\377\377\377\377\377\377'
refuses 1 'corrupt.png: ' $viewer corrupt.png $picture
$make_file tiff corrupt.tif size=300x300 && poke corrupt.tif 4 '\377\377\377\177'
refuses 1 'corrupt.tif: ' $viewer corrupt.tif $picture
$make_file jp2 corrupt.jp2 && poke corrupt.jp2 95 '\0\0\0\0\0\0\0\0'
refuses 1 'corrupt.jp2: ' $viewer corrupt.jp2 $picture
$make_file exr corrupt.exr size=40x40 && poke corrupt.exr 12 '\377\377\377\377'
refuses 1 'corrupt.exr: ' $viewer corrupt.exr $picture
printf 'P5\n9 nine\n65535\n' >corrupt.pgm && refuses 1 'corrupt.pgm: ' $viewer corrupt.pgm $picture
printf '<VRTDataset rasterXSize="9"' >corrupt.vrt && refuses 1 'corrupt.vrt: ' $viewer corrupt.vrt $picture
cat >missing.vrt <<end
<VRTDataset rasterXSize="65" rasterYSize="65"><VRTRasterBand dataType="Int16" band="1"><SimpleSource>
<SourceFilename relativeToVRT="1">nowhere.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>
end
refuses 1 'missing.vrt: ' $viewer missing.vrt $picture
sed 's/nowhere.tif/circle.vrt/' missing.vrt >circle.vrt
refuses 1 'circle.vrt: ' $viewer circle.vrt $picture

# ---- Headers that claim what no machine has

$make_file tiff huge.tif size=33x33 # its directory begins behind 8 + 33 * 33 * 2 bytes: width and height come first
poke huge.tif $((8 + 33 * 33 * 2 + 2 + 8)) '\0\0\0\177' && poke huge.tif $((8 + 33 * 33 * 2 + 2 + 20)) '\0\0\0\177'
refuses 1 'huge.tif: ' $viewer huge.tif $picture
printf 'P5\n999999999 999999999\n65535\n' >huge.pgm && refuses 1 'huge.pgm: ' $viewer huge.pgm $picture
$make_file png huge.png size=33x33 && poke huge.png 16 '\177\377\377\377\177\377\377\377'
refuses 1 'huge.png: ' $viewer huge.png $picture
$make_file jp2 huge.jp2 && poke huge.jp2 93 '\177\377\377\377\177\377\377\377'
refuses 1 'huge.jp2: ' $viewer huge.jp2 $picture
printf 'II+\0\010\0\0\0\020\0\0\0\0\0\0\0\377\377\377\377\377\377\377\177' >huge-directory.tif
refuses 1 'huge-directory.tif: damaged' $viewer huge-directory.tif $picture
cat >huge.vrt <<end
<VRTDataset rasterXSize="2000000000" rasterYSize="2000000000"><VRTRasterBand dataType="Int16" band="1"/></VRTDataset>
end
refuses 1 'huge.vrt: .*GiB' $viewer huge.vrt $picture
sed 's/Int16/Float64/; s/2000000000/2147483647/' huge.vrt >widest.vrt
refuses 1 'widest.vrt: ' $viewer widest.vrt $picture
printf 'P5\n0 0\n65535\n' >none.pgm && refuses 1 'none.pgm: ' $viewer none.pgm $picture

# ---- Not heights

$make_file tiff eight.tif size=65x65 type=u8 && accepts 'warning: 8-bit heights: .*steps' $viewer eight.tif $picture
$make_file png eight.png size=65x65 type=u8 && accepts 'warning: 8-bit heights: .*steps' $viewer eight.png $picture
accepts '' $viewer -q eight.tif $picture
$make_file png rgb.png size=65x65 type=u8 channels=3
refuses 1 'three channels: .*Terrarium.*Mapbox.*colour picture' $viewer rgb.png $picture
$make_file tiff rgb.tif size=65x65 type=u8 channels=3
refuses 1 'three channels: .*Terrarium.*Mapbox.*colour picture' $viewer rgb.tif $picture
$make_file tiff rgba.tif size=65x65 type=u8 channels=4
refuses 1 'more than three channels' $viewer rgba.tif $picture
$make_file png palette.png size=65x65 type=u8 palette=1 && refuses 1 'palette' $viewer palette.png $picture
$make_file tiff voids.tif size=65x65 heights=voids all=1 nodata=-32768
refuses 1 '4225 samples that are all void' $viewer voids.tif $picture
$make_file tiff nans.tif size=65x65 type=f32 heights=nan all=1 && refuses 1 'all void' $viewer nans.tif $picture
$make_file hgt N46E010.hgt heights=voids all=1 && refuses 1 'all void' $viewer N46E010.hgt $picture
refuses 1 'all void' $viewer --voids hole voids.tif $picture
refuses 1 'all void' $viewer --voids constant=5 voids.tif $picture
refuses 1 'expected metres within 1e9' $viewer --unit 1e9 hills.tif $picture

# ---- Heights here and there: voids are filled, left out or set

for heights in nan inf; do
    for type in f32 f64; do
        $make_file tiff $heights-$type.tif size=65x65 type=$type heights=$heights
        accepts '' $viewer $heights-$type.tif $picture
        accepts '' $viewer --voids hole $heights-$type.tif $picture
        accepts 'samples are void' $viewer -v --voids constant=7 $heights-$type.tif $picture
    done
done
$make_file exr nan.exr size=65x65 heights=nan && accepts '' $viewer --spacing 30 nan.exr $picture
$make_file tiff some.tif size=65x65 heights=voids nodata=-32768 && accepts '' $viewer some.tif $picture
accepts '' $viewer --voids hole some.tif $picture

# ---- Extreme shapes

for size in 1x1 1x65 65x1; do
    $make_file tiff $size.tif size=$size && refuses 1 'at least 2x2 samples, found' $viewer $size.tif $picture
    $make_file png $size.png size=$size && refuses 1 'at least 2x2 samples, found' $viewer $size.png $picture
done
for size in 2x2 2x65 65x2 3x3 3x70000; do
    $make_file tiff $size.tif size=$size && accepts '' $viewer $size.tif $picture
done
# 2,100 km across a zone of UTM
$make_file tiff 70000x3.tif size=70000x3 && accepts "projection's scale varies" $viewer 70000x3.tif $picture
$make_file png 2x2.png size=2x2 && accepts '' $viewer --spacing 30 2x2.png $picture
$make_file pgm 70000x3.pgm size=70000x3 && accepts '' $viewer --spacing 30 70000x3.pgm $picture

# ---- The command line

# Each value is out of the option's range.
while read -r option values; do
    for value in $values; do
        [ "$value" != '""' ] || value=
        refuses 2 "$option: expected " $viewer hills.tif $picture "$option=$value"
    done
done <<end
--view        1,2,3 1,2,3,4,91 1,2,3,361,0 1e13,0,0,0,0 1,2,3,4,5,6 1,2,3,4,5x ""
--view        nan,0,0,0,0 0,NaN,0,0,0 0,0,inf,0,0 0,0,0,nan,0 0,0,0,0,-nan
--fov         0 0.5 171 -60 nan inf 60x 0x40 ""
--size        0x1 1x0 16385x1 1x16385 64 64x 64x48x3 -64x48 x ""
--background  12345 1234567 gggggg #123456 ""
--samples     0 17 -1 1.5 ""
--target-ms   0 -0 -16 nan inf 1e7 16ms ""
--error       -1 nan inf 1001 1px ""
--output      ""
--colours     ""
--imagery     ""
--synthesis   0 21 -1 1.5 x ""
--shade       foo Slope slope,aspect ""
--sea         x nan inf -inf 1.1e9 -2e9 5m None ""
--sun         90 90, ,30 361,0 90,91 90,-91 nan,0 0,inf 90,30,0 90x30 ""
--date        2024-06-21 2024-06-21T12:00 2024-13-01T12:00Z 2024-02-30T12:00Z 2023-02-29T12:00Z 1900-01-01T12:00Z 2100-01-01T00:00Z 2024-06-21T24:00Z noon ""
--contours    0 -1 nan inf 1e-9 1e7 10m ""
--path        ""
--frames      0 -1 1000001 1e3 ""
--backend     gl Window ""
--spacing     0 -1 nan inf 1e8 1e-7 30m ""
--unit        0 nan inf 1e10 1e-10 ft ""
--nodata      nan inf none 1e999 ""
--voids       keep fill=1 constant constant= constant=nan constant=1e13 ""
--threads     0 -1 1025 two ""
--n           14 16 100 4095 -255 255.0 ""
--levels      0 -1 33 all ""
--budget      0 -5 1e6 99999999999999999999 ""
--budget-us   0 -5 1e6 99999999999999999999 ""
--stats       ""
end
refuses 2 'height of voids: expected -1e9 to 1e9' $viewer hills.tif $picture --voids constant=1e11
refuses 2 '--fov: expected 1..170 degrees, found nothing' $viewer hills.tif $picture --fov
refuses 2 '--unlit: expected no value' $viewer hills.tif $picture --unlit=yes
refuses 2 '--unlit: expected no --shade height with it' $viewer hills.tif $picture --unlit --shade height
refuses 2 '--nonsense: no such option' $viewer hills.tif $picture --nonsense
refuses 2 '-x: no such option' $viewer hills.tif $picture -x
refuses 2 'TERRAIN: expected one file, found also' $viewer hills.tif hills.tif $picture
refuses 2 'TERRAIN: expected a file, found none' env -u DISPLAY -u WAYLAND_DISPLAY $viewer # with a display: test_default.sh
refuses 2 '--path: expected --frames N' $viewer hills.tif --path views.txt
refuses 2 '--frames: expected --path FILE' $viewer hills.tif $picture --frames 5
refuses 2 '--output: expected one number such as %05d' $viewer hills.tif $picture --path views.txt --frames 5
refuses 2 '--n: expected at least 127 with --error, found 63' $viewer hills.tif $picture --error 1 --n 63
refuses 2 '--error: expected a scheme that chooses blocks by it, as hex does, found rings' $globe hills.tif $picture --error 1 --scheme rings
refuses 2 '--target-ms: expected more than 0 ms, found .0' $viewer hills.tif --target-ms 0
refuses 2 '--target-ms: expected a window or --path FILE with it, found one picture' $viewer hills.tif $picture --target-ms 16
refuses 2 '--target-ms: expected a window or --path FILE with it' $globe hills.tif $picture --target-ms 16
refuses 2 '--backend: expected -o FILE or --path' $viewer hills.tif --backend osmesa
echo 0,0,5000,0,-45 >views.txt
refuses 2 '--view: expected either it or --path' $viewer hills.tif --view 0,0,1,0,0 --path views.txt --frames 5

echo '10 1 2' >ramp.txt && refuses 1 'ramp.txt: line 1' $viewer hills.tif $picture --colours ramp.txt
: >none.txt && refuses 1 'none.txt' $viewer hills.tif --path none.txt --frames 5
echo 0,0,nan,0,0 >nan.txt && refuses 1 'nan.txt' $viewer hills.tif --path nan.txt --frames 5
echo 0,0,5 >short.txt && refuses 1 'short.txt' $viewer hills.tif --path short.txt --frames 5
refuses 1 'missing.txt: ' $viewer hills.tif --path missing.txt --frames 5
refuses 1 'out' $viewer hills.tif --path out --frames 5
refuses 1 'hills.tif' $viewer hills.tif --path hills.tif --frames 5

# ---- Outputs that cannot be written

refuses 1 'found a directory' $viewer hills.tif -o out
refuses 1 'missing/a.png: cannot be written' $viewer hills.tif -o missing/a.png
refuses 1 '/proc/.*cannot be written' $viewer hills.tif -o /proc/terraclip.png
refuses 1 'cannot be written' $viewer hills.tif -o hills.tif/a.png
refuses 2 'out/a: expected the extension of a picture' $viewer hills.tif -o out/a
refuses 2 'out/a.xyzzy: expected the extension of a picture' $viewer hills.tif -o out/a.xyzzy
refuses 2 'expected the extension' $viewer hills.tif -o out/a%d --path views.txt --frames 2
refuses 1 'found a directory' $viewer hills.tif $picture --stats out
refuses 1 'missing/a.json: cannot be written' $viewer hills.tif $picture --stats missing/a.json
refuses 1 '/proc/.*cannot be written' $viewer hills.tif $picture --stats /proc/terraclip.json
refuses 1 'frame: |picture: |missing' $viewer hills.tif -o missing/%d.png --path views.txt --frames 2
if [ -c /dev/full ]; then
    run sh -c '"$1" hills.tif -o out/picture.png --size 96x64 --json >/dev/full' sh "$viewer"
    { [ $rc = 1 ] && grep -q 'standard output: cannot be written' stderr.txt; } || report 'full disk not noticed' --json
    rm -f out/picture.png
fi

# ---- No display

for how in '' '--backend window' "--backend window $picture" '--frames 3'; do
    refuses 1 'window: ' env -u DISPLAY -u WAYLAND_DISPLAY $viewer hills.tif $how
done
refuses 1 'window: .*-o FILE.png writes a picture' env -u WAYLAND_DISPLAY DISPLAY=:987 $viewer hills.tif

# ---- terraclip

refuses 2 "expected one of 'terraclip --help'" $terraclip
refuses 2 'paint: expected a command' $terraclip paint
refuses 2 'synth: expected -o FILE.tif' $terraclip synth
refuses 2 'expected options only' $terraclip synth -o out/a.tif b.tif
for name in out/a.tclip a.TCLIP .tclip; do
    refuses 2 "--output: expected the name of a GeoTIFF, which 'terraclip pack' packs, found '$name'" \
        $terraclip synth --size 65 -o $name
done
refuses 2 '--output: expected the name of a GeoTIFF' $terraclip synth --size 65 -o ''
refuses 2 '--nonsense: no such option' $terraclip synth --nonsense -o out/a.tif
refuses 2 '--size: expected .*, found nothing' $terraclip synth -o out/a.tif --size
while read -r option values; do
    for value in $values; do
        [ "$value" != '""' ] || value=
        refuses 2 "$option: expected " $terraclip synth --size 65 -o out/a.tif "$option=$value"
    done
done <<end
--kind     hills Planar ""
--size     0 -1 1 999999999 33.5 ""
--seed     -1 99999999999999999999 one ""
--spacing  0 -1 nan inf 1e99 ""
--threads  0 1025 ""
--output   ""
end
refuses 2 '--size: expected an even number 4..65536' $terraclip synth --kind planet --size 65 -o out/a.tif
refuses 2 '--size: expected an even number 4..65536' $terraclip synth --kind planet --size 2 -o out/a.tif
refuses 2 '--spacing: expected none' $terraclip synth --kind planet --size 64 --spacing 30 -o out/a.tif
refuses 1 'cannot be written' $terraclip synth --kind planet --size 64 -o missing/a.tif
refuses 1 'found a directory' $terraclip synth --size 65 -o out
refuses 1 'cannot be written' $terraclip synth --size 65 -o missing/a.tif
refuses 1 'cannot be written' $terraclip synth --size 65 -o /proc/a.tif

finish

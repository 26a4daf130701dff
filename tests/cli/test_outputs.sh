#!/bin/sh
# An output is never an input: no program writes over a file that it reads, by whatever name and link, and none writes
# two of its outputs to one file. Found out before a byte is written.
. "${0%/*}/lib.sh"

$make_file tiff dem.tif size=65x65
$make_file png dem.png size=65x65
$make_file tiff globe.tif size=64x32
$terraclip pack dem.tif -o dem.tclip -q || exit 99
cat >dem.vrt <<end
<VRTDataset rasterXSize="65" rasterYSize="65"><VRTRasterBand dataType="Int16" band="1"><SimpleSource>
<SourceFilename relativeToVRT="1">dem.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>
end
sed 's/dem.tif/dem.vrt/' dem.vrt >nested.vrt
printf '0%% black\n100%% white\n' >ramp.png
printf '0,0,5000,0,-30\n0,9000,5000,0,-30\n' >flight.txt
printf '0,0,5e6,0,-90\n9,0,5e6,0,-90\n' >globe.txt
mkdir folder
ln -s ../dem.png folder/link.png
ln dem.png folder/hard.png
cp dem.png frame-0003.png
cp dem.png frame-0004.tif
cat ./*.* | cksum >before.sum
small='--size 96x64'

kept() {
    cases=$((cases + 1))
    rm -f error.txt
    [ "$(cat $(ls ./*.* | grep -v -e before.sum -e std) | cksum)" = "$(cat before.sum)" ] || fail "an input is changed: $*"
}
never() { # REGEX COMMAND...
    regex=$1
    shift
    refuses 2 "$regex: expected another file than the (in|out)put .*, found the same" "$@"
    kept "$@"
}

for program in $viewer $globe; do
    never dem.png $program dem.png -o dem.png $small
    never ./dem.png $program dem.png -o ./dem.png $small
    never folder/link.png $program dem.png -o folder/link.png $small
    never folder/hard.png $program dem.png -o folder/hard.png $small
    never dem.png $program folder/link.png -o dem.png $small
    never dem.tif $program dem.tif -o dem.tif $small
    never dem.tclip $program dem.tclip -o out/a.png --stats dem.tclip $small
    never dem.tif $program dem.tif -o out/a.png --stats dem.tif $small
    never dem.tif $program dem.vrt -o dem.tif $small
    never dem.tif $program nested.vrt -o dem.tif $small
    never dem.vrt $program nested.vrt -o out/a.png --stats dem.vrt $small
    never out/a.png $program dem.tif -o out/a.png --stats out/a.png $small
    never out/a.png $program dem.tif -o out/a.png --stats ./out/../out/a.png $small
done
never ramp.png $viewer dem.tif --colours ramp.png -o ramp.png $small
never flight.txt $viewer dem.tif --path flight.txt --frames 2 --stats flight.txt $small
never globe.txt $globe globe.tif --path globe.txt --frames 2 --stats globe.txt $small
never frame-0003.png $viewer frame-0003.png --path flight.txt --frames 6 -o frame-%04d.png $small
never frame-0004.tif $viewer frame-0004.tif --path flight.txt --frames 6 -o frame-%04d.tif $small
never out/frame-2.png $viewer dem.tif --path flight.txt --frames 6 -o out/frame-%d.png --stats out/frame-2.png $small
# What is not written is not refused: frames up to the number asked for, and the other way round.
does '' $viewer frame-0004.tif --path flight.txt --frames 4 -o out/frame-%04d.tif $small -q
kept 'a flight elsewhere'
rm -rf out && mkdir out

never dem.tif $terraclip pack dem.tif -o dem.tif
never dem.tif $terraclip pack dem.vrt -o dem.tif
never dem.tif $terraclip pack nested.vrt -o dem.tif
never folder/hard.png $terraclip pack dem.tif dem.png -o folder/hard.png
never dem.tclip $terraclip extract dem.tclip -o dem.tclip
ln -s ../dem.tclip folder/packed.tif
never folder/packed.tif $terraclip extract dem.tclip -o folder/packed.tif
# A device may be both.
does '' $viewer dem.tif -o out/a.png --stats /dev/null $small -q
kept 'a device'

finish

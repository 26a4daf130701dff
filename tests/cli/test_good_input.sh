#!/bin/sh
# What is to be shown is shown: the same terrain gives the same picture from every format, and the programs print what
# their users rely on.
. "${0%/*}/lib.sh"

# Over the terrain, in metres, so that several levels are drawn; without the colours of a latitude, which not every format tells.
near='--view 30000,20000,3200,30,-15 --no-surroundings'

# ---- One grid, many formats

$make_file hgt N46E008.hgt
$make_file tiff strips.tif
$make_file tiff tiles.tif tile=256
$make_file tiff unsigned.tif type=u16
$make_file tiff int32.tif type=i32 tile=64
$make_file tiff float32.tif type=f32
$make_file tiff float64.tif type=f64 tile=128
$make_file pgm heights.pgm
$make_file png heights.png
$make_file exr heights.exr
cat >mosaic.vrt <<end
<VRTDataset rasterXSize="1201" rasterYSize="1201"><VRTRasterBand dataType="Int16" band="1">
<SimpleSource><SourceFilename relativeToVRT="1">strips.tif</SourceFilename>
<SrcRect xOff="0" yOff="0" xSize="600" ySize="1201"/>
<DstRect xOff="0" yOff="0" xSize="600" ySize="1201"/></SimpleSource>
<SimpleSource><SourceFilename relativeToVRT="1">float32.tif</SourceFilename>
<SrcRect xOff="600" yOff="0" xSize="601" ySize="1201"/>
<DstRect xOff="600" yOff="0" xSize="601" ySize="1201"/></SimpleSource>
</VRTRasterBand></VRTDataset>
end
accepts '' $viewer N46E008.hgt --spacing 90 $near $picture
mv last.png tile.png
for file in strips.tif tiles.tif unsigned.tif int32.tif float32.tif float64.tif heights.pgm heights.png heights.exr \
    mosaic.vrt; do
    accepts '' $viewer $file --spacing 90 $near $picture
    same tile.png last.png "N46E008.hgt and $file"
done
if command -v gdal_translate >/dev/null 2>&1; then
    for how in 'JP2OpenJPEG heights.jp2 -co REVERSIBLE=YES -co QUALITY=100' 'GTiff deflated.tif -co COMPRESS=DEFLATE' \
        'GTiff lzw.tif -co COMPRESS=LZW -co TILED=YES -co PREDICTOR=2' 'GTiff big.tif -co BIGTIFF=YES'; do
        set -- $how # driver, file, its options
        driver=$1 file=$2
        shift 2
        gdal_translate -q -of "$driver" "$@" strips.tif "$file" >translate.txt 2>&1 ||
            { skip "$file: $(head -n 1 translate.txt)"; continue; }
        accepts '' $viewer $file --spacing 90 $near $picture
        same tile.png last.png "N46E008.hgt and $file"
    done
else
    skip 'gdal_translate is not installed: compressed TIFFs and a large JPEG 2000'
fi
# A small JPEG 2000 there is in any case.
$make_file jp2 small.jp2
$make_file tiff small.tif size=16x12 heights=plane
accepts '' $viewer small.jp2 --spacing 30 $picture
mv last.png small.png
accepts '' $viewer small.tif $picture # which says that it is 30 m
same small.png last.png 'small.jp2 and small.tif'

# ---- Where it lies and how high it is

accepts 'warning: no georeference: ' $viewer heights.pgm $picture
$make_file tiff nowhere.tif metres=0 && accepts 'warning: no georeference: ' $viewer nowhere.tif $picture
# The tile's name says where it lies, a GeoTIFF's tags say the same.
$make_file tiff placed.tif place=8,46
accepts '0.000833333333 x 0.000833333333 degrees become 63.9688 x 92.6342 m at the mean latitude of 46.5' \
    $viewer -v N46E008.hgt $near $picture
mv last.png by-name.png
accepts 'degrees become 63.9688 x 92.6342 m' $viewer -v placed.tif $near $picture
same by-name.png last.png 'place by name and by tags'
different tile.png last.png 'another spacing'
mkdir lower && cp N46E008.hgt lower/n46e008.HGT
accepts '' $viewer lower/n46e008.HGT $near $picture
same by-name.png last.png 'N46E008.hgt and n46e008.HGT'
cp N46E008.hgt tile.hgt && accepts "warning: the file's name says no place" $viewer tile.hgt $near $picture
accepts '' $viewer -q tile.hgt $near $picture
accepts '' $viewer tile.hgt --spacing 90 $near $picture
same tile.png last.png 'tile.hgt by --spacing'
for name in N46E008.SRTMGL3 n46_e008_3arc_v2 N46E008_1201; do
    cp N46E008.hgt $name.hgt && accepts '' $viewer $name.hgt $near $picture
    same by-name.png last.png "N46E008.hgt and $name.hgt"
done
# A name is understood whole or not at all: a ninth of a degree, and what is no place.
cp N46E008.hgt N46E008T86.hgt && accepts '9.25925926e-05 x 9.25925926e-05 degrees .* latitude of 46.8333' \
    $viewer -v N46E008T86.hgt $picture
for name in N46E008T80 N46E008_3601 N46E008b; do
    cp N46E008.hgt $name.hgt && accepts "warning: the file's name says no place that is understood: .* --spacing" \
        $viewer $name.hgt $picture
done
$make_file hgt hill.hgt size=100x100 && accepts 'says no place .* 1 m apart; --spacing' $viewer hill.hgt $picture
$make_file tiff metres.tif metres=90
accepts 'every 90 x 90 m' $viewer -v metres.tif $near $picture
same tile.png last.png 'projected, 90 m'
accepts 'every 45 x 45 m' $viewer -v --spacing 45 metres.tif $near $picture
different tile.png last.png '--spacing 45'
accepts 'heights 240.00 to 2160.00 m' $viewer -v N46E008.hgt $picture
accepts 'heights 24.00 to 216.00 m' $viewer -v --unit 0.1 N46E008.hgt $picture

# An eye under the ground would see its underside: it is lifted above it, and that is said. Beside the terrain there is
# no ground.
for view in 30000,20000,-500,30,-15 30000,20000,5,30,60 0,0,-1e6,0,0; do
    accepts 'warning: the eye was .* m under the ground' $viewer strips.tif --spacing 90 $picture "--view=$view"
    accepts '' $viewer strips.tif --spacing 90 $picture "--view=$view" -q
done
accepts '' $viewer strips.tif --spacing 90 $picture --view=-5000,20000,-500,90,0

# ---- Voids

$make_file tiff voids.tif heights=voids metres=90 nodata=-32768
accepts '' $viewer voids.tif $near $picture
mv last.png filled.png
accepts 'filled from their surroundings' $viewer -v voids.tif --voids fill $near $picture
same filled.png last.png '--voids fill'
accepts 'left out' $viewer -v voids.tif --voids hole $near $picture
different filled.png last.png '--voids hole'
accepts 'set to a constant height' $viewer -v voids.tif --voids constant=0 $near $picture
different filled.png last.png '--voids constant'
$make_file tiff untold.tif heights=voids metres=90
accepts '' $viewer untold.tif --nodata -32768 $near $picture
same filled.png last.png '--nodata'
$make_file tiff nan.tif heights=nan type=f32 metres=90
accepts '' $viewer nan.tif $near $picture
same filled.png last.png 'NaN and nodata'

# ---- As maps show it

accepts '' $viewer metres.tif $near $picture
mv last.png natural.png
accepts '' $viewer metres.tif $near $picture --shade natural
same natural.png last.png '--shade natural'
for shade in slope aspect height none; do
    accepts '' $viewer metres.tif $near $picture --shade $shade
    different natural.png last.png "--shade $shade"
    mv last.png shade.png
    accepts '' $viewer metres.tif $near $picture --shade $shade --contours 100
    different shade.png last.png "--shade $shade and --contours"
    accepts '' $viewer voids.tif $near $picture --shade $shade --voids hole --contours 100 --level-colours --samples 1
    [ $shade = height ] || accepts '' $viewer metres.tif $near $picture --shade $shade --unlit
    [ $shade = height ] || same shade.png last.png "--shade $shade, unlit or not"
done
accepts '' $viewer metres.tif $near $picture --unlit --background 000000
mv last.png unlit.png
accepts '' $viewer metres.tif $near $picture --shade none --background 000000
same unlit.png last.png '--unlit and --shade none without a sky'
accepts '' $viewer metres.tif $near $picture --error 1 --json
grep -q '"error_bound_px": [01]\.' stdout.txt || report 'no bound of the error' --error 1
accepts '' $viewer metres.tif $near $picture --error 1000
accepts '' $viewer voids.tif $near $picture --voids hole --error 0.5
accepts '' $viewer metres.tif $near $picture --contours 100
different natural.png last.png '--contours'

# ---- What is told

keys='frames frame_ms median p95 max update_ms draw_ms triangles draws levels_active samples_updated bytes_uploaded
bytes_decoded synthesised_levels imagery_levels memory geometry heights normals imagery pyramid renderer backend left_out throttle median max tolerance_px error_bound_px blocks_by_level
sun azimuth elevation sea exaggeration'
json_keys() { # FILE
    grep -o '"[A-Za-z0-9_]*":' "$1" | tr -d '":' | tr '\n' ' '
}
wanted=$(echo $keys)
accepts '' $viewer metres.tif $near --json --stats out.json $picture
[ "$(json_keys stdout.txt | sed 's/ $//')" = "$wanted" ] || fail "--json has the keys $(json_keys stdout.txt)"
cmp -s stdout.txt out.json || fail '--json and --stats differ'
grep -q '"frames": 1,' out.json || fail "--stats of a picture: $(grep frames out.json)"
grep -Eq '"backend": "(egl-device|egl-surfaceless|osmesa)"' out.json || fail "--stats: $(grep backend out.json)"
for backend in egl osmesa; do
    run $viewer metres.tif $near --backend $backend --json -o out/picture.png --size 96x64
    if [ $rc = 0 ]; then
        grep -Eq "\"backend\": \"$backend" stdout.txt || fail "--backend $backend: $(grep backend stdout.txt)"
    else
        skip "--backend $backend: $(cat stderr.txt)"
    fi
    rm -f out/picture.png
done
accepts '' $viewer metres.tif --explain $picture
grep -q '^left out: void mask: no holes' stdout.txt || fail "--explain prints $(cat stdout.txt)"
for line in 'shaders: terrain: .*renderer\.frag; .*LIT' 'texture: heights: RG32F, [0-9]+ x [0-9]+ x [0-9]+, [0-9]+ bytes' \
    'texture: normals: ' 'levels: [0-9]+ of [0-9]+ hold samples' 'levels: [0-9]+ of [0-9]+ drawn' \
    'blocks: [0-9]+ of [0-9]+ drawn' 'library: GDAL' 'threads: drawing; [0-9]+ of the driver'; do
    grep -Eq "^uses: $line" stdout.txt || fail "--explain does not tell of $line"
done
! grep -Evq '^(uses|left out): ' stdout.txt || fail "--explain prints $(grep -Ev '^(uses|left out): ' stdout.txt)"
# What the system has mapped: the libraries that --explain tells of, and none of the others.
printf '0,0,900,0,0\n9,0,900,0,0\n' >flight.txt
run $viewer N46E008.hgt --spacing 90 --path flight.txt --frames 2 --size 96x64 --explain
[ $rc = 0 ] && grep -q '^left out: GDAL: not loaded' stdout.txt && grep -q '^left out: OpenImageIO: not loaded' stdout.txt &&
    grep -q '^left out: GLFW: not loaded' stdout.txt || fail "--explain of a tile of its own kind: $(cat stdout.txt)"
! grep -q '^uses: library' stdout.txt || fail "--explain: $(grep '^uses: library' stdout.txt)"
if command -v strace >/dev/null; then
    strace -f -e trace=openat -o opened.txt $viewer N46E008.hgt --spacing 90 --path flight.txt --frames 2 --size 96x64 -q \
        >/dev/null 2>&1
    ! grep -Eq 'libgdal|OpenImageIO|libglfw' opened.txt || fail 'a library is opened without need'
fi
accepts '' $viewer metres.tif --json $near $picture
grep -q '"void mask: no holes to show"' stdout.txt && grep -Eq '"[0-9]+ of [0-9]+ triangles: outside the view or behind nearer ground"' stdout.txt ||
    fail "--json: left_out is $(grep -A9 left_out stdout.txt)"
accepts '' $viewer metres.tif --explain --unlit --background 000000 --no-morph $picture
! grep -Eq '^uses: (texture: normals|shaders: sky|shaders: .*(LIT|HAZE))' stdout.txt || fail '--explain: used without need'
for part in 'normal map' sky 'void mask' morph throttling synthesis imagery; do
    grep -q "^left out: $part" stdout.txt || fail "--explain does not tell of the $part"
done
accepts '' $viewer metres.tif --explain --shade slope --contours 50 $picture
for line in 'shaders: terrain: .*shade\.glsl.*CONTOURS.*SHADE_SLOPE' 'texture: fine normals: RGBA16_SNORM'; do
    grep -Eq "^uses: $line" stdout.txt || fail "--explain of a slope map does not tell of $line"
done
for part in lighting haze 'rock and snow' 'water, colours of heights'; do
    grep -q "^left out: $part" stdout.txt || fail "--explain of a slope map does not tell of the $part"
done
accepts '' $viewer voids.tif --voids hole --explain $picture
! grep -q 'void mask' stdout.txt || fail '--explain: the void mask is not left out where there are holes'
accepts 'OpenGL 4\.[5-9]' $viewer -v metres.tif $picture
accepts '' $viewer metres.tif $picture
[ ! -s stdout.txt ] || fail 'a picture without --json prints something'

for program in $viewer $terraclip; do
    run $program --version
    { [ $rc = 0 ] && grep -Eqx "${program##*/} [0-9]+\.[0-9]+\.[0-9]+" stdout.txt; } || report 'no version' $program
    run $program --help
    { [ $rc = 0 ] && grep -qi '^usage: ' stdout.txt && [ ! -s stderr.txt ]; } || report 'no help' $program
done
run $viewer --help
# Every option that the table of bad values knows is in the help, and the keys of the window are.
for word in --view --fov --size --colours --imagery --synthesis --sea --shade --contours --unlit --sun --date --background --wireframe --level-colours --no-morph --samples --target-ms --output --path \
    --frames --backend --spacing --unit --offset --nodata --band --layer --crs --voids --threads --n --levels --budget --budget-us --stats --json --explain \
    --quiet --verbose 'W A S D' F11; do
    grep -q -- "$word" stdout.txt || fail "the help does not tell of $word"
done

# ---- Flights

cat >views.txt <<end
# over the ridge
20000,10000,4000,20,-10
50000,40000,6000,80,-20   # and away

90000,80000,9000,170,-30
end
run $viewer metres.tif --path views.txt --frames 4 --size 96x64 --samples 1 -o out/frame-%03d.png --stats out/stats.json
{ [ $rc = 0 ] && [ ! -s stderr.txt ] && [ ! -s stdout.txt ]; } || report 'flight' -o out/frame-%03d.png
[ "$(echo $(ls out))" = 'frame-000.png frame-001.png frame-002.png frame-003.png stats.json' ] ||
    fail "a flight wrote $(echo $(ls out))"
grep -q '"frames": 4,' out/stats.json || fail "--stats of a flight: $(grep frames out/stats.json)"
mv out flight && mkdir out
# The first and last frames are the views themselves.
mv flight/frame-003.png flight/frame-000.png .
accepts '' $viewer metres.tif --view 20000,10000,4000,20,-10 --samples 1 $picture
same frame-000.png last.png 'the first frame of a flight'
accepts '' $viewer metres.tif --view 90000,80000,9000,170,-30 --samples 1 $picture
same frame-003.png last.png 'the last frame of a flight'
run $viewer metres.tif --path views.txt --frames 5 --size 96x64
{ [ $rc = 0 ] && grep -Eq '^5 frames: [0-9.]+ ms median' stdout.txt && [ -z "$(ls out)" ]; } ||
    report 'measured flight' --path
run $viewer -q metres.tif --path views.txt --frames 5 --size 96x64
{ [ $rc = 0 ] && [ ! -s stdout.txt ] && [ ! -s stderr.txt ]; } || report 'quiet measured flight' --path

# ---- The same again

accepts '' $viewer metres.tif $near -o out/picture.png --size 320x240
mv last.png once.png
accepts '' $viewer metres.tif $near -o out/picture.png --size 320x240
same once.png last.png 'two runs'
accepts '' $viewer metres.tif $near -o out/picture.png --size 320x240 --threads 1
same once.png last.png 'one thread and all'
accepts '' $viewer metres.tif $near -o out/picture.png --size 320x240 --budget 5000
same once.png last.png 'little by little'
accepts '' $viewer metres.tif $near -o out/picture.png --size 320x240 --budget-us 50
same once.png last.png 'in little time'
for extension in jpg tif ppm; do
    run $viewer metres.tif --size 96x64 -o out/picture.$extension
    { [ $rc = 0 ] && [ -s out/picture.$extension ] && [ ! -s stderr.txt ]; } || report "-o .$extension" $viewer
done
rm -rf out && mkdir out
$terraclip synth --size 129 --seed 5 -o once.tif && $terraclip synth --size 129 --seed 5 -o again.tif
same once.tif again.tif 'terraclip synth, twice'
accepts '' $viewer once.tif $picture
# An old file is replaced as a whole, through a link, too.
echo old >old.png && ln -s ../old.png out/picture.png
accepts '' $viewer metres.tif $picture
is_png old.png || fail 'a linked file was not replaced'

# ---- Real data

if [ -n "${TERRACLIP_DATA:-}" ]; then
    for file in "$TERRACLIP_DATA"/*.hgt "$TERRACLIP_DATA"/N46E008.tif "$TERRACLIP_DATA"/ps_height_1k.png \
        "$TERRACLIP_DATA"/srtm3_canyonlands_voids_2401x3601.tif "$TERRACLIP_DATA"/earth_etopo20_1080x540_f32.tif \
        "$TERRACLIP_DATA"/moon_gld100_256ppd_ne_4097.png; do
        [ -f "$file" ] && accepts '' $viewer "$file" -q $picture
    done
    picture_of_earth="$TERRACLIP_DATA"/earth_bluemarble_200412_5400x2700.jpg
    [ ! -f "$picture_of_earth" ] || refuses 1 'three channels' $viewer "$picture_of_earth" $picture
else
    skip 'TERRACLIP_DATA is not set: real elevation models'
fi

# More samples a pixel than the driver has are said.
accepts 'warning: --samples: expected at most [0-9]+ with this driver, found 16' $viewer small.tif --samples 16 $picture
accepts '' $viewer small.tif --samples 4 $picture

finish

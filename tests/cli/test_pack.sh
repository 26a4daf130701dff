#!/bin/sh
# Packed terrains by way of the programs: what goes in comes out, and what is wrong is said in one line.
. "${0%/*}/lib.sh"

# A number of a JSON file.
number() { # KEY
    sed -n "s/.*\"$1\": \([-0-9.e+]*\).*/\1/p" | head -n 1
}

is_less() { # A B WHAT
    cases=$((cases + 1))
    awk "BEGIN { exit !($1 <= $2) }" || fail "expected $1 <= $2: $3"
}

# Draws a terrain and keeps the picture.
shows() { # PICTURE TERRAIN OPTION...
    kept=$1
    shift
    does '' $viewer "$@" -o $kept --size 96x64
}

# Pictures that differ by no more than what coarser levels may lose to whole units of height.
alike() { # PICTURE PICTURE WHAT
    cases=$((cases + 1))
    cmp -l "$1" "$2" 2>&1 | awk '
        function decimal(octal) { return 64 * int(octal / 100) + 8 * (int(octal / 10) % 10) + octal % 10 }
        NF != 3 { far = 1 }
        { d = decimal($2) - decimal($3); if (d < -8 || d > 8) far++ }
        END { exit far > 20 }' || fail "pictures differ: $3"
}

json_keys() { # FILE
    grep -o '"[A-Za-z0-9_]*":' "$1" | tr -d '":' | tr '\n' ' '
}

pack="$terraclip pack -o out/a.tclip"
$make_file tiff hills.tif size=300x200 metres=30

# ---- The command line

refuses 2 'INPUT: expected at least one file' $pack
refuses 2 'pack: expected -o FILE.tclip' $terraclip pack hills.tif
refuses 2 '--nonsense: no such option' $pack hills.tif --nonsense
refuses 2 '--rms: expected .*, found nothing' $pack hills.tif --rms
while read -r option values; do
    for value in $values; do
        [ "$value" != '""' ] || value=
        refuses 2 "$option: expected " $pack hills.tif "$option=$value"
    done
done <<end
--rms       0 -1 nan inf 1e99 ten ""
--max-error 0 -1 nan inf 1e99 ""
--codec     jpeg LH04 ""
--voids     pit constant constant=
--nodata    nan none
--spacing   0 -1
--unit      0 inf
--threads   0 1.5
--atlas     globe ""
--radius    0 -5 6371km
--output    ""
end
refuses 2 'expected --rms, --max-error, both of them or --lossless, found --rms and --lossless' \
    $pack hills.tif --rms 1 --lossless
refuses 2 'found --max-error and --lossless' $pack hills.tif --max-error 1 --lossless
refuses 2 'found all three' $pack hills.tif --max-error 1 --lossless --rms 2
refuses 2 '--codec: expected lifting with --lossless' $pack hills.tif --codec lh04 --lossless
refuses 2 '--codec: expected lifting with --max-error' $pack hills.tif --codec lh04 --max-error 1
refuses 2 '--codec: expected lifting with --max-error' $pack hills.tif --codec lh04 --rms 1 --max-error 4
refuses 2 '--radius: expected --planet' $pack hills.tif --radius 6371000
refuses 2 '--atlas: expected --planet with it, found none' $pack hills.tif --atlas cube
refuses 2 'FILE: expected a packed terrain, found none' $terraclip info
refuses 2 "found also 'b'" $terraclip info a b
refuses 2 'FILE: expected a packed terrain, found none' $terraclip extract -o out/a.tif
refuses 2 'extract: expected -o OUT.tif' $terraclip extract a.tclip
for rect in 1,2,3 1,2,3,4,5 -1,0,5,5 0,0,0,5 0.5,0,5,5 a,b,c,d; do
    refuses 2 '--rect: expected' $terraclip extract a.tclip -o out/a.tif --rect=$rect
done
refuses 2 '--level: expected' $terraclip extract a.tclip -o out/a.tif --level 0
refuses 2 'FILE: expected a terrain, found none' $terraclip height
refuses 2 'point: expected two numbers, found one' $terraclip height hills.tif 5
refuses 2 "point: expected two numbers, found 'x'" $terraclip height hills.tif 5 x
refuses 2 "point: expected two numbers, found also '3'" $terraclip height hills.tif 1 2 3
for command in pack info extract height; do
    run $terraclip $command --help
    { [ $rc = 0 ] && grep -q "^Usage: terraclip $command " stdout.txt && [ ! -s stderr.txt ]; } ||
        report 'no help' $terraclip $command
done

# ---- Inputs and outputs that are not there, or are something else

refuses 1 'missing.tif: .*No such file' $pack missing.tif
mkdir nothing && refuses 1 'nothing: expected a folder of elevation files, found none' $pack nothing
refuses 1 'cannot be written' $terraclip pack hills.tif -o missing/a.tclip
refuses 1 'found a directory' $terraclip pack hills.tif -o out
refuses 2 'expected another file than the input' $terraclip pack hills.tif -o hills.tif
ln hills.tif link.tif && refuses 2 'expected another file than the input' $terraclip pack hills.tif -o link.tif
: >empty.tclip
head -c 5000 /dev/urandom >noise.tclip
for file in missing.tclip empty.tclip noise.tclip hills.tif .; do
    refuses 1 "${file##*/}" $terraclip info $file
    refuses 1 "${file##*/}" $terraclip extract $file -o out/a.tif
done
refuses 1 'missing.tclip' $terraclip height missing.tclip 1 2
$make_file tiff all.tif size=20x20 heights=voids all=1 nodata=-32768 metres=30
refuses 1 'void' $pack all.tif

# ---- Without loss, everything comes back

$make_file tiff u8.tif size=130x70 type=u8 metres=30
$make_file tiff u16.tif size=257x255 type=u16 tile=64 metres=30
$make_file tiff i32.tif size=64x300 type=i32 metres=30
$make_file tiff f32.tif size=100x100 type=f32 metres=30
$make_file tiff f64.tif size=31x90 type=f64 metres=30
$make_file tiff voids.tif size=99x101 heights=voids nodata=-32768 metres=30
$make_file tiff nan.tif size=99x101 heights=nan type=f32 metres=30
$make_file tiff placed.tif size=120x90 place=8,46
$make_file tiff area.tif size=120x90 area=1
$make_file tiff one.tif size=1x1 heights=plane
$make_file tiff row.tif size=70x1 heights=plane
$make_file tiff column.tif size=1x70 heights=plane
for file in hills u8 u16 i32 f32 f64 voids nan placed area one row column; do
    run $terraclip pack $file.tif -o $file.tclip --lossless -q
    [ $rc = 0 ] && [ ! -s stdout.txt ] || report 'pack --lossless' $file.tif
    run $terraclip extract $file.tclip -o $file.out.tif -q
    [ $rc = 0 ] || report 'extract' $file.tclip
    case $file in
    nan) equal nan.tif nan.out.tif ;; # which gets a nodata value: NaN
    *) equal $file.tif $file.out.tif stored ;;
    esac
done
$make_file hgt N46E008.hgt
does '' $terraclip pack N46E008.hgt -o tile.tclip --lossless
does '' $terraclip extract tile.tclip -o tile.tif
equal N46E008.hgt tile.tif stored
$make_file png heights.png size=200x200
does 'no georeference' $terraclip pack heights.png -o heights.tclip --lossless
does '' $terraclip extract heights.tclip -o heights.tif
equal heights.png heights.tif nowhere
does '' $terraclip pack heights.png -o heights.tclip --lossless --spacing 30 --unit 0.1
does '' $terraclip extract heights.tclip -o heights.tif
equal heights.png heights.tif nowhere within=2e4 # of another unit
does '' $terraclip pack hills.tif -o first.tclip --lossless --threads 1
does '' $terraclip pack hills.tif -o again.tclip --lossless --threads 3
same first.tclip again.tclip 'one thread and three'

# ---- With loss, no more than was said

does '' $terraclip pack hills.tif -o hills.tclip --max-error 2.5 --json
keys='input width height samples bytes bits_per_sample mode rms_m max_error_m voids seconds msamples_per_s peak_rss_bytes'
[ "$(json_keys stdout.txt)" = "$keys " ] || fail "pack --json has the keys $(json_keys stdout.txt)"
grep -q '"input": \["hills.tif"\],' stdout.txt || fail "pack --json: $(head -n 2 stdout.txt)"
grep -q '"mode": "max-error",' stdout.txt || fail "pack --json: $(grep mode stdout.txt)"
[ "$(number bytes <stdout.txt)" = "$(($(wc -c <hills.tclip)))" ] || fail "pack --json: $(grep bytes stdout.txt)"
is_less "$(number max_error_m <stdout.txt)" 2.5 '--max-error'
does '' $terraclip extract hills.tclip -o lossy.tif
equal hills.tif lossy.tif within=2.5
does '' $terraclip pack hills.tif -o hills.tclip --rms 0.5 --json
is_less "$(number rms_m <stdout.txt)" 0.5 '--rms'
$make_file tiff towers.tif size=300x200 metres=50 heights=towers
for bounds in '0.5 2' '0.5 1' '0.5 0.75' '2 1' '0.5 1000'; do
    does '' $terraclip pack towers.tif -o towers.tclip --rms ${bounds% *} --max-error ${bounds#* } --json
    is_less "$(number rms_m <stdout.txt)" ${bounds% *} "--rms and --max-error $bounds"
    is_less "$(number max_error_m <stdout.txt)" ${bounds#* } "--rms and --max-error $bounds"
    does '' $terraclip extract towers.tclip -o lossy.tif
    equal towers.tif lossy.tif within=${bounds#* }
done
does '' $terraclip pack towers.tif -o towers.tclip --rms 3 --json
is_less 12 "$(number max_error_m <stdout.txt)" '--rms alone bounds nothing'
does '' $terraclip pack towers.tif -o towers.tclip --json
is_less "$(number rms_m <stdout.txt)" 3 'the default'
is_less "$(number max_error_m <stdout.txt)" 12 'the default'
[ "$(json_keys stdout.txt)" = "$(echo "$keys" | sed 's/max_error_m/& lossless_bytes_about/') " ] ||
    fail "pack --json has the keys $(json_keys stdout.txt)"
grep -q '"mode": "rms",' stdout.txt || fail "pack --json: $(grep mode stdout.txt)"
does '' $terraclip extract towers.tclip -o lossy.tif
equal towers.tif lossy.tif within=12
does '' $terraclip pack towers.tif -o both.tclip --rms 3 --max-error 12
same towers.tclip both.tclip 'the default and what it stands for'
does '' $terraclip info both.tclip
echo "$out" | grep -Eq '3 m asked for, corrected beyond 1[01]\.?[0-9]* m; rms' || fail "info of a bound prints $out"
$make_file tiff steps.tif size=300x200 metres=0.1 heights=hills
does 'without loss the file would take fewer bytes: --lossless' $terraclip pack steps.tif -o steps.tclip
does '' $terraclip pack hills.tif -o paper.tclip --codec lh04
does '' $terraclip pack hills.tif -o paper.tclip --codec lh04 --rms 0.5
echo "$out" | grep -Eq '^paper.tclip: 300 x 200 samples, [0-9]+ bytes, ' || fail "pack prints $out"

# ---- What it says of itself

does '' $terraclip pack hills.tif -o hills.tclip
does '' $terraclip info hills.tclip --json
for key in version atlas levels level width height spacing_m bytes bits_per_sample rms_m max_error_m z_min_m z_max_m \
    voids synthesis_fit; do
    grep -q "\"$key\": " stdout.txt || fail "info --json lacks $key"
done
[ "$(grep -c '"level": ' stdout.txt)" = 10 ] || fail 'info --json has not the ten levels of 300 x 200 samples'
grep -q '"level": 10, "width": 300, "height": 200, "spacing_m": 30,' stdout.txt || fail 'info --json: the finest level'
grep -q '"level": 1, "width": 1, "height": 1,' stdout.txt || fail 'info --json: the coarsest level'
if command -v python3 >/dev/null 2>&1; then
    python3 -c 'import json; json.load(open("stdout.txt"))' || fail 'info --json is no JSON'
fi
does '' $terraclip info hills.tclip
{ echo "$out" | grep -q '300 x 200 samples' && [ "$(wc -l <stdout.txt)" -le 24 ]; } || fail "info prints $out"
grep -q 'synthesis' stdout.txt && fail 'info tells of a fit that is not there'
$terraclip info hills.tclip --json | grep -q '"synthesis_fit": false,' || fail 'info --json: no fit'
for threads in 1 4; do
    does '' $terraclip pack hills.tif -o fit$threads.tclip --synthesis-fit --threads $threads
done
cmp -s fit1.tclip fit4.tclip || fail 'a file with a fit depends on threads'
[ "$(wc -c <fit1.tclip)" = $(($(wc -c <hills.tclip) + 427)) ] || fail 'a fit takes more or less than its section'
does '' $terraclip info fit1.tclip
echo "$out" | grep -q '^  synthesis  *by a fit to the heights as they were given$' || fail "info of a fit prints $out"
does '' $terraclip info fit1.tclip --json
grep -q '"synthesis_fit": true,' stdout.txt || fail 'info --json: a fit'
does '' $terraclip info voids.tclip --json
[ "$(number void_count <stdout.txt)$(number voids <stdout.txt)" -gt 0 ] || fail 'info --json: voids'

# ---- Parts and levels

does '' $terraclip pack hills.tif -o hills.tclip --lossless
does '' $terraclip extract hills.tclip --rect 17,30,64,50 -o part.tif
equal hills.tif part.tif stored at=17,30
does '' $terraclip extract hills.tclip --rect 299,199,1,1 -o corner.tif
equal hills.tif corner.tif stored at=299,199
refuses 2 '--rect: expected a part of level 10, 300 x 200' $terraclip extract hills.tclip --rect 17,30,284,1 -o out/a.tif
refuses 2 '--level: expected 1..10, found 11' $terraclip extract hills.tclip --level 11 -o out/a.tif
refuses 2 'expected another file than the input' $terraclip extract hills.tclip -o hills.tclip
does '' $terraclip extract hills.tclip --level 8 -o level.tif
does '' $terraclip extract hills.tclip --level 8 --rect 5,6,20,30 -o part.tif
equal level.tif part.tif stored at=5,6
# A plane is a plane on every level, and every sample lies where it lay.
$make_file tiff plane.tif size=129x65 heights=plane metres=10
does '' $terraclip pack plane.tif -o plane.tclip --lossless
for level in 8 7 5 3; do
    does '' $terraclip extract plane.tclip --level $level -o level.tif
    for point in '500005 5199995' '500320 5199680' '501280 5199360' '500640 5199680'; do
        does '' $terraclip height plane.tif $point
        wanted=$out
        does '' $terraclip height level.tif $point
        is_less "($out - $wanted) ^ 2" 1e-4 "level $level at $point: $out and $wanted"
        does '' $terraclip height plane.tclip --level $level $point
        is_less "($out - $wanted) ^ 2" 1e-4 "height --level $level at $point: $out and $wanted"
    done
done

# ---- Heights

for point in '500000 5200000' '500015 5199985' '504000.5 5197123.25' '508970 5194030'; do
    does '' $terraclip height hills.tif $point
    wanted=$out
    does '' $terraclip height hills.tclip $point
    [ -n "$out" ] && [ "$out" = "$wanted" ] || fail "height at $point: $wanted and $out"
done
refuses 1 'expected a point of hills.tclip, found one outside' $terraclip height hills.tclip 499900 5199000
# Where info says that a map of areas ends, height answers; a millimetre beyond it does not.
set -- $($terraclip info area.tclip | sed -n 's/^  place *x \([0-9.]*\) to \([0-9.]*\), y \([0-9.]*\) to \([0-9.]*\), area.*/\1 \2 \3 \4/p')
for file in area.tif area.tclip; do
    for place in "$1 $3" "$2 $4"; do
        does '' $terraclip height $file $place
    done
    refuses 1 'found one outside' $terraclip height $file $(awk "BEGIN { printf \"%.4f\", $1 - .001 }") $3
    refuses 1 'found one outside' $terraclip height $file $1 $(awk "BEGIN { printf \"%.4f\", $4 + .001 }")
done
printf '504000.5 5197123.25\n\n500015,5199985\n' >points.txt
run sh -c "$terraclip height hills.tclip <points.txt"
[ $rc = 0 ] && [ "$(wc -l <stdout.txt)" = 2 ] || report 'points of the standard input' height
echo '0 0' >>points.txt
run sh -c "$terraclip height hills.tclip <points.txt"
[ $rc = 1 ] && [ "$(tail -n 1 stdout.txt)" = nan ] && grep -q 'found 1 outside' stderr.txt || report 'a point outside' height
echo 'here' >>points.txt
run sh -c "$terraclip height hills.tclip <points.txt"
[ $rc = 1 ] && grep -q "line 5: expected two numbers, found 'here'" stderr.txt || report 'no point' height
does '' $terraclip height placed.tclip 8.5 46.5
wanted=$out
does '' $terraclip height placed.tclip 368.5 46.5
[ "$out" = "$wanted" ] || fail "a whole turn further: $out instead of $wanted"
does '' $terraclip height placed.tif 8.5 46.5
[ "$out" = "$wanted" ] || fail "height in degrees: $out and $wanted"
# (0, 0) of voids.tif is valid, its neighbours are not.
does '' $terraclip height voids.tclip --voids hole 500010 5199990
[ "$out" = nan ] || fail "height of a hole: $out"
does '' $terraclip height voids.tclip --voids hole 500000 5200000
[ "$out" != nan ] || fail 'height of a sample beside a hole: nan'
does '' $terraclip height voids.tclip --voids constant=7 500030 5200000
[ "$out" = 7 ] || fail "height of a void of 7 m: $out"
does '' $terraclip height voids.tclip 500030 5200000
[ "$out" != nan ] || fail 'height of a filled void: nan'

# ---- Several inputs

$make_file tiff whole.tif size=200x100 metres=30
if command -v gdal_translate >/dev/null 2>&1; then
    gdal_translate -q -srcwin 0 0 100 100 whole.tif west.tif
    gdal_translate -q -srcwin 99 0 101 100 whole.tif east.tif
    does '' $terraclip pack east.tif west.tif -o two.tclip --lossless
    does '' $terraclip extract two.tclip -o two.tif
    equal whole.tif two.tif
    # Whose they are, each once, is told by whatever reads the packed file.
    gdal_translate -q -mo 'TIFFTAG_COPYRIGHT=(c) A. Person' west.tif of_a.tif
    gdal_translate -q -mo 'COPYRIGHT=B. Person' east.tif of_b.tif
    does '' $terraclip pack of_a.tif of_b.tif of_a.tif -o credited.tclip --lossless
    does '' $terraclip info credited.tclip
    [ "$(echo "$out" | sed -n 's/^  credit *//p' | tr '\n' '+')" = '(c) A. Person+B. Person+' ] || fail "credits: $out"
    does '' $terraclip info credited.tclip --json
    echo "$out" | grep -Fqx '  "credits": ["(c) A. Person", "B. Person"]' || fail "credits as JSON: $out"
    does '' $viewer credited.tclip --explain -o seen.png --size 96x64
    [ "$(echo "$out" | sed -n 's/^credit: terrain: //p' | tr '\n' '+')" = '(c) A. Person+B. Person+' ] ||
        fail "credits of what is shown: $out"
    does '' $terraclip extract credited.tclip -o credited.tif
    equal whole.tif credited.tif
    does '' $viewer credited.tif --explain -o seen.png --size 96x64
    echo "$out" | grep -Fqx 'credit: terrain: (c) A. Person B. Person' || fail "credits of what is extracted: $out"
    does '' $terraclip info two.tclip
    ! echo "$out" | grep -q '^  credit' || fail "credits of nobody: $out"
else
    skip 'gdal_translate is not installed: two halves'
fi
# Planes go on beyond their file.
$make_file tiff plane.tif size=60x40 heights=plane
$make_file tiff p1.tif size=31x21 heights=plane
$make_file tiff p2.tif size=30x21 heights=plane from=30,0
$make_file tiff p3.tif size=31x20 heights=plane from=0,20
$make_file tiff p4.tif size=30x20 heights=plane from=30,20
does '' $terraclip pack p3.tif p2.tif p1.tif p4.tif -o four.tclip --lossless --json
grep -q '"input": \["p3.tif", "p2.tif", "p1.tif", "p4.tif"\],' stdout.txt || fail "pack --json: $(head -n 2 stdout.txt)"
does '' $terraclip extract four.tclip -o four.tif
equal plane.tif four.tif stored
# Gaps are voids.
$make_file tiff p5.tif size=20x20 heights=plane from=100,100
does 'warning: the inputs cover .* % of the rectangle around them' $terraclip pack p1.tif p5.tif -o gaps.tclip --lossless --json
[ "$(number voids <stdout.txt)" = $((120 * 120 - 31 * 21 - 20 * 20)) ] || fail "voids of gaps: $(number voids <stdout.txt)"
does '' $terraclip extract gaps.tclip -o gaps.tif --rect 0,0,31,21
equal p1.tif gaps.tif
# Where inputs disagree the first one holds.
$make_file tiff lifted.tif size=30x21 heights=plane from=30,0 lift=3
does 'warning: 21 of 21 shared edge samples differ by up to 3 m; the first input.s hold' \
    $terraclip pack p1.tif lifted.tif -o edge.tclip --lossless
does '' $terraclip extract edge.tclip -o edge.tif --rect 0,0,31,21
equal p1.tif edge.tif stored
$make_file hgt N46E009.hgt
cp N46E008.hgt other.hgt
does 'shared edge samples differ by up to' $terraclip pack N46E009.hgt N46E008.hgt -o tiles.tclip
does '' $terraclip info tiles.tclip --json
grep -q '"width": 2401' stdout.txt && grep -q '"height": 1201' stdout.txt || fail 'two tiles are not 2401 x 1201'
refuses 1 'other.hgt: georeference: expected one' $pack N46E009.hgt other.hgt
refuses 1 'placed.tif: coordinate system: expected that of hills.tif' $pack hills.tif placed.tif
refuses 1 'area.tif: position: expected whole samples' $pack hills.tif area.tif
$make_file tiff zone.tif size=20x20 epsg=32633 && refuses 1 'zone.tif: coordinate system' $pack hills.tif zone.tif
$make_file tiff fine.tif size=20x20 metres=15 && refuses 1 'fine.tif: pixel size: expected 30 x 30' $pack hills.tif fine.tif
$make_file tiff cut.tif size=300x300 from=300,0
size=$(wc -c <cut.tif)
head -c $((size - 1000)) cut.tif >short.tif
refuses 1 'short.tif: damaged or truncated' $pack hills.tif short.tif

# ---- Nothing is left of what fails, and an old file stays

printf 'old' >out/a.tclip
run $pack short.tif
[ $rc = 1 ] && [ "$(cat out/a.tclip)" = old ] && [ "$(ls -A out)" = a.tclip ] || report 'the old file' $pack
$make_file tiff large.tif size=3000x3000
for signal in INT TERM; do
    cases=$((cases + 1))
    $pack large.tif --threads 1 >stdout.txt 2>stderr.txt &
    process=$!
    sleep 0.3
    if kill -$signal $process 2>/dev/null; then
        wait $process
        rc=$?
        if [ $rc = 0 ]; then
            skip "SIG$signal: packing was done before"
            printf 'old' >out/a.tclip
        else
            [ $rc = 1 ] && [ "$(cat stderr.txt)" = 'terraclip: interrupted' ] && [ "$(cat out/a.tclip)" = old ] &&
                [ "$(ls -A out)" = a.tclip ] || report "SIG$signal: exit code $rc" $pack
        fi
    else
        wait $process
        skip "SIG$signal: packing was done before"
        printf 'old' >out/a.tclip
    fi
done
rm -rf out large.tif && mkdir out

# ---- Cut short and damaged

size=$(wc -c <hills.tclip)
head -c $((size * 3 / 4)) hills.tclip >cut.tclip
does 'warning: cut.tclip: .*missing' $terraclip info cut.tclip --json
[ "$(number levels_missing <stdout.txt)" -gt 0 ] || fail 'info --json of a file cut short: levels_missing'
accepts 'warning: cut.tclip: .*missing' $viewer cut.tclip $picture
head -c 20 hills.tclip >stub.tclip
refuses 1 'stub.tclip' $terraclip info stub.tclip
cp hills.tclip dented.tclip
printf '\377\0\377\0\377\0\377\0' | dd of=dented.tclip bs=1 seek=$((size * 7 / 8)) conv=notrunc 2>/dev/null
run $terraclip extract dented.tclip -o out/dented.tif
[ $rc = 1 ] && grep -q 'dented.tclip: damaged: ' stderr.txt && [ -s out/dented.tif ] || report 'a damaged tile' extract
rm -rf out && mkdir out
accepts 'warning: dented.tclip: damaged' $viewer dented.tclip -o out/picture.png --size 1280x720

# ---- The viewer

for file in hills placed; do
    shows direct.ppm $file.tif
    shows packed.ppm $file.tclip
    alike direct.ppm packed.ppm "$file.tif and $file.tclip"
done
# Voids are filled by another method, so only policies are compared.
shows filled.ppm voids.tclip
shows holes.ppm voids.tclip --voids hole
shows constant.ppm voids.tclip --voids constant=0
different filled.ppm holes.ppm '--voids hole'
different filled.ppm constant.ppm '--voids constant'
does '' $terraclip pack voids.tif -o holes.tclip --lossless --voids hole
shows again.ppm holes.tclip
same holes.ppm again.ppm 'holes by the option and by the file'
shows again.ppm holes.tclip --voids constant=0
same constant.ppm again.ppm 'constant voids whatever the file says'
accepts '' $viewer hills.tclip --explain $picture
grep -q '^left out: GDAL: not loaded' stdout.txt || fail 'the viewer loads GDAL for a packed terrain'
# What the dynamic linker says that it loaded.
for command in "$terraclip info hills.tclip" "$terraclip height hills.tclip 100 100" \
    "$viewer hills.tclip --frames 2 --size 64x48 --backend osmesa"; do
    cases=$((cases + 1))
    LD_DEBUG=files LD_DEBUG_OUTPUT=loaded.txt $command >stdout.txt 2>stderr.txt
    [ -n "$(cat loaded.txt.*)" ] && ! grep -Eq 'libgdal|libOpenImageIO' loaded.txt.* || report 'loads GDAL or OpenImageIO' $command
    rm -f loaded.txt.*
done
accepts '' $viewer hills.tclip --json $picture
[ "$(number bytes_decoded <stdout.txt)" -gt 0 ] || fail "--json: $(grep bytes_decoded stdout.txt)"
for option in '--spacing 30' '--unit 2' '--nodata 0'; do
    refuses 2 "${option% *}: expected none for hills.tclip, a packed terrain" $viewer hills.tclip $option $picture
done
refuses 2 '--unit: expected none' $terraclip height hills.tclip --unit 2 1 2
refuses 1 'found a packed terrain' $pack hills.tclip

# ---- Real data

data=${TERRACLIP_DATA:-}
if [ -n "$data" ] && [ -d "$data" ]; then
    limit=120
    for file in N46E008.tif ps_height_1k.png earth_etopo20_1080x540_f32.tif; do
        [ -f "$data/$file" ] || { skip "$file is not there"; continue; }
        run $terraclip pack "$data/$file" -o real.tclip --lossless
        [ $rc = 0 ] || report 'pack' $file
        run $terraclip extract real.tclip -o real.tif
        [ $rc = 0 ] || report 'extract' $file
        case $file in
        *.png) equal "$data/$file" real.tif nowhere ;;
        *) equal "$data/$file" real.tif stored ;;
        esac
    done
    if [ -f "$data/N37W119.hgt" ] && [ -f "$data/N37W120.hgt" ]; then
        run $terraclip pack "$data/N37W119.hgt" "$data/N37W120.hgt" -o sierra.tclip --lossless
        [ $rc = 0 ] || report 'pack' 'two tiles'
        does '' $terraclip extract sierra.tclip -o east.tif --rect 1200,0,1201,1201
        equal "$data/N37W119.hgt" east.tif stored
    else
        skip 'N37W119.hgt and N37W120.hgt are not there'
    fi
else
    skip 'TERRACLIP_DATA is not set: real data'
fi

finish

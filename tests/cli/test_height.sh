#!/bin/sh
# `terraclip height` reads lists of points as they come: every line that should hold a point gets its answer.
. "${0%/*}/lib.sh"

$make_file tiff plane.tif size=129x65 heights=plane metres=10 # 1000 at 500000 5200000, 1 a metre east, 0.1 south
answers() { # EXIT ANSWERS REGEX, of the list in points.txt; one line of stderr matches each line of REGEX, '' none
    cases=$((cases + 1))
    $terraclip height plane.tif <points.txt >stdout.txt 2>stderr.txt
    rc=$?
    told=$(tr '\n' ' ' <stdout.txt)
    wrong=
    : >missing.txt
    [ $rc = "$1" ] || wrong="exit code $rc instead of $1"
    [ "$told" = "$2" ] || wrong="$wrong, '$told' instead of '$2'"
    [ "$(wc -l <stderr.txt)" = "$(printf '%s' "$3" | grep -c '')" ] || wrong="$wrong, more or less on stderr"
    [ -z "$3" ] || echo "$3" | while read -r regex; do
        grep -Eq -- "$regex" stderr.txt || echo "$regex"
    done >missing.txt
    [ ! -s missing.txt ] || wrong="$wrong, not on stderr: $(cat missing.txt)"
    [ -z "$wrong" ] || report "$wrong" "height, of" "$(cat points.txt)"
}

# ---- What is skipped, and what is left alone

printf '# two points\n500010 5200000\n\n   \n  # in between\n500020 5199990\n' >points.txt
answers 0 '1010 1021 ' ''
for names in 'x,y' 'x y name' 'Easting;Northing;Height' '"x","y"' 'lon (degrees)	lat (degrees)' 'Länge,Breite'; do
    printf '# of a survey\n\n%s\n500010,5200000\n' "$names" >points.txt
    answers 0 '1010 ' ''
done
printf '\357\273\277x,y\r\n500010,5200000\r\n' >points.txt && answers 0 '1010 ' ''
printf '\357\273\277500010,5200000\r\n' >points.txt && answers 0 '1010 ' ''
for line in '500010 5200000' '500010,5200000' '500010;5200000' '500010	5200000' ' 500010 ,	5200000 ' \
    '500010 5200000 1200 a peak' '500010,5200000,1200,a peak' '500010;5200000;1200' '500010	5200000	1200' \
    '500010.0,5200000.0 peak' '500010,5200000,' '500010 5200000 # here' '500010,5200000 peak' '500010 5200000,peak' \
    '500010.0,5200000.0 1200' '500010, 5200000 1200'; do
    echo "$line" >points.txt
    answers 0 '1010 ' ''
done
printf '500010 5200000' >points.txt && answers 0 '1010 ' '' # without an end of line
: >points.txt && answers 0 '' ''

# ---- What is no point

printf '500010 5200000\nhere\n500020 5200000\n500030\n500030 5200000\n' >points.txt
answers 1 '1010 nan 1020 nan 1030 ' "terraclip: standard input: line 2: expected two numbers, found 'here'
terraclip: standard input: line 4: expected two numbers, found '500030'
terraclip: standard input: expected points of plane.tif, found 2 of 5 lines bad and 0 outside"
printf 'x,y\nx,y\n0 0\n500010 5200000\n' >points.txt # names come once
answers 1 'nan nan 1010 ' "line 2: expected two numbers, found 'x,y'
found 1 of 4 lines bad and 1 outside"
# What could be read in two ways, and numbers that are none, also on a first line.
for line in '500010,5 5200000,5' '500010,5;5200000,5' '500010,5 5200000' '500010 5200000,5' '500010;5200000,5' \
    '500010,,5200000' '500010 5200000x' '500010E 5200000N' 'nan nan' 'inf,inf' 'N46 E008' '500010 5200000°' \
    '0x10 0x10' '1e999 1' '500010/5200000' 'here'; do
    echo "$line" >points.txt
    answers 1 'nan ' "line 1: expected two numbers, found
found 1 of 1 lines bad"
done
echo '0 0' >points.txt && answers 1 'nan ' 'found 1 outside$'

# ---- Rays: z = 1064 + x - 0.1 (640 - y) on the plane, whose sides are there, too

meets() { # ANSWER RAY [FILE]
    run $terraclip height "${3:-plane.tif}" --ray "$2"
    [ $rc = 0 ] || fail "height --ray $2: exit code $rc"
    [ "$(cat stdout.txt)" = "$1" ] || fail "height --ray $2: '$(cat stdout.txt)' instead of '$1'"
}
meets '0 0 1064 936' 0,0,2000,0,-90
meets '0 0 1064 936' 0,0,2000,270,-90 # whatever rounding leaves of the way to the west
meets '0 320 100 10000000' -1e7,320,100,90,0
meets '468 0 1532 661.851947' 0,0,2000,90,-45
meets '0 320 1000 1000' -1000,320,1000,90,0
refuses 1 '^terraclip: --ray: expected a ray that meets the ground of plane.tif' $terraclip height plane.tif --ray 640,320,5000,0,0
refuses 1 '^terraclip: --ray: expected an eye above the ground of plane.tif, found one 1672.* m below it' \
    $terraclip height plane.tif --ray 640,320,0,0,0
refuses 2 '^terraclip: --ray: expected X,Y,Z,HEADING,PITCH' $terraclip height plane.tif --ray 0,0,2000,90
refuses 2 '^terraclip: --ray: expected X,Y,Z,HEADING,PITCH' $terraclip height plane.tif --ray 0,0,nan,90,0
refuses 2 '^terraclip: --ray: expected no point with it' $terraclip height plane.tif --ray 0,0,2000,0,-90 5 5
refuses 2 '^terraclip: --ray: expected no --level with it' $terraclip height plane.tif --ray 0,0,2000,0,-90 --level 1
$make_file tiff one.tif size=1x1 heights=plane metres=10
run $terraclip height one.tif 500000 5200000 && flat=$(cat stdout.txt)
meets "0 0 $flat $((5000 - flat))" 0,0,5000,0,-90 one.tif
# A wall of one sample, which a walk by the height above ground would step over.
awk 'BEGIN { print "ncols 2049\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10"
    for (j = 0; j < 5; j++) { for (i = 0; i < 2049; i++) printf "%d ", i == 1500 ? 100 : 0; print "" } }' >wall.asc
meets '14995 20 50 14995' 0,20,50,90,0 wall.asc
meets '14999 20 90 9999' 5000,20,90,90,0 wall.asc
refuses 1 '^terraclip: --ray: expected a ray that meets' $terraclip height wall.asc --ray 0,20,101,90,0
# Up to the last centimetre of the edge, and from as far away as steps are lost in the way's last digits.
for beside in 3 2 0.7 0.1 0.01; do
    meets "$(awk "BEGIN { printf \"%.10g 320 %.10g\", 640 - $beside, 1672 - $beside }") $(awk "BEGIN { printf \"%.10g\", int((40 - $beside) * sqrt(2) * 1e6 + 0.5) / 1e6 }")" \
        "600,320,$(awk "BEGIN { printf \"%.10g\", 1712 - 2 * $beside }"),90,-45"
done
run $terraclip height plane.tif --spacing 0.0002 --ray 0.005,0.005,1e12,90,-90
[ $rc = 0 ] || fail "a ray from 10^12 m: exit code $rc"
# Holes let it through, and it meets nothing from below.
awk 'BEGIN { print "ncols 40\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999"
    for (j = 0; j < 40; j++) { for (i = 0; i < 40; i++) printf "%d ", (i > 9 && i < 20 && j > 9 && j < 30) ? -9999 : 7; print "" } }' >hole.asc
meets '145 200 7 93' 145,200,100,0,-90 hole.asc
hole='hole.asc --voids hole'
refuses 1 '^terraclip: --ray: expected a ray that meets' $terraclip height $hole --ray 145,200,100,0,-90
refuses 1 '^terraclip: --ray: expected a ray that meets' $terraclip height $hole --ray 50,200,100,90,-45
run $terraclip height $hole --ray 100,200,187,90,-45
[ "$(cat stdout.txt)" = '280 200 7 254.558441' ] || fail "a ray over a hole: $(cat stdout.txt)"

finish

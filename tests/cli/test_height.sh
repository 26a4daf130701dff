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

finish

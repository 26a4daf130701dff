#!/bin/sh
# --synthesis of all programs that have it: the same heights packed or not, on a plane, in a list, in an extract and in
# the extract's own file; pictures that have more to show; and what is refused.
. "${0%/*}/lib.sh"

$terraclip synth --size 257 --spacing 30 --seed 3 -o land.tif -q || fail 'no terrain'
$terraclip synth --kind planet --size 256 --seed 3 -o globe.tif -q || fail 'no planet'
$terraclip pack land.tif -o land.tclip --max-error 0.01 -q || fail 'not packed'
$terraclip pack --planet globe.tif -o globe.tclip -q || fail 'no packed planet'
awk 'BEGIN { for (i = 0; i < 40; i++) print 100 + i * 173.5, 7400 - i * 151.25 }' >points.txt

for wrong in 0 21 -1 1.5 x ''; do
    refuses 2 '--synthesis: expected auto or 1..20' $viewer land.tif $picture --synthesis="$wrong"
    refuses 2 '--synthesis: expected auto or 1..20' $globe globe.tif $picture --synthesis="$wrong"
    refuses 2 '--synthesis: expected auto or 1..20' $terraclip height land.tif 10 10 --synthesis="$wrong"
    refuses 2 '--synthesis: expected auto or 1..20' $terraclip extract land.tclip -o out/x.tif --synthesis="$wrong"
done

heights() { # FILE [OPTION]...: of the points
    cases=$((cases + 1))
    $terraclip height "$@" <points.txt
}
heights land.tclip --synthesis 3 >packed.txt || fail 'no heights of the packed terrain'
heights land.tclip --synthesis 3 >again.txt && cmp -s packed.txt again.txt || fail 'two runs differ'
heights land.tclip >smooth.txt
awk 'NR == FNR { z[NR] = $1; next } { s += ($1 - z[FNR]) ^ 2 } END { r = sqrt(s / FNR); exit !(r > 0.05 && r < 20) }' \
    smooth.txt packed.txt || fail 'synthesis adds nothing, or too much'

# All of an extract is what `height` tells, and its samples are half as far apart for each level.
does '' $terraclip extract land.tclip --synthesis 2 -o fine.tif
does '' $terraclip pack fine.tif -o fine.tclip --json
echo "$out" | grep -q '"width": 1025,' || fail "an extract of another size: $out"
heights land.tclip --synthesis 2 >two.txt
heights fine.tif >extracted.txt
awk 'NR == FNR { z[NR] = $1; next } { d = $1 - z[FNR]; if (d < 0) d = -d; if (d > 0.002) bad++ } END { exit bad > 0 }' \
    two.txt extracted.txt || fail "an extract's heights are others"

# Levels of the data stay.
heights land.tclip --synthesis 2 --level 10 >data.txt
cmp -s data.txt smooth.txt || fail 'a level of the data is another with synthesis'

# A file's own fit: that of the source, whose heights a lossless one then has; of a lossy one not that of what is left.
$make_file tiff whole.tif size=300x257 metres=0
does '' $terraclip pack whole.tif -o whole.tclip --spacing 30 --lossless --synthesis-fit -q
heights whole.tif --spacing 30 --synthesis 2 >two.txt || fail 'no heights of the source'
heights whole.tclip --synthesis 2 | cmp -s - two.txt || fail 'a stored fit makes other heights than the source'
does '' $terraclip pack --planet globe.tif -o globe-fit.tclip --synthesis-fit -q
does '' $terraclip height globe-fit.tclip 10 89.99 --synthesis 3
does '' $terraclip pack land.tif -o lossy-fit.tclip --synthesis-fit -q
does '' $terraclip pack land.tif -o lossy.tclip -q
heights lossy-fit.tclip --synthesis 2 >lossy-fit.txt
heights lossy.tclip --synthesis 2 >lossy.txt
cmp -s lossy.txt lossy-fit.txt && fail 'a stored fit is not gone by'

# So they do next to a pole, which is the caps' in a packed planet, and a row's mean in a map.
for level in 7 8 9; do
    cases=$((cases + 1))
    $terraclip height globe.tclip 10 89.99 --level $level >pole.txt
    $terraclip height globe.tclip 10 89.99 --level $level --synthesis 3 | cmp -s - pole.txt || fail "level $level at the pole"
done
does '' $terraclip height globe.tif 10 89.999 --synthesis auto -q

# More to see near the ground, on both bodies; a flight frame by frame is the picture of its view.
near=3800,3800,$($terraclip height land.tclip 3800 3800 | awk '{ print $1 + 30 }'),40,-10
for k in '' '--synthesis auto'; do
    does '' $viewer land.tclip --size 240x160 --view="$near" -o "land$k.png" $k
    does '' $globe globe.tclip --size 240x160 --view=10,20,9000,40,-10 -o "globe$k.png" $k
done
for file in land globe; do
    cases=$((cases + 1))
    cmp -s "$file.png" "$file--synthesis auto.png" && fail "$file: synthesis is not seen"
done
echo "$near" >views.txt
does '' $viewer land.tclip --synthesis auto --size 240x160 --path views.txt --frames 2 -o 'frame-%05d.png'
cases=$((cases + 1))
cmp -s frame-00001.png 'land--synthesis auto.png' || fail 'a frame of a flight is not the picture of its view'
accepts '' $viewer land.tclip $picture --synthesis 3 --explain
grep -q '^uses: synthesis: 3 levels finer than the data$' stdout.txt || fail '--explain does not tell of synthesis'
! grep -q '^left out: synthesis' stdout.txt || fail '--explain: synthesis is used and left out'
accepts '' $viewer land.tclip $picture --synthesis 3 --json
grep -q '"synthesised_levels": 3,' stdout.txt || fail '--json does not tell of synthesis'

# Two samples a side, voids nearly everywhere, and towers.
for what in 'size=2x2' 'size=40x30 heights=voids nodata=-32768' 'size=90x80 heights=towers'; do
    rm -f odd.tif
    $make_file tiff odd.tif $what metres=30 || fail "no file of $what"
    accepts '' $viewer -q odd.tif $picture --synthesis auto
done
finish

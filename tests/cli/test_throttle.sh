#!/bin/sh
# --target-ms: flights whose frames take twice as long as they may are drawn coarser until they do not, on a plane and on
# a planet; and what never takes so long is drawn as ever.
. "${0%/*}/lib.sh"
limit=240

$terraclip synth --size 1025 -o land.tif -q || fail 'synth'
$terraclip synth --kind planet --size 512 -o globe.tif -q || fail 'synth --kind planet'
printf '9000,9000,3200,45,-14\n9800,9800,3200,55,-14\n' >land.txt
printf '20,10,9000,45,-14\n20.2,10.2,9000,50,-14\n' >globe.txt

figure() { # KEY: a number of stdout.txt, the first one behind it
    sed -n "s/^  \"$1\": *{*\"*[a-z]*\"*:* *\([0-9.]*\).*/\1/p" stdout.txt
}
holds() { # NUMBERS CONDITION: of $1, $2, ...
    echo "$1" | awk "{ exit !($2) }"
}
fly() { # PROGRAM NAME FRAMES OPTION...
    program=$1 name=$2 frames=$3
    shift 3
    run $program $name.tif --path $name.txt --frames $frames --size 240x160 --json "$@"
    [ $rc = 0 ] && [ ! -s stderr.txt ] || report 'a flight' "$@"
}

# On a machine that others use, too, times vary: one of three tries must do.
throttled() { # PROGRAM NAME OPTION...
    program=$1 name=$2
    shift 2
    for try in 1 2 3; do
        fly $program $name 40 "$@"
        whole=$(figure triangles) target=$(figure frame_ms | awk '{ print $1 / 2 }')
        [ "$(figure throttle)" = 0.000 ] || fail "$name: throttled without --target-ms"
        fly $program $name 300 "$@" --target-ms "$target"
        told="$(figure frame_ms) $target $(figure throttle) $(figure triangles) $whole"
        echo "$name: median ms, target, throttle, triangles, unthrottled: $told"
        holds "$told" '$1 > 0.5 * $2 && $1 < 1.25 * $2 && $3 > 0.1 && $4 < 0.8 * $5' && return
    done
    fail "$name: --target-ms is not held: $told"
}
throttled $viewer land --n 255
throttled $globe globe --n 512

# Frames that may take ten minutes are those without the option.
for which in "$viewer land" "$globe globe"; do
    set -- $which
    for option in '' '--target-ms 6e5'; do
        run $1 $2.tif --path $2.txt --frames 3 --size 96x64 -o out/frame-%d.png $option
        [ $rc = 0 ] || report 'frames' $option
        mv out "frames${option%% *}" && mkdir out
    done
    for k in 0 1 2; do
        same frames/frame-$k.png frames--target-ms/frame-$k.png "$2, frame $k, with --target-ms"
    done
    rm -rf frames frames--target-ms
done

# What cannot be met is drawn as coarse as can be, and that is told. Written frames are throttled, too.
run $viewer land.tif --path land.txt --frames 200 --size 64x48 --n 127 --target-ms 0.001 --explain
grep -Eq '^uses: throttling: for frames of 0.001 ms the last one was drawn 2.90 of at most 2.90 octaves coarser$' stdout.txt ||
    fail "--explain: $(grep throttling stdout.txt)"
! grep -q '^left out: throttling' stdout.txt || fail '--explain: throttling is left out though it is asked for'
run $globe globe.tif --path globe.txt --frames 150 --size 64x48 --n 128 --target-ms 0.001 -o out/frame-%03d.png --json
[ $rc = 0 ] && [ "$(figure throttle)" != 0.000 ] && [ -f out/frame-149.png ] || report 'a throttled flight that is written'
different out/frame-000.png out/frame-149.png 'the first and the last frame'
rm -rf out && mkdir out
# Nothing to be throttled: one level, the smallest windows, no morph.
for options in '--levels 1' '--n 15' '--no-morph'; do
    run $viewer land.tif --path land.txt --frames 40 --size 64x48 --target-ms 0.001 $options
    [ $rc = 0 ] && [ ! -s stderr.txt ] || report 'a throttled flight' $options
done
finish

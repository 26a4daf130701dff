# packs.sh - what packing writes and what reading gives back; read by identity.sh.
#
# Each build packs and reads its own file, so that a new version of the format can be compared with an old one: framing
# differs then, but neither tiles nor heights. The cases of a packed terrain X:
#
#     pack/X/file     the whole file
#     pack/X/bytes    what is told of the version and of sizes, which framing is a part of
#     pack/X/tiles    base level, models, every tile of every level of every chart
#     pack/X/told     pack --json and info, without versions and sizes
#     pack/X/heights  extract and height, of several levels, at several places
#     pack/X/old      the same heights of BEFORE's file, read by AFTER

# NAME INPUT... OPTION...: what views and flights use as well, then all modes of all real terrains,
# large ones in parts. Those named whole- only with FULL=1.
packs_table() {
    cat <<'end'
land        land.tif --rms 1
land-default    land.tif
rocks-lossless  rocks.asc --lossless
rocks-bound rocks.asc --max-error 2
rocks-loose rocks.asc --max-error 40
rocks-lh04  rocks.asc --codec lh04 --rms 2
small       small.tif --max-error 0.25
holes       holes.asc --voids hole --rms 6
holes-default   holes.asc --voids hole
holes-constant  holes.asc --voids constant=500 --max-error 3
two         two.asc --lossless
strip       strip.asc --max-error 1
cliff       cliff.asc --voids hole --rms 2
planet      planet.tif --planet --rms 10
planet-default  globe.tif --planet
planet-bound    globe.tif --planet --max-error 30
planet-flat planet.tif --rms 10
globe       globe.tif --planet --radius 1737400 --rms 5
pits        pits.asc --planet --voids hole --rms 10
pits-lossless   pits.asc --planet --lossless
n37w119     N37W119.hgt --rms 5
n37w119-lossless    N37W119.hgt --lossless
n37w119-bound   N37W119.hgt --max-error 5
n37w120     N37W120.hgt --rms 5
n37w120-default N37W120.hgt
n37w120-lossless    N37W120.hgt --lossless
n37w120-bound   N37W120.hgt --max-error 1
n37w120-lh04    N37W120.hgt --codec lh04
sierra      N37W119.hgt N37W120.hgt --rms 8
n46e008     N46E008.tif --voids hole --rms 5
n46e008-lossless    N46E008.tif --lossless
n46e008-bound   N46E008.tif --max-error 10
ps          ps_height_1k.png --spacing 160 --unit 0.1 --rms 9.6
ps-lossless ps_height_1k.png --spacing 160 --unit 0.1 --lossless
ps-bound    ps_height_1k.png --spacing 160 --unit 0.1 --max-error 0.2
etopo       earth_etopo20_1080x540_f32.tif --planet --radius 6378137 --rms 10
etopo-lossless  earth_etopo20_1080x540_f32.tif --planet --radius 6378137 --lossless
etopo-bound earth_etopo20_1080x540_f32.tif --planet --radius 6378137 --max-error 40
etopo-lh04  earth_etopo20_1080x540_f32.tif --planet --radius 6378137 --codec lh04 --rms 20
canyonlands srtm3_canyonlands_voids_2401x3601.tif --voids hole --rms 5
canyonlands-lossless    canyonlands-part.vrt --lossless
canyonlands-bound   canyonlands-part.vrt --max-error 8
tatra       srtm3_tatra_poland_4801.tif --rms 5
tatra-default   tatra-part.vrt
tatra-lossless  tatra-part.vrt --lossless
tatra-bound tatra-part.vrt --max-error 6
moon-nw     moon_gld100_256ppd_ne_4097.png --spacing 118 --rms 2
moon-nw-lossless    moon-nw-part.vrt --lossless
moon-nw-bound   moon-nw-part.vrt --max-error 4
moon-ne     moon_gld100_256ppd_ne_8193.tif --rms 7
moon-ne-lossless    moon-ne-part.vrt --lossless
moon-ne-bound   moon-ne-part.vrt --max-error 3
moon        moon_gld100_global_5760x2880.tif --planet --rms 10
moon-lossless   moon-part.vrt --planet --lossless --radius 1737400
moon-bound  moon-part.vrt --planet --max-error 50 --radius 1737400
whole-canyonlands-lossless  srtm3_canyonlands_voids_2401x3601.tif --lossless
whole-canyonlands-bound srtm3_canyonlands_voids_2401x3601.tif --max-error 8
whole-tatra-lossless    srtm3_tatra_poland_4801.tif --lossless
whole-tatra-bound   srtm3_tatra_poland_4801.tif --max-error 6
whole-moon-nw-lossless  moon_gld100_256ppd_ne_4097.png --spacing 118 --lossless
whole-moon-nw-bound moon_gld100_256ppd_ne_4097.png --spacing 118 --max-error 4
whole-moon-ne-lossless  moon_gld100_256ppd_ne_8193.tif --lossless
whole-moon-ne-bound moon_gld100_256ppd_ne_8193.tif --max-error 3
whole-moon-lossless moon_gld100_global_5760x2880.tif --planet --lossless
whole-moon-bound    moon_gld100_global_5760x2880.tif --planet --max-error 50
end
}

# Packs what is not packed yet in this run. Fails where an input is not at hand.
packed() { # NAME
    [ -f "$work/after/out/pack/$1.rc" ] && return 0
    arguments=
    for word in $(packs_table | awk -v name="$1" '$1 == name { $1 = ""; print }'); do
        case $word in
        *.tif | *.hgt | *.png | *.asc | *.vrt)
            have "$word" || return 1
            word=in/$word ;;
        esac
        arguments="$arguments $word"
    done
    both "pack/$1" terraclip pack -o "pack/$1.tclip" --json $arguments
}

sizes='"(version|bytes|bits_per_sample)":'

# Lines of JSON about sizes; those about other things, with sizes taken out of the lines of levels.
only_sizes() { # FILE
    grep -E "$sizes" "$1"
}
without_sizes() { # FILE
    timeless "$1" | sed -E -e '/^  "(version|bytes|bits_per_sample)":/d' -e 's/"bytes": [0-9]+, //'
}

# Points all over a terrain, corners and poles included, as its own coordinates.
points() { # INFO.JSON
    awk -F '[:,[ ]+' '
        /^  "width"/ { w = $3 }
        /^  "height"/ { h = $3 }
        /^  "spacing_x_m"/ { dx = $3 }
        /^  "spacing_y_m"/ { dy = $3 }
        /^  "transform": \[/ { for (k = 0; k < 6; k++) t[k] = $(3 + k); placed = 1 }
        END {
            for (k = 0; k < 60; k++) {
                i = k % 8 == 0 ? 0 : (0.6180339887 * k) % 1 * (w - 1)
                j = k % 8 == 4 ? 0 : (0.7548776662 * k) % 1 * (h - 1)
                if (placed)
                    printf "%.12g %.12g\n", t[0] + (i + 0.5) * t[1], t[3] + (j + 0.5) * t[5]
                else
                    printf "%.12g %.12g\n", i * dx, j * dy
            }
        }' "$1"
}

# What both builds extracted is kept as a checksum: all levels of all terrains would fill the disk.
sum_of() { # FILE
    [ ! -f "$1" ] || { sha256sum <"$1" >"$1.sum" && rm -f "$1"; }
}

# The same heights by extract and height. TO: before's results that those of FILE are held against.
same_heights() { # NAME TO FILE LEVEL WHO [RECT]
    o=out/$1.l$4
    $5 "$1.l$4" terraclip extract -q "$3" --level "$4" ${6:+--rect $6} -o "$o.tif"
    stdin=$work/points.txt
    $5 "$1.p$4" terraclip height -q "$3" --level "$4"
    stdin=/dev/null
    sum_of "$work/before/$o.tif" && sum_of "$work/after/$o.tif"
    cmp -s "$work/before/out/$2.l$4.tif.sum" "$work/after/$o.tif.sum" || {
        different "$1" "level $4, extracted: $(cat "$work/before/out/$2.l$4.stderr" "$work/after/$o.stderr")"
        return 1
    }
    cmp -s "$work/before/out/$2.p$4.stdout" "$work/after/out/$1.p$4.stdout" || {
        different "$1" "level $4, height: $(cat "$work/before/out/$2.p$4.stderr" "$work/after/out/$1.p$4.stderr")"
        return 1
    }
}

after_only() { # NAME PROGRAM ARGUMENT...
    (run_side after "$@")
}

# The finest level whole where it is small, else a part of it that begins at no tile's edge; then two coarser ones.
compare_heights() { # PACK FILE
    info=$work/before/out/$1.info.stdout
    finest=$(grep -c '"level":' "$info")
    width=$(sed -n 's/^  "width": \([0-9]*\).*/\1/p' "$info")
    height=$(sed -n 's/^  "height": \([0-9]*\).*/\1/p' "$info")
    rect=
    [ $((width * height)) -le 3000000 ] || rect=$((width / 3)),$((height / 2)),700,500
    points "$info" >"$work/points.txt"
    good=yes
    for level in $finest $((finest - 2)) $((finest - 5)); do
        if [ $level -ge 1 ]; then
            [ $level = $finest ] || rect=
            same_heights "$1/heights" "$1/heights" "$2" $level both $rect || { good=; break; }
        fi
    done
    told=$(grep -c '^-*[0-9]' "$work/after/out/$1/heights.p$finest.stdout")
    if [ "$told" -lt 30 ]; then
        broken "$1/heights" "height tells of $told points only"
    elif [ $good ]; then
        same "$1/heights" "$finest levels"
    fi
    rect=
    [ $((width * height)) -le 3000000 ] || rect=$((width / 3)),$((height / 2)),700,500
    same_heights "$1/old" "$1/heights" "../before/$2" $finest after_only $rect && same "$1/old" ''
}

compare_pack() { # NAME
    case_name=pack/$1 file=pack/$1.tclip
    selected "$case_name/" || return
    packed "$1" || { skipped "$case_name" 'no such terrain at hand'; return; }
    ended_well "$case_name" || return
    compare_file "$case_name/file" "$file"
    both "$case_name/tiles" ../tile-sums "$file"
    if ended_well "$case_name/tiles"; then
        texts_differ sort "out/$case_name/tiles.stdout"
        verdict "$case_name/tiles" "$(grep -c tile "$work/after/out/$case_name/tiles.stdout") tiles"
    fi
    both "$case_name.info" terraclip info --json "$file"
    both "$case_name.words" terraclip info -v "$file"
    ended_well "$case_name.info" || return
    texts_differ only_sizes "out/$case_name.info.stdout"
    verdict "$case_name/bytes" ''
    texts_differ without_sizes "out/$case_name.stdout"
    [ -n "$difference" ] || texts_differ without_sizes "out/$case_name.info.stdout"
    [ -n "$difference" ] || texts_differ words_without_sizes "out/$case_name.words.stdout"
    verdict "$case_name/told" ''
    compare_heights "$case_name" "$file"
}

# info for people: the first line has version and size, a line of a chart or level its bytes.
words_without_sizes() { # FILE
    sed -E -e 's/format version.*//' -e 's/[0-9.]+ [KMG]?i?B[^ ]*,/ /' \
        -e 's/^( +[0-9]+ +[0-9]+ x [0-9]+ +[0-9.e+]+) +[0-9]+ /\1 /' "$1"
}

compare_packs() {
    for row in $(packs_table | awk '{ print $1 }'); do
        case $row in
        whole-*) [ "${FULL:-0}" = 1 ] && compare_pack "$row" ;;
        *) compare_pack "$row" ;;
        esac
    done
}

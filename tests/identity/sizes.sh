#!/bin/sh
# Sizes of real terrains as two builds pack them, in every mode, and whether the tiles are the same:
#
#   TERRACLIP_DATA=FOLDER sizes.sh BEFORE_BUILD_DIR AFTER_BUILD_DIR
#
# A row of a table each, as docs/figures.md has it; sums last. Ends with 1 where tiles differ.
set -u
here=$(cd "$(dirname "$0")" && pwd) || exit 99
[ $# = 2 ] && [ -d "${TERRACLIP_DATA:-}" ] || { echo "usage: TERRACLIP_DATA=FOLDER sizes.sh BEFORE AFTER" >&2; exit 2; }
work=$(mktemp -d "${TMPDIR:-/tmp}/terraclip-sizes-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
${CC:-cc} -std=c11 -O2 -o "$work/tile-sums" "$here/tiles.c" || exit 99

tiles() { # FILE
    "$work/tile-sums" "$1" | grep ' tile ' | sort
}

echo '| file | mode | before | after | | tiles |'
echo '|---|---|---|---|---|---|'
while read -r file options; do
    [ -f "$TERRACLIP_DATA/$file" ] || continue
    for mode in '--lossless' '--rms 1' '--max-error 2' '--codec lh04 --rms 1'; do
        "$1/terraclip" pack -q "$TERRACLIP_DATA/$file" -o "$work/a.tclip" $options $mode 2>"$work/a.txt" &
        "$2/terraclip" pack -q "$TERRACLIP_DATA/$file" -o "$work/b.tclip" $options $mode 2>"$work/b.txt" || exit 99
        wait $! || exit 99
        tiles "$work/a.tclip" >"$work/a.txt" && tiles "$work/b.tclip" >"$work/b.txt"
        echo "$file $(($(wc -c <"$work/a.tclip"))) $(($(wc -c <"$work/b.tclip")))" \
            "$(diff "$work/a.txt" "$work/b.txt" | grep -c '^>') $(wc -l <"$work/b.txt") $mode"
    done
done <<'end' | awk '{
        mode = $6 == "--codec" ? "LH04, rms 1 m" : $6 == "--rms" ? "rms 1 m" : $6 == "--max-error" ? "2 m" : "lossless"
        printf "| `%s` | %s | %d | %d | %+.3f %% | %s |\n", $1, mode, $2, $3, 100 * ($3 / $2 - 1),
            $4 ? $4 " of " $5 " differ" : $5 " equal"
        a += $2; b += $3; differ += $4; n += $5
    }
    END {
        printf "| all | | %d | %d | %+.3f %% | %d of %d differ |\n", a, b, 100 * (b / a - 1), differ, n
        exit differ > 0
    }'
N37W119.hgt
N37W120.hgt
N46E008.tif
ps_height_1k.png --spacing 160 --unit 0.1
earth_etopo20_1080x540_f32.tif --planet
srtm3_canyonlands_voids_2401x3601.tif
srtm3_tatra_poland_4801.tif
moon_gld100_global_5760x2880.tif --planet
moon_gld100_256ppd_ne_4097.png --spacing 118
moon_gld100_256ppd_ne_8193.tif
end

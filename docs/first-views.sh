#!/bin/sh
# first-views.sh - ten first views by two builds side by side: docs/first-views-flat.png and docs/first-views-globe.png.
#
#   sh docs/first-views.sh BUILD-BEFORE BUILD-AFTER DATA
#
# DATA is a folder of elevation files by the names below. Needs ImageMagick's convert and montage.
set -eu
before=$1 after=$2 data=$3 out=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

flat='N46E008.tif
N37W120.hgt
srtm3_tatra_poland_4801.tif
ps_height_1k.png --spacing 160 --unit 0.1
moon_gld100_256ppd_ne_8193.tif'
globe='N37W119.hgt
srtm3_canyonlands_voids_2401x3601.tif
moon_gld100_256ppd_ne_8193.tif
moon_gld100_global_5760x2880.tif
earth_etopo20_1080x540_f32.tif'

side_by_side() { # PROGRAM VIEWS NAME
    number=0
    echo "$2" | while read -r file options; do
        number=$((number + 1))
        for build in "$before" "$after"; do
            which=$([ "$build" = "$before" ] && echo 1 || echo 2)
            # shellcheck disable=SC2086
            "$build/$1" "$data/$file" $options --size 480x270 -q -o "$folder/whole.png" </dev/null
            convert "$folder/whole.png" -resize 384x216 "$folder/$3-$number-$which.png"
        done
    done
    montage "$folder/$3"-*.png -tile 2x -geometry 384x216+2+2 "$folder/$3.png"
    convert "$folder/$3.png" -strip -define png:compression-level=9 "$out/first-views-$3.png"
}
side_by_side planar-viewer "$flat" flat
side_by_side planet-viewer "$globe" globe

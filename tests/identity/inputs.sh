# inputs.sh - terrains of all kinds in $work/in, the same for both builds; read by identity.sh.
#
# Synthesised ones are BEFORE's. Whether AFTER synthesises the same is a case of its own.

have() { # FILE
    [ -e "$work/in/$1" ]
}

synthesise() { # NAME OPTION...
    name=synth/$1
    shift
    both "$name" terraclip synth -q -o "out/$name.tif" "$@"
    ln -sfn "../before/out/$name.tif" "$work/in/${name#synth/}.tif"
    selected "$name" && ended_well "$name" && compare_file "$name" "out/$name.tif"
}

# An ASCII grid. METRES is awk for the height at column i of row j, rows from the north; void where there is none. All
# are whole metres but for the first, so that they can be packed without loss.
grid() { # NAME WIDTH HEIGHT CELL METRES [WEST SOUTH]
    [ "$1" = holes ] && form='%.2f ' || form='%d '
    printf '%s\n' "ncols $2" "nrows $3" "xllcorner ${6:-0}" "yllcorner ${7:-0}" "cellsize $4" 'nodata_value -9999' \
        >"$work/in/$1.asc"
    awk -v w="$2" -v h="$3" "
        BEGIN { void = -9999
            for (j = 0; j < h; j++) { for (i = 0; i < w; i++) printf \"$form\", $5; print \"\" } }" >>"$work/in/$1.asc"
    rm -f "$work/in/$1.prj"
    [ -z "${6:-}" ] || echo "$wgs84" >"$work/in/$1.prj"
}

wgs84='GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],
UNIT["degree",0.0174532925199433]]'
hills='1200 + 700 * sin(i / 19 + 0.4) * cos(j / 13) + 200 * sin(i / 7 + j / 5) + 60 * cos(j / 3 - i / 2)'
# Holes of many sizes: single samples, a lattice, a lake, a corner.
holes="(i * 7 + j * 13) % 61 == 0 || (i < 60 && j > 130) || (i - 160) ^ 2 + (j - 60) ^ 2 < 900 ||
    (i > 200 && (i + j) % 5 == 0)"
pits='(i * 7 + j * 13) % 31 == 0 || j < 9 || (i > 180 && j > 60 && j < 80)'

# A part of a file, or all of it with fewer samples, as a VRT that names it; packing all of the large ones in all modes
# would take many minutes.
cut_out() { # NAME FILE TYPE "TRANSFORM" "X Y W H" [W H]
    have "$2" || return
    set -- "$1" "$2" "$3" "$4" $5 ${6:-} ${7:-}
    nodata=
    [ "$3" != Int16 ] || nodata='<NoDataValue>-32768</NoDataValue>'
    cat >"$work/in/$1.vrt" <<end
<VRTDataset rasterXSize="${9:-$7}" rasterYSize="${10:-$8}">
<SRS>$wgs84</SRS>
<GeoTransform>$4</GeoTransform>
<VRTRasterBand dataType="$3" band="1">$nodata
<SimpleSource>
<SourceFilename relativeToVRT="1">$2</SourceFilename>
<SourceBand>1</SourceBand>
<SrcRect xOff="$5" yOff="$6" xSize="$7" ySize="$8"/>
<DstRect xOff="0" yOff="0" xSize="${9:-$7}" ySize="${10:-$8}"/>
</SimpleSource>
</VRTRasterBand>
</VRTDataset>
end
}

one_line() {
    printf '%s' "$1" | tr '\n' ' '
}

make_inputs() {
    synthesise land --size 1025 --seed 3
    synthesise small --size 130 --seed 8 --spacing 10
    synthesise planet --kind planet --size 1024 --seed 2
    synthesise globe --kind planet --size 250 --seed 5
    grid holes 300 200 0.001 "($(one_line "$holes")) ? void : ($hills)" 8 46
    grid pits 256 128 1.40625 "($(one_line "$pits")) ? void : 9 * ($hills)" -180 -90
    grid rocks 500 400 30 "$hills + 30 * sin(i * j / 50)"
    grid two 2 2 30 '90 * i + 50 * j'
    grid three 3 2 30 '90 * (i - 1) ^ 2 + 50 * j'
    grid strip 5 70 30 "$hills"
    grid seventeen 17 17 30 "$hills"
    grid cliff 64 48 30 '(i == 9 && j == 9) ? void : (i + j > 60 ? 800 : -800)'
    if [ -z "${TERRACLIP_DATA:-}" ]; then
        skipped data 'TERRACLIP_DATA is not set: no real terrains'
        return
    fi
    for file in N37W119.hgt N37W120.hgt N46E008.tif ps_height_1k.png earth_etopo20_1080x540_f32.tif \
        srtm3_canyonlands_voids_2401x3601.tif srtm3_tatra_poland_4801.tif moon_gld100_256ppd_ne_4097.png \
        moon_gld100_256ppd_ne_8193.tif moon_gld100_global_5760x2880.tif; do
        rm -f "$work/in/$file"
        if [ -f "$TERRACLIP_DATA/$file" ]; then
            ln -s "$(cd "$TERRACLIP_DATA" && pwd)/$file" "$work/in/$file"
        else
            skipped data "TERRACLIP_DATA has no $file"
        fi
    done
    step=0.000833333333333333
    cut_out canyonlands-part srtm3_canyonlands_voids_2401x3601.tif Int16 \
        "-111, $step, 0, 38, 0, -$step" '900 1100 900 1000'
    cut_out tatra-part srtm3_tatra_poland_4801.tif Int16 \
        "19.8, $step, 0, 49.5, 0, -$step" '2200 2300 900 801'
    cut_out moon-nw-part moon_gld100_256ppd_ne_4097.png UInt16 \
        '100, 0.00390625, 0, 40, 0, -0.00390625' '301 77 1001 720'
    cut_out moon-ne-part moon_gld100_256ppd_ne_8193.tif Int16 \
        '110, 0.00390625, 0, 30, 0, -0.00390625' '3500 2900 801 900'
    cut_out moon-part moon_gld100_global_5760x2880.tif Int16 '0, 0.25, 0, 90, 0, -0.25' '0 0 5760 2880' 1440 720
}

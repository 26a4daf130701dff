# sections.sh - the parts of the report's page, in their order; read by page.sh, whose functions it uses.

parts='summary contents error fidelity hillshades update levels space figures9 ch06 bn08 schemes compression scaling extreme left_out runs'

gp() { # TEXT: as a string of gnuplot
    printf "'%s'" "$(printf '%s' "$1" | tr '\n\\' '  ' | sed "s/'/''/g")"
}

# The papers' figures of one table, and what we have beside them.
papers() { # PAPER TABLE
    of_paper=$1 of_table=$2
    set --
    for f in hexagons views update error_time space scaling precision; do
        [ ! -f "$out/$f.csv" ] || set -- "$@" "$out/$f.csv"
    done
    awk -v paper="$of_paper" -v table="$of_table" -v papers="$here/papers.csv" -f "$here/csv.awk" \
        -f "$here/compare.awk" "$@" "$here/papers.csv" >"$work/papers.csv"
    table "$work/papers.csv" 'columns=row=Paper;value=Paper has:given;unit=Unit;ours=We have:4;
        remark=Where ours is from;where=Where the paper'"'"'s figure was found'
}

# Such figures that papers.csv has by subject and quantity, and ours, as a table of CSV.
beside() { # AWK PAPER TABLE OURS [FORM]
    set -- "$1" "$2" "$3" "$out/$4.csv" "${5:-}"
    [ -f "$4" ] || set -- "$1" "$2" "$3" /dev/null "$5"
    awk -v paper="$2" -v table="$3" -v form="$5" -v papers="$here/papers.csv" -f "$here/csv.awk" -f "$here/paper.awk" \
        -f "$here/$1.awk" "$here/papers.csv" "$4"
}

head_of_page() {
    cat <<END
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Terraclip: error against run time</title>
<style>
$(cat "$here/style.css")
</style></head><body><main>
<h1>Terraclip: error against run time</h1>
<p>What error a view has for what time, where it breaks, and what its scene did not pay for: measured on this machine by
<code>make report$([ "$(run_kind)" = full ] && echo -full)</code>. Errors are |height drawn &minus; true height of the
finest level| at each pixel that shows terrain, divided by the distance and multiplied by W / (2 tan(fov/2)).</p>
END
    if has_rows "$out/machine.csv"; then
        echo '<dl>'
        awk -f "$here/csv.awk" -f "$here/pairs.awk" "$out/machine.csv"
        echo '</dl>'
    else
        echo '<p class="fault">Nothing is known of the machine.</p>'
    fi
    [ "$(run_kind)" != quick ] || echo '<p class="grey">Quick: fewer and smaller terrains, fewer repetitions, a default
terrain of 1025 x 1025 samples in some tables. <code>make report-full</code> takes all.</p>'
}

run_kind() {
    awk -v name=Kind -v want=value -f "$here/csv.awk" -f "$here/field.awk" "$out/machine.csv" 2>/dev/null
}

# ---- Summary ---------------------------------------------------------------------------------------------------------

part_summary() {
    section summary 'In short'
    echo '<div class="tiles">'
    set --
    for f in error_time fidelity lod_error precision update triangles space rate_distortion scaling left_out; do
        ! has_rows "$out/$f.csv" || set -- "$@" "$out/$f.csv"
    done
    for f in "$out"/extreme/*.csv "$out/runs.csv"; do [ ! -e "$f" ] || set -- "$@" "$f"; done
    awk -f "$here/csv.awk" -f "$here/rates.awk" -f "$here/headlines.awk" "$@" /dev/null
    echo '</div>'
    wrong=$(awk -f "$here/csv.awk" -f "$here/wrong.awk" "$out/runs.csv" 2>/dev/null)
    [ -z "$wrong" ] || printf '<p class="fault">Not everything was measured: %s. <a href="#runs">Why</a></p>\n' "$wrong"
}

part_contents() {
    echo '<nav>'
    sed -n "s/^    section \([a-z0-9_]*\) '\(.*\)'\$/<a href=\"#\1\">\2<\/a>/p" "$here/sections.sh"
    echo '</nav>'
}

# ---- Error against run time ------------------------------------------------------------------------------------------

legend='<p class="legend"><i style="color:#0b6fb8">&#9679; square, number: n</i>
<i style="color:#7db8e0">&#9675; square, morph off</i>
<i style="color:#b02a8f">&#9670; square-error: 4, 2, 1 and 0.5 pixels of tolerance</i>
<i style="color:#1a8a4a">&#9650; rings, number: steps around</i> <i style="color:#d06418">&#9651; rings-ch06</i>
<i style="color:#666">&#9632; brute: mesh of all samples</i>
<i>&#9476; front: nothing is both faster and nearer</i></p>'

panels() { # COLUMN KIND XLABEL WHICH-LIMITS
    before=
    [ -s "$work/panels" ] || { echo '<p class="fault">No row can be plotted.</p>'; return; }
    while IFS='|' read -r number terrain title ms tris pixels; do
        limits=$ms
        [ "$2" = ms ] || limits=$tris
        [ "$terrain" = "$before" ] || printf '%s<h3>%s</h3><div class="panels">\n' "${before:+</div>}" \
            "$(printf '%s\n' "$terrain" | escaped)"
        before=$terrain
        figure "error$number$2" 'Error against cost' '' 430 300 error_time.gp "rows = '$work/$number.rows'" \
            "front = '$work/$number.$2'" "column = $1" "xlabel_ = '$3'" "x0 = ${limits%:*}" "x1 = ${limits#*:}" \
            "y0 = ${pixels%:*}" "y1 = ${pixels#*:}" "title_ = $(gp "$title above ground")"
    done <"$work/panels"
    echo '</div>'
}

part_error() {
    section error 'Error against run time'
    measured error_time error_time.csv || return
    set -- "$out/error_time.csv"
    [ ! -f "$out/frames.csv" ] || set -- "$out/frames.csv" "$@"
    awk -v out="$work" -v least=1e-5 -f "$here/csv.awk" -f "$here/error_time.awk" "$@"
    echo "$legend"
    panels 3 ms 'milliseconds a frame'
    echo '<p class="grey">Errors below those of all schemes are drawn at the lower edge. Times are
 medians of repeated views whose windows are held, and their means over the places looked from.</p>'
    echo '<details><summary>The same against triangles</summary>'
    panels 6 tris 'triangles drawn'
    echo '</details><h3>The fronts</h3><p>Rows that no other row of their scene beats in both time and error. Marked: from 1 px
on.</p>'
    columns='columns=scene=Scene;scheme=Scheme;morph=Morph;n=n;triangles=Triangles:int;frame_ms=Frame, ms:4;
        frame_low_ms=10 %:4;frame_high_ms=90 %:4;brute_times=Brute force takes, times:3;err_rms_px=rms, px:3;
        err_p999_px=99.9 %, px:3;err_max_px=Largest, px:3'
    table "$work/table.csv" "$columns" group=1 only=best=yes 'limits=err_p999_px<1'
    echo '<details><summary>All rows</summary>'
    table "$work/table.csv" "$columns;best=Front" group=1 'limits=err_p999_px<1'
    echo '</details>'
    if has_rows "$out/frames.csv"; then
        echo '<details><summary>First views: what a scene loads</summary>'
        table "$out/frames.csv" group=1
        echo '</details>'
    fi
}

# Plots of one table, one a value of its column GROUP, which is the title or, where XLABEL is "=", that.
curves() { # ID FILE GROUP SERIES X Y XLABEL YLABEL [NAME=VALUE of curves.awk...] -- [NAME=VALUE of curves.gp...]
    id=$1 file=$2 group=$3 series=$4 x=$5 y=$6 xlabel=$7 ylabel=$8
    shift 8
    awk_settings=
    while [ "$1" != -- ]; do awk_settings="$awk_settings -v $1"; shift; done
    shift
    if ! awk -v group="$group" -v series="$series" -v x="$x" -v y="$y" -v out="$work/$id" $awk_settings \
        -f "$here/csv.awk" -f "$here/curves.awk" "$file" 2>"$work/curves.log"; then
        printf '<p class="grey">No plot: %s</p>\n' "$(escaped <"$work/curves.log")"
        return
    fi
    echo '<div class="panels wide">'
    while IFS='|' read -r number count xspread yspread value; do
        title=$value label=$xlabel
        [ "$xlabel" != = ] || title= label=$value
        figure "$id$number" 'Curves' '' 560 460 curves.gp "data = '$work/$id.$number'" "blocks = $count" \
            "xlabel_ = $(gp "$label")" "ylabel_ = $(gp "$ylabel")" "title_ = $(gp "$title")" \
            "xspread = $xspread" "yspread = $yspread" "$@"
    done <"$work/$id.list"
    echo '</div>'
}

part_fidelity() {
    section fidelity 'Fidelity: pictures against cast ones'
    measured fidelity fidelity.csv || return
    echo '<p>Pictures of a scheme, unlit, against pictures cast ray by ray from the finest level: structural
similarity of luminance (1: equal) and root mean square difference in levels of 8 bits.
Lower is better in the plots.</p>'
    awk -f "$here/csv.awk" -f "$here/scenes.awk" "$out/fidelity.csv" >"$work/fidelity.csv"
    curves fidelity "$work/fidelity.csv" terrain height+scheme n loss 'n' '1 - SSIM' positive=1 -- xlog=1 ylog=1
    table "$work/fidelity.csv" 'columns=terrain=Terrain;height=From;scheme=Scheme;n=n;ssim=SSIM:5;
        rmse=RMSE, levels:3;pixels=Pixels:int' group=2
}

part_hillshades() {
    section hillshades 'Detail finer than the data: hillshades'
    measured hillshades hillshades.csv || return
    echo '<p>Terrains as they are, and with their two finest levels dropped and made again from what is left. A pixel is a
sample of the finest level; light from the north-west, 45 degrees high, nothing exaggerated. Of each terrain a square
steeper than three quarters of it. How much a level adds is not learned from the true one: it follows the trend of the
coarser levels.</p>'
    before=
    awk -f "$here/csv.awk" -f "$here/hillshades.awk" "$out/hillshades.csv" >"$work/hillshades"
    while IFS='|' read -r terrain spacing side file caption; do
        [ "$terrain" = "$before" ] || printf '%s<h3>%s, every %s m</h3><div class="pictures">\n' "${before:+</div>}" \
            "$(printf '%s\n' "$terrain" | escaped)" "$(printf '%s\n' "$spacing" | escaped)"
        before=$terrain
        picture "$file" "$side" "$caption"
    done <"$work/hillshades"
    echo "${before:+</div>}"
}

# ---- LH04 ------------------------------------------------------------------------------------------------------------

part_update() {
    section update 'LH04 table 1: cost of an update'
    measured update update.csv || return
    echo '<p>A full level of 255 x 255 samples: processor time of each step, median of many, and how many times as long
as copying the bytes that it writes.</p>'
    table "$out/update.csv" 'columns=step=Step;us=Median, µs:4;us_low=10 %, µs:4;us_high=90 %, µs:4;
        copy_ratio=times copying:3;paper_ms=LH04, ms:given'
    papers LH04 'table 1'
    echo '<p>The papers’ times are those of processors and graphics cards of 2004 and 2005. Our decompression includes
U, and decodes whole tiles; our synthesis includes U, too.</p>'
}

part_levels() {
    section levels 'LH04 table 2: error of the levels'
    measured lod_error lod_error.csv || return
    echo '<p>Each level’s mesh against the finest samples; pixels for n = 255, W = 640, 90 degrees at LH04’s
distance 0.4 n g, that is its e times s / g with s = 1.25 W / (n tan(fov/2)). The finest level has no error. Marked: rms
from 0.2 px, 99.9 % from 1 px.</p>'
    beside levels LH04 'table 2' lod_error list >"$work/levels.csv"
    curves levels "$work/levels.csv" '' terrain spacing_m p999_px 'spacing of the level, m' '99.9 % within, px' \
        positive=1 -- xlog=1 ylog=1
    echo '<h3>Side by side</h3><p>Pixels, by how many levels a level is coarser than the finest one; LH04 counts from the
coarsest, so that its level l stands in column 9 &minus; l (Puget Sound) or 11 &minus; l (United States).</p>'
    beside levels LH04 'table 2' lod_error wide >"$work/wide.csv"
    table "$work/wide.csv" "columns=figure=px;terrain=Terrain;spacing_m=Finest, m:3$(head -n 1 "$work/wide.csv" |
        tr , '\n' | sed -n 's/^c\([0-9]*\)$/;c\1=\1:given/p' | tr -d '\n')" group=1
    echo '<h3>By level</h3>'
    table "$work/levels.csv" 'columns=terrain=Terrain;level=Level;spacing_m=Spacing, m:3;rms_m=rms, m:3;
        p999_m=99.9 %, m:3;max_m=Largest, m:3;rms_px=rms, px:3;p999_px=99.9 %, px:3;max_px=Largest, px:3' \
        group=1 'limits=rms_px<0.2;p999_px<1'
    echo '<p class="grey">LH04’s figures: the project’s notes of the papers.</p>'
}

part_space() {
    section space 'LH04 table 3: space'
    measured space space.csv || return
    echo '<p>What it takes to show a view with n = 255 from a packed file, which a fresh process opens. "View" is the
packed file, clipmap, vertex textures, geometry and the caches of what was read and decoded; textures live in
main memory on a software renderer.</p>'
    table "$out/space.csv" 'columns=terrain=Terrain;width=Samples x:int;height=Samples y:int;
        raw_bytes=Raw (16 bits):bytes;packed_bytes=Packed:bytes;bits_per_sample=Bits a sample:3;rms_m=rms, m:3;
        max_error_m=Largest, m:3;view_bytes=View:bytes;view_over_raw=View / raw:3'
    table "$out/space.csv" 'columns=terrain=Terrain;levels=L;clipmap_height_bytes=Clipmap heights:bytes;
        clipmap_normal_bytes=Clipmap normals:bytes;texture_height_bytes=Height textures:bytes;
        texture_normal_bytes=Normal textures:bytes;geometry_bytes=Geometry:bytes;pyramid_bytes=Caches:bytes;
        resident_start_bytes=Resident at start:bytes;resident_context_bytes=with a context:bytes;
        resident_view_bytes=with the view:bytes'
    echo '<h3>Run-time space, side by side</h3>'
    beside space LH04 'table 3' space >"$work/runtime.csv"
    table "$work/runtime.csv" 'columns=scheme=Scheme and terrain;samples=Samples:int;bytes=Run-time space:bytes;
        bytes_per_sample=Bytes a sample:3'
    echo '<p>The clipmap’s share does not grow with the terrain: for small terrains it is most of the view, for the
papers’ it vanishes beside the data.</p><h3>What a clipmap takes, of the terrain with the most levels</h3>'
    papers LH04 memory
}

part_figures9() {
    section figures9 'LH04 section 9 and AH05: frames and triangles a second'
    ran error_time
    ran views
    echo '<p>Ours: squares, n = 255, the view lowest above ground, without a window, lit before a flat background where it
says so; the papers’: a graphics card of their year (LH04: Radeon 9800 XT, 640 x 480, 90 degrees). What compares is the
number of triangles, not the time.</p>'
    papers LH04 'section 9'
    papers AH05 'section 2.5'
    papers AH05 'table 2-2'
}

# ---- Planets ---------------------------------------------------------------------------------------------------------

part_ch06() {
    section ch06 'CH06: triangles of three views, precision'
    if measured triangles triangles.csv; then
        table "$out/triangles.csv" 'columns=scene=View;scheme=Scheme;all=All levels:int;
            to_pixel=down to a pixel:int;to_horizon=and to the horizon:int;drawn=Drawn:int;paper=CH06:int'
        echo '<p>CH06 has 16 levels, to about a metre, and no culling by direction: its figures compare with those to the
horizon. Ours go on to centimetres. "Drawn" is what is left of them by direction.</p>'
    fi
    echo '<h3>The three views, side by side</h3>'
    if measured views views.csv; then
        echo '<p>1280 x 960, 512 steps around, 20 a level. CH06: GeForce 6800, the Earth with colours from pictures; ours:
the default planet, lit, 60 degrees, from 2 m, 10 km and 10,000 km.</p>'
    fi
    beside views CH06 views views >"$work/ch06.csv"
    table "$work/ch06.csv" 'columns=view=View;scheme=Scheme;levels=Levels;triangles=Triangles of these:int;drawn=Drawn:int;
        rate=Frames a second:3;scene=Our scene' group=1
    papers CH06 culling
    echo '<h3>Precision by level (CH06 figure 12)</h3>'
    measured precision precision.csv || return
    awk -v column=err_px -f "$here/csv.awk" -f "$here/precision.awk" "$out/precision.csv" >"$work/precision.px"
    awk -v column=err_over_radius -f "$here/csv.awk" -f "$here/precision.awk" "$out/precision.csv" \
        >"$work/precision.radius"
    echo '<div class="panels wide">'
    figure precisionpx 'Precision, pixels' \
        'Vertices as the driver computes them against long double; worst of all places, frame 1280 wide.' \
        560 380 precision.gp "data = '$work/precision.px'" "ylabel_ = 'worst error on the screen, px'" 'goal = 0.01'
    figure precisionradius 'Precision, share of the radius' 'The same as a share of the planet’s radius.' \
        560 380 precision.gp "data = '$work/precision.radius'" "ylabel_ = 'worst error / radius'" 'goal = 0'
    echo '</div><details><summary>The figures</summary>'
    table "$out/precision.csv" 'columns=level=Level;variant=Transform;err_over_radius=Error / radius;
        err_px=Error, px:3'
    echo '</details>'
    papers CH06 'figure 12'
    papers PT precision
}

part_bn08() {
    section bn08 'BN08: planar squares against a planet of hexagons'
    if measured hexagons hexagons.csv; then
        echo '<p>BN08: GeForce 8800 GT, 630 frames a second for squares of n = 255 over Puget Sound, 520 for hexagons of
n = 257 over a sphere of four of them, a ratio of 0.83. Ours: windows of 255 for both, a plane and four charts of as many
samples a side, 640 x 480, 90 degrees, lit; frames of both in turns, and the median of the ratios within a turn. The
planet hides behind its horizon what a plane goes on to show, so that triangles a second compare what frames do not.</p>'
        awk -f "$here/csv.awk" -f "$here/hexagons.awk" "$out/hexagons.csv" >"$work/hexagons.csv"
        table "$work/hexagons.csv" 'columns=spacings=Samples above ground;scheme=Scheme;n=n;triangles=Triangles:int;
            frame_ms=Frame, ms:4;frames_per_s=Frames a second:4;ratio=over squares:3;ratio_low=10 %:3;
            ratio_high=90 %:3;mtriangles=Million triangles a second:3' group=1
    fi
    papers BN08 rates
}

part_schemes() {
    section schemes 'Rings, hexagons and cube over the same planets'
    if measured schemes schemes.csv; then
        cat <<'END'
<p>The same samples in longitude and latitude (rings) and resampled to the faces of an octahedron (hex) and a cube; the
same cameras at random for all: ground 2 to 100 m above it, aircraft 5 to 50 km, space 300 to 20,000 km, pole 5 to 2,000
km within a degree of one. Sizes: 128, 256, ... steps around, windows of 127, 255, ... Errors are those against the
source's samples, interpolated; "own" are those against the charts that are drawn. "-detail": with synthesis below the
ground, against the charts' own. Without it a view from the ground shows the data's own cells: rings draw them curved, the
others as two triangles each.</p>
END
        awk -v form=plots -f "$here/csv.awk" -f "$here/schemes.awk" "$out/schemes.csv" >"$work/schemes.csv"
        echo '<h3>Error against triangles</h3>'
        curves schemestris "$work/schemes.csv" what scheme triangles err_p999_px 'triangles drawn' \
            '99.9 % of pixels within, px' positive=1 -- xlog=1 ylog=1
        echo '<h3>Error against time</h3><p>Milliseconds a frame, of held windows. All schemes of a size
are drawn in turns, sizes one after the other: where the machine had other work, curves bend between sizes.</p>'
        curves schemesms "$work/schemes.csv" what scheme frame_ms err_p999_px 'milliseconds a frame' \
            '99.9 % of pixels within, px' positive=1 -- xlog=1 ylog=1
        echo '<h3>At equal triangles</h3><p>Between the two nearest sizes of each, in logarithms; views whose schemes have
no number of triangles in common are left out. Uploads and updates are those of a flight straight on.</p>'
        awk -v form=equal -f "$here/csv.awk" -f "$here/schemes.awk" "$out/schemes.csv" >"$work/equal.csv"
        table "$work/equal.csv" 'columns=planet=Planet;view=View;triangles=Triangles:int;scheme=Scheme;err_rms_px=rms, px:3;
            err_p999_px=99.9 %, px:3;err_max_px=Largest, px:3;own_p999_px=Own 99.9 %, px:3;frame_ms=Frame, ms:3;
            update_ms=Update, ms:3;bytes_per_km=Uploaded a km:bytes;samples_held=Samples held:int;
            memory_bytes=Memory:bytes' group=3
        echo '<details><summary>All rows</summary>'
        table "$out/schemes.csv" 'columns=planet=Planet;view=View;scheme=Scheme;n=n;triangles=Triangles:int;
            err_rms_px=rms, px:3;err_p999_px=99.9 %, px:3;err_max_px=Largest, px:3;own_rms_px=Own rms, px:3;
            own_p999_px=Own 99.9 %, px:3;own_max_px=Own largest, px:3;frame_ms=Frame, ms:4;
            frame_ratio=over the first:3;update_ms=Update, ms:3;bytes_per_km=Uploaded a km:bytes;
            samples_held=Samples held:int;memory_bytes=Memory:bytes' group=3
        echo '</details><h3>Samples stored</h3><p>At equal spacing along the equator; of longitude and latitude with
its polar caps.</p>'
        awk -v form=stored -f "$here/csv.awk" -f "$here/schemes.awk" "$out/schemes.csv" >"$work/stored.csv"
        table "$work/stored.csv" 'columns=planet=Planet;scheme=Scheme;samples=Samples:int;share=Share:3' group=1
    fi
    echo '<h3>What samples are worth</h3>'
    if measured atlas atlas.csv; then
        echo '<p>Levels against the source, by area, of what is drawn between their samples. Bytes of files at equal rms:
<code>docs/figures.md</code>, Planets.</p>'
        table "$out/atlas.csv" 'columns=planet=Planet;atlas=Atlas;coarser=Levels coarser;samples=Samples:int;
            cap_samples=of caps:int;rms_m=rms, m:4;max_error_m=Largest, m:4' group=2
    fi
    echo '<h3>Size of triangles by yaw</h3>'
    if measured triangle_size triangle_size.csv; then
        echo '<p>Square root of the area in pixels of what lies whole in the frame, from the same places at all yaws.
BN08: triangles of hexagons are alike at any yaw. Spread: standard deviation over mean, within a yaw. "By yaw": largest over
smallest of all yaws.</p>'
        awk -v form=plots -f "$here/csv.awk" -f "$here/yaws.awk" "$out/triangle_size.csv" >"$work/yaws.csv"
        curves yaws "$work/yaws.csv" what curve yaw_deg mean_px 'yaw, degrees' 'mean size, px' -- xlog=0 ylog=0
        awk -v form=summary -f "$here/csv.awk" -f "$here/yaws.awk" "$out/triangle_size.csv" >"$work/yaws.csv"
        table "$work/yaws.csv" 'columns=view=View;scheme=Scheme;n=n;triangles=Triangles:int;mean_px=Mean size, px:3;
            spread=Spread:3;mean_ratio=Mean size by yaw:3;count_ratio=Triangles by yaw:3' group=1
    fi
    echo '<h3>What changes from frame to frame</h3>'
    if measured popping popping.csv; then
        echo '<p>A slow flight, 0.3 of the height above ground a second at 60 frames: change of the height drawn at one and the
same place from a frame to the next, in pixels. A mesh of all samples has none. cube-pt exchanges levels at once, as PT
does; hex and cube let them pass over; vertices of rings go with the viewer, so that they change all the time.</p>'
        table "$out/popping.csv" 'columns=view=View;n=n;scheme=Scheme;frames=Frames;changes=Changes:int;rms_px=rms, px:3;
            p999_px=99.9 %, px:3;max_px=Largest, px:3' group=2
    fi
}

# ---- Compression, scaling, extreme cases, what is left out -----------------------------------------------------------

part_compression() {
    section compression 'Compression: bits against error'
    echo '<h3>LH04’s terrains and ours</h3><p>Ours: the files of <a href="#space">space</a>, at the rms that packing takes by default, 6 % of the
spacing; PSNR of the range of heights; packing by processor time (LH04: about 5 hours for the United States).</p>'
    beside space LH04 compression space >"$work/compression.csv"
    table "$work/compression.csv" 'columns=terrain=Terrain;samples=Samples:int;spacing_m=Spacing, m:3;
        raw_bytes=Raw (16 bits):bytes;packed_bytes=Packed:bytes;factor=Factor:3;bits_per_sample=Bits a sample:3;
        rms_m=rms, m:3;rms_percent=of the spacing, %:3;psnr_db=PSNR, dB:3;msps=Packing, million samples/s:3'
    echo '<h3>Against other codecs</h3>'
    measured rate_distortion rate_distortion.csv || return
    curves rate "$out/rate_distortion.csv" dataset codec+mode^ bits_per_sample rms_m \
        'bits a sample, whole files' 'rms, m' \
        positive=1 -- xlog=1 ylog=1
    awk -f "$here/csv.awk" -f "$here/rates.awk" -f "$here/equal_rms.awk" "$out/rate_distortion.csv" \
        >"$work/equal_rms.csv"
    echo '<h3>Bytes at equal error</h3><p>Ours against the other codec’s at the rms of ours, interpolated between its
two nearest points in logarithms; rows where it has none on both sides are left out.</p>'
    table "$work/equal_rms.csv" 'columns=dataset=Terrain;rms_m=rms, m:3;bits=Ours, bits:4;codec=Against;
        theirs=Its bits:4;difference=Ours against its, %:3' group=1
    echo '<h3>Speed and regions</h3>'
    table "$out/rate_distortion.csv" 'columns=dataset=Terrain;codec=Codec;mode=Mode;bits_per_sample=Bits:4;
        rms_m=rms, m:3;max_error_m=Largest, m:3;encode_msps=Encoding, million samples/s:3;
        decode_msps=Decoding, million samples/s:3;roi255_ms=255 x 255 cold, ms:3' group=2
}

part_scaling() {
    section scaling 'Scaling'
    measured scaling scaling.csv || return
    echo '<p>Frames of 640 x 480, unlit, n = 255 unless said otherwise, over one terrain repeated in mirror images: a
held view, or one that moves; updates are windows and uploads, of the first view where the view is held.</p>'
    awk -f "$here/csv.awk" -f "$here/scaling.awk" "$out/scaling.csv" >"$work/scaling.csv"
    curves scaling "$work/scaling.csv" what cost value ms = milliseconds positive=1 -- xlog=1 ylog=1
    table "$out/scaling.csv" 'columns=what=What;value=Value:given;frame_ms=Frame, ms:4;frame_low_ms=10 %:4;
        frame_high_ms=90 %:4;update_ms=Update, ms:4;triangles=Triangles:int;samples=Samples updated:int;
        bytes_uploaded=Uploaded:bytes' group=1
}

part_extreme() {
    section extreme 'Extreme cases'
    echo '<p class="command">Again: <code>make test-extreme</code></p>'
    set --
    for f in "$out"/extreme/*.csv; do [ ! -e "$f" ] || set -- "$@" "$f"; done
    if grep -q '^extreme_' "$out/runs.csv" 2>/dev/null; then
        runs_table '^extreme_'
    fi
    if [ $# = 0 ]; then
        echo '<div class="grey">Not run: <code>make test-extreme</code></div>'
        return
    fi
    awk -f "$here/csv.awk" -f "$here/extreme.awk" "$@" >"$work/extreme.csv"
    echo '<p>Failures first; rows of a family are as old as it says.</p><ul>'
    for f; do
        printf '<li>%s: %s</li>\n' "$(basename "$f" .csv | escaped)" "$(date -u -r "$f" '+%Y-%m-%d %H:%M UTC')"
    done
    echo '</ul>'
    table "$work/extreme.csv" 'columns=family=Family;case=Case;figure=Figure;value=Value;limit=Limit;
        verdict=Verdict;note=Note'
}

part_left_out() {
    section left_out 'What scenes did not pay for'
    if measured left_out left_out.csv; then
        clock='the time that passed'
        case $(run_field left_out renderer) in
        *llvmpipe* | *softpipe* | *swrast*) clock='processor time of all threads' ;;
        esac
        echo "<p>What each thing would have cost, had it been forced upon the scene: milliseconds of a frame, $clock
(of libraries and threads: once), median of differences, and bytes. Below zero is noise.</p>"
        table "$out/left_out.csv" 'columns=scene=Scene;feature=Left out;saved_ms=Saved, ms:3;
            saved_bytes=Saved, bytes:bytes' group=1
    fi
    echo '<h3>What the viewers say (--explain)</h3>'
    ran explain
    for f in "$out"/explain/*.txt; do
        [ -e "$f" ] || continue
        printf '<details><summary>%s</summary><pre>' "$(head -n 1 "$f" | escaped)"
        tail -n +2 "$f" | escaped
        echo '</pre></details>'
    done
}

part_runs() {
    section runs 'All runs'
    echo '<p>Every program that this report ran, how long it took and what became of it.</p>'
    if has_rows "$out/runs.csv"; then
        runs_table .
    else
        echo '<p class="fault">Nothing was run.</p>'
    fi
}

runs_table() { # REGEX of their names
    sed '1s/state/verdict/' "$out/runs.csv" >"$work/runs.csv"
    table "$work/runs.csv" "only=name=$1" 'columns=name=Name;verdict=State;seconds=Seconds:int;
        cpu_seconds=of processor:4;renderer=OpenGL;command=Command;reason=Reason'
}

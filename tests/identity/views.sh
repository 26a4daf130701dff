# views.sh - pictures of all kinds of scenes, compared pixel by pixel; read by identity.sh.
#
# Left out: terrains of 2^30 samples a side and more, which have a shader of their own (tests/extreme has them).

# A picture; a terrain in pack/ is packed first, by each build for itself. Later options override earlier ones.
view() { # NAME VIEWER TERRAIN OPTION...
    case_name=view/$1 viewer=$2-viewer terrain=$3
    shift 3
    selected "$case_name" || return
    at_hand "$terrain" || { skipped "$case_name" 'no such terrain at hand'; return; }
    both "$case_name" "$viewer" "$terrain" --backend $backend --size 400x300 "$@" ${VIEW_OPTIONS:-} \
        -o "out/$case_name.ppm"
    compare_picture "$case_name"
}

at_hand() { # TERRAIN
    pack=${1#*pack/}
    case $1 in
    *pack/*) packed "${pack%.tclip}" ;;
    *) have "${1#in/}" ;;
    esac
}

# Views given in one line each: NAME [OPTION]..., of one terrain by one viewer.
views_of() { # PREFIX VIEWER TERRAIN <LINES
    prefix=$1 scene_viewer=$2 scene_terrain=$3
    while read -r name options; do
        view "$prefix-$name" "$scene_viewer" "$scene_terrain" $options </dev/null
    done
}

compare_views() {
    planar_views
    planet_views
}

planar_views() {
    # Counting stays in this shell: no pipes, the lines come from here-documents.
    views_of land planar in/land.tif <<'end'
all
slope --view 9000,8000,1400,40,-12
low --view 16000,12000,700,300,-3
low-unlit --view 16000,12000,700,300,-3 --unlit
flat --view 9000,8000,1400,40,-12 --background ff00ff
flat-unlit --view 9000,8000,1400,40,-12 --background 103050 --unlit --samples 1
levels --view 9000,8000,1400,40,-12 --level-colours --n 63
wires --view 9000,8000,1400,40,-12 --wireframe --n 63
wires-bare --view 9000,8000,1400,40,-12 --wireframe --n 31 --level-colours --unlit --background 000000 --samples 1
abrupt --view 9000,8000,1400,40,-12 --no-morph --n 63
abrupt-bare --view 15000,15000,2500,130,-30 --no-morph --unlit --n 31 --samples 1
one-sample --view 12000,9000,900,70,-8 --samples 1
n15 --view 15000,15000,2500,130,-30 --n 15
n31-levels3 --view 15000,15000,2500,130,-30 --n 31 --levels 3
n511 --view 15000,15000,2500,130,-30 --n 511 --samples 2
n1023 --view 15000,15000,2500,130,-30 --n 1023
level1 --view 15000,15000,2500,130,-30 --levels 1
levels4 --view 15000,15000,2500,130,-30 --levels 4
narrow --view 1000,1000,1500,45,-3 --fov 3
narrowest --view 1000,1000,1500,45,-3 --fov 1 --samples 1
wide --view 15000,15000,1800,250,-10 --fov 130
widest --view 15000,15000,1800,250,-20 --fov 170
tall --view 9000,8000,1400,40,-12 --size 97x400
flat-frame --view 9000,8000,1400,40,-12 --size 501x61
tiny-frame --size 64x48
down --view 15000,15000,12000,0,-90
up --view 15000,15000,3000,0,60
edge --view 200,200,1000,80,-20
corner --view 30720,30720,900,250,-15
outside --view=-40000,15000,9000,90,-10
far --view=-900000,15000,300000,90,-18 --fov 5
below --view 15000,15000,-3000,90,40
stretched --spacing 900 --unit 0.1
one-thread --view 9000,8000,1400,80,-12 --threads 1
end
    views_of packed planar pack/land.tclip <<'end'
all
low --view 16000,12000,700,300,-3
levels --view 9000,8000,1400,40,-12 --level-colours --n 127
abrupt --view 9000,8000,1400,200,-12 --no-morph --samples 1
levels3 --view 15000,15000,2500,130,-30 --levels 3
down --view 15000,15000,12000,0,-90 --unlit
end
    view rocks-lossless planar pack/rocks-lossless.tclip --view 5000,5000,2500,40,-12
    view rocks-loose planar pack/rocks-loose.tclip --view 5000,5000,2500,40,-12
    view rocks-lh04 planar pack/rocks-lh04.tclip --view 5000,5000,2500,40,-12
    view packed-old planar ../before/pack/land.tclip --view 9000,8000,1400,40,-12

    views_of holes planar in/holes.asc <<'end'
filled
open --voids hole
open-low --voids hole --view 9000,9000,2500,240,-20 --samples 1
open-below --voids hole --view 9000,9000,-3000,0,70
open-n31 --voids hole --n 31 --no-morph
open-wires --voids hole --wireframe --n 63
open-levels --voids hole --level-colours --n 31 --unlit --background 00ff00
constant --voids constant=0
constant-low --voids constant=2500 --view 9000,9000,2600,240,-20 --n 63
nodata --nodata 1200 --voids hole --unlit
end
    view holes-packed planar pack/holes.tclip --n 31
    view holes-packed-filled planar pack/holes.tclip --voids fill --view 9000,9000,2500,240,-20
    view holes-packed-constant planar pack/holes-constant.tclip --samples 1

    view tiny-two planar in/two.asc --spacing 30
    view tiny-two-packed planar pack/two.tclip --wireframe --n 15
    view tiny-three planar in/three.asc --spacing 30 --level-colours
    view tiny-strip planar in/strip.asc --spacing 30 --n 15
    view tiny-strip-packed planar pack/strip.tclip --unlit
    view tiny-seventeen planar in/seventeen.asc --spacing 30 --n 15 --level-colours
    view tiny-cliff planar in/cliff.asc --spacing 30 --voids hole
    view tiny-small planar in/small.tif --n 31
    view tiny-cliff-packed planar pack/cliff.tclip --background ffffff

    view sierra planar in/N37W119.hgt --view 40000,60000,5000,120,-10 --fov 50
    view sierra-open planar in/N37W119.hgt --voids hole --view 30000,90000,4600,180,-20
    view sierra-mosaic planar pack/sierra.tclip
    view alps-flat planar pack/n46e008.tclip --view 30000,30000,3500,30,-8
    view canyonlands planar in/srtm3_canyonlands_voids_2401x3601.tif --voids hole --view 90000,150000,6000,10,-25
    view canyonlands-packed planar pack/canyonlands.tclip --level-colours
    view canyonlands-constant planar pack/canyonlands.tclip --voids constant=1000 --view 90000,150000,6000,10,-25
    view tatra planar pack/tatra.tclip --view 149000,5000,3500,0,-12
    view puget planar in/ps_height_1k.png --spacing 160 --unit 0.1
    view moon-flat planar pack/moon-ne.tclip --view 400000,500000,20000,60,-12
    view moon-map planar pack/moon.tclip
}

planet_views() {
    # Caps blend in at 56 to 59 degrees.
    views_of planet planet in/planet.tif <<'end'
all
far --view 10,20,60000000,0,-90 --fov 20
farther --view 10,20,1e9,0,-90 --fov 1
space --view=-75,25,9000000,30,-80
horizon --view 100,30,400000,45,-15
ground --view 119.9,16,3000,-20,-2
ground-unlit --view 119.9,16,3000,-20,-2 --unlit
down --view 40,-30,200000,0,-90
up --view 40,-30,9000,90,35 --samples 1
flat --view 100,30,400000,45,-15 --background ff00ff
levels --view 100,30,400000,45,-15 --level-colours
wires --view 100,30,900000,45,-40 --wireframe --n 64
wires-bare --view 100,30,900000,45,-40 --wireframe --n 64 --level-colours --unlit --background 000000 --samples 1
abrupt --view 100,30,400000,45,-15 --no-morph
one-sample --view 100,30,400000,200,-15 --samples 1
n64 --view 100,30,100000,90,-25 --n 64
n256-steps8 --view 100,30,100000,90,-25 --n 256 --steps 8
n1024 --view 100,30,100000,90,-25 --n 1024
levels3 --view 100,30,400000,45,-15 --levels 3
level1 --view 100,30,400000,45,-15 --levels 1
north --view 0,90,1000000,0,-90
north-low --view 17,89.9999999,5000,10,-5
north-side --view 0,86,900000,20,-30
south --view 0,-90,3000000,0,-90
south-low --view=-140,-89.99,6000,100,-6 --level-colours
blend --view 60,57.5,300000,90,-40
blend-low --view=-60,-57.5,6000,0,-4
antimeridian --view 180,10,900000,20,-60
antimeridian-west --view=-180,0,50000,90,-20
antimeridian-low --view 179.999,40,7000,80,-4 --samples 1
small --radius 20000 --view 30,20,60000,0,-80
moon-size --radius 1737400 --view 30,20,500000,120,-20
wide --view 100,30,400000,45,-15 --fov 130
tall --view 100,30,400000,45,-15 --size 120x400
ch06 --scheme rings-ch06
ch06-horizon --scheme rings-ch06 --view 100,30,400000,45,-15
ch06-ground --scheme rings-ch06 --view 119.9,16,3000,-20,-2 --samples 1
ch06-north --scheme rings-ch06 --view 0,86,900000,20,-30 --level-colours
ch06-wires --scheme rings-ch06 --view 100,30,900000,45,-40 --wireframe --n 64
end
    views_of planet-packed planet pack/planet.tclip <<'end'
all
ground --view 119.9,16,3000,-20,-2
north --view 0,86,900000,20,-30
south-low --view=-140,-89.99,6000,100,-6
blend --view 60,57.5,300000,90,-40
antimeridian --view 180,10,90000,20,-30
ch06 --scheme rings-ch06 --view 100,30,400000,45,-15
end
    view pits-lossless planet pack/pits-lossless.tclip --view 0,86,900000,20,-30 --samples 1
    view planet-bound planet pack/planet-bound.tclip --view 180,10,900000,20,-30
    view planet-packed-flat planet pack/planet-flat.tclip --view 100,30,400000,45,-15
    view planet-old planet ../before/pack/planet.tclip --view 0,86,900000,20,-30
    view planet-map planar pack/planet.tclip
    view globe planet pack/globe.tclip --view 20,-70,600000,0,-40
    view pits-open planet in/pits.asc --voids hole
    view pits-filled planet in/pits.asc --view=-20,30,3000000,0,-70
    view pits-constant planet in/pits.asc --voids constant=0 --view 90,-10,900000,30,-30 --level-colours
    view pits-packed planet pack/pits.tclip --view 90,-10,900000,30,-30

    views_of region planet in/holes.asc <<'end'
filled
open --voids hole --view 8.15,45.9,9000,0,-30
constant --voids constant=3000 --view 8.15,45.9,9000,0,-30 --samples 1
levels --voids hole --view 8.15,46.1,30000,0,-90 --level-colours --unlit
above --view 8.1,46.1,4000,70,-12
antipode --view=-171,-46,900000,0,-80
ch06 --scheme rings-ch06 --view 8.15,45.9,9000,0,-30
end
    view region-packed planet pack/holes.tclip --view 8.15,45.9,9000,0,-30

    view alps planet in/N46E008.tif --radius 6378137 --view 8.5,46.1,4500,20,-8
    view alps-open planet pack/n46e008.tclip --view 8.5,46.1,9000,20,-20
    view sierra-globe planet in/N37W119.hgt --view=-118.6,37.2,5000,-30,-6
    view canyonlands-globe planet pack/canyonlands.tclip --view=-110.5,37,9000,0,-12
    view moon planet in/moon_gld100_global_5760x2880.tif
    view moon-clavius planet pack/moon.tclip --view=-14,-52,80000,180,-16
    view moon-pole planet pack/moon.tclip --view 40,-89.5,30000,0,-12
    view moon-ch06 planet pack/moon.tclip --scheme rings-ch06 --view 20,10,100000,90,-20
    view moon-lossless planet pack/moon-lossless.tclip --view 180,57,60000,45,-20 --level-colours
    view moon-region planet pack/moon-ne.tclip --view 110,25,40000,0,-20
    view etopo planet in/earth_etopo20_1080x540_f32.tif --radius 6378137
    view etopo-pole planet pack/etopo.tclip --view 0,88,2000000,0,-70
    view etopo-andes planet pack/etopo-bound.tclip --view=-75,-20,200000,60,-15
    view etopo-antimeridian planet pack/etopo-lh04.tclip --view 179.9,-17,500000,300,-30
}

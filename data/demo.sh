#!/bin/sh
# Default terrain and planet and their pictures: demo.sh BUILD_DIR (by `make demo`). What is there already is kept.
set -eu
build=${1:?usage: demo.sh BUILD_DIR}
out=$build/demo
source=$out/terrain.tif
terrain=$out/terrain.tclip
mkdir -p "$out"

if [ ! -f "$source" ]; then
    echo "  SYNTH $source"
    "$build/terraclip" synth --kind planar --size 4097 --seed 4 -o "$source"
fi
if [ ! -f "$terrain" ] || [ "$source" -nt "$terrain" ]; then
    echo "  PACK  $terrain"
    "$build/terraclip" pack "$source" -o "$terrain" --rms 1
fi

# picture NAME VIEW [OPTION]...
picture() {
    name=$1 view=$2
    shift 2
    echo "  VIEW  $out/$name.png"
    "$build/planar-viewer" "$terrain" -o "$out/$name.png" --size 1280x720 --view="$view" "$@"
}

picture terrain -16000,176000,90000,145,-41 --fov 66
picture ridge 88500,74500,2457,118,-3 --fov 45
picture gullies 80000,80000,1250,125,-6 --fov 60 --synthesis auto
picture contours 80000,66000,6500,40,-30 --fov 60 --shade height --contours 50
picture coast 112000,103000,1556,200,-7 --fov 45
picture levels 80000,80000,4207,125,-10 --fov 60 --n 127 --level-colours
picture wireframe 80000,80000,4207,125,-14 --fov 60 --n 63 --wireframe --background 0c1420

# All of the terrain from so far away that it is a map, and that map as colours of the terrain.
picture map 61440,61440,7042045,0,-90 --fov 1 --size 2048x2048 --shade none --contours 200
picture draped 62000,20000,24000,20,-33 --fov 60 --imagery "$out/map.png"

globe=$out/planet.tif
planet=$out/planet.tclip
if [ ! -f "$globe" ]; then
    echo "  SYNTH $globe"
    "$build/terraclip" synth --kind planet --size 4096 --seed 1 -o "$globe"
fi
if [ ! -f "$planet" ] || [ "$globe" -nt "$planet" ]; then
    echo "  PACK  $planet"
    "$build/terraclip" pack --planet "$globe" -o "$planet"
fi

# globe NAME VIEW [OPTION]...
globe_picture() {
    name=$1 view=$2
    shift 2
    echo "  VIEW  $out/$name.png"
    "$build/planet-viewer" "$planet" -o "$out/$name.png" --size 1280x720 --view="$view" "$@"
}

# Two hundred metres above the ground.
shore=$("$build/terraclip" height "$planet" 120 16.5 --synthesis auto | awk '{ print $NF + 200 }')
globe_picture planet -75,25,15000000,0,-90 --fov 60
globe_picture planet-10km 119.9,16,10000,-20,-4 --fov 40 --synthesis auto
globe_picture planet-ground 120,16.5,"$shore",150,-8 --fov 55 --synthesis auto
globe_picture planet-north 0,88,3000000,0,-80
globe_picture planet-south 30,-89,3000000,0,-85

echo "Pictures are in $out; fly yourself with $build/planar-viewer $terrain or $build/planet-viewer $planet"

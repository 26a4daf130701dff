#!/bin/sh
# Default terrain and its pictures: demo.sh BUILD_DIR (by `make demo`). A terrain that is there already is kept.
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
picture coast 112000,103000,1556,200,-7 --fov 45
picture levels 80000,80000,4207,125,-10 --fov 60 --n 127 --level-colours
picture wireframe 80000,80000,4207,125,-14 --fov 60 --n 63 --wireframe --background 0c1420

echo "Pictures are in $out; fly over the terrain yourself with: $build/planar-viewer $terrain"

# said.sh - what the programs tell: counts of flights, what scenes use, help, heights, refusals; read by identity.sh.

# A flight that is only measured: all counts of its statistics, and what was left out.
flight() { # NAME VIEWER TERRAIN FRAMES "VIEW VIEW..." OPTION...
    case_name=stats/$1 viewer=$2-viewer terrain=$3 frames=$4
    printf '%s\n' $5 >"$work/path.txt"
    shift 5
    selected "$case_name" || return
    at_hand "$terrain" || { skipped "$case_name" 'no such terrain at hand'; return; }
    mkdir -p "$work/in/paths"
    cp "$work/path.txt" "$work/in/paths/${case_name#stats/}.txt"
    both "$case_name" "$viewer" "$terrain" --backend $backend --size 160x120 --path "in/paths/${case_name#stats/}.txt" \
        --frames "$frames" --stats "out/$case_name.json" "$@"
    ended_well "$case_name" || return
    texts_differ timeless "out/$case_name.json"
    verdict "$case_name" "$(sed -n 's/.*"samples_updated": \([0-9]*\).*/\1 samples updated/p' \
        "$work/after/out/$case_name.json")"
}

compare_flights() {
    over='9000,8000,1400,40,-12 16000,12000,900,300,-3 20000,22000,3000,200,-20 2000,28000,9000,90,-40'
    rocks='500,900,2500,40,-12 14000,2000,3000,300,-20 9000,9000,2100,200,-5'
    flight land planar in/land.tif 30 "$over"
    flight land-slow planar in/land.tif 30 "$over" --budget 9000 --n 127
    flight land-bare planar in/land.tif 20 "$over" --unlit --background 102030 --n 63 --samples 4
    flight land-abrupt planar in/land.tif 20 "$over" --no-morph --n 31 --level-colours
    flight land-packed planar pack/land.tclip 30 "$over"
    flight rocks-lossless planar pack/rocks-lossless.tclip 20 "$rocks" --n 127
    flight rocks-lh04 planar pack/rocks-lh04.tclip 20 "$rocks" --n 63
    flight rocks-bound planar pack/rocks-loose.tclip 20 "$rocks" --n 63 --budget 5000
    flight land-old planar ../before/pack/land.tclip 20 "$over"
    flight holes planar in/holes.asc 20 '1000,1000,3000,45,-20 20000,18000,4000,240,-20' --voids hole
    flight holes-packed planar pack/holes.tclip 20 '1000,1000,3000,45,-20 20000,18000,4000,240,-20' --n 31
    flight tiny planar in/three.asc 5 '0,0,200,45,-20 60,30,300,220,-50' --spacing 30
    around='170,10,2e6,0,-60 -170,20,1e6,30,-50 -150,89,5e5,0,-40'
    down='119.9,16,3000000,0,-80 119.9,16,60000,40,-30 119.9,16.2,4000,90,-5 121,17,4000,90,-5'
    south='0,-50,400000,180,-20 10,-58,200000,170,-20 40,-89,90000,90,-10 -120,-80,300000,0,-30'
    flight planet planet in/planet.tif 20 "$around"
    flight planet-down planet in/planet.tif 30 "$down"
    flight planet-slow planet in/planet.tif 20 "$south" --budget 20000 --n 256
    flight planet-bare planet in/planet.tif 15 "$down" --unlit --background 000000 --n 128 --steps 8 --levels 6
    flight planet-ch06 planet in/planet.tif 15 "$down" --scheme rings-ch06
    flight planet-packed planet pack/planet.tclip 30 "$around"
    flight planet-packed-south planet pack/planet.tclip 20 "$south"
    flight pits-lossless planet pack/pits-lossless.tclip 15 "$down" --n 256
    flight planet-old planet ../before/pack/planet.tclip 20 "$south"
    flight region planet in/holes.asc 15 '8.1,45.9,9000,0,-30 8.2,46.1,3000,90,-10' --voids hole
    flight pits planet pack/pits.tclip 15 "$around" --n 128
    flight sierra planar pack/sierra.tclip 20 '40000,60000,5000,120,-10 90000,30000,6000,40,-20'
    flight tatra planar pack/tatra.tclip 20 '149000,5000,3500,0,-12 160000,20000,3500,90,-8' --n 127
    flight moon planet pack/moon.tclip 20 '-14,-52,80000,180,-16 20,-70,60000,160,-16 60,-88,30000,100,-10'
    flight moon-lossless planet pack/moon-lossless.tclip 10 '0,0,900000,0,-60 10,5,50000,60,-16' --n 256
}

# Any command: all that it prints, and how it ends.
says() { # NAME PROGRAM ARGUMENT...
    case_name=said/$1
    shift
    selected "$case_name" || return
    both "$case_name" "$@"
    compare_said "$case_name"
}

# What a scene uses and leaves out. The number of the driver's threads is not the programs' affair.
explains() { # NAME VIEWER TERRAIN OPTION...
    case_name=explain/$1 viewer=$2-viewer terrain=$3
    shift 3
    selected "$case_name" || return
    at_hand "$terrain" || { skipped "$case_name" 'no such terrain at hand'; return; }
    both "$case_name" "$viewer" "$terrain" --backend $backend --size 96x64 --explain -o "out/$case_name.ppm" "$@"
    ended_well "$case_name" || return
    texts_differ without_threads "out/$case_name.stdout"
    verdict "$case_name" "$(wc -l <"$work/after/out/$case_name.stdout") lines"
}

without_threads() { # FILE
    sed -E 's/^(uses: threads: .*; )[0-9]+ of the driver/\1of the driver/' "$1"
}

compare_texts() {
    explains land planar in/land.tif
    explains land-low planar in/land.tif --view 16000,12000,700,300,-3 --n 63
    explains land-bare planar in/land.tif --unlit --background 000000 --samples 1 --no-morph
    explains land-packed planar pack/land.tclip --level-colours
    explains holes planar in/holes.asc --voids hole --wireframe
    explains planet planet in/planet.tif
    explains planet-ground planet in/planet.tif --view 10,5,3000,30,-5
    explains planet-bare planet in/planet.tif --unlit --background 000000 --samples 1 --scheme rings-ch06
    explains planet-pole planet pack/planet.tclip --view 10,-89.9,9000,30,-5
    explains region planet in/holes.asc --voids hole --view 8.15,45.9,9000,0,-30
    explains moon planet pack/moon.tclip --view=-14,-52,80000,180,-16

    for program in planar-viewer planet-viewer terraclip; do
        says help-$program $program --help
        says version-$program $program --version
        says nothing-$program $program
        says option-$program $program --nonsense
        says missing-$program $program in/missing.tif
    done
    for command in synth pack info extract height; do
        says help-$command terraclip $command --help
        says bare-$command terraclip $command
        says option-$command terraclip $command --nonsense
    done
    says refused-view planar-viewer in/land.tif --view 1,2,3
    says refused-n planar-viewer in/land.tif --n 100 -o out/x.ppm
    says refused-steps planet-viewer in/planet.tif --steps 7 -o out/x.ppm
    says refused-scheme planet-viewer in/planet.tif --scheme hex -o out/x.ppm
    says refused-place planet-viewer in/seventeen.asc -o out/x.ppm
    says refused-globe planet-viewer in/land.tif -o out/x.ppm
    says refused-format planar-viewer in/land.tif -o out/x.txt
    says refused-lh04 terraclip pack in/land.tif --codec lh04 --lossless -o out/x.tclip
    says refused-planet terraclip pack in/land.tif --planet -o out/x.tclip
    says info-other terraclip info in/land.tif
    says height-land terraclip height in/land.tif 5000 12000
    says height-land-level terraclip height in/land.tif 5000 12000 --level 5
    says height-outside terraclip height in/land.tif -- -5000 12000
    says height-planet terraclip height in/planet.tif 119.71 16.7
    says height-planet-pole terraclip height in/planet.tif 33 89.99
    says height-holes terraclip height in/holes.asc 8.16 46.14 --voids hole
    says height-holes-filled terraclip height in/holes.asc 8.16 46.14 --voids fill -v
}

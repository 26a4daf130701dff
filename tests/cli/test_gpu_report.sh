#!/bin/sh
# `make gpu-report` in a short form: the folder is made, moved, and run with nothing but a system's common tools. What it
# is given to compare with decides what it says, and what fails does not keep the rest from being measured.
. "${0%/*}/lib.sh"
case $build in */sanitize | */thread)
    skip 'the folder for GPUs, which runs without suppressions'
    finish ;;
esac
limit=120
export TERRACLIP_GPU_SCHEMES=square TERRACLIP_GPU_QUICK=1 TERRACLIP_GPU_FRAMES=0.05

mkdir -p made/tests tools
cp "$build/tests/gpu_figures" made/tests/
printf '#!/bin/sh\necho "OpenGL: $TERRACLIP_BACKEND, $TERRACLIP_SWEEP; 0 cracks"\n' >made/tests/test_good
printf '#!/bin/sh\necho "OpenGL: none"\nexit 3\n' >made/tests/test_bad
chmod +x made/tests/*
does '' sh "$root/tests/gpu/folder.sh" made folder test_good test_bad
rm -r made
mv folder moved
for tool in awk cat cut date dirname env getconf grep head mkdir mktemp rm sed sh sort tail timeout tr uname wc xargs; do
    ln -s "$(command -v $tool)" tools/
done

runs() { # EXIT
    run env -i PATH="$work/tools" TERRACLIP_GPU_SCHEMES="${2:-square}" TERRACLIP_GPU_QUICK=1 TERRACLIP_GPU_FRAMES=0.05 \
        TERRACLIP_SWEEP=99 sh moved/run.sh
    [ $rc = "$1" ] || report "exit code $rc instead of $1" "$(tail -n 3 stdout.txt)"
    [ ! -s stderr.txt ] || report 'something on stderr' run.sh
}
holds() { # REGEX WHAT [FILE]
    cases=$((cases + 1))
    grep -Eq -- "$1" "${3:-moved/gpu.csv}" || fail "$2: ${3:-moved/gpu.csv} does not hold $1"
}
count() { # NUMBER REGEX WHAT
    cases=$((cases + 1))
    found=$(grep -Ec -- "$2" moved/gpu.csv)
    [ "$found" = "$1" ] || fail "$3: $found rows instead of $1 with $2"
}

runs 1
count 6 '^square,(ground|aircraft|space),(192x108|384x216),gpu_p99_ms,[0-9.e-]+,ms,,,"?.' 'times of frames'
count 6 '^square,[a-z]+,[0-9x]+,triangles,[1-9][0-9]*,,[1-9][0-9]*,same,"?.' 'counts'
count 6 '^square,[a-z]+,[0-9x]+,error_rms,[0-9.e-]+,px,[0-9.e-]+,(same|differs),' 'errors'
count 6 '^square,[a-z]+,[0-9x]+,share_off,[0-9.e-]+,%,,(same|differs),' 'pictures'
count 0 ',wrong,' 'as in software'
count 0 ',$' 'every figure says what drew it'
holds '^test_good,,,test,"passed in [0-9]+ s",,,passed,' 'a test that passes'
holds '^test_bad,,,test,"FAILED \(3\) in [0-9]+ s",,,failed,' 'a test that fails'
holds '^OpenGL: auto, 99; 0 cracks' 'what tests are asked for' moved/logs/tests.log
holds '<tr class="bad"><td>test_bad' 'the page' moved/index.html
holds '^ +square +space +384x216 .*same' 'the table' stdout.txt

# Another picture and other figures than software's.
rm moved/programs/test_bad
black=moved/software/pictures/square-ground-192x108.pgm
{ printf 'P5\n192 108\n255\n'; head -c 20736 /dev/zero; } >$black
sed -i -e 's/^\(square,ground,192x108,triangles,\)[0-9]*/\17/' -e 's/^\(square,space,192x108,error_rms,\)[0-9.e-]*/\11e-9/' \
    moved/software/square.csv
runs 1
holds '^square,ground,192x108,grey_mean,[0-9.]+,greys,,wrong,' 'another picture'
holds '^square,ground,192x108,triangles,[0-9]+,,7,differs,' 'other triangles'
holds '^square,space,192x108,error_rms,[0-9.]+,px,1e-09,wrong,' 'a larger error'
holds 'What is not as in software' 'what differs' stdout.txt
count 3 ',wrong,' 'wrong figures' # of the picture two

# Without a picture nothing is compared; what cannot run is told, and the rest goes on.
rm $black
sed -i '/error_rms\|triangles/d' moved/software/square.csv
runs 1 'nonsense square'
holds '^nonsense,,,failed,"exit code 2: usage' 'a program that fails'
holds 'no software picture: not compared' 'a lost picture' stdout.txt
count 6 '^square,[a-z]+,[0-9x]+,gpu_ms,' 'the rest'
runs 0
rm tools/awk
runs 0
holds 'awk is missing' 'a missing tool' stdout.txt
rm moved/programs/gpu_figures
runs 1
holds '^square,,,failed,"exit code 12[67]: ' 'a missing program'
finish

#!/bin/sh
# Makes a folder that measures a machine with a GPU, with neither this tree nor a compiler there: folder.sh BUILD OUT
# TEST... OUT gets the programs, the tests named, the libraries of theirs that not every machine has, and run.sh, which
# then draws in software what is to be compared with. What was drawn in software since the program was made is kept.
set -eu
here=${0%/*} build=$1 out=$2
shift 2
mkdir -p "$out/programs" "$out/lib" "$out/page"
for program in gpu_figures "$@"; do
    rm -f "$out/programs/$program"
    strip -o "$out/programs/$program" "$build/tests/$program" 2>/dev/null ||
        cp "$build/tests/$program" "$out/programs/$program"
    # The C library comes with the system.
    ldd "$build/tests/$program" 2>/dev/null | awk '/=> \// && !/\/lib(c|m|dl|pthread|rt)\.so/ { print $3 }'
done | sort -u | while read -r library; do cp -L "$library" "$out/lib/"; done
cp "$here/run.sh" "$out/run.sh"
cp "$here/../run.sh" "$out/programs/run-tests.sh"
cp "$here"/*.awk "$here/../report/csv.awk" "$here/../report/table.awk" "$here/../report/escape.awk" \
    "$here/../report/style.css" "$out/page/"
if [ -n "$(find "$out/software" -name '*.csv' ! -newer "$build/tests/gpu_figures" 2>/dev/null)" ]; then
    rm -rf "$out/software" "$out/terrains" # the generators may have changed
fi
sh "$out/run.sh" software

#!/bin/sh
# Files must not depend on the compiler: builds the core and pack_sums.c anew in other ways, runs each and prints
# "NAME: SUMS", or "NAME: skipped, WHY": compilers.sh FOLDER LIBRARY. LIBRARY is the one that make has built. What is
# newer than the sources is not built again.
folder=$1 library=$2
here=${0%/*}
# What packing takes; the rest of the core would be compiled for nothing.
core=$(make -s --no-print-directory print-core | tr ' ' '\n' | grep -E '^common/(base|field|synthesis|codec|chart|packed)/') || exit 1
mkdir -p "$folder" || exit 1

build() { # NAME COMPILER FLAG...
    name=$1 compiler=$2; shift 2
    if ! command -v "$compiler" > /dev/null; then
        echo "$name: skipped, no $compiler"
        return
    fi
    program=$folder/pack-sums-$name
    if [ ! -x "$program" ] || [ -n "$(find common "$here/pack_sums.c" "$0" "$library" -newer "$program")" ]; then
        set -- "$@" "$here/pack_sums.c"
        if [ "$name" = library ]; then set -- "$@" "$library"; else set -- "$@" $core; fi
        "$compiler" -std=c11 -D_GNU_SOURCE -pthread -ffp-contract=off -I. -DTC_VERSION='"test"' -w "$@" \
            -o "$program" -lm || { echo "$name: cannot be built"; return; }
    fi
    echo "$name: $("$program" "$folder")"
}

# In the order of what is compared: the first one is what the others are held against.
build library "${CC:-cc}" -O2
build gcc-O0 gcc -O0
# Most of a minute of compiling.
if [ "${TERRACLIP_SWEEP:-}" = whole ]; then
    build clang-O2 clang -O2
else
    echo 'clang-O2: skipped, it is for make test-extreme'
fi

# lib.sh - what the command-line tests share. A test begins with
#     . "${0%/*}/lib.sh"
# gets the build folder as its argument, and ends with `finish`. It runs in an empty folder of its own ($work), where
# ./out is for what the programs write. One case is one line: refuses, accepts, or any command followed by || fail.

set -u
build=$(cd "${1:-build}" && pwd) || exit 99
root=$(cd "${0%/*}/../.." && pwd)
viewer=$build/planar-viewer
globe=$build/planet-viewer
terraclip=$build/terraclip
make_file=$build/tests/make-file
compare=$build/tests/compare-heights
make_picture=$build/tests/make-picture
used=$build/tests/used
work=$(mktemp -d "${TMPDIR:-/tmp}/terraclip-cli-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
cd "$work" || exit 99
mkdir out
export MESA_SHADER_CACHE_DIR="${MESA_SHADER_CACHE_DIR:-$work/shaders}"
picture='-o out/picture.png --size 96x64' # what most cases write; split into words where it is used
limit=20                                  # seconds that a case may take
case $build in
*/sanitize) # Leaks are the unit tests' affair: here LeakSanitizer falls over threads of libraries that are just ending.
    limit=90
    export ASAN_OPTIONS="detect_leaks=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}" ;;
esac
cases=0 failures=0 skips=0

fail() { # MESSAGE
    failures=$((failures + 1))
    echo "FAILED: $1"
}

skip() { # MESSAGE
    skips=$((skips + 1))
    echo "skipped: $1"
}

# Runs a command; sets $rc and leaves what it said in stdout.txt and stderr.txt.
run() { # COMMAND...
    cases=$((cases + 1))
    timeout -k 5 $limit "$@" >stdout.txt 2>stderr.txt </dev/null
    rc=$?
}

# A command must end with this code, one line on stderr that names the program and matches the regular expression
# (warnings may come before it), nothing on stdout and no file in out/.
refuses() { # EXIT REGEX COMMAND...
    expected=$1 regex=$2
    shift 2
    run "$@"
    wrong=
    [ $rc = "$expected" ] || wrong="exit code $rc instead of $expected"
    grep -Ev '^(planar-viewer|planet-viewer|terraclip): warning: ' stderr.txt >error.txt
    lines=$(wc -l <error.txt)
    [ "$lines" = 1 ] || wrong="$wrong, $lines lines on stderr instead of 1"
    grep -Eq '^(planar-viewer|planet-viewer|terraclip): ' error.txt || wrong="$wrong, stderr does not name the program"
    grep -Eq -- "$regex" error.txt || wrong="$wrong, stderr does not match '$regex'"
    [ ! -s stdout.txt ] || wrong="$wrong, something on stdout"
    [ -z "$(ls -A out)" ] || wrong="$wrong, left behind: $(ls -A out)"
    [ -z "$wrong" ] || report "$wrong" "$@"
    rm -rf out && mkdir out
}

# Runs a command; $wrong says what is not as it should be: an end with 0, on stderr only what matches the regular
# expression ('' for nothing at all).
ends_well() { # REGEX COMMAND...
    regex=$1
    shift
    run "$@"
    wrong=
    [ $rc = 0 ] || wrong="exit code $rc instead of 0"
    if [ -z "$regex" ]; then
        [ ! -s stderr.txt ] || wrong="$wrong, something on stderr"
    else
        grep -Eq -- "$regex" stderr.txt || wrong="$wrong, stderr does not match '$regex'"
    fi
}

# A command must end with 0, on stderr only what matches the regular expression ('' for nothing at all), and write the
# picture; which is then last.png.
accepts() { # REGEX COMMAND...
    ends_well "$@"
    shift
    is_png out/picture.png || wrong="$wrong, no picture"
    [ "$(ls -A out)" = picture.png ] || wrong="$wrong, in out/: $(ls -A out)"
    [ -z "$wrong" ] || report "$wrong" "$@"
    rm -f last.png
    [ -f out/picture.png ] && mv out/picture.png last.png
    rm -rf out && mkdir out
}

# A command must end with 0; sets $out to what it printed. Warnings must match the regular expression ('' for none).
does() { # REGEX COMMAND...
    ends_well "$@"
    shift
    [ -z "$wrong" ] || report "$wrong" "$@"
    out=$(cat stdout.txt)
}

# Both files hold the same heights.
equal() { # FILE FILE SETTING...
    cases=$((cases + 1))
    difference=$($compare "$@") || fail "$1 and $2 differ: $difference"
}

report() { # WHAT COMMAND...
    what=$1
    shift
    fail "$what: $*"
    sed 's/^/    /' stderr.txt | head -n 12
}

is_png() { # FILE
    [ "$(dd if="$1" bs=1 skip=1 count=3 2>/dev/null)" = PNG ]
}

# Both pictures hold the same bytes.
same() { # FILE FILE WHAT
    cases=$((cases + 1))
    cmp -s "$1" "$2" || fail "pictures differ: $3"
}

different() { # FILE FILE WHAT
    cases=$((cases + 1))
    ! cmp -s "$1" "$2" || fail "pictures are the same: $3"
}

finish() {
    echo "$cases cases, $failures failed, $skips skipped"
    [ $failures = 0 ]
    exit
}

#!/bin/sh
# Runs test programs and scripts, as many at a time as there are processors (TERRACLIP_JOBS): run.sh BUILD_DIR TEST...
# What each prints is shown when it ends; a last line sums up. Ends with 1 where any failed. The first ones are begun
# first, so that long ones had better come first.
build=$1; shift

if [ "${TERRACLIP_RESULTS:-}" ]; then # one test, of those below
    t=$1
    log=$TERRACLIP_RESULTS/${t##*/}.log
    start=$(date +%s)
    case "$t" in
        *.sh) sh "$t" "$build" ;;
        *) "$t" ;;
    esac >"$log" 2>&1 </dev/null
    rc=$?
    [ $rc = 0 ] && result=passed || result="FAILED ($rc)"
    echo "== ${t##*/}: $result in $(($(date +%s) - start)) s" >>"$log"
    cat "$log" # in one write or a few, so that two that end together stay apart, mostly; the sum below reads the files
    exit 0
fi

export TERRACLIP_BUILD="$build" TERRACLIP_GL_DEBUG=1
case "$build" in
    *sanitize) # what the driver and the input libraries lose is not ours; only one file of suppressions is read
        cat "${0%/*}"/support/lsan*.supp > "$build/lsan.supp"
        export UBSAN_OPTIONS="print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}"
        suppressions=$(cd "$build" && pwd)/lsan.supp
        export LSAN_OPTIONS="suppressions=$suppressions:print_suppressions=0${LSAN_OPTIONS:+:$LSAN_OPTIONS}" ;;
    *thread)
        suppressions=$(cd "${0%/*}" && pwd)/support/tsan.supp
        export TSAN_OPTIONS="suppressions=$suppressions:print_suppressions=0${TSAN_OPTIONS:+:$TSAN_OPTIONS}" ;;
esac
TERRACLIP_RESULTS=$(mktemp -d "${TMPDIR:-/tmp}/terraclip-results-XXXXXX") || exit 99
export TERRACLIP_RESULTS
case "$build" in # compiling shaders is half of what a program takes to draw one picture
    *sanitize | *thread) export MESA_SHADER_CACHE_DISABLE=true ;;
    *) export MESA_SHADER_CACHE_DIR="$TERRACLIP_RESULTS/shaders" ;;
esac
trap 'rm -rf "$TERRACLIP_RESULTS"' EXIT
trap 'exit 130' INT TERM
printf '%s\n' "$@" | xargs -P "${TERRACLIP_JOBS:-$(getconf _NPROCESSORS_ONLN)}" -I TEST sh "$0" "$build" TEST
passed=0; failures=
for t; do
    if tail -n 1 "$TERRACLIP_RESULTS/${t##*/}.log" 2>/dev/null | grep -q '^== .*: passed in '; then
        passed=$((passed + 1))
    else
        failures="$failures ${t##*/}"
    fi
done
[ -z "$failures" ] || echo "failed:$failures"
echo "$passed passed, $(($# - passed)) failed"
[ -z "$failures" ]

#!/bin/sh
# Runs test programs and scripts one after the other: run.sh BUILD_DIR TEST...
# Each prints its own result; a last line sums up. Ends with 1 where any failed.
build=$1; shift
export MESA_SHADER_CACHE_DISABLE=true TERRACLIP_BUILD="$build" TERRACLIP_GL_DEBUG=1
case "$build" in
    *sanitize) # what the driver and the input libraries lose is not ours; only one file of suppressions is read
        cat "${0%/*}"/support/lsan*.supp > "$build/lsan.supp"
        export UBSAN_OPTIONS="print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}"
        suppressions=$(cd "$build" && pwd)/lsan.supp
        export LSAN_OPTIONS="suppressions=$suppressions:print_suppressions=0${LSAN_OPTIONS:+:$LSAN_OPTIONS}" ;;
esac
passed=0; failed=0; failures=
for t; do
    start=$(date +%s)
    case "$t" in
        *.sh) sh "$t" "$build" ;;
        *) "$t" ;;
    esac
    rc=$?
    echo "== ${t##*/}: $([ $rc = 0 ] && echo passed || echo "FAILED ($rc)") in $(($(date +%s) - start)) s"
    if [ $rc = 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)); failures="$failures ${t##*/}"; fi
done
[ -z "$failures" ] || echo "failed:$failures"
echo "$passed passed, $failed failed"
[ $failed = 0 ]

#!/bin/sh
# Runs the fuzzers: run.sh BUILD_DIR SECONDS CLANG. Each gets an equal share of the time and starts from the seeds in the
# tree and what it found before. Inputs that break something are left in BUILD_DIR/findings and named at the end.
set -u
build=$1 seconds=$2 clang=$3
root=$(cd "${0%/*}/../.." && pwd)
cd "$root" || exit 1

can_fuzz() { # whether this clang comes with the fuzzer's and the sanitizers' runtimes
    command -v "$clang" >/dev/null 2>&1 || return 1
    mkdir -p "$build"
    echo 'int LLVMFuzzerTestOneInput(const char *d, long n); int LLVMFuzzerTestOneInput(const char *d, long n)
          { return !d && n; }' >"$build/try.c"
    "$clang" -fsanitize=fuzzer,address,undefined "$build/try.c" -o "$build/try" >/dev/null 2>&1
}

can_fuzz || sh .ci/packages clang libclang-rt-dev || true
if ! can_fuzz; then
    echo "fuzz: skipped: no clang with libFuzzer here (Debian: clang, libclang-rt-dev)"
    exit 0
fi
fuzzers="reader tile"
set -- $fuzzers
share=$((seconds / $#))
[ $share -gt 0 ] || share=1
for f in $fuzzers; do
    make --no-print-directory "$build/$f" || exit 1
done
mkdir -p "$build/findings"
rc=0
for f in $fuzzers; do
    mkdir -p "$build/found-$f"
    case $f in reader) most=8000 ;; *) most=4096 ;; esac
    echo "fuzz: $f for $share s"
    "$build/$f" -max_total_time=$share -timeout=20 -rss_limit_mb=1024 -malloc_limit_mb=256 -max_len=$most \
        -print_final_stats=1 -verbosity=1 -artifact_prefix="$build/findings/$f-" "$build/found-$f" \
        "tests/fuzz/corpus/$f" >"$build/$f.log" 2>&1 || rc=1
    grep -E 'ERROR|SUMMARY|runtime error|^fuzz_' "$build/$f.log"
    echo "fuzz: $f: $(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$f.log") executions," \
        "$(grep -Eo 'cov: [0-9]+' "$build/$f.log" | tail -n 1 | sed 's/cov: //') edges"
done
if [ $rc != 0 ] || [ -n "$(ls -A "$build/findings")" ]; then
    echo "fuzz: findings:"
    ls "$build/findings"
    rc=1
fi
exit $rc

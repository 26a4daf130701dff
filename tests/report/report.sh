#!/bin/sh
# Measures, and makes a page of it: report.sh BUILD quick|full. The page is BUILD/report/index.html, the tables that it
# draws lie beside it. Goes on after a failure, which the page shows; ends with 1 where there was any.
set -u
build=${1:?} mode=${2:?} here=${0%/*} out=$1/report
case $mode in quick | full) ;; *) echo "report: $mode: expected quick or full" >&2; exit 2 ;; esac
start=$(date +%s)
trap 'exit 130' INT TERM
sh "$here/measure.sh" "$build" "$mode" "$out"
measured=$?
[ $measured -lt 2 ] || exit $measured
echo "report: the page"
sh "$here/page.sh" "$out" || { echo "report: no page" >&2; exit 1; }
echo "report: $out/index.html, after $(($(date +%s) - start)) s"
[ $measured = 0 ] || echo "report: not all measurements were made; the page says which and why" >&2
exit $measured

#!/bin/sh
# The proof that a change of the code changes nothing that is drawn, packed or printed:
#
#   identity.sh BEFORE_BUILD_DIR AFTER_BUILD_DIR [WORK_DIR]
#
# The folders hold planar-viewer, planet-viewer and terraclip with their plugins. Both builds do the same work side by
# side, and what they made is compared: pictures by their pixels, packed files by their bytes, what is told by its text
# without times. A line a case: same, explained (in expected.txt), DIFFERENT, BROKEN (both builds failed, so nothing was
# compared) or skipped; then how many. Ends with 1 where anything is DIFFERENT or BROKEN.
#
# Terrains are synthesised; real ones are added where TERRACLIP_DATA names their folder; FULL=1 packs the large ones
# whole in every mode. ONLY='view/planet-*' runs the cases of that pattern. VIEW_OPTIONS='--samples 1' draws all
# pictures so, for a change that is meant to change how samples add up and nothing else. In a WORK_DIR everything stays
# to be looked at, and what BEFORE made is used again by the next run as long as its programs and the command are the
# same.
set -u
here=$(cd "$(dirname "$0")" && pwd) || exit 99
usage() { echo "usage: identity.sh BEFORE_BUILD_DIR AFTER_BUILD_DIR [WORK_DIR]" >&2 && exit 2; }
[ $# = 2 ] || [ $# = 3 ] || usage
before=$(cd "$1" && pwd) && after=$(cd "$2" && pwd) || usage
for build in "$before" "$after"; do
    for program in planar-viewer planet-viewer terraclip; do
        [ -x "$build/$program" ] || { echo "identity: $build/$program: expected a program" >&2; exit 2; }
    done
done
if [ $# = 3 ]; then
    mkdir -p "$3" && work=$(cd "$3" && pwd) || exit 99
else
    work=$(mktemp -d "${TMPDIR:-/tmp}/terraclip-identity-XXXXXX") || exit 99
    trap 'rm -rf "$work"' EXIT
fi
trap 'exit 130' INT TERM

. "$here/lib.sh"
. "$here/inputs.sh"
. "$here/packs.sh"
. "$here/views.sh"
. "$here/said.sh"
started=$(date +%s)
begin_work
make_inputs
compare_packs
compare_views
compare_flights
compare_texts
finish

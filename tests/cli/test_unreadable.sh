#!/bin/sh
# A part of a packed terrain that cannot be read, as on a disk that is failing: viewers say so in one line, offscreen
# and in a window, where it is shown coarser.
. "${0%/*}/lib.sh"

case $build in */sanitize) skip 'a library before that of a sanitizer'; finish; exit ;; esac
cat >broken.c <<'end'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <unistd.h>
/* Bytes from BROKEN_FROM on cannot be read while there is a file of the name BROKEN. */
static int is_broken(long long offset, size_t size)
{
    const char *from = getenv("BROKEN_FROM"), *while_there = getenv("BROKEN");
    errno = EIO;
    return from && offset + (long long)size > atoll(from) && access(while_there, F_OK) == 0;
}
ssize_t pread(int file, void *bytes, size_t size, off_t offset)
{
    ssize_t (*real)(int, void *, size_t, off_t) = (ssize_t(*)(int, void *, size_t, off_t))dlsym(RTLD_NEXT, "pread");
    return is_broken(offset, size) ? -1 : real(file, bytes, size, offset);
}
ssize_t pread64(int file, void *bytes, size_t size, off64_t offset)
{
    ssize_t (*real)(int, void *, size_t, off64_t) = (ssize_t(*)(int, void *, size_t, off64_t))dlsym(RTLD_NEXT, "pread64");
    return is_broken(offset, size) ? -1 : real(file, bytes, size, offset);
}
end
"${CC:-cc}" -shared -fPIC -o broken.so broken.c -ldl 2>/dev/null || { skip 'no compiler'; finish; exit; }

$terraclip synth -q --size 1025 -o hills.tif || fail 'making a terrain'
$terraclip pack -q hills.tif -o hills.tclip --rms 0.5 || fail 'packing'
size=$(wc -c <hills.tclip)
export BROKEN_FROM=$((size * 9 / 10)) BROKEN="$work/broken"
warnings() { # COUNT REGEX
    [ "$(grep -Ec -- "$2" stderr.txt)" = "$1" ] || fail "expected $1 warnings '$2', found: $(cat stderr.txt)"
}

# ---- Offscreen

view='--view 15000,29000,900,0,-60'
touch broken
refuses 1 'a part of it cannot be read' env LD_PRELOAD="$work/broken.so" $viewer hills.tclip $view $picture --n 255
warnings 1 '^planar-viewer: warning: hills.tclip: [1-9][0-9]* tiles could not be read$'
rm broken
accepts '' env LD_PRELOAD="$work/broken.so" $viewer hills.tclip $view $picture --n 255

# ---- In a window

command -v xvfb-run >/dev/null 2>&1 || { skip 'xvfb-run is not installed'; finish; exit; }
unset WAYLAND_DISPLAY
printf '15000,29000,900,0,-60\n15001,29000,900,0,-60\n' >still.txt
touch broken
limit=60
run xvfb-run -a -s '-screen 0 800x600x24 -noreset' env LD_PRELOAD="$work/broken.so" $viewer hills.tclip --size 320x240 --n 255 \
    --backend window --path still.txt --frames 200
[ $rc = 0 ] || report 'a window whose file cannot be read' $rc
warnings 1 'warning: hills.tclip: .* cannot be read and (are|is) shown coarser; .* will be tried again$'
warnings 0 'could not be read'
finish

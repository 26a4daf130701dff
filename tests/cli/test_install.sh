#!/bin/sh
# make install: into a staging folder; what lies there works from there, and a program can be built against it.
. "${0%/*}/lib.sh"

case $build in */debug | */sanitize) config=${build##*/} ;; *) config=release ;; esac
stage=$work/stage
unset MAKEFLAGS MAKELEVEL MFLAGS
if ! make -C "$root" config=$config install PREFIX=/usr DESTDIR="$stage" >install.txt 2>&1; then
    fail 'make install'
    tail -n 5 install.txt
    finish
fi

cases=$((cases + 1))
wanted='./bin/planar-viewer ./bin/planet-viewer ./bin/terraclip ./include/terraclip.h ./lib/libterraclip.a ./lib/libterraclip.so.'"$(cat "$root/VERSION")"' ./lib/pkgconfig/terraclip.pc
./lib/terraclip/terraclip-gdal.so ./lib/terraclip/terraclip-oiio.so ./lib/terraclip/terraclip-video.so ./lib/terraclip/terraclip-window.so
./share/applications/planar-viewer.desktop ./share/applications/planet-viewer.desktop
./share/bash-completion/completions/planar-viewer ./share/bash-completion/completions/planet-viewer ./share/bash-completion/completions/terraclip
./share/icons/hicolor/256x256/apps/terraclip.png ./share/icons/hicolor/scalable/apps/terraclip.svg
./share/man/man1/planar-viewer.1 ./share/man/man1/planet-viewer.1 ./share/man/man1/terraclip-extract.1 ./share/man/man1/terraclip-height.1
./share/man/man1/terraclip-info.1 ./share/man/man1/terraclip-pack.1 ./share/man/man1/terraclip-synth.1 ./share/man/man1/terraclip.1
./share/mime/packages/terraclip.xml'
found=$(cd "$stage/usr" && find . -type f | LC_ALL=C sort | tr '\n' ' ')
[ "$(echo $found)" = "$(echo $wanted)" ] || fail "installed: $found"
[ "$(ls "$stage")" = usr ] || fail "outside of PREFIX: $(ls "$stage")"

# ---- Desktops: entries name programs, icons and kinds of files that are there

for entry in "$stage"/usr/share/applications/*.desktop; do
    cases=$((cases + 1))
    name=${entry##*/} name=${name%.desktop}
    grep -qx "Exec=$name %f" "$entry" && [ -x "$stage/usr/bin/$name" ] || fail "$name.desktop: its program"
    grep -qx "StartupWMClass=$name" "$entry" || fail "$name.desktop: its window" # tests/cli/test_window.sh
    icon=$(sed -n 's/^Icon=//p' "$entry")
    [ -s "$stage/usr/share/icons/hicolor/scalable/apps/$icon.svg" ] || fail "$name.desktop: its icon"
    is_png "$stage/usr/share/icons/hicolor/256x256/apps/$icon.png" || fail "$name.desktop: its icon's pixels"
    for kind in $(sed -n 's/.*type="\([^"]*\)".*/\1/p' "$stage/usr/share/mime/packages/terraclip.xml"); do
        grep -q "^MimeType=.*$kind;" "$entry" || fail "$name.desktop: does not open $kind"
    done
    if command -v desktop-file-validate >/dev/null 2>&1; then
        run desktop-file-validate "$entry"
        { [ $rc = 0 ] && [ ! -s stdout.txt ]; } || fail "$name.desktop: $(cat stdout.txt)"
    fi
done

# ---- Manuals and completion: every option of the help is in both

share=$stage/usr/share
for command in planar-viewer planet-viewer 'terraclip synth' 'terraclip pack' 'terraclip info' 'terraclip extract' 'terraclip height'; do
    page=$share/man/man1/$(echo $command | tr ' ' -).1
    for option in $($stage/usr/bin/$command --help | grep -o '^ *\(-., \)\?--[a-z-]*' | sed 's/.*--/--/'); do
        cases=$((cases + 1))
        sed 's/\\-/-/g' "$page" | grep -q -e "^\.B .*$option" || fail "$page lacks $option"
        found=$(bash -c ". '$share/bash-completion/completions/terraclip'; COMP_WORDS=($command $option)
            COMP_CWORD=\$((\${#COMP_WORDS[@]} - 1)); _terraclip; echo \${COMPREPLY[*]}")
        case " $found " in *" $option "*) ;; *) fail "$command: $option is not completed: $found" ;; esac
    done
done

# ---- The programs, with nothing of the build folder around; also moved as a whole, and by a link

viewer=$stage/usr/bin/planar-viewer
terraclip=$stage/usr/bin/terraclip
run $terraclip synth --size 129 -o hills.tif
[ $rc = 0 ] || report 'installed' $terraclip synth
accepts '' $viewer hills.tif $picture
mv last.png first.png
mkdir elsewhere && mv "$stage/usr" elsewhere/terraclip && ln -s elsewhere/terraclip/bin/planar-viewer shown
accepts '' elsewhere/terraclip/bin/planar-viewer hills.tif $picture
same first.png last.png 'installed and moved'
accepts '' ./shown hills.tif $picture
if [ ! -d /usr/lib/terraclip ] && [ ! -d /usr/local/lib/terraclip ]; then
    mv elsewhere/terraclip/lib/terraclip hidden
    refuses 1 'terraclip-[a-z]*.so: not found' elsewhere/terraclip/bin/planar-viewer hills.tif $picture
    mv hidden elsewhere/terraclip/lib/terraclip
fi
mv elsewhere/terraclip "$stage/usr"

# ---- The library

cat >use.c <<'end'
/* A slope of 100 x 50 samples as a field, and what is read from it. */
#include <terraclip.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(void)
{
    tc_grid grid = {.width = 100, .height = 50, .spacing_x = 30, .spacing_y = 30, .z_max = 99 + 2 * 49};
    grid.z = malloc(100 * 50 * sizeof *grid.z);
    for (int i = 0; grid.z && i < 100 * 50; i++)
        grid.z[i] = (float)(i % 100 + 2 * (i / 100));
    tc_field *field;
    tc_error error;
    if (!grid.z || tc_field_build(&grid, 0, &field, &error) != TC_OK)
        return 1;
    int levels = tc_field_info(field)->levels;
    tc_level coarser = tc_field_level(field, levels - 1);
    float z[6] = {0};
    double height = 0;
    if (tc_field_read(field, levels - 1, (tc_rect){10, 10, 13, 12}, z, NULL, 3) != TC_OK ||
        tc_field_height(field, 45 * 30, 12.5 * 30, &height) != TC_OK)
        return 2;
    printf("%s: %d levels, %dx%d, %.3f %.3f %.3f, %.3f\n", tc_version(), levels, (int)coarser.width,
           (int)coarser.height, z[0], z[1], z[3], height);
    tc_field_destroy(field);
    return tc_exit_code(TC_ERR_USAGE) == 2 && strlen(tc_status_text(TC_ERR_IO)) > 0 ? 0 : 3;
}
end
# Without what /usr itself may hold.
export PKG_CONFIG_LIBDIR="$stage/usr/lib/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$stage"
export LD_LIBRARY_PATH="$stage/usr/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
export PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1
sanitizers=
[ $config != sanitize ] || sanitizers=-fsanitize=address,undefined
version=$(cat "$root/VERSION")
cases=$((cases + 1))
found=$(pkg-config --modversion terraclip 2>&1)
[ "$found" = "$version" ] || fail "pkg-config: $found"
for standard in c11 c99; do
    run ${CC:-cc} -std=$standard -Wall -Wextra -Werror $sanitizers $(pkg-config --cflags terraclip) use.c -o use \
        $(pkg-config --libs terraclip)
    [ $rc = 0 ] || report "-std=$standard" use.c
done
run ./use
{ [ $rc = 0 ] && [ "$(cat stdout.txt)" = "$version: 8 levels, 50x25, 60.000 62.000 64.000, 70.000" ]; } ||
    report "found $(cat stdout.txt)" use
# The header is C++, too.
printf '#include <terraclip.h>\nint main() { return tc_exit_code(TC_OK) + (*tc_version() == 0); }\n' >use.cpp
run ${CXX:-c++} -Wall -Wextra -Werror $sanitizers $(pkg-config --cflags terraclip) use.cpp -o use++ \
    $(pkg-config --libs terraclip)
[ $rc = 0 ] && ./use++ || report 'C++' use.cpp
# The README's example, as C and as C++, prints what the README says.
awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' "$root/README.md" >readme.c
cp readme.c readme.cpp
for compile in "${CC:-cc} -std=c11 readme.c" "${CXX:-c++} -std=c++17 readme.cpp"; do
    run $compile -Wall -Wextra -Werror $sanitizers $(pkg-config --cflags terraclip) -o readme $(pkg-config --libs terraclip)
    [ $rc = 0 ] || report 'README' $compile
    run ./readme
    while read -r line; do
        grep -qF "\`$line\`" "$root/README.md" || fail "the README's example prints $line"
    done <stdout.txt
    [ "$(wc -l <stdout.txt)" = 2 ] || fail "the README's example prints $(wc -l <stdout.txt) lines"
done
# Every function that the header declares is there.
cases=$((cases + 1))
library=$stage/usr/lib/libterraclip.a
for name in $(grep -o '^[^/ ].*\btc_[a-z_]*(' "$root/common/terraclip.h" | grep -o 'tc_[a-z_]*($' | tr -d '('); do
    nm --defined-only "$library" 2>/dev/null | grep -q " T $name\$" || fail "$name is not in the library"
done
# What the shared libraries show are the functions of their headers, and nothing else.
shows() { # LIBRARY HEADER
    cases=$((cases + 1))
    strange=$(nm -D --defined-only "$1" | awk '$2 ~ /[TDBRVW]/ { print $3 }' | grep -Ev '^(_init|_fini|__(asan|odr_asan|ubsan|sanitizer).*)$' |
        while read -r name; do grep -q "\b$name\b" "$2" || echo "$name"; done | head -n 4 | tr '\n' ' ')
    [ -z "$strange" ] || fail "${1##*/} shows $strange"
    for name in $(grep -o '^[^/ ].*\btc_[a-z_]*(' "$2" | grep -o 'tc_[a-z_]*($' | tr -d '('); do
        nm -D --defined-only "$1" | grep -q " T $name\$" || fail "${1##*/} does not show $name"
    done
}
shows "$stage/usr/lib/libterraclip.so" "$root/common/terraclip.h"
shows "$build/libterraclip-draw.so" "$root/common/terraclip_draw.h"
# Nothing in the library needs OpenGL, GDAL or a window; and what it exports has its prefix.
cases=$((cases + 1))
strange=$(nm -u "$library" 2>/dev/null | grep -Ei ' (gl[A-Z]|egl|osmesa|gdal|glfw|dlopen)' | head -n 3)
[ -z "$strange" ] || fail "the library needs $strange"
strange=$(nm --defined-only -g "$library" 2>/dev/null | grep -E ' [TDBRC] ' | grep -v ' tc_' |
    grep -Ev '__(asan|odr_asan|ubsan|sanitizer)' | head -n 3)
[ -z "$strange" ] || fail "the library exports $strange"

finish

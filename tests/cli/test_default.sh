#!/bin/sh
# A viewer without a file, on a display of its own: its window shows the default terrain, which is made once, into the
# cache. Whatever comes between, what lies there is whole.
. "${0%/*}/lib.sh"
. "$root/tests/cli/window.sh"
on_own_display "$0"
case $build in */sanitize | */thread)
    skip 'makes a terrain, which takes minutes with sanitizers'
    finish ;;
esac

export XDG_CACHE_HOME="$work/cache"
version=$(cat "$root/VERSION")
folder=$XDG_CACHE_HOME/terraclip
terrain=$folder/terrain-$version.tclip
planet=$folder/planet-$version.tclip
patience=1800 # a terrain is made

holds() { # WHAT FILE...: the cache has these files, and no others
    cases=$((cases + 1))
    what=$1
    shift
    [ "$(ls -A "$folder" | tr '\n' ' ')" = "$*${*:+ }" ] || fail "$what: in the cache: $(ls -A "$folder" | tr '\n' ' ')"
}
making() { [ -e "$terrain.making" ]; }

# ---- Without a display, or with what is no window, a file is expected as before

refuses 2 'TERRAIN: expected a file, found none' env -u DISPLAY $viewer
refuses 2 'TERRAIN: expected a file, found none' env -u DISPLAY $globe
refuses 2 'TERRAIN: expected a file, found none' env DISPLAY= WAYLAND_DISPLAY= $viewer
refuses 2 'TERRAIN: expected a file, found none' $viewer $picture
refuses 2 'TERRAIN: expected a file, found none' $viewer --path views.txt --frames 5
refuses 2 'TERRAIN: expected a file, found none' $viewer --path views.txt --frames 5 --video out/film.mp4
refuses 2 'TERRAIN: expected a file, found none' $viewer --backend egl
cases=$((cases + 1))
[ ! -e "$XDG_CACHE_HOME" ] || fail 'a refused viewer made a cache'

# ---- What is in its way: one line, and nothing is left

refuses 1 'the default terrain cannot be kept in /proc/nothing: ' env XDG_CACHE_HOME=/proc/nothing $viewer
refuses 1 'TERRAIN: expected a file, or .XDG_CACHE_HOME or .HOME' env -u XDG_CACHE_HOME -u HOME $viewer
: >plain
refuses 1 'the default terrain cannot be kept in .*: Not a directory' env XDG_CACHE_HOME="$work/plain" $viewer
mkdir alone
cp "$viewer" alone && cp "$build"/terraclip-window.so alone
refuses 1 'the default terrain cannot be made: .*/alone/terraclip: No such file' alone/planar-viewer
printf '#!/bin/sh\necho "terraclip: synth: no luck" >&2\nexit 1\n' >alone/terraclip
chmod +x alone/terraclip
refuses 1 'terraclip: synth: no luck' alone/planar-viewer
printf '#!/bin/sh\nkill -9 $$\n' >alone/terraclip
refuses 1 'the default terrain cannot be made: terraclip synth ended by signal 9' alone/planar-viewer
rm -rf "$XDG_CACHE_HOME"

# ---- Ended while it is made; what is left is no terrain, and does no harm

for signal in TERM INT KILL; do
    cases=$((cases + 1))
    rm -rf "$XDG_CACHE_HOME"
    setsid $viewer --size 320x240 >stdout.txt 2>stderr.txt </dev/null &
    pid=$!
    await making || report "SIG$signal: nothing is being made"
    case $signal in
    KILL) kill -s KILL -- -$pid ;; # all at once
    *) kill -s $signal $pid ;;
    esac
    await gone || fail "SIG$signal: does not end"
    wait $pid
    rc=$?
    [ $signal = KILL ] || [ $rc = 1 ] || report "SIG$signal: exit code $rc"
    [ $signal = KILL ] || grep -q '^planar-viewer: interrupted$' stderr.txt || report "SIG$signal"
    [ ! -e "$terrain" ] || fail "SIG$signal: there is a terrain"
done
# The window is there meanwhile, and may be closed.
rm -rf "$XDG_CACHE_HOME"
$viewer --size 320x240 >stdout.txt 2>stderr.txt </dev/null &
pid=$!
cases=$((cases + 1))
if await has_window '^terrain-.* - making the default terrain, once - planar-viewer$'; then
    "$build/tests/drop-file" "$(window ' - making the default terrain')"
    ends 'closed while the terrain is made'
    [ ! -s stderr.txt ] || report 'closed while the terrain is made: something is said'
    holds 'closed while the terrain is made'
else
    report 'no window while the terrain is made'
    kill -9 $pid
fi
mkdir -p "$terrain.making" && : >"$terrain.making/left" # as by one that was killed; and goes
making() { [ ! -e "$terrain.making/left" ]; }

# ---- Two at once: one makes it, both show it

$viewer --size 320x240 --frames 3 >stdout.txt 2>other.txt </dev/null &
other=$!
await making || fail 'nothing is being made'
$viewer --size 320x240 >stdout.txt 2>stderr.txt </dev/null &
pid=$!
cases=$((cases + 3))
await said '^another viewer is making the default terrain$' || report 'the second of two does not wait'
wait $other || fail "the first of two ended with $?: $(cat other.txt)"
if await has_window 'ms, .* triangles'; then
    id=$(window 'ms, .* triangles')
    grep -q '^the default terrain; your own: planar-viewer FILE, ' stderr.txt || report 'the second of two: no hint'
    grep -q '^the default terrain; your own: planar-viewer FILE, ' other.txt || fail "the first of two: $(cat other.txt)"
    holds 'two at once' "${terrain##*/}"
    cases=$((cases + 1))
    xdotool getwindowname "$id" | grep -q '^terrain-' || fail "the title is '$(xdotool getwindowname "$id")'"
    colours=$(shown colours)
    [ "$colours" -gt 300 ] || fail "the default terrain has $colours colours"
    xdotool windowfocus "$id"
    xdotool key Escape
    ends 'two at once'
else
    report 'the second of two shows no window'
    kill -9 $pid
fi

# ---- Once it is there it is only opened: from a folder that cannot be written, too, and without terraclip

before=$(stat -c '%i %Y %Z' "$terrain")
run alone/planar-viewer --size 320x240 --frames 3 -q
[ $rc = 0 ] || report 'there already'
[ ! -s stderr.txt ] || report 'there already: -q says something'
chmod 500 "$folder"
run $viewer --size 320x240 --frames 3
[ $rc = 0 ] || report 'from a folder that cannot be written'
chmod 700 "$folder"
cases=$((cases + 1))
[ "$(stat -c '%i %Y %Z' "$terrain")" = "$before" ] || fail 'made twice'
# That of another version is not taken.
mv "$terrain" "$folder/terrain-0.0.0.tclip"
rm -rf alone/terraclip
refuses 1 'the default terrain cannot be made: ' alone/planar-viewer

# ---- The planet

viewer=$globe
if start --size 320x240; then
    cases=$((cases + 1))
    grep -q '^the default planet; your own: planet-viewer FILE, ' stderr.txt || report 'the planet: no hint'
    await sh -c "[ -e $planet ]"
    xdotool key Escape
    ends 'the planet'
    holds 'the planet' "${planet##*/}" terrain-0.0.0.tclip
    does '' $terraclip info "$planet" --json
    echo "$out" | grep -q '"width": 2048' || fail "the planet: $out"
fi

finish

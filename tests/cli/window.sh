# window.sh - what tests of windows share, after lib.sh: a display of their own, viewers in it, and what they show.
#     on_own_display "$0"     runs the test once more on a display of 800 x 600, unless it is on one

on_own_display() { # TEST
    for needed in xvfb-run xdotool xwd; do
        command -v $needed >/dev/null 2>&1 || { skip "$needed is not installed"; finish; }
    done
    if [ -z "${TERRACLIP_DISPLAY:-}" ]; then
        export TERRACLIP_DISPLAY=own
        rm -rf "$work"
        cd "$root" && xvfb-run -a -s '-screen 0 800x600x24 -noreset' sh "$root/tests/cli/${1##*/}" "$build"
        exit
    fi
    unset WAYLAND_DISPLAY
}

patience=150 # tenths of a second to wait for anything
case $build in */sanitize) patience=900 ;; esac

# Waits until a command succeeds.
await() { # COMMAND...
    tenths=0
    until "$@" >/dev/null 2>&1; do
        tenths=$((tenths + 1))
        [ $tenths -lt $patience ] || return 1
        sleep 0.1
    done
}

window() {
    xdotool search --name "${1:-planar-viewer}" 2>/dev/null | head -n 1
}
has_window() { [ -n "$(window "$@")" ]; }
said() { grep -Eq -- "$1" stderr.txt stdout.txt; }
gone() { ! kill -0 "$pid" 2>/dev/null; }

# Starts the viewer and waits for its first frames: then the title has figures.
start() { # ARGUMENT...
    "$viewer" "$@" >stdout.txt 2>stderr.txt </dev/null &
    pid=$!
    if ! await has_window 'ms, .* triangles, .* levels'; then
        report 'no window that draws' "$@"
        kill -9 $pid
        wait $pid
        return 1
    fi
    id=$(window 'ms, .* triangles')
    xdotool windowfocus --sync "$id" 2>/dev/null || xdotool windowfocus "$id"
}

# The viewer must end by itself.
ends() { # WHAT
    cases=$((cases + 1))
    await gone || { fail "$1: does not end"; kill -9 $pid; }
    wait $pid
    rc=$?
    [ $rc = 0 ] || report "$1: exit code $rc"
}

# A key makes the viewer say something.
key() { # KEY REGEX
    cases=$((cases + 1))
    xdotool key "$1"
    await said "$2" || fail "key $1: does not say '$2'"
}

# What the window shows: window-pixels' answer.
shown() { # ARGUMENT...
    xwd -silent -id "$id" >window.xwd 2>/dev/null && "$build/tests/window-pixels" "$@" <window.xwd
}

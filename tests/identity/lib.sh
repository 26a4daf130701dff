# lib.sh - running a command with both builds and comparing what came of it; read by identity.sh.
#
# Each build works in a folder of its own, $work/before and $work/after, by the same relative paths: in/ holds inputs
# (the same for both), pack/ what it packed itself, out/ the results of cases. So messages that name files can be
# compared as they are.

limit=300                  # seconds that a command may take
backend=osmesa             # the reference of picture tests; the same everywhere
count_same=0 count_explained=0 count_different=0 count_broken=0 count_skipped=0

begin_work() {
    rm -rf "$work/after" "$work/in" # a build under test is run anew each time, and no old data stays
    mkdir -p "$work/in" "$work/before/out" "$work/before/pack" "$work/after/out" "$work/after/pack" || exit 99
    ln -sfn ../in "$work/before/in" && ln -sfn ../in "$work/after/in" || exit 99
    # What an old result is worth: these programs with these plugins and this data.
    (cd "$before" && cat planar-viewer planet-viewer terraclip ./*.so "$here/tiles.c") | cksum >"$work/before.key"
    echo "data: ${TERRACLIP_DATA:-}" >>"$work/before.key"
    ${CC:-cc} -std=c11 -O2 -o "$work/tile-sums" "$here/tiles.c" || exit 99
    grep -Ev '^(#|[[:space:]]*$)' "$here/expected.txt" >"$work/expected"
    : >"$work/explained"
}

selected() { # NAME
    case $1 in ${ONLY:-*}) return 0 ;; esac
    return 1
}

# ---- Running -----------------------------------------------------------------------------------------------------

stdin=/dev/null

sums_of_inputs() { # ARGUMENT...
    option=
    for argument; do
        [ "$option" = -o ] || [ ! -f "$argument" ] || cksum "$argument"
        option=$argument
    done
}

run_side() { # before|after NAME PROGRAM ARGUMENT...
    side=$1 name=$2 program=$3
    shift 3
    [ "$side" = before ] && build=$before || build=$after
    case $program in *viewer | terraclip) program=$build/$program ;; esac
    cd "$work/$side" || exit 99
    o=out/$name
    mkdir -p "${o%/*}" || exit 99
    if [ "$side" = before ]; then
        { cat ../before.key; cksum <"$stdin"; echo "$program" "$@"; sums_of_inputs "$@"; } >"$o.now"
        [ -f "$o.rc" ] && cmp -s "$o.now" "$o.command" && return
        rm -f "$o.rc"
        mv "$o.now" "$o.command"
    fi
    MESA_SHADER_CACHE_DIR=$PWD/shaders timeout -k 5 $limit "$program" "$@" >"$o.stdout" 2>"$o.stderr" <"$stdin"
    echo $? >"$o.rc"
}

both() { # NAME PROGRAM ARGUMENT...
    (run_side before "$@") &
    (run_side after "$@")
    wait
}

# ---- Telling -----------------------------------------------------------------------------------------------------

tell() { # VERDICT NAME DETAIL
    printf '%-9s %s %s\n' "$1" "$2" "$3"
}

same() { # NAME DETAIL
    count_same=$((count_same + 1))
    tell same "$@"
}

broken() { # NAME DETAIL
    count_broken=$((count_broken + 1))
    tell BROKEN "$@"
}

skipped() { # NAME DETAIL
    count_skipped=$((count_skipped + 1))
    tell skipped "$@"
}

different() { # NAME DETAIL
    while read -r pattern reason; do
        case $1 in
        $pattern)
            echo "$pattern" >>"$work/explained"
            count_explained=$((count_explained + 1))
            tell explained "$1" "$2; $reason"
            return ;;
        esac
    done <"$work/expected"
    count_different=$((count_different + 1))
    tell DIFFERENT "$@"
}

# Of what texts_differ() found.
verdict() { # NAME DETAIL
    if [ -z "$difference" ]; then
        same "$@"
    else
        different "$1" "$difference"
    fi
}

finish() {
    [ -n "${ONLY:-}" ] || sort -u "$work/explained" | awk '
        NR == FNR { met[$1] = 1; next }
        !met[$1] { print "expected.txt: nothing differs that is named " $1 }' - "$work/expected"
    echo "$count_same same, $count_explained explained, $count_different different, $count_broken broken," \
        "$count_skipped skipped in $(($(date +%s) - started)) s"
    [ $((count_different + count_broken)) = 0 ]
    exit
}

# ---- Comparing ---------------------------------------------------------------------------------------------------

# How both builds ended a command that ought to succeed. Anything else than twice 0 is told here.
ended_well() { # NAME
    a=$(cat "$work/before/out/$1.rc") b=$(cat "$work/after/out/$1.rc")
    [ "$a$b" = 00 ] && return 0
    why=$(tail -qn 1 "$work/before/out/$1.stderr" "$work/after/out/$1.stderr" | sort -u | tr '\n' ' ')
    if [ "$a" = "$b" ]; then
        broken "$1" "both end with $a: $why"
    else
        different "$1" "ends with $a and $b: $why"
    fi
    return 1
}

# Text without what a clock or the machine's memory tells.
timeless() { # FILE
    sed -E '/"(frame_ms|update_ms|draw_ms|seconds|msamples_per_s|peak_rss_bytes)":/d' "$1"
}

# Sets $difference to what differs between two texts, '' for nothing; FILTER is a command that prints a file's part.
texts_differ() { # FILTER FILE
    $1 "$work/before/$2" >"$work/a.txt"
    $1 "$work/after/$2" >"$work/b.txt"
    difference=
    cmp -s "$work/a.txt" "$work/b.txt" && return
    difference=$(diff "$work/a.txt" "$work/b.txt" | awk '
        /^[<>]/ { n++; if (n <= 4) { sub(/^([<>]) */, substr($0, 1, 1) " "); text = text " " $0 } }
        END { print n " lines:" text (n > 4 ? " ..." : "") }')
}

# Everything that a command printed, and how it ended: with 0, 1 or 2, and not without a word.
compare_said() { # NAME
    for part in rc stdout stderr; do
        texts_differ timeless "out/$1.$part"
        [ -z "$difference" ] || { different "$1" "$part: $difference"; return; }
    done
    code=$(cat "$work/after/out/$1.rc") lines=$(cat "$work/after/out/$1.stdout" "$work/after/out/$1.stderr" | wc -l)
    if [ "$code" -gt 2 ] || [ "$lines" = 0 ]; then
        broken "$1" "both end with $code and $lines lines"
    else
        same "$1" "ends with $code, $lines lines"
    fi
}

# Two binary PPM pictures, pixel by pixel. Three bytes a pixel stand at the end of the file, whatever the header.
pixels_differ() { # FILE FILE
    a_size=$(head -n 2 "$1" | tail -n 1) b_size=$(head -n 2 "$2" | tail -n 1)
    difference=
    cmp -s "$1" "$2" && return
    difference="sizes $a_size and $b_size"
    [ "$a_size" = "$b_size" ] || return
    set -- "$1" "$2" $a_size
    difference=$(cmp -l "$1" "$2" | awk -v pixels=$(($3 * $4)) -v header=$(($(wc -c <"$1") - 3 * $3 * $4)) '
        function decimal(octal) { return 64 * int(octal / 100) + 8 * (int(octal / 10) % 10) + octal % 10 }
        $1 <= header { next }
        {
            pixel = int(($1 - 1 - header) / 3)
            n += pixel != last || n == 0
            last = pixel
            d = decimal($2) - decimal($3)
            if (d < 0) d = -d
            if (d > most) most = d
        }
        END { printf "%d of %d pixels, by at most %d of 255 levels", n, pixels, most }')
}

# A picture that both builds were to write to out/NAME.ppm.
compare_picture() { # NAME
    ended_well "$1" || return
    picture=out/$1.ppm
    pixels_differ "$work/before/$picture" "$work/after/$picture"
    [ -z "$difference" ] || { different "$1" "$difference"; return; }
    texts_differ timeless "out/$1.stderr"
    [ -z "$difference" ] || { different "$1" "messages: $difference"; return; }
    # A picture of one colour would be the same whatever was wrong with it.
    if [ "$(gzip -c "$work/after/$picture" | wc -c)" -lt 1000 ]; then
        broken "$1" "next to nothing is seen"
    else
        same "$1" "$(echo $a_size | tr ' ' x)"
    fi
}

# A file that both builds were to write.
compare_file() { # NAME FILE
    a=$work/before/$2 b=$work/after/$2
    if [ ! -f "$a" ] || [ ! -f "$b" ]; then
        broken "$1" "$2: not there"
    elif cmp -s "$a" "$b"; then
        same "$1" "$(wc -c <"$b") bytes"
    else
        at=$(cmp "$a" "$b" 2>&1 | sed 's/.*\(byte\|EOF\)/\1/')
        different "$1" "$(wc -c <"$a") and $(wc -c <"$b") bytes, from $at on"
    fi
}

#!/bin/sh
# The measuring half of the report: measure.sh BUILD quick|full OUT. Runs every measurement program, one after the other
# and whatever becomes of the one before, and leaves in OUT their CSV files and logs and
#     runs.csv      name,state,code,seconds,cpu_seconds,command,reason,renderer
#                   state: done, failed, missing, skipped, old; renderer: what drew, as the program says
#     machine.csv   key,value
#     explain/      what the viewers say they left out, a file a scene: the command, then its output
#     extreme/      rows of the extreme cases
# Ends with 1 where one failed or is missing.
set -u
build=$1 mode=$2 out=$3 here=${0%/*}
failed=0 number=0
trap 'echo stopped; exit 130' INT TERM
export MESA_SHADER_CACHE_DISABLE=true TERRACLIP_BUILD="$build"
quick= limit=1500 # seconds after which a program counts as hanging
[ "$mode" = quick ] && quick=--quick limit=600
all=${TERRACLIP_REPORT_SECONDS:-170} # of a quick report: what is left of them the extreme cases may take
start=$(date +%s)
total=$(($(set -- "$build"/tests/extreme_*; [ -e "$1" ] && echo $# || echo 0) + 18))

quoted() { # TEXT: as a field of CSV
    printf '"%s"' "$(printf '%s' "$1" | tr '\n\r\t' '   ' | sed 's/"/""/g')"
}

# Sets cpu to the processor time of all programs so far, seconds. Not in a subshell, which would tell of its own.
see_cpu() {
    times >"$out/logs/times"
    cpu=$(awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); s += 60 * t[1] + t[2] } print s }' \
        "$out/logs/times")
}

record() { # NAME STATE CODE COMMAND REASON
    before=$cpu
    see_cpu
    processor=$(awk -v before="$before" -v after="$cpu" 'BEGIN { printf "%.1f", after - before }')
    renderer=
    case $2 in
    'done' | failed) renderer=$(sed -n 's/^OpenGL: //p' "$out/logs/$1.log" 2>/dev/null | head -n 1) ;;
    esac
    printf '%s,%s,%s,%s,%s,%s,%s,%s\n' "$1" "$2" "$3" $(($(date +%s) - begin)) "$processor" "$(quoted "$4")" \
        "$(quoted "$5")" "$(quoted "$renderer")" >>"$out/runs.csv"
    case $2 in failed | missing) failed=1 ;; esac
    printf '%s in %d s (%s s of processor)%s\n' "$2" $(($(date +%s) - begin)) "$processor" "${5:+: $5}"
}

announce() { # NAME
    number=$((number + 1)) begin=$(date +%s)
    see_cpu
    printf 'report: %d/%d, %d s: %s ... ' "$number" "$total" "$(($(date +%s) - start))" "$1"
}

last_line() { # FILE
    grep -v '^[[:space:]]*$' "$1" | tail -n 1 | cut -c 1-300
}

# Whether the program was stopped for its time. The kernel, too, ends one with 137, where memory runs out.
hung() { # CODE SECONDS
    case $1 in 124 | 137) [ $(($(date +%s) - begin)) -ge "$2" ] ;; *) false ;; esac
}

# A program of tests/bench/, whose first table is CSV. It may write others beside it.
bench() { # NAME CSV...
    name=$1 csv=$2 program=$build/tests/bench_$1 log=$out/logs/$1.log
    command="${TERRACLIP_DATA:+TERRACLIP_DATA=$TERRACLIP_DATA }$program${quick:+ $quick} --csv $out/$csv"
    shift
    for old; do rm -f "$out/$old"; done
    announce "$name"
    if [ ! -x "$program" ]; then
        record "$name" missing '' "$command" "there is no program $program"
        return
    fi
    timeout --foreground -k 10 $limit "$program" $quick --csv "$out/$csv" >"$log" 2>&1 </dev/null
    code=$?
    if hung $code $limit; then
        record "$name" failed $code "$command" "stopped after $limit s"
    elif [ $code != 0 ]; then
        record "$name" failed $code "$command" "exit code $code; its last line: $(last_line "$log")"
    elif [ "$(wc -l <"$out/$csv" 2>/dev/null || echo 0)" -gt 1 ]; then
        record "$name" 'done' 0 "$command" ''
    else
        record "$name" skipped 0 "$command" "no rows; its last line: $(last_line "$log")"
    fi
}

# ---- The machine -----------------------------------------------------------------------------------------------------

package() { # NAME: its version, where Debian's packages are known
    dpkg-query -W -f '${Version}' "$1" 2>/dev/null || echo unknown
}

machine() {
    gl=$(sed -n 's/^planar-viewer: OpenGL //p' "$out/logs/renderer.log" | head -n 1)
    data='only what the generators make: TERRACLIP_DATA is not set'
    [ -z "${TERRACLIP_DATA:-}" ] || data="$(ls "$TERRACLIP_DATA" 2>/dev/null | wc -l) files in TERRACLIP_DATA"
    load='what else is running makes times longer, not errors'
    echo key,value
    while IFS='|' read -r key value; do
        printf '%s,%s\n' "$key" "$(quoted "${value:-unknown}")"
    done <<END
Date|$(date -u '+%Y-%m-%d %H:%M:%S UTC')
Kind|$mode
Terraclip|$("$build/terraclip" --version 2>/dev/null)
Commit|$(git -C "$here" describe --always --dirty 2>/dev/null || echo 'none: not a git working copy')
Processor|$(sed -n 's/^model name[[:space:]]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)
Processors online|$(getconf _NPROCESSORS_ONLN)
Memory|$(awk '/^MemTotal/ { printf "%.1f GiB", $2 / 1048576 }' /proc/meminfo 2>/dev/null)
System|$(sed -n 's/^PRETTY_NAME="*\([^"]*\)"*$/\1/p' /etc/os-release 2>/dev/null), $(uname -sr)
OpenGL|$gl
Mesa|$(package libgl1-mesa-dri)
GDAL|$(gdal-config --version 2>/dev/null || package libgdal-dev)
OpenImageIO|$(package libopenimageio-dev)
Compiler|$(${CC:-cc} --version 2>/dev/null | head -n 1)
Elevation data|$data
Load at the start|$(cut -d ' ' -f 1-3 /proc/loadavg 2>/dev/null) (1, 5, 15 minutes); $load
END
}

# ---- What scenes leave out -------------------------------------------------------------------------------------------

explain() { # TITLE COMMAND...
    title=$1
    shift
    explained=$((explained + 1))
    file=$out/explain/$explained.txt
    printf '%s\n$ %s\n' "$title" "$*" >"$file"
    timeout --foreground -k 5 60 "$@" >>"$file" 2>&1 </dev/null && return
    echo "(exit code $?)" >>"$file"
    wrong="$wrong $title;"
}

explanations() {
    announce explain
    explained=0 wrong= s=$out/scenes
    rm -rf "$out/explain" "$s" && mkdir -p "$out/explain" "$s"
    {
        "$build/terraclip" synth --size 513 --seed 7 -o "$s/land.tif" -q &&
            "$build/terraclip" synth --kind planet --size 512 --seed 7 -o "$s/planet.tif" -q &&
            "$build/terraclip" pack "$s/land.tif" -o "$s/land.tclip" -q
    } >"$out/logs/explain.log" 2>&1 || wrong=" no scenes: $(last_line "$out/logs/explain.log");"
    set -- --size 320x240 -o "$s/picture.png" --explain
    explain 'A flat terrain, whole, lit' "$build/planar-viewer" "$s/land.tif" "$@"
    explain 'The same, packed, unlit, flat background' "$build/planar-viewer" "$s/land.tclip" \
        --unlit --background 000000 "$@"
    eye=$("$build/terraclip" height "$s/land.tclip" 7000 7000 2>/dev/null | awk '{ print $NF + 2 }')
    explain 'From 2 m above the ground' "$build/planar-viewer" "$s/land.tif" --view "7000,7000,${eye:-2000},0,-10" "$@"
    explain 'A planet from far away' "$build/planet-viewer" "$s/planet.tif" "$@"
    explain 'A planet from near the ground' "$build/planet-viewer" "$s/planet.tif" --view 10,46,5000,30,-5 "$@"
    command="$build/planar-viewer TERRAIN $*"
    if [ -z "$wrong" ]; then
        record explain 'done' 0 "$command" ''
    else
        record explain failed 1 "$command" "failed:$wrong"
    fi
    rm -rf "$s"
}

# ---- Extreme cases ---------------------------------------------------------------------------------------------------

# A quick report runs what fits into its time, and shows the rows of an earlier run else.
extreme() { # PROGRAM
    family=${1##*/extreme_} new=$out/logs/extreme old=$build/extreme
    command="TERRACLIP_EXTREME=$old $1"
    announce "extreme_$family"
    rm -rf "$new" && mkdir -p "$new" "$old"
    most=$limit
    [ -z "$quick" ] || most=$((all - (begin - start)))
    code=124
    if [ $most -gt 0 ]; then
        TERRACLIP_EXTREME=$new timeout --foreground -k 10 $most "$1" >"$out/logs/extreme_$family.log" 2>&1 </dev/null
        code=$?
    fi
    if hung $code $most; then
        if [ -z "$quick" ]; then
            record "extreme_$family" failed $code "$command" "stopped after $most s"
        elif [ -s "$old/$family.csv" ]; then
            record "extreme_$family" old '' "$command" \
                "did not fit into the time; rows of $(date -u -r "$old/$family.csv" '+%Y-%m-%d %H:%M UTC')"
        else
            record "extreme_$family" skipped '' "$command" 'did not fit into the time: make test-extreme'
        fi
        return
    elif [ $code = 0 ]; then
        record "extreme_$family" 'done' 0 "$command" ''
    else
        record "extreme_$family" failed $code "$command" \
            "exit code $code; its last line: $(last_line "$out/logs/extreme_$family.log")"
    fi
    for csv in "$new"/*.csv; do [ ! -e "$csv" ] || mv "$csv" "$old/"; done
}

mkdir -p "$out/logs" || exit 1
echo name,state,code,seconds,cpu_seconds,command,reason,renderer >"$out/runs.csv"
"$build/terraclip" synth --size 65 -o "$out/logs/renderer.tif" -q >/dev/null 2>&1
timeout --foreground 60 "$build/planar-viewer" "$out/logs/renderer.tif" -v --size 16x16 -o "$out/logs/renderer.png" \
    >"$out/logs/renderer.log" 2>&1 </dev/null
machine >"$out/machine.csv"

# Several programs want the default terrain: made anew for this report, and once.
TERRACLIP_TERRAINS=$(cd "$out" && pwd)/terrains
export TERRACLIP_TERRAINS
rm -rf "$TERRACLIP_TERRAINS" && mkdir "$TERRACLIP_TERRAINS"

bench error_time error_time.csv frames.csv
bench update update.csv
bench lod_error lod_error.csv
bench space space.csv
bench triangles triangles.csv
bench views views.csv
bench precision precision.csv
bench schemes schemes.csv
bench atlas atlas.csv
bench triangle_size triangle_size.csv
bench popping popping.csv
bench hexagons hexagons.csv
bench left_out left_out.csv
bench fidelity fidelity.csv
bench hillshades hillshades.csv
bench rate_distortion rate_distortion.csv
bench scaling scaling.csv
explanations
rm -rf "$out/extreme"
for program in "$build"/tests/extreme_*; do
    [ ! -x "$program" ] || extreme "$program"
done
rm -rf "$TERRACLIP_TERRAINS"
mkdir -p "$out/extreme"
for csv in "$build"/extreme/*.csv; do [ ! -e "$csv" ] || cp -p "$csv" "$out/extreme/"; done
awk -v seconds=$(($(date +%s) - start)) 'BEGIN { print "Time for all of it," seconds " s" }' >>"$out/machine.csv"
exit $failed

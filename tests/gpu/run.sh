#!/bin/sh
# Measures what this machine's OpenGL draws, and holds it against what a software renderer drew: run.sh [software].
# It runs in the folder that it lies in (tests/gpu/folder.sh makes that), without compiler, sources or network: over EGL
# where there is one, else over OSMesa. It leaves there
#     gpu.csv      scheme,view,size,figure,value,unit,software,verdict,renderer: a figure a row, marked with what drew
#     index.html   the same as tables
#     pictures/    what was drawn, grey; software/pictures/ has what software drew
#     logs/        what the programs printed
# software: only draws in software, where that was not done before. A program that is missing or fails is told, and the
# rest goes on; ends with 1 where there was any, or where a figure is wrong.
#
# TERRACLIP_GPU_SECONDS: for all of it (480). TERRACLIP_GPU_FRAMES: seconds of frames a case (2). TERRACLIP_GPU_SCHEMES.
# TERRACLIP_GPU_QUICK: any text for small sizes. TERRACLIP_SWEEP: tests look at so small a part of their views (24).
set -u
here=$(cd "$(dirname "$0")" && pwd) || exit 99
cd "$here" || exit 99
start=${TERRACLIP_GPU_START:-$(date +%s)} all=${TERRACLIP_GPU_SECONDS:-480}
schemes=${TERRACLIP_GPU_SCHEMES:-square rings hex cube} frames=${TERRACLIP_GPU_FRAMES:-2}
quick=${TERRACLIP_GPU_QUICK:+--quick}
export LC_ALL=C TERRACLIP_TERRAINS="$here/terrains" TERRACLIP_SWEEP="${TERRACLIP_SWEEP:-24}"
export LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
trap 'exit 130' INT TERM
mkdir -p logs pictures software terrains || exit 1
export MESA_SHADER_CACHE_DIR="$here/logs/shaders"
figures=programs/gpu_figures

left() { # seconds
    echo $((all - ($(date +%s) - start)))
}

say() {
    printf 'gpu-report: %d s: %s\n' $(($(date +%s) - start)) "$1"
}

limited() { # SECONDS COMMAND...
    seconds=$1
    shift
    if command -v timeout >/dev/null 2>&1; then
        timeout -k 5 "$seconds" "$@"
    else
        "$@"
    fi
}

drew() { # LOG: "renderer", as the program says
    sed -n 's/^OpenGL: [^,]*, //p' "$1" 2>/dev/null | head -n 1
}

field() { # TEXT: as one of CSV
    printf '"%s"' "$(printf '%s' "$1" | tr '\n\r\t' '   ' | sed 's/"/""/g')"
}

# ---- In software -----------------------------------------------------------------------------------------------------

# A share of the time for each scheme; what takes longer is left out and then not compared.
draw_in_software() {
    for scheme in $schemes; do
        [ ! -s "software/$scheme.csv" ] || continue
        say "$scheme in software"
        rm -f "software/$scheme.csv"
        LIBGL_ALWAYS_SOFTWARE=1 limited $((all / 2)) env -u TERRACLIP_BACKEND \
            "$figures" "$scheme" software --in-software --seconds 0 --within $((all / 8)) $quick \
            >"logs/software-$scheme.log" 2>&1 </dev/null
        code=$?
        if [ $code = 0 ]; then
            echo "$(drew "logs/software-$scheme.log"), on $(uname -n), $(date -u '+%Y-%m-%d %H:%M UTC')" >software/about
        else
            rm -f "software/$scheme.csv"
            say "$scheme: nothing to compare with: exit code $code: $(tail -n 1 "logs/software-$scheme.log")"
        fi
    done
}

# ---- On the driver at hand -------------------------------------------------------------------------------------------

failure() { # SCHEME WHAT LOG
    say "$1: $2"
    printf '%s,,,failed,%s,,,failed,%s\n' "$1" "$(field "$2")" "$(field "$(drew "$3")")" >>gpu.csv
}

draw() { # SCHEME SECONDS: no case is begun that takes longer
    log=logs/$1.log most=$((2 * $2 + 60))
    say "$1"
    rm -f "$1.csv"
    TERRACLIP_BACKEND=auto limited "$most" "$figures" "$1" . --software software \
        --seconds "$frames" --within "$2" $quick >"$log" 2>&1 </dev/null
    code=$?
    sed 's/^/    /' "$log"
    [ ! -f "$1.csv" ] || sed 1d "$1.csv" >>gpu.csv
    rm -f "$1.csv"
    case $code in
    0 | 1) ;; # the rows say what is wrong
    124 | 137) failure "$1" "stopped after $most s" "$log" ;;
    *) failure "$1" "exit code $code: $(tail -n 1 "$log")" "$log" ;;
    esac
}

# Of each what it says of itself, and a line that begins with == (programs/run-tests.sh).
run_tests() {
    set --
    for program in programs/test_*; do [ ! -x "$program" ] || set -- "$@" "$program"; done
    [ $# -gt 0 ] || return 0
    seconds=$(left)
    [ "$seconds" -ge 20 ] || seconds=20
    say "$# tests, a ${TERRACLIP_SWEEP}th of their views, for $seconds s at most"
    TERRACLIP_BACKEND=auto limited "$seconds" sh programs/run-tests.sh . "$@" >logs/tests.log 2>&1 </dev/null
    for program; do
        name=${program##*/}
        line=$(grep "^== $name: " logs/tests.log | tail -n 1)
        result=${line#"== $name: "}
        case $result in
        passed*) verdict=passed ;;
        FAILED*) verdict=failed ;;
        *) verdict=failed result="not finished after $seconds s" ;;
        esac
        say "$name: $result"
        printf '%s,,,test,%s,,,%s,%s\n' "$name" "$(field "$result")" $verdict "$(field "$(drew logs/tests.log)")" >>gpu.csv
    done
}

# ---- Tables ----------------------------------------------------------------------------------------------------------

# TITLE|FIGURES, a table a line.
tables='Frames of a flight|frames gpu_ms gpu_p99_ms cpu_ms cpu_p99_ms frame_ms frame_p99_ms triangles draws
Uploads of a flight of 32 frames|uploaded upload_ms memory
Errors against all samples, pixels|error_rms error_p999 error_max
Pictures against software, grey values of 255|grey_mean grey_most pixels_off share_off'

wide() { # FIGURES
    awk -v figures="$1" -f page/csv.awk -f page/wide.awk gpu.csv
}

rows() { # unlike, tests: of these
    awk -f page/csv.awk -f "page/$1.awk" gpu.csv
}

as_text() { # of the standard input
    awk -f page/csv.awk -f page/text.awk
}

as_html() { # of the standard input
    cat >page/table.csv
    awk -v columns="$(head -n 1 page/table.csv | sed 's/\([^,]*\)/\1=\1:given/g; s/,/;/g')" \
        -f page/csv.awk -f page/table.awk page/table.csv
}

escaped() { # of the standard input
    awk -f page/csv.awk -f page/escape.awk
}

printed() {
    printf '%s\n' "$tables" | while IFS='|' read -r title names; do
        printf '\n%s\n' "$title"
        wide "$names" | as_text
    done
    printf '\nTests\n'
    rows tests | as_text
    printf '\nWhat is not as in software\n'
    rows unlike | as_text
}

page() {
    printf '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Terraclip on a GPU</title><style>\n'
    cat page/style.css
    printf '</style></head><body><main><h1>Terraclip on %s</h1>\n' "$(drawn_by | escaped)"
    about | escaped | sed 's|.*|<p>&</p>|'
    printf '<h2>What is not as in software</h2>\n'
    rows unlike | as_html
    printf '%s\n' "$tables" | while IFS='|' read -r title names; do
        printf '<h2>%s</h2>\n' "$title"
        wide "$names" | as_html
    done
    printf '<h2>Tests</h2>\n'
    rows tests | as_html
    printf '<pre>\n'
    grep -E '^== |cracks|holes|worst|off' logs/tests.log 2>/dev/null | cut -c 1-200 | escaped
    printf '</pre></main></body></html>\n'
}

drawn_by() { # what the first scheme that drew says; with its backend before it
    for scheme in $schemes; do
        sed -n "s/^OpenGL: ${1:-[^,]*, }//p" "logs/$scheme.log" 2>/dev/null
    done | head -n 1
}

about() {
    echo "Drawn by $(drawn_by ' *'), on $(uname -n), $(date -u '+%Y-%m-%d %H:%M UTC'); $(getconf _NPROCESSORS_ONLN) processors."
    if [ -s software/about ]; then
        echo "Software pictures and figures: $(cat software/about)."
    else
        echo 'There was nothing drawn in software to compare with.'
    fi
    echo 'gpu_ms is GL_TIME_ELAPSED; cpu_ms is the time of the thread that draws; frame_ms the clock until all is drawn.'
    echo 'Medians and 99th percentiles. A software renderer draws on the processor: there gpu_ms tells but a part.'
}

# ---- All of it -------------------------------------------------------------------------------------------------------

draw_in_software
[ "${1:-}" != software ] || exit 0
echo scheme,view,size,figure,value,unit,software,verdict,renderer >gpu.csv
rm -f logs/tests.log
rest=$(echo $schemes | wc -w)
for scheme in $schemes; do # a share of what is left for each, but for the tests' time
    share=$((($(left) - all * 5 / 12) / rest))
    draw "$scheme" $((share > 10 ? share : 10))
    rest=$((rest - 1))
done
run_tests
if command -v awk >/dev/null 2>&1; then
    echo
    about
    printed
    page >index.html
else
    say 'awk is missing: no tables, no page'
fi
wrong=$(grep -cE ',(wrong|failed),' gpu.csv)
say "$here/index.html and gpu.csv; $wrong figures wrong or failed"
[ "$wrong" = 0 ]

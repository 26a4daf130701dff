#!/bin/sh
# Packing that is killed, interrupted, or runs out of room: the old file is as it was or the new one is whole, and
# nothing is left beside it.
. "${0%/*}/lib.sh"

size=1281 kills=17 # of each kind of signal
case $build in */sanitize) size=513 kills=5 ;; esac

whole() { # FILE: a packed file that holds all its levels
    "$terraclip" info "$1" >/dev/null 2>&1 && cmp -s "$1" new.tclip
}

"$terraclip" synth --size $size -q -o in.tif || fail "no terrain"
start=$(date +%s%N)
"$terraclip" pack in.tif -q -o new.tclip || fail "not packed"
took=$((($(date +%s%N) - start) / 1000000))
printf 'old' >old.tclip

# ---- Signals at moments spread over the whole run, from a fixed seed

replaced=0 kept=0 litter=0
for signal in KILL INT TERM; do
    moments=$(awk -v n=$kills -v took=$took 'BEGIN { srand(7); for (; n > 0; n--) printf "%.3f ", rand() * 1.1 * took / 1000 }')
    for moment in $moments; do
        cases=$((cases + 1))
        mkdir dir && cp old.tclip dir/a.tclip
        "$terraclip" pack in.tif -q -o dir/a.tclip >stdout.txt 2>stderr.txt </dev/null &
        packer=$!
        sleep "$moment"
        kill -$signal $packer 2>/dev/null
        wait $packer 2>/dev/null
        rc=$?
        found=$(ls -A dir)
        if [ "$found" != a.tclip ]; then
            # A file has a name for an instant before it takes the target's: only a kill in that instant leaves it.
            litter=$((litter + 1))
            [ $signal = KILL ] && [ $litter = 1 ] || fail "SIG$signal after $moment s: left in the folder: $found"
        fi
        if cmp -s dir/a.tclip old.tclip; then
            kept=$((kept + 1))
            [ $rc != 0 ] || fail "SIG$signal after $moment s: exit code 0, the old file is still there"
            [ $signal = KILL ] || [ $rc -gt 128 ] || [ "$(wc -l <stderr.txt)" = 1 ] ||
                fail "SIG$signal after $moment s: $(wc -l <stderr.txt) lines on stderr"
        elif whole dir/a.tclip; then
            replaced=$((replaced + 1))
        else
            fail "SIG$signal after $moment s: the file is neither the old nor the new one"
        fi
        rm -rf dir
    done
done
echo "signals: $kept times the old file, $replaced times the new one, $litter left-overs; a run takes $took ms"
[ $kept -gt 0 ] || fail "no signal came in time"

# ---- No room

try_full() { # FOLDER WHAT: the folder holds an old a.tclip and has no room for a new one
    run "$terraclip" pack in.tif -q -o "$1/a.tclip"
    [ $rc != 0 ] || fail "$2: exit code 0"
    [ $rc -gt 128 ] || [ "$(wc -l <stderr.txt)" = 1 ] || fail "$2: $(wc -l <stderr.txt) lines on stderr"
    cmp -s "$1/a.tclip" old.tclip || fail "$2: the old file is gone"
    [ "$(ls -A "$1")" = a.tclip ] || fail "$2: left in the folder: $(ls -A "$1")"
}

mkdir full
if mount -t tmpfs -o size=64k tmpfs full 2>/dev/null; then
    trap 'umount "$work/full"; rm -rf "$work"' EXIT
    for room in 64k 900k 3m 6m 12m 18m 24m; do # too little for the heights, for what is made of them, for the file
        mount -o remount,size=$room full
        rm -f full/a.tclip
        cp old.tclip full/a.tclip
        "$terraclip" pack in.tif -q -o full/a.tclip >/dev/null 2>&1 && break
        try_full full "a disk of $room"
    done
    umount full
    trap 'rm -rf "$work"' EXIT
else
    skip "no disk can be mounted here that is full; a limit on the size of files stands in for it"
fi
rm -rf full && mkdir full && cp old.tclip full/a.tclip
for blocks in 1 100 2000; do # of 512 bytes; the signal that comes with it ends the program
    { (ulimit -f $blocks && exec "$terraclip" pack in.tif -q -o full/a.tclip) >/dev/null 2>&1; rc=$?; } 2>/dev/null
    [ $rc != 0 ] || fail "a limit of $blocks blocks: exit code 0"
    cases=$((cases + 1))
    [ "$(ls -A full)" = a.tclip ] && cmp -s full/a.tclip old.tclip || fail "a limit of $blocks blocks: $(ls -A full)"
done

# ---- Inputs that end badly, folders that cannot be written

"$terraclip" synth --size 257 -q -o small.tif
head -c 100000 small.tif >cut.tif
for second in missing.tif cut.tif old.tclip; do
    run "$terraclip" pack small.tif $second -q -o full/a.tclip
    [ $rc = 1 ] && [ "$(wc -l <stderr.txt)" = 1 ] || fail "second input $second: exit code $rc, $(cat stderr.txt)"
    [ "$(ls -A full)" = a.tclip ] && cmp -s full/a.tclip old.tclip || fail "second input $second: $(ls -A full)"
done
refuses 1 'out/no/such.tclip: .*No such file' "$terraclip" pack small.tif -o out/no/such.tclip
refuses 1 'found a directory' "$terraclip" pack small.tif -o full
refuses 1 'found a device or pipe' "$terraclip" pack small.tif -o /dev/full
if [ "$(id -u)" != 0 ]; then
    chmod 555 full
    refuses 1 'Permission denied' "$terraclip" pack small.tif -o full/b.tclip
    chmod 755 full && chmod 444 full/a.tclip
    refuses 1 'Permission denied' "$terraclip" pack small.tif -o full/a.tclip
elif mkdir sealed && mount -t tmpfs -o size=1m tmpfs sealed 2>/dev/null; then # root may write everywhere else
    cp old.tclip sealed/a.tclip && mount -o remount,ro sealed
    refuses 1 'Read-only file system' "$terraclip" pack small.tif -o sealed/a.tclip
    refuses 1 'Read-only file system' "$terraclip" pack small.tif -o sealed/b.tclip
    cmp -s sealed/a.tclip old.tclip || fail "a folder that cannot be written: the old file is gone"
    umount sealed
else
    skip "root writes everywhere, and nothing can be mounted here"
fi

finish

#!/bin/sh
# new_model.sh [BUILD] - a new model costs a file pair and a row: what tests/new_model/new_model.c checks, and the
# instructions of its tick (callgrind): within 5 % of a tick whose step and ledger are written by hand for
# this one equation. Run from the top folder.
build=${1:-build}
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
"$build"/new_model >"$out/said" || failed=1
grep -vE '^[0-9]+ passed' "$out/said"
strip -g -o "$out/program" "$build"/new_model
LD_BIND_NOW=1 valgrind -q --tool=callgrind --callgrind-out-file="$out/calls" "$out/program" ticks >/dev/null
callgrind_annotate --inclusive=yes --threshold=100 "$out/calls" 2>/dev/null | awk '
    match($0, /:once_[a-z]+/) && !/=>/ {
        name = substr($0, RSTART + 6, RLENGTH - 6)
        gsub(",", "", $1)
        n[name] = $1 / 1000
    }
    END {
        if (!n["row"] || !n["hand"] || !n["pointers"]) {
            print "FAIL  a tick was not counted (apt-get install valgrind binutils)"
            exit 1
        }
        off = n["row"] / n["hand"] - 1
        good = off <= 0.05
        printf "%s  a tick of the new model: %.0f instructions, %.0f by hand, %+.1f %%, at most 5\n",
            good ? "ok  " : "FAIL", n["row"], n["hand"], 100 * off
        printf "      without a row, through pointers: %.0f instructions\n", n["pointers"]
        exit !good
    }' || failed=1
exit ${failed:-0}

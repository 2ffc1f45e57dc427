#!/bin/bash
# coverage.sh BUILD - lines and branches of the core and of the wire path in hal/ that the unit tests of a build with gcov ran.
#
# Prints a line a file and each line that never ran, which is a failure. Branches are numbers, not a gate: docs/PROOFS.md
# says which are left and why. With --branches also the places of branches that were never taken.
build=$1
branches=$2
cd "$(dirname "$0")/.." || exit 2
files=$(ls firmware/*.c models/*.c | grep -v '^firmware/main\.c$')
for h in can cannelloni faults ipv4 log log_read loopback net replay; do files="$files hal/$h.c"; done
out=$build/coverage.txt
for f in $files; do
    gcov -b -t -o "$build/$f" "$f" 2>/dev/null | awk -v file="$f" -v places="$branches" '
        /^ *-: *0:Source:/ { split($0, part, "Source:"); mine = part[2] == file; next }
        !mine { next }
        /^branch/ {
            branches++
            if ($0 ~ /never|taken 0%/) { open++; if (places && line != told) place[++n_places] = line; told = line }
            next
        }
        /^(call|function|unconditional)/ { next }
        { split($0, part, ":"); count = part[1]; gsub(/ /, "", count); line = part[2] + 0 ": " substr($0, index($0, part[3])) }
        count == "-" { next }
        { lines++ }
        count ~ /#####|=====/ { missed[++n_missed] = line }
        END {
            printf "%s  %-30s %4d lines, %d not run; %4d branches, %d not taken\n", n_missed ? "FAIL" : "ok  ", file,
                lines, n_missed, branches, open
            for (i = 1; i <= n_missed; i++) print "      " file ":" missed[i]
            for (i = 1; i <= n_places; i++) print "      branch " file ":" place[i]
        }'
done | tee "$out"
awk '$2 ~ /\.c$/ { files++; lines += $3; missed += $5; branches += $8; open += $10 }
    END { printf "%d files, %d lines, %d not run; %d branches, %d not taken\n", files, lines, missed, branches, open }' "$out"
! grep -q '^FAIL' "$out"

#!/bin/bash
# coverage.sh BUILD - lines and branches of the core and of the wire path in hal/ that the unit tests of a build with gcov ran.
#
# Prints a line a file and each line that never ran, which is a failure. Branches never taken are counted by cause, an assertion or
# a switch over an enum by itself, the others by tests/data/branches.txt (tab-separated: cause, file, begin of the line); what has
# no cause is named and is a failure, as is an entry that matches nothing. With --branches every place. The last line is the verdict.
build=$1
branches=$2
cd "$(dirname "$0")/../.." || exit 2
files=$(find firmware models -name '*.c' ! -path firmware/main.c | sort)
files="$files hal/can/can.c hal/link/cannelloni.c hal/link/faults.c hal/link/loopback.c hal/ethernet/ipv4.c hal/ethernet/net.c
    hal/ethernet/lan9118.c hal/link/share.c hal/device/registers.c hal/device/cmsdk_watchdog.c
    hal/device/i6300esb.c hal/device/uart_16550.c hal/device/uart_cadence.c hal/can/kvaser_pci.c hal/can/sja1000.c hal/can/xilinx_can.c
    hal/posix/log.c hal/posix/log_read.c host_sim/replay/replay_source.c"
out=$build/coverage.txt
for f in $files; do
    gcov -b -t -o "$build/$f" "$f" 2>/dev/null | awk -v file="$f" -v places="$out.$(basename "$f")" '
        /^ *-: *0:Source:/ { split($0, part, "Source:"); mine = part[2] == file; next }
        !mine { next }
        /^branch/ {
            branches++
            if ($0 ~ /never|taken 0%/) { open++; untaken[line]++ }
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
            for (l in untaken) { split(l, part, ": "); printf "%d\t%s\t%s\t%s\n", untaken[l], file, part[1], substr(l, length(part[1]) + 3) > places }
        }'
done | tee "$out"
awk '$2 ~ /\.c$/ { files++; lines += $3; missed += $5; branches += $8; open += $10 }
    END { printf "%d files, %d lines, %d not run; %d branches, %d not taken\n", files, lines, missed, branches, open }' "$out"
cat "$out".*.c | sort -t '	' -k 2,2 -k 3,3n >"$out.branches"
rm -f "$out".*.c
[ -z "$branches" ] || awk -F '\t' '{ sub(/^ +/, "", $4); print "      branch " $2 ":" $3 ": " $4 " (" $1 ")" }' "$out.branches"
awk -F '\t' 'FNR == NR { if ($0 !~ /^#/) { n++; cause[n] = $1; file[n] = $2; begin[n] = $3 } next }
    {
        sub(/^ +/, "", $4)
        why = $4 ~ /^(ASSERT|assert)\(/ ? "the failing side of an assertion" : $4 ~ /^switch \(/ ? "a value outside its enum" : ""
        for (i = 1; i <= n && why == ""; i++)
            if (file[i] == $2 && (begin[i] == "" || index($4, begin[i]) == 1)) {
                why = cause[i]
                used[i] = 1
            }
        if (why == "") { why = "no cause given"; print "      " why ": " $2 ":" $3 ": " $4 " (" $1 ")" }
        count[why] += $1
    }
    END {
        for (why in count) printf "      %3d not taken: %s\n", count[why], why | "sort -rn"
        close("sort -rn")
        for (i = 1; i <= n; i++)
            if (!used[i]) {
                stale++
                print "FAIL  tests/data/branches.txt: no branch that is not taken: " file[i] ": " begin[i]
            }
        exit stale + count["no cause given"] > 0
    }' tests/data/branches.txt "$out.branches"
causes=$?
lines=$(grep -c '^FAIL' "$out")
if [ "$causes" = 0 ] && [ "$lines" = 0 ]; then
    echo "ok    coverage: each line runs, and each branch that is not taken has its cause"
else
    echo "FAIL  coverage: lines not run in $lines files$([ "$causes" = 0 ] || echo '; branches without a cause, or causes without a branch')"
    exit 1
fi

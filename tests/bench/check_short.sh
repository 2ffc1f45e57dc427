#!/bin/sh
# check_short.sh DIR - the short form of make bench: did everything run, and are the numbers of a size that can be? Times are
# never judged closer than that: the machine decides them.
cd "$1" || exit 1
awk '
    function check(good, text) { print (good ? "ok    " : "FAIL  ") text; failed += !good }
    FILENAME == "frame.txt" && /ratio/ { ratio = $NF }
    FILENAME == "frame.txt" { lines++ }
    FILENAME == "batch.csv" && FNR > 1 { split($0, f, ","); batch++; slow += !(f[3] > 1 && f[3] < 1e6) }
    FILENAME == "ratios.csv" && FNR > 1 { split($0, f, ","); at++; sane += f[4] > 10 && f[4] < 1e6 && f[5] > 10 && f[10] > 0.05 && f[10] < 1000 }
    FILENAME == "tables.md" && /^\|/ { rows++; filled += /^\| (A1|tip|C2) \|.*[0-9]/ }
    FILENAME == "peers.csv" && FNR > 1 { split($0, f, ","); split($0, quoted, "\""); split(quoted[3], n, ","); settings[f[2] " " f[1]]++
        good[f[2] " " f[1]] += n[5] == 1 && n[3] < 1e-3 }
    END {
        check(lines == 6 && ratio > 0.2 && ratio < 20, "bench_frame: " lines + 0 " lines, rk4 kernel " ratio " times a loop by hand")
        check(batch == 3 && !slow, "bench_batch: " batch + 0 " ways, times a period between 1 ns and 1 ms")
        check(at == 9 && sane == 9, "peers: " sane + 0 " of " at + 0 " ratios between 0.05 and 1000 (wanted 9)")
        check(rows == 15 && filled == 9, "tables: " rows + 0 " lines, " filled + 0 " with a case in them (wanted 15 and 9)")
        for (s in settings) check(good[s] >= 1, "peers: of " settings[s] " settings of " s " " good[s] " timed, with errors below 1e-3")
        exit failed > 0
    }' frame.txt batch.csv ratios.csv tables.md peers.csv

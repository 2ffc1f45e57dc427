#!/bin/sh
# tables.sh RATIOS BASELINE_RATIOS - the numbers of the table in docs/why/accuracy.md, in Markdown, from the ratios.csv of two
# runs of the benchmark: with AVX2 and on baseline x86-64. Ratios have two digits, for the third is another on each machine.
awk -F , '
    function two(x) { return x >= 10 ? sprintf("%.0f", x) : sprintf("%.1f", x) }
    function rounded(ns, unit) { for (unit = 1; ns >= 1000 * unit; unit *= 10) {} return int(ns / unit + 0.5) * unit }
    FNR == 1 { file++; next }
    file == 2 { baseline[$1, $2] = two($13); next }
    !($1 in title) { title[$1] = 1; name[++n] = $1 }
    {
        plant[$1, $2] = sprintf("%s: `%s` %s, peer %s", two($13), $14, rounded($5), rounded($7))
        method[$1, $2] = two($10)
        cvode[$1, $2] = $11 > 0 ? sprintf("%.0f", $11) : "-"
    }
    END {
        print "Whole plants: the time of the best peer over that of the plant; nanoseconds a forcing period.\n"
        print "| case | 1e-3 | 1e-6 | 1e-9 |\n|---|---|---|---|"
        for (i = 1; i <= n; i++)
            printf "| %s | %s | %s | %s |\n", name[i], plant[name[i], "1e-03"], plant[name[i], "1e-06"], plant[name[i], "1e-09"]
        print "\nThe same on baseline x86-64.\n\n| case | 1e-3 | 1e-6 | 1e-9 |\n|---|---|---|---|"
        for (i = 1; i <= n; i++)
            if ((name[i], "1e-03") in baseline)
                printf "| %s | %s | %s | %s |\n", name[i], baseline[name[i], "1e-03"], baseline[name[i], "1e-06"], baseline[name[i], "1e-09"]
        print "\nMethods alone.\n\n| case | 1e-3 | 1e-6 | 1e-9 | CVODE, 1e-6 |\n|---|---|---|---|---|"
        for (i = 1; i <= n; i++)
            printf "| %s | %s | %s | %s | %s |\n", name[i], method[name[i], "1e-03"], method[name[i], "1e-06"], method[name[i], "1e-09"], cvode[name[i], "1e-06"]
    }' "$1" "$2"

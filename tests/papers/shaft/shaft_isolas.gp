# shaft_isolas.gp - figures 14 to 16 of the shaft-bearing paper; see style.gp.

name = "shaft_isolas"; width = 1000; height = 900
eval page
set multiplot
set size 1, 0.5
set origin 0, 0.5
set logscale y
set xlabel "forcing frequency, Hz"
set ylabel "largest x1, mm"
set xrange [680:730]
set yrange [0.001:1.5]
set key bottom center maxrows 6 font ",8" spacing 1
set title "14, 15: kg = 1.4e6 N/m, 25 N"
colour(n) = word("#888888 #888888 #888888 #d4a017 #2a9d3a #5fbf6f #c22f6f #e88fb0 #e07b00 #f0b060 #9467bd #b8a0d8 #17a0b0 #888888 #7a4a2a #888888 #888888 #000000", n)
f = "14 x1"
plot csv using 3:(of(f, "balance")) with lines ls 10 title "one mode kept, averaged", csv using 3:(of(f, "theory")) with lines ls 1 title "linear, no contact", \
     csv using 3:(of(f, "branch")) with lines ls 4 title "true contact, period 1", csv using 3:(of(f, "branch unstable")) with lines ls 5 title "unstable", \
     for [n in "4 5 6 7 8 9 10 11 12 13 15 18"] csv using 3:(of(f, "isola ".n)) with lines lc rgb colour(n + 0) lw 1.6 title "isola, period ".n, \
     for [n in "4 5 6 7 8 9 10 11 12 13 15 18"] csv using 3:(of(f, "isola ".n." unstable")) with lines lc rgb colour(n + 0) lw 0.7 dt (4, 3) notitle, \
     csv using 3:(of(f, "true period 4")) with points lc rgb "#111111" pt 6 ps 0.35 title "found by random starts", \
     for [m in "'period 1' 'period 2' 'period 3' 'period 4' 'aperiodic'"] csv using 3:(of(f, "mode ".m)) with points ls 3 ps 0.4 title (m eq "period 1" ? "one mode kept" : ""), \
     csv using 3:(of(f, "true aperiodic")) with points lc rgb "#888888" pt 7 ps 0.3 title "aperiodic", 0.254 with lines ls 2 lw 0.7 title "gap"
unset logscale
set xrange [*:*]; set yrange [*:*]
set key off
set size 0.5, 0.5
set xlabel "start x1, mm"; set ylabel "start rate, m/s"
set palette maxcolors 32 defined (0 "#d0d8e8", 0.2 "#1f5fbf", 0.6 "#e07b00", 1 "#c22f6f")
set cbrange [0:1]
set cblabel "largest x1, mm" font ",8"
do for [i = 1:2] {
    hz = word("687 705", i)
    set origin 0.5 * (i - 1), 0
    set title "16: 10,000 starts by where they end, ".hz." Hz"
    plot csv using 3:(of("16 ".hz, "start")):5 with points pt 7 ps 0.35 palette
}
eval done

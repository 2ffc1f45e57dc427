# shaft_soft.gp - figures 12, 13 of the shaft-bearing paper; see style.gp.

name = "shaft_soft"; width = 1000; height = 1120
eval page
set multiplot
set size 1, 0.32; set origin 0, 0.68
set logscale y
set ylabel "largest x1, mm"
set xlabel "forcing frequency, Hz"
set key top right maxrows 6
set yrange [0.02:20]; set xrange [3:100]
f = "12 x1"
set title "12: kg = 2.626e4 N/m, 25 N"
plot csv using 3:(of(f, 'balance')) with lines ls 10 title 'one mode kept, averaged', csv using 3:(of(f, 'theory')) with lines ls 1 title 'linear, no contact', \
     csv using 3:(of(f, 'branch')) with lines ls 6 title 'true contact, period 1', csv using 3:(of(f, 'branch unstable')) with lines ls 6 dt (4, 3) lw 1 title 'unstable', \
     csv using 3:(of(f, 'true period 1')) with points ls 4 ps 0.25 title 'period 1', \
     csv using 3:(of(f, 'true period 2')) with points ls 7 title 'period 2', \
     csv using 3:(of(f, 'true period 3')) with points ls 8 title 'period 3', csv using 3:(of(f, 'true period 4')) with points lc rgb '#17a0b0' pt 5 ps 0.35 title 'periods 4 to 32', \
     csv using 3:(of(f, 'true aperiodic')) with points lc rgb '#888888' pt 7 ps 0.22 title 'aperiodic', for [p in "'period 1' 'period 2' 'period 3' 'period 4' 'aperiodic'"] csv using 3:(of(f, 'mode '.p)) with points ls 3 ps 0.45 lw 0.8 title (p eq 'period 1' ? 'one mode kept' : ''), 0.254 with lines ls 2 lw 0.7 title 'gap'
set size 0.333, 0.23
set key off
set xrange [5:21]; set yrange [0.3:5]
set ytics (0.3, 0.5, 1, 2, 5)
do for [k = 1:3] {
    set origin (k - 1) / 3.0, 0.45
    set title "12, enlarged: x".k
    set ylabel "largest x".k.", mm"
    f = "12 zoom x".k
    plot csv using 3:(of(f, 'theory')) with lines ls 1, for [p in "'period 1' 'period 3' 'aperiodic'"] csv using 3:(of(f, 'mode '.p)) with points ls 3 ps 0.45 lw 0.8, for [j = 1:4] csv using 3:(of(f, 'true period '.j)) with points pt 7 ps 0.22 lc rgb word("#1f5fbf #c22f6f #9467bd #17a0b0", j), \
         csv using 3:(of(f, 'true aperiodic')) with points lc rgb '#888888' pt 7 ps 0.22
}
unset logscale
set ytics autofreq
set xrange [*:*]; set yrange [*:*]
set xlabel "time, ms"
set size 0.333, 0.225
do for [i = 1:6] {
    set origin ((i - 1) % 3) / 3.0, i < 4 ? 0.225 : 0
    hz = i < 4 ? "12.47" : "18.49"
    k = (i - 1) % 3 + 1
    set title "13: ".hz." Hz, x".k
    set ylabel "x".k.", mm"
    set xrange [0:2000 / hz]
    set yrange [-1.2:1.8]
    if (i == 1) { set key top right font ",8" spacing 0.9 } else { set key off }
    plot for [j = 1:2] csv using 3:(of("13 ".hz." x".k, sprintf('mode %d', j))) with lines ls 9 lw 2.4 title (j == 1 ? "one mode kept" : ""), \
         for [j = 1:4] csv using 3:(of("13 ".hz." x".k, sprintf('attractor %d', j))) with lines ls word('4 6 7 8', j) + 0 lw 1 title (j == 1 ? "true contact (colours: its motions)" : ""), \
         0.254 with lines ls 2 lw 0.7 title "gap", -0.254 with lines ls 2 lw 0.7 notitle
}
eval done

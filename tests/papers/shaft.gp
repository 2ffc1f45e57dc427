# shaft.gp - figures of the shaft-bearing paper, curves and histories; see style.gp.

set samples 2
name = "shaft-linear"; width = 1000; height = 540
eval page
set multiplot layout 2, 3
set xlabel "contact stiffness kg, N/m"
set ylabel "Hz"
set logscale xy
set format x "10^{%T}"
set key top left
set title "4: gaps closed"
plot for [k = 1:3] csv using 3:(of("4", sprintf("mode %d", k))) with lines ls word("1 6 8", k) + 0 title sprintf("mode %d", k)
unset logscale; set format x "%g"
set xlabel "support ks3, N/m"
set yrange [0:50]
set key bottom right
set title "5: gaps open"
plot for [k = 1:2] csv using 3:(of("5", sprintf("mode %d", k))) with lines ls word("1 6 8", k) + 0 title sprintf("mode %d", k)
set title "21: gaps closed, kg = 2.626e4"
plot for [k = 1:2] csv using 3:(of("21", sprintf("mode %d", k))) with lines ls word("1 6 8", k) + 0 title sprintf("mode %d", k)
set logscale y
set yrange [0.01:50]
set xlabel "forcing frequency, Hz"
set ylabel "amplitude of x1, mm"
set key top right
do for [f in "6 7"] {
    set title f eq "6" ? "6: linear, 25 N on the middle" : "7: linear, 25 N on bearing 1"
    plot for [k = 0:3] csv using 3:(of(f, sprintf("ks3 %d", k))) with lines ls word("1 6 7 8", k + 1) + 0 title word("8030 4015 803 0", k + 1)." N/m"
}
eval done

points = "plot csv using 3:(of(f, 'theory')) with lines ls 1 title 'linear, no contact', \
     csv using 3:(of(f, 'mode aperiodic')) with points ls 3 ps 0.25 title 'one mode kept', csv using 3:(of(f, 'mode period 1')) with points ls 3 ps 0.25 notitle, \
     csv using 3:(of(f, 'branch')) with lines ls 6 title 'true contact, period 1', csv using 3:(of(f, 'branch unstable')) with lines ls 6 dt (4, 3) lw 1 title 'unstable', \
     csv using 3:(of(f, 'true period 1')) with points ls 4 ps 0.22 title 'true contact, period 1', csv using 3:(of(f, 'true period 2')) with points ls 7 title 'period 2', \
     csv using 3:(of(f, 'true period 3')) with points ls 8 title 'period 3', csv using 3:(of(f, 'true period 4')) with points lc rgb '#17a0b0' pt 5 ps 0.35 title 'periods 4 to 16', \
     csv using 3:(of(f, 'true aperiodic')) with points lc rgb '#888888' pt 7 ps 0.2 title 'aperiodic', 0.254 with lines ls 2 lw 0.7 title 'gap'"
name = "shaft-hard"; width = 1000; height = 330
eval page
set multiplot layout 1, 3
set logscale y
set ylabel "largest x1, mm"
set xlabel "forcing frequency, Hz"
set yrange [0.01:30]
set key off
f = "8 low 10"; set title "8: hard contact, 10 N"; eval points
f = "8 low 25"; set title "8: hard contact, 25 N"; set key top right; eval points
set key off
f = "8 high 25"; set title "8: hard contact, 25 N"; set yrange [0.005:1]; eval points
eval done

name = "shaft-soft"; width = 1000; height = 420
eval page
set multiplot layout 1, 2
set logscale y
set ylabel "largest x1, mm"
set xlabel "forcing frequency, Hz"
set key top right
f = "12"; set title "12: kg = 2.626e4 N/m, 25 N"; set yrange [0.02:20]; set xrange [3:100]; eval points
set xrange [680:725]
set key off
f = "14"; set title "14, 15: kg = 1.4e6 N/m, 25 N"; set yrange [0.005:1.5]; eval points
eval done

name = "shaft-history"; width = 1000; height = 640
eval page
set multiplot layout 3, 4
set key off
set xlabel "time, ms"
history = "plot for [k = 1:3] csv using 3:(of(f, sprintf('attractor %d', k))) with lines ls word('4 9 6', k) + 0, 0.254 with lines ls 2 lw 0.7, -0.254 with lines ls 2 lw 0.7"
do for [i = 1:4] {
    f = word("'13 12.47 x1' '13 12.47 x2' '13 18.49 x1' '13 18.49 x2'", i)
    set ylabel i % 2 ? "x1, mm" : "x2, mm"
    set title "13: ".word("12.47 12.47 18.49 18.49", i)." Hz, kg = 2.626e4"
    eval history
}
set ylabel "x1, mm"
do for [i = 1:6] {
    f = word("'18 C1 5' '18 C1 15' '18 C1 25' '18 C2 5' '18 C2 15' '18 C2 25'", i)
    set title "18: damping ".(i > 3 ? "c(1, 2, 1)" : "c(1, 1, 1)").", ".word("5 15 25 5 15 25", i)." Hz"
    eval history
}
eval done

name = "shaft-chaos"; width = 1000; height = 480
eval page
set multiplot layout 2, 3
set key off
set xlabel "x1, mm"; set ylabel "x1 rate, m/s"
do for [f in "25 80 700"] {
    set title "9: once a period, ".f." Hz"
    plot csv using 3:(of("9 ".f, "true")) with points ls 4 pt 7 ps 0.2
}
set title "19: c = 139 N s/m, 5 Hz"; set xlabel "Hz"; set ylabel "harmonics of x1, mm"
set logscale xy; set format y "10^{%T}"
set key bottom left
plot csv using 3:(of("19", "true")) with points ls 4 pt 7 ps 0.25 title "true contact", [15:2000] 0.3 * (x / 5)**(-1.5) with lines ls 2 title "slope -3/2"
set key off
unset logscale; set format y "%g"
set xlabel "start x1, mm"; set ylabel "start rate, m/s"
set cbrange [0:0.45]
set palette maxcolors 32 defined (0 "#d0d8e8", 0.2 "#1f5fbf", 0.6 "#e07b00", 1 "#c22f6f")
set cblabel "largest x1, mm" font ",8"
do for [hz in "687 705"] {
    f = "16 ".hz
    if (hz eq "687") { unset colorbox } else { set colorbox }
    set title "16: starts by where they end, ".hz." Hz"
    plot csv using 3:(of(f, "start")):5 with points pt 7 ps 0.3 palette
}
eval done

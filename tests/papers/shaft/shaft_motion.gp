# shaft_motion.gp - figures 9, 18, 19 of the shaft-bearing paper; see style.gp.

name = "shaft_motion-chaos"; width = 1000; height = 900
eval page
set multiplot layout 4, 3
set key off
do for [f in "'9 25' '9 80' '9 700'"] {
    hz = f[3:*]." Hz"
    set xlabel "time, ms"; set ylabel "x1, mm"; set yrange [-0.4:0.7]
    set title "9: ".hz
    set key top right maxrows 2 font ",8"
    plot csv using 3:(of(f." x1", "true")) with lines ls 4 lw 0.8 title "true, impacting", csv using 3:(of(f." x1", "quiet")) with lines lc rgb "#000000" lw 1.2 title (f eq "9 80" ? "true, quiet" : ""), \
         csv using 3:(of(f." x1", "mode")) with lines ls 9 title "one mode kept", 0.254 with lines ls 2 lw 0.7 title "gap", -0.254 with lines ls 2 lw 0.7 notitle
    set key off
    set xlabel "x1, mm"; set ylabel "x1 rate, m/s"; set yrange [*:*]
    set title "9: phase portrait, ".hz
    plot csv using 3:(of(f, "true portrait")) with lines ls 4 lw 0.6, csv using 3:(of(f, "mode portrait")) with lines ls 9, csv using 3:(of(f, "quiet portrait")) with lines lc rgb "#000000" lw 1.2
    set title "9: once a period, ".hz
    plot csv using 3:(of(f, "true section")) with points pt 7 ps 0.2 lc rgb "#1f5fbf", csv using 3:(of(f, "mode section")) with points pt 6 ps (f eq "9 25" ? 0.25 : 0.8) lw 1.4 lc rgb "#e07b00", csv using 3:(of(f, "quiet section")) with points pt 7 ps 0.5 lc rgb "#000000"
}
set key top right maxrows 2 font ",8"
set title "19: c = 139 N s/m, 5 Hz"; set xlabel "time, ms"; set ylabel "x1, mm"; set yrange [-0.4:0.7]
plot csv using 3:(of("19 x1", "true")) with lines ls 4 lw 0.8 title "true contact", csv using 3:(of("19 x1", "mode")) with lines ls 9 title "one mode kept", 0.254 with lines ls 2 lw 0.7 title "gap", -0.254 with lines ls 2 lw 0.7 notitle
set key off
set yrange [*:*]
set title "19: phase portrait, and once a period"; set xlabel "x1, mm"; set ylabel "x1 rate, m/s"
plot csv using 3:(of("19", "true portrait")) with lines ls 4 lw 0.6, csv using 3:(of("19", "mode portrait")) with lines ls 9 lw 0.8, \
     csv using 3:(of("19", "true section")) with points pt 7 ps 0.3 lc rgb "#c22f6f", csv using 3:(of("19", "mode section")) with points pt 6 ps 0.8 lw 1.4 lc rgb "#000000"
set title "19: harmonics"; set xlabel "Hz"; set ylabel "harmonics of x1, mm"
set logscale xy; set format y "10^{%T}"
set yrange [1e-8:10]
set key bottom left
set samples 2
plot csv using 3:(of("19", "mode harmonics")) with points ls 3 ps 0.4 title "one mode kept", csv using 3:(of("19", "true harmonics")) with points ls 4 pt 7 ps 0.25 title "true contact", [15:2000] 0.3 * (x / 5)**(-1.5) with lines ls 2 title "slope -3/2"
eval done

name = "shaft_motion-damping"; width = 1000; height = 860
eval page
set multiplot
set size 0.5, 0.38
set xlabel "forcing frequency, Hz"; set ylabel "largest x1, mm"
set logscale y; set yrange [0.05:2]
set key top right
do for [k = 1:2] {
    f = "18 C".k." x1"
    set origin (k - 1) / 2.0, 0.62
    set title "18: c = 139 N s/m, hard contact, damping c(1, ".k.", 1)"
    plot csv using 3:(of(f, "balance")) with lines ls 10 title "one mode kept, averaged", csv using 3:(of(f, "theory")) with lines ls 1 title "linear, no contact", \
         for [p in "'period 1' 'period 2' 'period 3' 'period 4' 'aperiodic'"] csv using 3:(of(f, "mode ".p)) with points ls 3 ps 0.45 title (p eq "period 1" ? "one mode kept" : ""), \
         for [p in "'period 1' 'period 2' 'period 3' 'period 4' 'aperiodic'"] csv using 3:(of(f, "true ".p)) with points pt 7 ps 0.25 lc rgb "#1f5fbf" title (p eq "period 1" ? "true contact" : ""), \
         0.254 with lines ls 2 lw 0.7 title "gap"
}
unset logscale; set yrange [-0.4:0.7]
set xlabel "time, ms"; set ylabel "x1, mm"
set size 0.333, 0.31
do for [i = 1:6] {
    set origin ((i - 1) % 3) / 3.0, i > 3 ? 0 : 0.31
    f = word("'18 C1 5 x1' '18 C1 15 x1' '18 C1 25 x1' '18 C2 5 x1' '18 C2 15 x1' '18 C2 25 x1'", i)
    set title "18: damping ".(i > 3 ? "c(1, 2, 1)" : "c(1, 1, 1)").", ".word("5 15 25 5 15 25", i)." Hz"
    if (i == 1) { set key top right maxrows 3 font ",8" } else { set key off }
    plot csv using 3:(of(f, "mode 1")) with lines ls 9 lw 2.4 title "one mode kept", for [k = 1:4] csv using 3:(of(f, sprintf('attractor %d', k))) with lines ls word('4 6 7 8', k) + 0 lw 1 title (k == 1 ? "true contact (colours: its motions)" : ""), \
         0.254 with lines ls 2 lw 0.7 title "gap", -0.254 with lines ls 2 lw 0.7 notitle
}
eval done

# shaft_motion.gp - figures 9, 18, 19 of the shaft-bearing paper; see style.gp.

name = "shaft_motion-chaos"; width = 1000; height = 900
eval page
set multiplot layout 4, 3
set key off
do for [f in "'9 25' '9 80' '9 700'"] {
    hz = f[3:*]." Hz"
    set xlabel "time, ms"; set ylabel "x1, mm"; set yrange [-0.4:0.4]
    set title "9: ".hz
    if (f eq "9 80") { set key top right horizontal } else { set key off }
    plot csv using 3:(of(f." x1", "true")) with lines ls 4 lw 0.8 title "impacting", csv using 3:(of(f." x1", "quiet")) with lines ls 9 title "quiet", 0.254 with lines ls 2 lw 0.7 notitle, -0.254 with lines ls 2 lw 0.7 notitle
    set key off
    set xlabel "x1, mm"; set ylabel "x1 rate, m/s"; set yrange [*:*]
    set title "9: phase portrait, ".hz
    plot csv using 3:(of(f, "portrait")) with lines ls 4 lw 0.6, csv using 3:(of(f, "quiet portrait")) with lines ls 9
    set title "9: once a period, ".hz
    plot csv using 3:(of(f, "section")) with points pt 7 ps 0.2 lc rgb "#c22f6f", csv using 3:(of(f, "quiet section")) with points pt 7 ps 0.5 lc rgb "#000000"
}
set title "19: c = 139 N s/m, 5 Hz"; set xlabel "time, ms"; set ylabel "x1, mm"
plot csv using 3:(of("19 x1", "true")) with lines ls 4 lw 0.8, 0.254 with lines ls 2 lw 0.7, -0.254 with lines ls 2 lw 0.7
set title "19: phase portrait, and once a period"; set xlabel "x1, mm"; set ylabel "x1 rate, m/s"
plot csv using 3:(of("19", "portrait")) with lines ls 4 lw 0.6, csv using 3:(of("19", "section")) with points pt 7 ps 0.3 lc rgb "#c22f6f"
set title "19: harmonics"; set xlabel "Hz"; set ylabel "harmonics of x1, mm"
set logscale xy; set format y "10^{%T}"
set key bottom left
set samples 2
plot csv using 3:(of("19", "harmonics")) with points ls 4 pt 7 ps 0.25 title "true contact", [15:2000] 0.3 * (x / 5)**(-1.5) with lines ls 2 title "slope -3/2"
eval done

name = "shaft_motion-damping"; width = 1000; height = 760
eval page
set multiplot
set size 1, 0.36; set origin 0, 0.64
set title "18: c = 139 N s/m, hard contact"
set xlabel "forcing frequency, Hz"; set ylabel "largest x1, mm"
set logscale y; set yrange [0.05:2]
set key top right
plot csv using 3:(of("18 C1 x1", "theory")) with lines ls 1 title "linear, no contact, c(1, 1, 1)", csv using 3:(of("18 C2 x1", "theory")) with lines ls 2 title "c(1, 2, 1)", \
     for [k = 1:5] csv using 3:(of("18 C1 x1", "true ".word("aperiodic period_1 period_2 period_3 period_4", k)[1:6].(k == 1 ? "dic" : " ".(k - 1)))) with points pt 7 ps 0.3 lc rgb "#c22f6f" title (k == 1 ? "true contact, c(1, 1, 1)" : ""), \
     for [k = 1:5] csv using 3:(of("18 C2 x1", "true ".word("aperiodic period_1 period_2 period_3 period_4", k)[1:6].(k == 1 ? "dic" : " ".(k - 1)))) with points pt 6 ps 0.3 lc rgb "#1f5fbf" title (k == 1 ? "true contact, c(1, 2, 1)" : ""), \
     0.254 with lines ls 2 lw 0.7 title "gap"
unset logscale; set yrange [-0.4:0.4]
set key off
set xlabel "time, ms"; set ylabel "x1, mm"
set size 0.333, 0.32
do for [i = 1:6] {
    set origin ((i - 1) % 3) / 3.0, i > 3 ? 0 : 0.32
    f = word("'18 C1 5 x1' '18 C1 15 x1' '18 C1 25 x1' '18 C2 5 x1' '18 C2 15 x1' '18 C2 25 x1'", i)
    set title "18: damping ".(i > 3 ? "c(1, 2, 1)" : "c(1, 1, 1)").", ".word("5 15 25 5 15 25", i)." Hz"
    plot for [k = 1:4] csv using 3:(of(f, sprintf('attractor %d', k))) with lines ls word('4 9 6 7', k) + 0 lw 1, 0.254 with lines ls 2 lw 0.7, -0.254 with lines ls 2 lw 0.7
}
eval done

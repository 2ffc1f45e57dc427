# shaft_hard.gp - figure 8 of the shaft-bearing paper; see style.gp.

name = "shaft_hard"; width = 1000; height = 660
eval page
set multiplot layout 2, 3
set logscale y
set xlabel "forcing frequency, Hz"
do for [band in "low high"] {
    if (band eq "low") { set yrange [0.005:100] } else { set yrange [0.0005:3] }
    do for [k = 1:3] {
        f = "8 ".band." x".k
        set title "8: hard contact, x".k
        set ylabel "largest x".k.", mm"
        if (k == 1 && band eq "low") { set key top right font ",8" spacing 0.9 } else { set key off }
        plot csv using 3:(of(f, "balance")) with lines ls 10 title "one mode kept, averaged, 25 N", for [p in "15 25 35"] csv using 3:(of(f, "theory ".p)) with lines lc rgb "#bbbbbb" lw 1 title (p eq "15" ? "linear, no contact" : ""), \
             for [m in "'aperiodic' 'period 1' 'period 2' 'period 3' 'period 4'"] csv using 3:(of(f, "mode 25 ".m)) with points ls 3 ps 0.35 title (m eq "aperiodic" ? "one mode kept, 25 N" : ""), \
             for [i = 1:3] csv using 3:(of(f, "true ".word("15 25 35", i)." aperiodic")) with points pt 7 ps 0.25 lc rgb word("#2a9d3a #1f5fbf #9467bd", i) title "true contact, ".word("15 25 35", i)." N", \
             for [i = 1:3] csv using 3:(of(f, "true ".word("15 25 35", i)." period 1")) with points pt 7 ps 0.25 lc rgb word("#2a9d3a #1f5fbf #9467bd", i) notitle, \
             csv using 3:(of(f, "branch")) with lines lc rgb "#c22f6f" lw 1 title "period 1, 25 N", csv using 3:(of(f, "branch unstable")) with lines lc rgb "#c22f6f" dt (4, 3) lw 1.4 title "unstable", \
             0.254 with lines ls 2 lw 0.7 title "gap"
    }
}
eval done

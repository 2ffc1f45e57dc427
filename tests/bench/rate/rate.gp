# rate.gp - error against instructions per period on a Cortex-M7.
#   gnuplot -e "csv='docs/img/board_rate.csv'; out='docs/img/board_rate.svg'" tests/bench/rate/rate.gp
set terminal svg size 960,720 font "sans,13" background "#ffffff"
set output out
set datafile separator ","
set logscale xy
set format x "10^{%T}"
set format y "10^{%T}"
set grid lc rgb "#dddddd"
set multiplot layout 2,2
set key top left samplen 1.5 Left reverse
set xrange [1:1e-12] reverse
set xlabel "error"
set ylabel "instructions per period"
pick(c, m, e) = strcol(1) eq c && strcol(2) eq m && e > 0 && e < 1 ? e : NaN
do for [panel in "rig_lost rig_kept tip_repelled shaft"] {
    if (panel eq "shaft") { set yrange [1e5:1e8] } else { set yrange [1e4:3e6] }
    set title panel eq "rig_lost" ? "rig, contact lost" : panel eq "rig_kept" ? "rig, contact kept" : \
              panel eq "tip_repelled" ? "AFM tip, repelled, lock-in amplitude" : "shaft, 46 switches in 4 periods"
    plot csv skip 1 using (pick(panel, "rk4", $5)):6 with linespoints pt 7 ps 0.4 lc rgb "#1f5fbf" title "rk4", \
         csv skip 1 using (pick(panel, "rk4_float32", $5)):6 with linespoints pt 7 ps 0.4 lc rgb "#c0392b" title "rk4\\_float32", \
         csv skip 1 using (pick(panel, "taylor", $5)):($3 == 16 ? $6 : NaN) with linespoints pt 5 ps 0.6 lc rgb "#2e8b57" title "taylor", \
         csv skip 1 using (pick(panel, "exact", $5)):6 with points pt 9 ps 1 lc rgb "#7d3c98" title "exact"
}
unset multiplot

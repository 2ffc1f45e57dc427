# ledger.gp - rules for the energy ledger: error against instructions of a tick, from docs/img/ledger.csv; run from the folder above docs.
set datafile separator ","
set terminal svg size 1000, 820 background rgb 'white' font 'Helvetica,11' dynamic
set output "docs/img/ledger.svg"
csv = "docs/img/ledger.csv"
set border 3 lc rgb '#555555'
set grid xtics ytics lc rgb '#dcdcdc' lt 1 lw 0.6
set xtics nomirror textcolor rgb '#222222'
set ytics nomirror textcolor rgb '#222222'
set multiplot
set logscale xy
set format x "10^{%T}"
set xrange [2e-3:1e-10] noextend
set xlabel "error over the energy of a period" offset 0, 0.4
set style line 1 lc rgb "#1f5fbf" lw 2.6 pt 7 ps 0.5
set style line 2 lc rgb "#7f7f7f" lw 1.3 pt 11 ps 0.5
set style line 3 lc rgb "#17a0b0" lw 1.3 pt 13 ps 0.6
set style line 4 lc rgb "#2a9d3a" lw 2 pt 5 ps 0.4
set style line 5 lc rgb "#c8a000" lw 1.3 pt 9 ps 0.5
set style line 6 lc rgb "#d62728" lw 2 pt 7 ps 0.4
set style line 7 lc rgb "#e07070" lw 1.3 dt (6, 3) pt 6 ps 0.5
set style line 8 lc rgb "#9467bd" lw 2 pt 9 ps 0.6
rows(rule) = sprintf("< grep ^%s,%s, %s", scene, rule, csv)
scenes = "rig_rk4 rig_taylor tip shaft"
titles = "'rig by rk4, 64 to 1024 ticks a period' 'rig by taylor at 1e-9' 'AFM tip by taylor at 1e-9' 'shaft by exact, 46 switches, 256 to 4096 ticks'"
do for [k = 1:4] {
    scene = word(scenes, k)
    set title word(titles, k) font ',12' offset 0, -0.4
    set origin 0.5 * ((k - 1) % 2), 0.57 - 0.43 * ((k - 1) / 2)
    set size 0.5, 0.43
    set ylabel k % 2 ? "instructions a tick" : "" offset 0.8, 0
    set yrange [k == 4 ? 80 : 8:600]
    set ytics (10, 20, 50, 100, 200, 500)
    unset key
    plot rows("simpson") using 4:5 with linespoints ls 1, rows("trapezoid") using 4:5 with linespoints ls 2, \
         rows("with_ends") using 4:5 with linespoints ls 3, rows("hermite") using 4:5 with linespoints ls 4, \
         rows("boole") using 4:5 with linespoints ls 5, rows("series") using 4:5 with linespoints ls 6, \
         rows("terms") using 4:5 with linespoints ls 7, rows("forms") using 4:5 with linespoints ls 8
}
# One key for all.
set origin 0, 0
set size 1, 0.13
unset title
unset xlabel
unset ylabel
unset border
unset tics
unset grid
set key center center horizontal Left reverse samplen 2 spacing 1.2 maxrows 3 width -2
set xrange [1:2]
set yrange [1:2]
plot NaN with linespoints ls 1 title "Simpson, quintic middle: the ledger", NaN with linespoints ls 2 title "trapezoid", \
     NaN with linespoints ls 3 title "trapezoid with end terms", NaN with linespoints ls 4 title "Hermite over two ticks", \
     NaN with linespoints ls 5 title "Boole over four ticks", NaN with linespoints ls 6 title "series of taylor, summed when they end", \
     NaN with linespoints ls 7 title "series of taylor, read each tick", NaN with linespoints ls 8 title "closed forms, Simpson at switches"
unset multiplot

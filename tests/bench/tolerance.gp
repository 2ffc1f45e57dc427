# tolerance.gp - what adaptive solvers deliver for the tolerance they were given, from docs/img/tolerance_truth.csv; run from the
# project's top folder. On the diagonal the error is the tolerance; above it the solver has promised too much.

csv = "docs/img/tolerance_truth.csv"
name = "tolerance_truth"
set datafile separator ","
set datafile missing NaN
set terminal svg size 1200, 450 background rgb 'white' font 'Helvetica,11' dynamic
set output sprintf('docs/img/%s.svg', name)
set border 3 lc rgb '#555555'
set grid xtics ytics lc rgb '#dcdcdc' lt 1 lw 0.6
set xtics nomirror textcolor rgb '#222222'
set ytics nomirror textcolor rgb '#222222'
set title font ',12' textcolor rgb '#111111' offset 0, -0.4
set logscale xy
set format xy "10^{%T}"
set xrange [1e-2:1e-14]
set yrange [1e-15:10]
set xlabel "tolerance given, absolute and relative"
of(c, solver, setting) = strcol(1) eq c && strcol(2) eq solver && strcol(3) eq setting ? column(5) : NaN
any(c, solver) = strcol(1) eq c && strcol(2) eq solver ? column(5) : NaN
stats csv using (any("C1", "exact")) nooutput
exact_error = STATS_max
# Lines and their names; the third panel is the key.
array solver[8] = ["CVODE", "CVODE", "CVODE", "GSL rk8pd", "GSL rk8pd", "odeint dopri5", "odeint dopri5", "odeint rkf78"]
array setting[8] = ["Adams + no roots", "Adams + roots + reinit", "BDF + roots + reinit", "driver", "events", "dense", \
                    "dense + events", "controlled"]
array label[8] = ["CVODE Adams", "CVODE Adams, switches located", "CVODE BDF, switches located", "GSL rk8pd", \
                  "GSL rk8pd, switches located", "odeint dopri5", "odeint dopri5, switches located", "odeint rkf78"]
set style line 1 lc rgb "#7f7f7f" pt 4 ps 0.4
set style line 2 lc rgb "#222222" pt 5 ps 0.4
set style line 3 lc rgb "#c8a000" pt 7 ps 0.4
set style line 4 lc rgb "#8c564b" pt 9 ps 0.45
set style line 5 lc rgb "#d9a899" pt 8 ps 0.45
set style line 6 lc rgb "#9467bd" pt 11 ps 0.45
set style line 7 lc rgb "#c5b0d5" pt 10 ps 0.45
set style line 8 lc rgb "#e377c2" pt 13 ps 0.45
set style line 9 lc rgb "#333333" lw 1 dt (5, 4)
set style line 10 lc rgb "#d62728" pt 7 ps 0.5
set style line 11 lc rgb "#2a9d3a" lw 2.6
set multiplot
set tmargin at screen 0.92
set bmargin at screen 0.13
unset key
do for [k = 1:2] {
    c = word("A1 C1", k)
    set lmargin at screen 0.07 + 0.37 * (k - 1)
    set rmargin at screen 0.365 + 0.37 * (k - 1)
    set title word("'rig, contact lost in each of 20 periods' 'shaft, 25 Hz, 46 switches in 4 periods'", k)
    set ylabel (k == 1 ? "true error / largest value of each state" : "")
    plot x with lines ls 9, for [i = 1:8] csv using 4:(of(c, solver[i], setting[i])) with linespoints ls i, \
         csv using 4:(any(c, "taylor")) with points ls 10, (k == 2 ? exact_error : NaN) with lines ls 11
}
set lmargin at screen 0.76
set rmargin at screen 0.99
unset title; unset xlabel; unset ylabel; unset xtics; unset ytics; unset border; unset grid
set key at screen 0.76, screen 0.9 left top Left reverse samplen 2 spacing 1.3
plot NaN with lines ls 9 title "error = tolerance", for [i = 1:8] NaN with linespoints ls i title label[i], \
     NaN with points ls 10 title "taylor, several steps", NaN with lines ls 11 title "exact, has no tolerance"
unset multiplot
unset output

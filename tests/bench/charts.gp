# charts.gp - work-precision charts: cost of each solver against the error that it reached, one chart a plant.
#   gnuplot -e "csv='docs/img/bench_front.csv'; out='docs/img'" tests/bench/charts.gp
# A point is a run that no other setting of the same solver beats. Down and right is good.

if (!exists("csv")) csv = "build/bench/front.csv"
if (!exists("out")) out = "docs/img"

array solver[13] = ["taylor", "exact", "rk4", "adams", "taylor plant", "exact plant", "adams plant", "GSL rk8pd", \
                    "odeint dopri5", "odeint rkf78", "odeint rk4", "CVODE", "naive RK4 loop"]
array label[13] = ["taylor", "exact", "rk4", "adams", "taylor, whole plant tick", "exact, whole plant tick", \
                   "adams, whole plant tick", "GSL rk8pd", "odeint dopri5", "odeint rkf78", "odeint rk4", \
                   "SUNDIALS CVODE", "naive RK4 loop"]
# Ours: thick, the plant around them dashed. Peers: thin.
set style line 1 lc rgb "#d62728" lw 2.6 pt 7 ps 0.35
set style line 2 lc rgb "#2a9d3a" lw 2.6 pt 7 ps 0.6
set style line 3 lc rgb "#1f5fbf" lw 2.6 pt 7 ps 0.35
set style line 4 lc rgb "#111111" lw 2.6 pt 7 ps 0.35
set style line 5 lc rgb "#d62728" lw 1.4 dt (6, 4) pt 7 ps 0.25
set style line 6 lc rgb "#2a9d3a" lw 1.4 dt (6, 4) pt 6 ps 0.6
set style line 7 lc rgb "#111111" lw 1.4 dt (6, 4) pt 7 ps 0.25
set style line 8 lc rgb "#8c564b" lw 1.2 pt 5 ps 0.3
set style line 9 lc rgb "#9467bd" lw 1.2 pt 9 ps 0.4
set style line 10 lc rgb "#e377c2" lw 1.2 pt 11 ps 0.4
set style line 11 lc rgb "#17a0b0" lw 1.2 pt 13 ps 0.4
set style line 12 lc rgb "#7f7f7f" lw 1.2 pt 4 ps 0.35
set style line 13 lc rgb "#c8a000" lw 1.2 pt 8 ps 0.4

set datafile separator ","
set logscale xy
set xrange [1:1e-14]
axes = "\
set xtics nomirror ('1' 1, '10^{-2}' 1e-2, '10^{-4}' 1e-4, '10^{-6}' 1e-6, '10^{-8}' 1e-8, '10^{-10}' 1e-10, \
    '10^{-12}' 1e-12, '10^{-14}' 1e-14) textcolor rgb '#222222'; \
set ytics nomirror format '10^{%T}' textcolor rgb '#222222'; \
set mytics 10; \
set grid xtics ytics lc rgb '#dcdcdc' lt 1 lw 0.6; \
set border 3 lc rgb '#555555'"
no_axes = "unset title; unset xlabel; unset ylabel; unset xtics; unset ytics; unset mytics; unset border; unset grid"
set title font ",12" textcolor rgb "#111111" offset 0, -0.4

error(c, s) = strcol(1) eq c && strcol(3) eq s ? column(6) : NaN

# `n` panels side by side with the solvers of all of them in one key on the right.
width = 400
key = 190
margin = 66

chart = "\
set terminal svg size n * width + key, 430 background rgb 'white' font 'Helvetica,11' dynamic; \
set output sprintf('%s/bench_%s.svg', out, file); \
total = n * width + key * 1.0; \
set multiplot; \
eval axes; \
do for [i = 1:n] { \
    set lmargin at screen ((i - 1) * width + margin) / total; \
    set rmargin at screen (i * width - 10) / total; \
    set tmargin at screen 0.91; \
    set bmargin at screen 0.125; \
    c = word(cases, i); \
    set title word(titles, i); \
    set xlabel 'largest error / largest value of each state' textcolor rgb '#222222'; \
    set ylabel (i == 1 ? 'CPU time, ns per forcing period' : '') textcolor rgb '#222222'; \
    unset key; \
    plot for [k = 1:13] csv using (error(c, solver[k])):7 with linespoints ls k notitle \
}; \
seen = ''; \
do for [k = 1:13] { \
    found = 0; \
    do for [i = 1:n] { c = word(cases, i); \
        stats csv using (error(c, solver[k]) > 0 ? 1 : 0) nooutput; found = found + STATS_max }; \
    seen = seen . (found > 0 ? sprintf(' %d', k) : '') \
}; \
set lmargin at screen n * width / total; set rmargin at screen 1; \
eval no_axes; \
set key at screen (n * width + 8) / total, screen 0.9 left top Left reverse samplen 2.2 spacing 1.35 textcolor rgb '#222222'; \
plot [1:1e-14] [1:10] for [q in seen] NaN with linespoints ls (q + 0) title label[q + 0]; \
unset multiplot; \
eval axes; \
unset output"

n = 2
file = "hertz_rig"
cases = "A1 A2"
titles = "'rig: contact lost in every cycle' 'rig: smooth, drive at 8'"
eval chart

n = 3
file = "hertz_rig_fast"
cases = "base5 force60 stiff5"
titles = "'rig: fast base, 5' 'rig: fast force, 60' 'rig: fast stiffness, 5'"
eval chart

n = 1
file = "rolling_contact"
cases = "roll045"
titles = "'rolling contact: waviness 0.45'"
eval chart

n = 2
file = "afm_tip"
cases = "tip tip_r05"
titles = "'repulsive tip: contact lost' 'repulsive tip: stiffness modulation 0.5'"
eval chart

n = 2
file = "shaft_bearing"
cases = "C1 C2"
titles = "'shaft: 25 Hz, c = 139 N s/m, 46 switches' 'shaft: 80 Hz, c = 4 N s/m, 4 switches'"
eval chart

n = 2
file = "held"
cases = "A1held C1held"
titles = "'rig: force held for 1/128 period' 'shaft, 25 Hz: force held for 1/128 period'"
eval chart

# float32.gp - error of rk4_float32 beside rk4, against steps per period and against the number of periods.
#   gnuplot -e "csv='docs/img/float32.csv'; out='docs/img/float32.svg'" tests/bench/float32.gp

if (!exists("csv")) csv = "docs/img/float32.csv"
if (!exists("out")) out = "docs/img/float32.svg"

array method[4] = ["rk4", "rk4_float32", "float state", "float state and time"]
array label[4] = ["rk4 (double)", "rk4\\_float32", "naive, float state", "naive, float state and time"]
set style line 1 lc rgb "#1f5fbf" lw 2.2 pt 7 ps 0.3
set style line 2 lc rgb "#d62728" lw 2.6 pt 7 ps 0.35
set style line 3 lc rgb "#c8a000" lw 1.4 pt 8 ps 0.45
set style line 4 lc rgb "#7f7f7f" lw 1.4 pt 4 ps 0.4

set terminal svg size 1180, 700 background rgb "white" font "Helvetica,11" dynamic
set output out
set datafile separator ","
set logscale xy
set format x "10^{%T}"
set format y "10^{%T}"
set xtics nomirror textcolor rgb "#222222"
set ytics nomirror 1e2 textcolor rgb "#222222"
set mxtics 10
set grid xtics ytics lc rgb "#dcdcdc" lt 1 lw 0.6
set border 3 lc rgb "#555555"
set title font ",12" textcolor rgb "#111111" offset 0, -0.4
set yrange [1e-13:10]
unset key

error(chart, c, m) = strcol(1) eq chart && strcol(2) eq c && strcol(3) eq m ? column(5) : NaN

panel = "\
set lmargin at screen (0.078 + 0.333 * column_of); \
set rmargin at screen (0.078 + 0.333 * column_of + 0.245); \
set tmargin at screen (0.945 - 0.5 * row_of); \
set bmargin at screen (0.945 - 0.5 * row_of - 0.36); \
set ylabel (column_of == 0 ? 'error / largest deviation' : '') textcolor rgb '#222222'; \
plot for [k = 1:4] csv using 4:(error(chart, case, method[k])) with linespoints ls k title label[k]"

set multiplot
chart = "steps"
set xlabel "steps per drive period" textcolor rgb "#222222"
set xrange [10:2e4]
row_of = 0
column_of = 0; case = "rig kept"; set title "rig, drive at 8, contact kept, 160 periods"; eval panel
column_of = 1; case = "rig lost"; set title "rig, contact lost in every cycle, 20 periods"; eval panel
column_of = 2; case = "tip kept"; set title "tip, contact kept, 100 periods"; eval panel
row_of = 1
set key left bottom Left reverse samplen 1.6 spacing 1.15 textcolor rgb "#222222"
column_of = 0; case = "shaft kept"; set title "shaft between its gaps, 100 periods"; eval panel
unset key
column_of = 1; case = "rig steady"; set title "rig, steady, 300 periods"; eval panel
chart = "periods"
set xlabel "periods" textcolor rgb "#222222"
set xrange [1:1e5]
column_of = 2; set title "rig, steady, 128 steps a period"; eval panel
unset multiplot
unset output

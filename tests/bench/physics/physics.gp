# physics.gp - charts of what methods get wrong, from docs/img/NAME.csv to docs/img/NAME.svg; run from the project's top folder.
# Ours thick, in the colours of charts.gp; classical methods thin.

set datafile separator ","
set datafile missing NaN
set style line 1 lc rgb "#d62728" lw 2.6 pt 7 ps 0.35
set style line 2 lc rgb "#2a9d3a" lw 2.6 pt 7 ps 0.35
set style line 3 lc rgb "#1f5fbf" lw 2.6 pt 7 ps 0.35
set style line 4 lc rgb "#17a0b0" lw 1.3 pt 13 ps 0.45
set style line 5 lc rgb "#9467bd" lw 1.3 pt 9 ps 0.45
set style line 6 lc rgb "#c8a000" lw 1.3 pt 5 ps 0.35
set style line 7 lc rgb "#7f7f7f" lw 1.3 pt 11 ps 0.45
set style line 8 lc rgb "#e07070" lw 1.6 dt (6, 3) pt 6 ps 0.35
set style line 10 lc rgb "#999999" lw 1 dt (2, 3)
set style line 11 lc rgb "#333333" lw 1 dt (5, 4)
grey = "set border 3 lc rgb '#555555'; set grid xtics ytics lc rgb '#dcdcdc' lt 1 lw 0.6; \
        set xtics nomirror textcolor rgb '#222222'; set ytics nomirror textcolor rgb '#222222'; \
        set title font ',12' textcolor rgb '#111111' offset 0, -0.4"
eval grey
power = "10^{%T}"
start = "set terminal svg size width, 430 background rgb 'white' font 'Helvetica,11' dynamic; \
         set output sprintf('docs/img/%s.svg', name); csv = sprintf('docs/img/%s.csv', name)"
stop = "unset multiplot; unset output; unset tmargin; unset bmargin; unset logscale; unset label; unset arrow; set format '%g'; set xrange [*:*]; \
        set yrange [*:*]; set xtics autofreq; set ytics autofreq; unset ylabel; unset xlabel; set key default; unset title"

# Column y of the rows whose first, or first two, columns are these.
of(a, y) = strcol(1) eq a ? column(y) : NaN
of2(a, b, y) = strcol(1) eq a && strcol(2) eq b ? column(y) : NaN

# Guard of a method at x, labelled.
guard = "set arrow from first x, graph 0 to first x, graph 1 nohead ls 11 back; \
         set label caption at first x, graph height rotate by 90 font ',9' textcolor rgb '#333333' offset 0.7, 0"

# ---- order_kink ----
name = "order_kink"
width = 1000
eval start
set terminal svg size width, 480 background rgb 'white' font 'Helvetica,11' dynamic
set multiplot layout 1, 2
set tmargin at screen 0.92
set bmargin at screen 0.34
set logscale xy
set format xy power
set xlabel "h ω of the closed contact, rad"
set key below Left reverse samplen 2 spacing 1.2 maxrows 3
fit_of = "stats [log(0.003):log(0.15)] [*:*] csv using (log(column(3))):(of2(plant, method, 4) > 0 ? log(column(4)) : NaN) nooutput; fitted = STATS_slope"
set xrange [1:1e-3]
set yrange [1e-15:1]
x = 0.2; caption = "guard of rk4"; height = 0.03
eval guard
plant = "hertz"
set title "Hertz contact, one touchdown and lift-off"
set ylabel "state error after one period / size"
method = "plain RK4"; eval fit_of; plain = fitted
method = "rk4"; eval fit_of; shipped = fitted
plot csv using 3:(of2("hertz", "plain RK4", 4)):5:6 with yerrorbars lc rgb "#9fd8de" lw 1 pt -1 notitle, \
     csv using 3:(of2("hertz", "rk4", 4)):5:6 with yerrorbars lc rgb "#b3c7e6" lw 1 pt -1 notitle, \
     csv using 3:(of2("hertz", "plain RK4", 4)) with linespoints ls 4 title sprintf("plain RK4, no switch located: slope %.2f", plain), \
     csv using 3:(of2("hertz", "rk4", 4)) with linespoints ls 3 title sprintf("rk4, switches located: slope %.2f", shipped), \
     csv using 3:(of2("hertz", "taylor 1e-6", 4)) with linespoints ls 8 title "taylor, tol 1e-6", \
     csv using 3:(of2("hertz", "taylor 1e-12", 4)) with linespoints ls 1 title "taylor, tol 1e-12", \
     0.06 * x**2.5 with lines ls 10 title "slope 2.5"
plant = "gap"
set title "gap springs, two touchdowns and lift-offs"
unset ylabel
method = "plain RK4"; eval fit_of; plain = fitted
method = "rk4"; eval fit_of; shipped = fitted
plot csv using 3:(of2("gap", "plain RK4", 4)):5:6 with yerrorbars lc rgb "#9fd8de" lw 1 pt -1 notitle, \
     csv using 3:(of2("gap", "rk4", 4)):5:6 with yerrorbars lc rgb "#b3c7e6" lw 1 pt -1 notitle, \
     csv using 3:(of2("gap", "plain RK4", 4)) with linespoints ls 4 title sprintf("plain RK4, no switch located: slope %.2f", plain), \
     csv using 3:(of2("gap", "rk4", 4)) with linespoints ls 3 title sprintf("rk4, switches located: slope %.2f", shipped), \
     csv using 3:(of2("gap", "exact", 4)) with linespoints ls 2 title "exact", \
     0.3 * x**2 with lines ls 10 title "slopes 2 and 4", 0.002 * x**4 with lines ls 10 notitle
eval stop

# ---- energy_bounce ----
name = "energy_bounce"
width = 1000
eval start
set terminal svg size width, 760 background rgb 'white' font 'Helvetica,11' dynamic
set multiplot layout 2, 2
set logscale xy
set xrange [0.09:3.4]
set xtics (0.1, 0.2, 0.4, 0.8, 1.6, 3.2)
set xlabel "h ω of the contact, rad"
limit(y) = y < -0.999 ? 1e-3 : 1 + y > 1e6 ? 1e6 : 1 + y
do for [row = 1:2] {
    do for [col = 1:2] {
        plant = col == 1 ? "spring" : "hertz"
        best = col == 1 ? "exact" : "taylor"
        unset arrow
        unset label
        x = 0.2; caption = "guard of rk4"; height = 0.03
        if (col == 2) { x = 0.376 }
        eval guard
        if (col == 1) { x = 2.1; caption = "guard of exact"; eval guard }
        set title (col == 1 ? "stiff spring" : "Hertz contact") . (row == 1 ? ", 350 bounces: energy left" : ", 350 bounces: energy error")
        if (row == 1) {
            set yrange [5e-4:2e6]
            set format y power
            set ylabel (col == 1 ? "energy at the end / at the start" : "")
            set key left top Left reverse samplen 2 spacing 1.2
            plot csv using (of2(plant, "plain RK4", 3)):(limit(column(4))) with linespoints ls 4 title "plain RK4", \
                 csv using (of2(plant, "Verlet", 3)):(limit(column(4))) with linespoints ls 5 title "Verlet", \
                 csv using (of2(plant, "Newmark", 3)):(limit(column(4))) with linespoints ls 6 title "Newmark", \
                 csv using (of2(plant, "semi-implicit Euler", 3)):(limit(column(4))) with linespoints ls 7 title "semi-implicit Euler", \
                 csv using (of2(plant, "rk4", 3)):(limit(column(4))) with linespoints ls 3 title "rk4", \
                 csv using (of2(plant, best, 3)):(limit(column(4))) with linespoints ls (col == 1 ? 2 : 1) title best
        } else {
            set yrange [1e-15:1e3]
            set ylabel (col == 1 ? "largest |energy change| / energy, of 7 runs" : "")
            unset key
            worst(a) = strcol(1) eq plant && strcol(2) eq a ? (abs(column(5)) > abs(column(6)) ? abs(column(5)) : abs(column(6))) : NaN
            plot csv using 3:(worst("plain RK4")) with linespoints ls 4, csv using 3:(worst("Verlet")) with linespoints ls 5, \
                 csv using 3:(worst("Newmark")) with linespoints ls 6, \
                 csv using 3:(worst("semi-implicit Euler")) with linespoints ls 7, \
                 csv using 3:(worst("rk4")) with linespoints ls 3, \
                 csv using 3:(worst(best)) with linespoints ls (col == 1 ? 2 : 1)
        }
    }
}
eval stop

# ---- energy_drift ----
name = "energy_drift"
width = 760
eval start
set logscale xy
set format xy power
set xrange [1:1e4]
set yrange [1e-13:2]
set xlabel "periods"
set ylabel "largest |energy error| / energy"
set title "free Hertz rig, 32 steps a period, η_{max} 1.5, 2, 2.5, 3, 3.5"
set key outside right top Left reverse samplen 2 spacing 1.3
run(m, k) = strcol(1) eq m && column(2) == 1 + 0.5 * k ? column(4) : NaN
plot for [k = 1:5] csv using 3:(run("semi-implicit Euler", k)) with lines ls 7 title (k == 1 ? "semi-implicit Euler" : ""), \
     for [k = 1:5] csv using 3:(run("Verlet", k)) with lines ls 5 title (k == 1 ? "Verlet" : ""), \
     for [k = 1:5] csv using 3:(run("Newmark", k)) with lines ls 6 title (k == 1 ? "Newmark" : ""), \
     for [k = 1:5] csv using 3:(run("plain RK4", k)) with lines ls 4 title (k == 1 ? "plain RK4" : ""), \
     for [k = 1:5] csv using 3:(run("rk4", k)) with lines ls 3 title (k == 1 ? "rk4" : ""), \
     for [k = 1:5] csv using 3:(run("taylor 1e-9", k)) with lines ls 8 title (k == 1 ? "taylor, tol 1e-9" : ""), \
     for [k = 1:5] csv using 3:(run("taylor 1e-12", k)) with lines ls 1 title (k == 1 ? "taylor, tol 1e-12" : "")
eval stop

# ---- observables ----
name = "observables"
width = 1000
eval start
set terminal svg size width, 760 background rgb 'white' font 'Helvetica,11' dynamic
set multiplot layout 2, 2
set logscale xy
set format xy power
set xrange [1:1e-8]
set yrange [1e2:1e5]
set xlabel "error / true value"
do for [k = 0:3] {
    set title word("'energy, worst of all steps' 'contact time, worst of 100' 'peak force, worst of 100' 'state after 100 periods'", k + 1)
    set ylabel (k % 2 == 0 ? "CPU time, ns per period" : "")
    if (k == 0) { set key left top Left reverse samplen 2 spacing 1.2 } else { unset key }
    plot csv using (of("Verlet", 5 + k)):4 with linespoints ls 5 title "Verlet", \
         csv using (of("plain RK4", 5 + k)):4 with linespoints ls 4 title "plain RK4", \
         csv using (of("rk4", 5 + k)):4 with linespoints ls 3 title "rk4", \
         csv using (of("taylor", 5 + k)):4 with points lc rgb "#d62728" pt 7 ps 0.25 title "taylor, all tolerances and steps"
}
eval stop

# ---- floquet ----
name = "floquet"
width = 1100
eval start
set multiplot layout 1, 2
set xrange [1.84:2.16]
set xlabel "frequency of the modulation / eigenfrequency"
steps(panel, m, n) = strcol(1) eq panel && strcol(2) eq m && column(3) == n ? column(5) : NaN
set title "modulation 0.12"
set ylabel "largest |multiplier| per period of the modulation"
set yrange [0.94:1.2]
set key left top Left reverse samplen 2 spacing 1.15
set arrow from first 1.84, first 1 to first 2.16, first 1 nohead ls 11 back
set label "unstable" at first 2.158, first 1.003 right font ',9' textcolor rgb '#333333'
plot csv using 4:(steps("magnitude", "plant", 0)) with lines lc rgb "#111111" lw 4 title "the plant itself", \
     csv using 4:(steps("magnitude", "rk4", 4)) with lines ls 3 title "rk4, 4 steps a period (the guard asks for 16)", \
     csv using 4:(steps("magnitude", "rk4", 8)) with lines ls 3 dt (2, 2) title "rk4, 8 steps", \
     csv using 4:(steps("magnitude", "Verlet", 4)) with lines ls 5 title "Verlet, 4 steps", \
     csv using 4:(steps("magnitude", "Verlet", 8)) with lines ls 5 dt (4, 3) title "Verlet, 8 steps", \
     csv using 4:(steps("magnitude", "Newmark", 4)) with lines ls 6 title "Newmark, 4 steps", \
     csv using 4:(steps("magnitude", "Newmark", 8)) with lines ls 6 dt (4, 3) title "Newmark, 8 steps", \
     csv using 4:(steps("magnitude", "semi-implicit Euler", 8)) with lines ls 7 dt (2, 2) title "semi-implicit Euler, 8 steps"
unset arrow
unset label
set title "edge of the tongue: above it the rest position is unstable"
set ylabel "modulation"
set yrange [0:0.4]
set key bottom left Left reverse samplen 1
$hill << END
1.98,0.056289308152417505
2.02,0.05685485091192883
2.1,0.2069119111170403
END
plot csv using 4:(steps("edge", "plant", 0)) with lines lc rgb "#111111" lw 4 notitle, \
     csv using 4:(steps("edge", "rk4", 4)) with lines ls 3 notitle, \
     csv using 4:(steps("edge", "Verlet", 4)) with lines ls 5 notitle, \
     csv using 4:(steps("edge", "Verlet", 8)) with lines ls 5 dt (4, 3) notitle, \
     csv using 4:(steps("edge", "Newmark", 4)) with lines ls 6 notitle, \
     csv using 4:(steps("edge", "Newmark", 8)) with lines ls 6 dt (4, 3) notitle, \
     $hill using 1:2 with points pt 6 ps 1.2 lw 1.5 lc rgb "#d62728" title "plant, from Hill's equation"
eval stop

# ---- phasor ----
name = "phasor"
width = 800
eval start
set logscale xy
set format xy power
set xrange [1e3:1e9]
set yrange [1e-15:10]
set xlabel "ticks"
set ylabel "error of the drive's phase, rad"
set title "a drive after many ticks"
set key outside right top Left reverse samplen 2 spacing 1.3
plot csv using 2:(of("cos of t += h float32", 3)) with linespoints ls 7 title "cos of t += h, float32", \
     csv using 2:(of("rotation float32", 3)) with linespoints ls 6 title "rotation, float32", \
     csv using 2:(of("cos of t += h", 3)) with linespoints ls 5 title "cos of t += h, double", \
     csv using 2:(of("rotation", 3)) with linespoints ls 4 title "rotation, double", \
     csv using 2:(of("drive", 3)) with linespoints ls 3 title "ours: integer phase,\nphasor renewed"
eval stop

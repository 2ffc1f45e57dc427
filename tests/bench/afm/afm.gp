# afm.gp - charts of the AFM lever, from docs/img/afm_NAME.csv to docs/img/afm_NAME.svg; top: the project's folder.

if (!exists("top")) top = "."
set datafile separator ","
set style line 1 lc rgb "#d62728" lw 2.2 pt 7 ps 0.4
set style line 2 lc rgb "#1f5fbf" lw 2.2 pt 7 ps 0.4
set style line 3 lc rgb "#2a9d3a" lw 1.4 pt 9 ps 0.5
set style line 4 lc rgb "#c8a000" lw 1.4 pt 5 ps 0.4
set style line 5 lc rgb "#111111" lw 1 pt 6 ps 0.6
set style line 6 lc rgb "#333333" lw 1 dt (5, 4)
set style line 7 lc rgb "#7f7f7f" lw 1.6 dt (6, 3)
set border 3 lc rgb "#555555"
set grid xtics ytics lc rgb "#dcdcdc" lt 1 lw 0.6
set xtics nomirror textcolor rgb "#222222"
set ytics nomirror textcolor rgb "#222222"
set title font ",12" textcolor rgb "#111111" offset 0, -0.4
start = "set terminal svg size 1080, 640 background rgb 'white' font 'Helvetica,11' dynamic; \
         set output sprintf('docs/img/%s.svg', name); csv = sprintf('docs/img/%s.csv', name)"
stop = "unset multiplot; unset output; unset logscale; unset arrow; unset label; set format '%g'; set xrange [*:*]; set yrange [*:*]; \
        unset xlabel; unset ylabel; set key default; unset title; set xtics autofreq; set ytics autofreq"

# Column y of the rows whose first two columns are these.
of(a, b, y) = strcol(1) eq a && strcol(2) eq b ? column(y) : NaN

# ---- cost ----
name = "afm_cost"
eval start
set multiplot layout 2, 3 margins 0.07, 0.985, 0.2, 0.95 spacing 0.06, 0.13
set logscale xy
set format xy "10^{%T}"
set xrange [1:1e-6]
set yrange [200:2e5]
array title[3] = ["A: 2 N/m, polymer", "B: 40 N/m, polymer", "C: 40 N/m, 70 GPa"]
do for [row = 1:2] {
    do for [k = 1:3] {
        set title row == 1 ? title[k] : ""
        set xlabel row == 1 ? "error of amplitude and phase / free amplitude" : "error of the peak force, relative"
        set ylabel k == 1 ? "ns a period" : ""
        if (row == 2 && k == 2) { set key at screen 0.5, 0.045 center horizontal samplen 2.5 width 2 } else { unset key }
        c = word("A B C", k)
        y = 3 + row
        plot csv using (of(c, "modal", y)):6 with linespoints ls 1 title "modal, whole plant", \
             csv using (of(c, "rk4", y)):6 with linespoints ls 2 title "rk4, whole plant", \
             csv using (of(c, "velocity Verlet", y)):6 with linespoints ls 3 title "velocity Verlet, bare loop", \
             csv using (of(c, "one tick late", y)):6 with linespoints ls 4 title "force one tick late, bare loop"
    }
}
eval stop

# ---- tapping ----
name = "afm_tapping"
orbits = sprintf("<sed 's/  */,/g' %s/tests/data/tapping_orbits.txt", top)
free = 20.0
reading(row, amplitude, lag) = row == 1 ? amplitude / free : lag
ends = "repulsive branch ends here"
eval start
set multiplot layout 2, 3 margins 0.06, 0.985, 0.16, 0.95 spacing 0.05, 0.13
set xrange [1.3:0.25]
do for [row = 1:2] {
    do for [k = 1:3] {
        set title row == 1 ? title[k] : ""
        set xlabel "height / free amplitude"
        set ylabel k > 1 ? "" : row == 1 ? "amplitude / free amplitude" : "lag of the phase, degrees"
        if (row == 1) { set yrange [0:1.1]; set ytics 0.2 } else { set yrange [0:180]; set ytics 45 }
        if (row == 2 && k == 2) { set key at screen 0.5, 0.03 center horizontal samplen 2.5 width 2 } else { unset key }
        unset arrow
        unset label
        if (k < 3) {
            at = k == 1 ? 0.9405 : 0.8855
            set arrow from first at, graph 0 to first at, graph 1 nohead ls 6 back
            if (row == 1) { set label ends at first at, graph 0.04 rotate by 90 font ",9" textcolor rgb "#333333" offset 0.7, 0 }
        }
        c = word("A B C", k)
        free = k == 2 ? 10.0 : 20.0
        plot csv using 3:(of(c, "approach", 3 + row)) with lines ls 1 title "modal, approach from far away", \
             csv using 3:(of(c, "retract", 3 + row)) with lines ls 2 title "modal, retract on the repulsive branch", \
             orbits using 3:(strcol(1) eq c ? reading(row, column(4), column(5)) : NaN) with points ls 5 title "periodic orbits, another program"
    }
}
eval stop

# ---- shift ----
name = "afm_shift"
eval start
set terminal svg size 1080, 470 background rgb "white" font "Helvetica,11" dynamic
set multiplot
set key top right samplen 2.5
set bmargin at screen 0.13
set tmargin at screen 0.92
set lmargin at screen 0.065
set rmargin at screen 0.6
set xlabel "frequency of the modulation / f_0"
set ylabel "shift of the contact resonance, %"
set title "modulated by 0.5"
set xrange [13:60]
set yrange [-3:3]
plot 0 with lines ls 6 notitle, \
     csv using 3:(100 * of("frequency", "point mass", 6)) with lines ls 2 title "point mass (the paper's)", \
     csv using 3:(100 * of("frequency", "four modes", 6)) with lines ls 1 title "four modes", \
     csv using 3:(100 * of("frequency", "four modes and adhesion", 6)) every 4 with points ls 5 title "with adhesion", \
     csv using 3:(of("frequency", "four modes", 7) == 1 ? -2.9 : NaN) with points pt 7 ps 0.4 lc rgb "#c8a000" title "motion grows"
set lmargin at screen 0.67
set rmargin at screen 0.985
set xlabel "modulation"
unset ylabel
set title "at 30 f_0"
set xrange [0:1]
set yrange [-1.2:1.2]
plot 0 with lines ls 6 notitle, \
     csv using 4:(100 * of("depth", "point mass", 6)) with lines ls 2 notitle, \
     csv using 4:(100 * of("depth", "four modes", 6)) with lines ls 1 notitle, \
     csv using 4:(100 * of("depth", "four modes and adhesion", 6)) with points ls 5 notitle
eval stop

# shaft_linear.gp - figures 4 to 7, 21 of the shaft-bearing paper; see style.gp.

name = "shaft_linear"; width = 1000; height = 1568
eval page
set multiplot layout 7, 3
set xlabel "contact stiffness kg, N/m"
set ylabel "Hz"
set logscale xy
set format x "10^{%T}"
set key top left
set title "4: gaps closed"
plot for [k = 1:3] csv using 3:(of("4", sprintf("mode %d", k))) with lines ls word("1 6 8", k) + 0 title sprintf("mode %d", k)
unset logscale; set format x "%g"
set xlabel "support ks3, N/m"
set yrange [0:50]
set key bottom right
set title "5: gaps open; mode 3 at 699.8"
plot for [k = 1:2] csv using 3:(of("5", sprintf("mode %d", k))) with lines ls word("1 6 8", k) + 0 title sprintf("mode %d", k)
set title "21: gaps closed, kg = 2.626e4; mode 3 at 700.2"
plot for [k = 1:2] csv using 3:(of("21", sprintf("mode %d", k))) with lines ls word("1 6 8", k) + 0 title sprintf("mode %d", k)
set yrange [-1.1:1.1]; set ylabel "component of the mode, 1"
set key bottom left
do for [f in "4b 5b"] {
    if (f eq "4b") { set logscale x; set format x "10^{%T}"; set xlabel "contact stiffness kg, N/m" } \
    else { unset logscale; set format x "%g"; set xlabel "support ks3, N/m" }
    do for [k = 1:3] {
        set title f.": mode ".k
        plot for [j = 1:3] csv using 3:(of(f, sprintf("mode %d x%d", k, j))) with lines ls word("1 6 8", j) + 0 dt j title sprintf("x%d", j)
    }
}
set logscale y
set xlabel "forcing frequency, Hz"
set key top left
do for [f in "6 7"] {
    do for [band in "low high"] {
        if (band eq "low") { set yrange [0.01:50]; set xrange [0:70] } else { set xrange [690:710]; set yrange [0.001:2] }
        do for [k = 1:3] {
            set title f.": 25 N on ".(f eq "6" ? "the middle" : "bearing 1").", x".k
            set ylabel sprintf("amplitude of x%d, mm", k)
            if (k == 1 && band eq "low") { set key top right } else { set key off }
            plot for [j = 0:3] csv using 3:(of(f." ".band." x".k, "ks3 ".j)) with lines ls word("1 6 7 8", j + 1) + 0 title "ks3 = ".word("8030 4015 803 0", j + 1)." N/m"
        }
    }
}
eval done

# style.gp - what the charts of docs/papers/figures.md share: averaged theory grey lines, the paper's truncated model open orange
# circles, the true contact blue. gnuplot -e "csv='...'; out='docs/img/papers'" style.gp NAME.gp

set datafile separator ","
set datafile missing NaN
set style line 1 lc rgb "#444444" lw 1.6
set style line 2 lc rgb "#444444" lw 1.2 dt (4, 3)
set style line 3 lc rgb "#e07b00" pt 6 ps 0.38 lw 1
set style line 4 lc rgb "#1f5fbf" pt 7 ps 0.30 lw 1.8
set style line 5 lc rgb "#1f5fbf" lw 1.2 dt (4, 3)
set style line 6 lc rgb "#2a9d3a" lw 1.6 pt 9 ps 0.4
set style line 7 lc rgb "#c22f6f" lw 1.4 pt 5 ps 0.3
set style line 8 lc rgb "#9467bd" lw 1.4 pt 13 ps 0.4
set style line 9 lc rgb "#e07b00" lw 1.4
set style line 10 lc rgb "#b4b4b4" lw 2.6
set border 3 lc rgb "#555555"
set grid xtics ytics lc rgb "#dcdcdc" lt 1 lw 0.6
set xtics nomirror textcolor rgb "#222222"
set ytics nomirror textcolor rgb "#222222"
set title font ",11" textcolor rgb "#111111" offset 0, -0.6
set key top right Left reverse samplen 1.6 spacing 1.1 font ",9"
page = "set terminal svg size width, height background rgb 'white' font 'Helvetica,10' dynamic; \
        set output sprintf('%s/%s.svg', out, name)"
done = "unset multiplot; unset output; unset logscale; unset label; unset arrow; set xrange [*:*]; set yrange [*:*]; \
        unset xlabel; unset ylabel; set format '%g'; unset title; set key default; set key top right Left reverse samplen 1.6 spacing 1.1 font ',9'; unset object"
# y of the rows of this figure and curve
of(f, c) = strcol(1) eq f && strcol(2) eq c ? column(4) : NaN

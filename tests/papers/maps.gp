# maps.gp - maps of the shaft-bearing paper; see style.gp.

name = "maps"; width = 1000; height = 760
eval page
set multiplot layout 3, 4
set palette maxcolors 40 defined (0 "#f4f4f4", 0.25 "#9db8e0", 0.5 "#1f5fbf", 0.75 "#e07b00", 1 "#8c1030")
set cbrange [-2:1]
set cblabel "largest, mm" font ",8"
set cbtics ("0.01" -2, "0.1" -1, "1" 0, "10" 1) font ",8"
set key off
set xlabel "Hz"
figures = "'10 low' '10 high' '11 low' '11 high' '17 low' '17 high' '20 soft' '20 hard' '22 low' '23 low'"
titles = "'10: gap, m' '10: gap, m' '11: kg, N/m' '11: kg, N/m' '17: c, N s/m' '17: c, N s/m' '20: ks3, N/m; kg = 2.626e4' '20: ks3, N/m; hard' '22: gap 3, m; x3' '23: kg3, N/m; x3'"
do for [i = 1:10] {
    f = word(figures, i)
    set title word(titles, i)
    if (i == 10) { set colorbox } else { unset colorbox }
    if (f[1:2] eq "20") { set format y "%g"; set yrange [0:8030] } else { set format y "10^{%.1f}"; set yrange [*:*] }
    if (strstrt(f, "high")) { set xrange [672:728] } else { set xrange [2:112] }
    if (f[1:2] eq "10") { set yrange [log10(2e-5):log10(strstrt(f, "high") ? 6e-4 : 2e-2)] }
    if (f[1:2] eq "11" || f[1:2] eq "23") { set yrange [3:log10(3.502e7)] }
    if (f[1:2] eq "17") { set yrange [log10(4):log10(184)] }
    if (f[1:2] eq "22") { set yrange [log10(2.54e-4):log10(2e-2)] }
    plot csv using 3:(of(f, "map")):5 with image, \
         for [k = 1:3] csv using 3:(of(f, sprintf("open %d", k))) with lines lc rgb "#222222" lw 1.2, \
         for [k = 1:3] csv using 3:(of(f, sprintf("closed %d", k))) with lines lc rgb "#222222" lw 1.2 dt (4, 3)
}
eval done

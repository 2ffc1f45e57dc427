# maps.gp - maps of the shaft-bearing paper; see style.gp.

set palette maxcolors 40 defined (0 "#f4f4f4", 0.25 "#9db8e0", 0.5 "#1f5fbf", 0.75 "#e07b00", 1 "#8c1030")
set cbrange [-2:1]
set cblabel "largest, mm" font ",8"
set cbtics ("0.01" -2, "0.1" -1, "1" 0, "10" 1) font ",8"
set rmargin 6
map = "set format y figure eq '20' ? '%g' : '10^{%.1f}'; \
       set yrange [low(f):high(f)]; \
       if (strstrt(f, 'high')) { set xrange [650:770]; set xtics 660, 40 } else { set xrange [2:152]; set xtics 0, 40 }; \
       plot csv using 3:(of(f, coordinate)):5 with image, \
         for [k = 1:3] csv using 3:(of(f, sprintf('open %d', k))) with lines lc rgb '#222222' lw 1.2, \
         for [k = 1:3] csv using 3:(of(f, sprintf('closed %d', k))) with lines lc rgb '#222222' lw 1.2 dt (4, 3)"
is(f, n) = f[1:2] eq n
low(f) = is(f, "10") ? log10(2e-5) : is(f, "11") || is(f, "23") ? 3 : is(f, "17") ? log10(4) : is(f, "22") ? log10(2.54e-4) : 0
high(f) = is(f, "10") ? log10(strstrt(f, "high") ? 6e-4 : 2e-2) : is(f, "11") || is(f, "23") ? log10(3.502e7) : is(f, "17") ? log10(184) : is(f, "22") ? log10(2e-2) : 8030

name = "maps"; width = 1000; height = 760
eval page
set multiplot layout 3, 4
set key off
set xlabel "Hz"
figures = "'10 low' '10 high' '11 low' '11 high' '17 low' '17 high' '20 soft low' '20 soft high' '20 hard low' '20 hard high'"
titles = "'10: gap, m' '10: gap, m' '11: kg, N/m' '11: kg, N/m' '17: c, N s/m' '17: c, N s/m' '20: ks3, N/m; kg = 2.626e4' '20: ks3, N/m; kg = 2.626e4' '20: ks3, N/m; hard' '20: ks3, N/m; hard'"
coordinate = "x1"
do for [i = 1:10] {
    f = word(figures, i)
    figure = f[1:2]
    set title word(titles, i)
    if (i % 4 == 0 || i == 10) { set colorbox } else { unset colorbox }
    eval map
}
eval done

name = "maps-asymmetry"; width = 1000; height = 900
eval page
set multiplot layout 4, 3
set key off
set xlabel "Hz"
do for [f in "'22 low' '22 high' '23 low' '23 high'"] {
    do for [i = 1:3] {
        figure = f[1:2]
        coordinate = sprintf("x%d", i)
        set title figure.": ".(figure eq "22" ? "gap 3, m" : "kg3, N/m")."; ".coordinate
        if (i == 3) { set colorbox } else { unset colorbox }
        eval map
    }
}
eval done

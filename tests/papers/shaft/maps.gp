# maps.gp - maps of the shaft-bearing paper, and rows of them as responses; see style.gp.

set palette maxcolors 40 defined (0 "#f4f4f4", 0.25 "#9db8e0", 0.5 "#1f5fbf", 0.75 "#e07b00", 1 "#8c1030")
set cbrange [-2:1]
set cblabel "largest, mm" font ",8"
set cbtics ("0.01" -2, "0.1" -1, "1" 0, "10" 1) font ",8"
set rmargin 6
# The rows of one figure: the file is large.
only(f) = sprintf("<grep '^%s,' %s", f, csv)
map = "set format y figure eq '20' ? '%g' : '10^{%.1f}'; \
       set yrange [low(f):high(f)]; \
       if (strstrt(f, 'high')) { set xrange [650:770]; set xtics 660, 40 } else { set xrange [2:152]; set xtics 0, 40 }; \
       plot only(f) using 3:(of(f, coordinate)):5 with image, \
         for [k = 1:3] only(f) using 3:(of(f, sprintf('open %d', k))) with lines lc rgb '#222222' lw 1.2, \
         for [k = 1:3] only(f) using 3:(of(f, sprintf('closed %d', k))) with lines lc rgb '#222222' lw 1.2 dt (4, 3)"
is(f, n) = f[1:2] eq n
low(f) = is(f, "10") ? log10(2e-5) : is(f, "11") || is(f, "23") ? 3 : is(f, "17") ? log10(4) : is(f, "22") ? log10(2.54e-4) : 0
high(f) = is(f, "10") ? log10(strstrt(f, "high") ? 6e-4 : 2e-2) : is(f, "11") || is(f, "23") ? log10(3.502e7) : is(f, "17") ? log10(184) : is(f, "22") ? log10(2e-2) : 8030
figures = "'10 low' '10 high' '11 low' '11 high' '17 low' '17 high' '20 soft low' '20 soft high' '20 hard low' '20 hard high'"
titles = "'10: gap, m' '10: gap, m' '11: kg, N/m' '11: kg, N/m' '17: c, N s/m' '17: c, N s/m' '20: ks3, N/m; kg = 2.626e4' '20: ks3, N/m; kg = 2.626e4' '20: ks3, N/m; hard' '20: ks3, N/m; hard'"

# The true map, and under it that of the mode.
name = "maps"; width = 1000; height = 1380
eval page
set multiplot
set label 1 "true: the shaft; one mode: translation, near 700 Hz bending;\nlargest x1 of two starts after 3 s\nlines: linear frequencies, gaps open\ndashed: gaps closed" at screen 0.56, 0.28 font ",11"
set key off
set size 0.25, 0.1667
do for [i = 1:10] {
    f = word(figures, i)
    figure = f[1:2]
    if (i % 4 == 0 || i == 10) { set colorbox } else { unset colorbox }
    if (i == 2) { unset label 1 }
    do for [k = 0:1] {
        set origin ((i - 1) % 4) / 4.0, (5 - 2 * ((i - 1) / 4) - k) / 6.0
        set title word(titles, i).(k ? ": one mode" : ": true")
        if (k) { set xlabel "Hz" } else { unset xlabel }
        coordinate = k ? "mode" : "x1"
        eval map
    }
}
eval done

name = "maps-asymmetry"; width = 1000; height = 900
eval page
set multiplot layout 4, 4
set key off
set xlabel "Hz"
do for [f in "'22 low' '22 high' '23 low' '23 high'"] {
    do for [i = 1:4] {
        figure = f[1:2]
        coordinate = i < 4 ? sprintf("x%d", i) : "mode"
        set title figure.": ".(figure eq "22" ? "gap 3, m" : "kg3, N/m")."; ".(i < 4 ? coordinate : "one mode, x1 = x3")
        if (i == 4) { set colorbox } else { unset colorbox }
        eval map
    }
}
eval done

# Rows as responses: c: the coordinate drawn, true of x1 too where it is x3.
response = "set yrange [bottom:top]; \
            if (strstrt(f, 'high')) { set xrange [650:770]; set xtics 660, 40 } else { set xrange [0:152]; set xtics 0, 40 }; \
            plot only(f.' '.c) using 3:(of(f.' '.c, 'balance')) with lines ls 10 title 'one mode kept, averaged', \
              only(f.' '.c) using 3:(of(f.' '.c, 'theory')) with lines ls 1 lw 1.2 title 'linear, gaps open', \
              only(f.' '.c) using 3:(of(f.' '.c, 'closed')) with lines ls 2 title (c eq 'x1' ? 'gaps closed' : 'bearing 1 closed (23: both)'), \
              only(f.' '.c) using 3:(of(f.' '.c, 'mode')) with points ls 3 ps 0.45 title 'one mode kept', \
              only(f.' '.c) using 3:(of(f.' '.c, 'other')) with points pt 8 ps 0.45 lw 1 lc rgb '#c22f6f' notitle, \
              NaN with points pt 8 ps 0.45 lw 1 lc rgb '#c22f6f' title (c eq 'x1' ? 'mode 2 kept (20)' : ''), \
              only(f.' x1') using 3:(c eq 'x1' ? NaN : of(f.' x1', 'true')) with points pt 7 ps 0.3 lc rgb '#2a9d3a' title (c eq 'x1' ? '' : 'true contact, x1'), \
              only(f.' '.c) using 3:(of(f.' '.c, 'true')) with points ls 4 ps 0.28 title 'true contact'.(c eq 'x1' ? '' : ', x3')"
set format y "10^{%T}"
set xlabel "forcing frequency, Hz"

name = "maps-rows"; width = 1000; height = 1200
eval page
set multiplot
set size 0.25, 0.19
c = "x1"
rows = "'10: gap 0.27 mm' '10: gap 3.6 mm' '10: gap 0.047 mm' '10: gap 0.26 mm' '11: kg 2.63e4 N/m' '11: kg 6.9e5 N/m' '11: kg 1.33e6 N/m' '11: kg 9.5e6 N/m' \
        '17: c 27 N s/m' '17: c 184 N s/m' '17: c 4 N s/m' '17: c 8.2 N s/m' '20, soft: ks3 0' '20, soft: ks3 4015 N/m' '20, soft: ks3 0' '20, soft: ks3 4015 N/m' \
        '20, hard: ks3 0' '20, hard: ks3 4015 N/m' '20, hard: ks3 0' '20, hard: ks3 4015 N/m'"
do for [i = 1:20] {
    f = word(figures, (i + 1) / 2)." ".((i - 1) % 2)
    set origin ((i - 1) % 4) / 4.0, (4 - (i - 1) / 4) * 0.19
    set title word(rows, i)
    if (i % 4 == 1) { set ylabel "largest x1, mm" } else { unset ylabel }
    bottom = strstrt(f, "high") ? 1e-3 : 1e-2
    top = strstrt(f, "high") ? 3 : 30
    set logscale y
    if (i == 1) { set key at screen 0.97, 0.985 top right maxrows 2 font ",9" } else { set key off }
    eval response
}
eval done

name = "maps-asymmetry-rows"; width = 1000; height = 560
eval page
set multiplot
set size 0.25, 0.45
c = "x3"
rows = "'22: gap 3 1.3 mm' '22: gap 3 20 mm' '22: gap 3 1.3 mm' '22: gap 3 20 mm' '23: kg3 2.63e4 N/m' '23: kg3 6.9e5 N/m' '23: kg3 2.63e4 N/m' '23: kg3 6.9e5 N/m'"
set format y "10^{%T}"
set xlabel "forcing frequency, Hz"
do for [i = 1:8] {
    f = word("'22 low' '22 high' '23 low' '23 high'", (i + 1) / 2)." ".((i - 1) % 2)
    set origin ((i - 1) % 4) / 4.0, i < 5 ? 0.45 : 0
    set title word(rows, i)
    if (i % 4 == 1) { set ylabel "largest x3, mm" } else { unset ylabel }
    bottom = strstrt(f, "high") ? 1e-3 : 1e-2
    top = strstrt(f, "high") ? 3 : 30
    set logscale y
    if (i == 1) { set key at screen 0.97, 0.985 top right maxrows 2 font ",9" } else { set key off }
    eval response
}
eval done

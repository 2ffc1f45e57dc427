# kirrou.gp - figures of Kirrou & Belhaq 2013 beside the true contact; see style.gp.

draw = "plot csv using 3:(of(f, 'theory')) with lines ls 1 title 'averaged', \
     csv using 3:(of(f, 'theory unstable')) with lines ls 2 title 'unstable', \
     csv using 3:(of(f, 'truncated')) with lines ls 9 title 'truncated', \
     csv using 3:(of(f, 'truncated unstable')) with lines ls 9 dt (4, 3) lw 1 notitle, \
     csv using 3:(of(f, 'true')) with lines ls 4 title 'true contact', \
     csv using 3:(of(f, 'true unstable')) with lines ls 5 notitle"

name = "kirrou-response"; width = 1000; height = 520
eval page
set multiplot layout 2, 3
figures = "'2 f=0.004' '2 f=0.01' '3 b=0.7' '3 b=0.8' '3 b=0.9' '14 r=0'"
titles = "'2: β = 0.8, f = 0.004' '2: β = 0.8, f = 0.01' '3: β = 0.7, f = 0.008' '3: β = 0.8, f = 0.008' '3: β = 0.9, f = 0.008' '14: β = 0.95, r = 0, f = 0.008'"
set yrange [0:1.25]
set xrange [-0.2:0.2]
set xlabel "detuning σ = ω - ω1"
set ylabel "amplitude of u"
do for [i = 1:6] {
    f = word(figures, i)
    set title word(titles, i)
    if (i == 1) { set key top right } else { set key off }
    eval draw
}
eval done

name = "kirrou-modulated"; width = 1000; height = 980
eval page
set multiplot layout 4, 3
figures = "'6 Omega=1' '6 Omega=1.5' '6 Omega=2' '7 r=0.4' '7 r=0.7' '7 r=1' '13 r=0.4' '13 r=0.7' '13 r=0.9' '14 r=0.4' '14 r=0.7' '14 r=1'"
titles = "'6: Ω = 1, r = 0.5' '6: Ω = 1.5, r = 0.5' '6: Ω = 2, r = 0.5' '7: Ω = 1, r = 0.4' '7: Ω = 1, r = 0.7' '7: Ω = 1, r = 1' '13: Ω = 0.6, r = 0.4' '13: Ω = 0.6, r = 0.7' '13: Ω = 0.6, r = 0.9' '14: β = 0.95, Ω = 1, r = 0.4' '14: β = 0.95, Ω = 1, r = 0.7' '14: β = 0.95, Ω = 1, r = 1'"
set yrange [0:1.1]
set xrange [-0.1:0.15]
set xlabel "detuning σ = ω - ω1(r)"
set ylabel "amplitude of u at ω"
do for [i = 1:12] {
    f = word(figures, i)
    set title word(titles, i)
    if (i == 3) { set key top right } else { set key off }
    if (i > 6) { set xrange [-0.1:0.2] }
    if (i > 9) { set xrange [-0.2:0.2] }
    unset label
    if (word("1 0 0 1 0 0 1 1 1 1 0 1", i) + 0) { set label "true contact, truncated: nothing stays" at graph 0.97, 0.94 right font ",8" }
    eval draw
}
eval done

name = "kirrou-critical"; width = 1000; height = 780
eval page
set multiplot layout 3, 3
set title "4a: three amplitudes, Ω = 1"
set xlabel "drive f"
set xtics 0.004
set yrange [-0.3:0.25]
set key top left
set ylabel "detuning σ of the jumps"
plot csv using 3:(of("4a", "theory")) with lines ls 1 title "averaged, r = 0", csv using 3:(of("4a", "theory other")) with lines ls 1 notitle, \
     csv using 3:(of("4a", "theory r=0.4")) with lines ls 6 title "averaged, r = 0.4", csv using 3:(of("4a", "theory r=0.4 other")) with lines ls 6 notitle, \
     csv using 3:(of("4a", "truncated")) with points ls 3 ps 0.6 title "truncated, r = 0, jump up", \
     csv using 3:(of("4a", "true")) with points ls 4 title "true contact, r = 0, jump up"
set yrange [-0.14:0.08]
set xtics autofreq
set key bottom right
set title "4b: three amplitudes, f = 0.008"
set xlabel "modulation r"
unset ylabel
plot csv using 3:(of("4b", "theory")) with lines ls 1 title "averaged, Ω = 1", csv using 3:(of("4b", "theory other")) with lines ls 1 notitle, \
     csv using 3:(of("4b Omega 2", "theory")) with lines ls 6 title "averaged, Ω = 2", csv using 3:(of("4b Omega 2", "theory other")) with lines ls 6 notitle, \
     for [k = 1:2] csv using 3:(of(word("'4b' '4b Omega 2'", k), "truncated")) with points ls 3 ps 0.6 title (k == 1 ? "truncated, jump up" : ""), \
     for [k = 1:2] csv using 3:(of(word("'4b' '4b Omega 2'", k), "true")) with points ls 4 title (k == 1 ? "true contact, jump up" : "")
set yrange [*:*]
set title "5: edges of three amplitudes"
set xlabel "modulation r"
set ylabel "fast frequency Ω"
set xrange [0:1.2]
set yrange [0.4:3.8]
set key top left
plot csv using 3:(of("5a", "theory")) with points ls 7 ps 0.25 title "averaged, σ = 0", csv using 3:(of("5b", "theory")) with points ls 8 ps 0.25 title "averaged, σ = -0.08", \
     csv using 3:(of("5a", "truncated")) with points ls 3 ps 0.6 title "truncated, jump up at σ = 0", csv using 3:(of("5a", "true")) with points ls 4 title "true contact, jump up at σ = 0"
set xrange [*:*]
set key top left
set title "16: c = 0.05, Ω = 3, r = 0.2, σ = 0.01"
set xlabel "time, in the stationary motion"
set ylabel "u"
set yrange [-0.4:0.55]
plot csv using 3:(of("16", "true")) with lines ls 4 title "true contact", csv using 3:(of("16", "truncated")) with lines ls 9 title "truncated", \
     csv using 3:(of("16", "theory")) with lines ls 1 title "averaged"
set yrange [*:*]
set title "8: resonance, f = 0.008 and small"
set xlabel "modulation r"
set ylabel "frequency"
set key top left
set yrange [0.3:1.0]
plot for [k = 1:3] csv using 3:(of(sprintf("8 Omega %d", k), "theory small")) with lines ls 1 title (k == 1 ? "averaged, small f, Ω = 1, 2, 3" : ""), \
     csv using 3:(of("8 Omega 1", "theory")) with lines ls 6 title "averaged, f = 0.008, Ω = 1", \
     for [k = 1:3] csv using 3:(of(sprintf("8 Omega %d", k), "truncated")) with points ls 3 ps 0.6 title (k == 1 ? "truncated, small f" : ""), \
     for [k = 1:3] csv using 3:(of(sprintf("8 Omega %d", k), "true")) with points ls 4 title (k == 1 ? "true contact, small f" : "")
set yrange [*:*]
set title "8: detuning of the peak, f = 0.008, Ω = 1"
set ylabel "σ"
set key top left
set yrange [-0.15:0.5]
plot csv using 3:(of("8 Omega 1", "theory detuning")) with lines ls 1 title "averaged: turns back", \
     csv using 3:(of("8 Omega 1", "theory") - 0.4472136) with lines ls 6 title "the same from ω1(0): does not"
set yrange [*:*]
set title "9: β = 0.8, Ω = 1"
set ylabel "effective coefficients"
set key top right
set yrange [-0.12:0.3]
set arrow from 0.66507, -0.12 to 0.66507, 0.3 nohead ls 2
set arrow from 0.77012, -0.12 to 0.77012, 0.3 nohead ls 2
plot csv using 3:(of("9", "rho_n")) with lines ls 1 title "ρn", csv using 3:(of("9", "rho_l")) with lines ls 6 title "ρl", \
     csv using 3:(of("9", "sum")) with lines ls 7 title "ρn + ρl"
unset arrow
set yrange [0.5:1.6]
set xrange [0:1.5]
set title "10, 11, 12, 15"
set ylabel "fast frequency Ω"
set key at screen 0.97, screen 0.25
plot csv using 3:(of("10", "linear")) with lines ls 1 title "ρn + ρl = 0 (10, 15)", csv using 3:(of("10", "turn")) with lines ls 6 title "ρn = 0 (11)", \
     csv using 3:(of("10", "unstable")) with lines ls 7 title "rest unstable right of this", \
     csv using 3:(of("15", "silicon") / 4) with lines ls 8 title "ρn + ρl = 0, β = 29.7; Ω/4 (15)"
eval done

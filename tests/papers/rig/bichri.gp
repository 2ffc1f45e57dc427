# bichri.gp - figures of Bichri, Belhaq & Perret-Liaudet 2011 beside the true contact; see style.gp.

name = "bichri-resonance"; width = 1000; height = 400
eval page
set multiplot layout 1, 3
set yrange [0.6:1.3]
set ylabel "resonance frequency / ν for a small slow force"
do for [s in "force base stiffness"] {
    f = "resonance ".s
    set title s eq "force" ? "fast force from above" : s eq "base" ? "fast base displacement" : "fast stiffness"
    set xlabel s eq "force" ? "amplitude over the preload N" : s eq "base" ? "amplitude over 2 zs/3" : "amplitude over the stiffness"
    if (s eq "stiffness") { set key bottom left } else { set key top left }
    plot csv using 3:(0.6 + 0.5 * of(f, "loss")) with filledcurves y1=0.6 lc rgb "#f3c9d6" fs transparent solid 0.55 noborder title "share of time without contact (height 0.5 = all)", \
         csv using 3:(of(f, "theory")) with lines ls 1 title "averaged theory of the paper", \
         csv using 3:(of(f, "mean force")) with lines ls 6 title "mean of the one-sided force", \
         csv using 3:(of(f, "truncated")) with points ls 3 title "truncated model", \
         csv using 3:(of(f, "true")) with linespoints ls 4 title "true contact"
}
eval done

name = "bichri-response"; width = 1000; height = 520
eval page
set multiplot layout 2, 4
panels = "3a 3b 3c - 6b 6c 9b 9c"
titles = "'3a, 6a, 9a: no fast drive' '3b: fast force 60' '3c: fast force 70' '-' '6b: base 5' '6c: base 8' '9b: stiffness 4' '9c: stiffness 5'"
set yrange [0:3]
set xlabel "slow frequency ω / ν"
do for [i = 1:8] {
    f = word(panels, i)
    if (f eq "-") { set multiplot next } else {
    set title word(titles, i)
    if (f eq "6b" || f eq "6c") { set xrange [0.5:1.2] } else { set xrange [0.7:1.3] }
    if (i % 4 == 1) { set ylabel "amplitude of q at ω" } else { unset ylabel }
    if (i == 3) { set key at screen 0.97, 0.9 } else { set key off }
    plot csv using 3:(of(f, "theory")) with lines ls 1 title "averaged theory of the paper", \
         csv using 3:(of(f, "theory unstable")) with lines ls 2 title "unstable", \
         csv using 3:(of(f, "truncated")) with lines ls 9 title "truncated model, both ways", \
         csv using 3:(of(f, "true")) with lines ls 4 title "true contact, both ways" }
}
eval done

name = "bichri-motion"; width = 1000; height = 330
eval page
set multiplot layout 1, 3
set xlabel "time ν t, stationary"
set xrange [0:26]
set key top left horizontal
do for [i = 1:3] {
    f = word("2 5 8", i)
    set title word("'2: force 60, ω = 0.98' '5: base 8, ω = 0.99' '8: stiffness 5, ω = 1.12'", i)
    set ylabel i == 1 ? "q" : ""
    if (i == 1) { set yrange [-2.5:3] }
    if (i == 2) { set yrange [-9:4] }
    if (i == 3) { set yrange [-1.2:1.2] }
    plot csv using 3:(of(f, "true")) with lines ls 4 title "true contact", \
         csv using 3:(of(f, "truncated")) with lines ls 9 title "truncated", \
         csv using 3:(of(f, "theory")) with lines ls 1 title "averaged", \
         -1.5 with lines ls 2 title (i == 2 ? "" : "contact lost below")
}
eval done

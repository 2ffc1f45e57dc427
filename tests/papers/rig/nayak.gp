# nayak.gp - figures of Nayak 1972 beside the true contact; see style.gp.

name = "nayak-harmonic"; width = 1000; height = 540
eval page
set multiplot layout 2, 3
set xlabel "vibration frequency Ω"
set ylabel "over its static value"
set xrange [0.4:1.05]
set yrange [0:6.5]
set title "3: free vibration"
plot csv using 3:(of("3", "largest")) with lines ls 1 title "largest compression", csv using 3:(of("3", "amplitude")) with lines ls 6 title "amplitude", \
     csv using 3:(of("3", "area")) with lines ls 7 title "mean contact area", csv using 3:(of("3", "stress")) with lines ls 8 title "largest stress", \
     csv using 3:(of("3", "true")) with points ls 4 ps 0.5 title "model, largest compression"
set title "5: free vibration"
plot csv using 3:(of("3", "largest")) with lines ls 4 title "largest compression, exact", csv using 3:(of("5", "balance largest")) with lines ls 2 title "harmonic balance", \
     csv using 3:(of("3", "amplitude")) with lines ls 6 title "amplitude, exact", csv using 3:(of("5", "balance amplitude")) with lines ls 2 notitle
set xlabel "forcing frequency Ω"
set ylabel "amplitude of the mass X0"
set xrange [0.35:1.5]
set yrange [0:8]
figures = "'6 zeta=0.05' '6 zeta=0.1' '7'"
titles = "'6, 12: ξ0 = 0.9, ζ = 0.05' '6: ξ0 = 0.9, ζ = 0.1' '7: ξ0 = 0.5, ζ = 0.05'"
do for [i = 1:3] {
    f = word(figures, i)
    set title word(titles, i)
    if (i == 1) { set yrange [0:10]; set xrange [0.35:1.8] } else { set yrange [0:8]; set xrange [0.35:1.5] }
    plot csv using 3:(of(f, "theory")) with lines ls 1 title "harmonic balance", csv using 3:(of(f, "linear")) with lines ls 9 title "linear (eq 52)", \
         csv using 3:(of(f, "true")) with lines ls 4 title "true contact", csv using 3:(of(f, "true unstable")) with lines ls 5 title "unstable", \
         csv using 3:(of(f, "jump")) with points pt 5 ps 0.5 lc rgb "#c22f6f" title (i == 1 ? "jump (61)" : ""), \
         csv using 3:(of(f, "half power")) with points pt 5 ps 0.4 lc rgb "#9467bd" title (i == 1 ? "half power (65)" : "")
}
set title "12: longer periods too, ξ0 = 0.9, ζ = 0.05"
set ylabel "half the range of η"
set xrange [0.3:1.5]
set yrange [0:10]
plot csv using 3:(of("12", "up")) with points ls 4 ps 0.35 title "true contact, Ω raised", csv using 3:(of("12", "down")) with points ls 3 ps 0.5 title "Ω lowered"
eval done

name = "nayak-jumps"; width = 1000; height = 300
eval page
set multiplot layout 1, 3
set title "10: downward jump"
set xlabel "ξ0/ζ"
set ylabel "Ω"
set xrange [0:20]
set yrange [0.4:1]
plot csv using 3:(of("10", "half")) with lines ls 2 title "half power, heuristic", csv using 3:(of("10", "down")) with lines ls 1 title "jump, heuristic", \
     csv using 3:(of("10", "true zeta=0.02")) with points ls 4 ps 0.5 title "true contact, ζ = 0.02", csv using 3:(of("10", "true zeta=0.05")) with points ls 7 ps 0.5 title "true contact, ζ = 0.05"
set title "11: upward jump"
set xlabel "ξ0"
set xrange [0:3.5]
plot for [z in "0.05 0.1 0.2"] csv using 3:(of("11", "balance zeta=".z)) with lines ls (z eq "0.05" ? 1 : z eq "0.1" ? 6 : 8) title "harmonic balance, ζ = ".z, \
     csv using 3:(of("11", "true zeta=0.05")) with points ls 4 ps 0.5 title "true contact, ζ = 0.05", csv using 3:(of("11", "true zeta=0.1")) with points ls 6 ps 0.5 title "ζ = 0.1"
set title "13: least waviness that loses contact"
set xlabel "forcing frequency Ω"
set ylabel "ξ0"
set xrange [0.5:1.5]
set yrange [0:1.3]
set key top center
plot for [k = 1:4] csv using 3:(of("13", "theory ".word("0.02 0.05 0.1 0.5", k))) with lines ls word("1 6 8 7", k) + 0 title "theory, ζ = ".word("0.02 0.05 0.1 0.5", k), \
     for [k = 1:4] csv using 3:(of("13", "true ".word("0.02 0.05 0.1 0.5", k))) with points ls word("4 6 8 7", k) + 0 pt 7 ps 0.35 title (k == 1 ? "true contact" : "")
eval done

name = "nayak-random"; width = 1240; height = 560
eval page
set multiplot layout 2, 4
triple = "plot csv using 3:(of(f, 'theory')) with lines ls 4 lw 1.4 title 'exact (eq 68)', csv using 3:(of(f, 'gauss')) with lines ls 2 title 'Gaussian (eq 74)', \
     csv using 3:(of(f, 'true')) with points ls 3 ps 0.55 title 'model under noise'"
set xlabel "compression η"
set title "density of η, Φ/ζ = 0.1"
set ylabel "p(η)"
set yrange [0:1.5]
f = "density"; set key top left; eval triple
set title "up-crossings of a level"
set logscale y; set format y "10^{%T}"
set yrange [1e-5:1]
set ylabel "per unit of ωc t"
set xlabel "level z/zs"
f = "crossings"; set key bottom center; eval triple
set title "mean length of an exceedance"
set yrange [0.1:100]
set ylabel "ωc t"
f = "length"; set key top right; eval triple
set title "probability of the plastic limit"
set logscale x
set xrange [0.004:1]
set yrange [1e-13:1]
set xlabel "load P0/Pp"
set ylabel "probability"
set key bottom right
plot for [k = 1:2] csv using 3:(of("plastic", "theory ".word("0.1 0.3", k))) with lines ls (k == 1 ? 4 : 7) title "exact, σ = ".word("0.1 0.3", k)." at Pp", \
     for [k = 1:2] csv using 3:(of("plastic", "gauss ".word("0.1 0.3", k))) with lines ls 2 title (k == 1 ? "Gaussian (eq 88)" : "")
set title "up-crossings of the plastic limit"
set ylabel "per unit of ωc t"
plot for [k = 1:2] csv using 3:(of("plastic crossings", "theory ".word("0.1 0.3", k))) with lines ls (k == 1 ? 4 : 7) title "exact, σ = ".word("0.1 0.3", k)." at Pp", \
     for [k = 1:2] csv using 3:(of("plastic crossings", "gauss ".word("0.1 0.3", k))) with lines ls 2 title (k == 1 ? "Gaussian (eq 95)" : "")
set title "mean length above the plastic limit"
set yrange [0.01:1000]
set ylabel "ωc t"
set key top left
plot for [k = 1:2] csv using 3:(of("duration", "theory ".word("0.1 0.3", k))) with lines ls (k == 1 ? 4 : 7) title "exact, σ = ".word("0.1 0.3", k)." at Pp", \
     for [k = 1:2] csv using 3:(of("duration", "gauss ".word("0.1 0.3", k))) with lines ls 2 title (k == 1 ? "Gaussian (eqs 88, 95)" : "")
set format y "%g"
set title "speed to spectrum, spread, area and stress"
set xrange [0.1:2.5]
set yrange [1e-4:5]
set xlabel "rolling speed V/V0, Φ/ζ = 0.1 at V0"
set ylabel ""
set key at screen 0.80, screen 0.42
plot 0.1 * x**3 with lines ls 9 lw 1 title "Φ/ζ (eq 80)", csv using 3:(of("speed", "theory")) with lines ls 4 title "standard deviation of η", csv using 3:(of("speed", "gauss")) with lines ls 2 title "σ ∝ V^{3/2}, eq 81", \
     csv using 3:(of("area", "theory")) with lines ls 6 title "mean area", csv using 3:(of("stress", "theory")) with lines ls 8 title "mean peak stress", \
     csv using 3:(of("speed", "true")) with points ls 3 ps 0.55 title "model under noise", csv using 3:(of("area", "true")) with points ls 3 ps 0.55 notitle, csv using 3:(of("stress", "true")) with points ls 3 ps 0.55 notitle
eval done

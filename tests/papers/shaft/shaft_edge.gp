# shaft_edge.gp - ends of the impacting motion, figures 8 and 20 of the shaft-bearing paper; see style.gp.

name = "shaft_edge"; width = 1000; height = 560
eval page
set multiplot
set size 1, 0.5; set origin 0, 0.5
set title "20: share of 80 starts that still impact after 3 s; hard contact, 25 N"
set xlabel "forcing frequency, Hz"
set ylabel "share"
set yrange [0:1.05]
set xrange [0:800]
set key at 655, 1.05
set arrow from 680, 0 to 680, 1.05 nohead ls 4 lw 0.8
set arrow from 740, 0 to 740, 1.05 nohead ls 4 lw 0.8
set arrow from 670, 0 to 670, 1.05 nohead ls 7 lw 0.8 dt (4, 3)
set arrow from 760, 0 to 760, 1.05 nohead ls 7 lw 0.8 dt (4, 3)
plot csv using 3:(of("20 share", "ks3=8030")) with lines ls 4 title "ks3 = 8030 N/m; upright: the paper's ends", csv using 3:(of("20 share", "ks3=803")) with lines ls 6 title "803", \
     csv using 3:(of("20 share", "ks3=0")) with lines ls 7 title "0; dashed: the paper's ends", \
     csv using 3:(of("20 share", "mode ks3=8030")) with lines ls 9 title "one mode kept, 8030; bending from 400 Hz", csv using 3:(of("20 share", "mode ks3=0")) with lines ls 9 dt (4, 3) title "0"
unset arrow
set size 0.5, 0.5; set origin 0, 0
set title "20: half of the starts impact after 3 s between these"
set xlabel "support ks3, N/m"
set ylabel "Hz"
set xrange [-200:8300]
set yrange [600:800]
set key inside top right
plot csv using 3:(of("20 edges", "upper")) with linespoints ls 4 ps 0.5 title "true contact", csv using 3:(of("20 edges", "lower")) with linespoints ls 4 ps 0.5 notitle, \
     "<printf '8030,680\\n8030,740\\n0,670\\n0,760\\n'" using 1:2 with points pt 2 lc rgb "#444444" title "the paper's ends"
set origin 0.5, 0
set title "8: a tenth of the starts impact after 3 s between these"
set xlabel "force p2, N"
set xrange [0:62]
set yrange [0:900]
set key inside center left
plot csv using 3:(of("8 edges", "upper")) with linespoints ls 4 ps 0.5 title "true contact", csv using 3:(of("8 edges", "lower")) with linespoints ls 4 ps 0.5 notitle, \
     csv using 3:(of("8 edges", "low")) with linespoints ls 6 ps 0.5 title "and below this", \
     150 with lines ls 2 title "the paper's ends, all forces", 650 with lines ls 2 notitle, 750 with lines ls 2 notitle, \
     "<printf '25,100\\n25,680\\n25,740\\n'" using 1:2 with points pt 2 lc rgb "#444444" title "at 25 N"
eval done

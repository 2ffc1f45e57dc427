# plants.gp - time of a frame of many plants, and how late they begin.
#   gnuplot -e "csv='docs/img/plants.csv'; out='docs/img/plants.svg'" tests/bench/cost/plants.gp
set terminal svg size 720,440 font "sans,13" background "#ffffff"
set output out
set datafile separator ","
set grid lc rgb "#dddddd"
set key top left Left reverse
set xlabel "plants on the bus"
set ylabel "us"
set yrange [0:1500]
set xrange [0:*]
set title "rigs at 1 kHz on one core, each with a controller"
plot 1000 with lines dt 2 lc rgb "#888888" title "the period", \
     csv skip 1 using 1:2 with linespoints pt 7 ps 0.6 lc rgb "#1f5fbf" title "frame of all plants, median", \
     csv skip 1 using 1:3 with linespoints pt 6 ps 0.6 lc rgb "#1f5fbf" title "99 % of these frames are shorter", \
     csv skip 1 using 1:6 with linespoints pt 5 ps 0.6 lc rgb "#c0392b" title "99 % of the plants' frames begin earlier"

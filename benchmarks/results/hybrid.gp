set terminal pngcairo size 900,560 font 'sans,11'
set output 'hybrid.png'
set datafile separator ','
set datafile missing NaN
set yrange [0:*]
set grid
set key outside right
set xlabel 'speed-up of a step over all non-linear'
set ylabel 'error in equilibrium, relative L2'
series(r) = strcol(4) eq r ? column(7) : NaN
plot 'hybrid.csv' using (series('precomputed')):8:(0.5 + 0.6 * log10($2 / 1000)) with points pt 7 ps variable lc '#c02020' \
    title 'pre-computed', \
  '' using (series('tensor-mass')):8:(0.5 + 0.6 * log10($2 / 1000)) with points pt 6 ps variable lc '#0060ad' \
    title 'tensor-mass', \
  '' using (series('precomputed')):8:(sprintf('%dk', $2 / 1000 + 0.5)) with labels font ',8' offset 2,0.6 notitle
scenes = "liver_declared liver_undeclared "
own = "10299 10299 "
set terminal pngcairo noenhanced size 1300,560 font 'sans,10'
set output 'gestures.png'
set yrange [0.03:50]
set xrange [0:3.6]
set datafile separator ','
set datafile missing NaN
set logscale y
set grid lc '#dddddd'
unset key
set xlabel 'speed-up of all frames over all non-linear'
set ylabel 'largest error of any frame [%]'
regions = "proposed proposed-corrected precomputed-alone precomputed-corrected selective-mass-alone \
selective-mass-corrected"
others = "strain-recipe proposed-precomputed all-linear-corrected precomputed-in-frame"
colours = "#d95f02 #e7298a #8da0cb #7570b3 #66c2a5 #1b9e77"
series(i, r) = strcol(1) eq word(scenes, i) && strcol(2) eq word(own, i) && strcol(3) eq r ? column(5) : NaN
at(i, r, tolerance) = column(13) == tolerance ? series(i, r) : NaN
# Where names would lie upon each other they are moved by a factor of the error.
move(j) = j == 1 ? 1.25 : j == 2 ? 0.8 : j == 3 ? 1.4 : j == 4 ? 0.8 : j == 5 ? 1.4 : 1
set multiplot layout 1,2
do for [i=1:words(scenes)] {
  set title word(scenes, i)
  plot for [j=1:words(others)] 'gestures.csv' using (series(i, word(others, j))):(100 * $8) \
    with linespoints lc '#cccccc' pt 7 ps 0.6, \
    for [j=1:words(regions)] '' using (series(i, word(regions, j))):(100 * $8) \
    with linespoints lc rgb word(colours, j) pt 7 ps 1.2 lw 2, \
    for [j=1:words(regions)] '' using (at(i, word(regions, j), 0.05)):(100 * $8 * move(j)):('  '.word(regions, j)) \
    with labels left textcolor rgb word(colours, j)
}
unset multiplot

set terminal pngcairo size 900,560 font 'sans,11'
set output 'cut.png'
set datafile separator ','
set datafile missing NaN
set logscale xy
set grid
set key outside right
set xlabel 'tetrahedra'
set ylabel 'µs per removed tetrahedron'
series(r, b) = (strcol(1) eq r && column(3) == b) ? column(4) : NaN
plot for [b in '1 10 100'] 'cut.csv' using 2:(series('nonlinear', b + 0)) with linespoints lw 2 pt 7 \
    title 'non-linear, batches of '.b, \
  for [b in '1 10 100'] '' using 2:(series('tensor-mass', b + 0)) with linespoints lw 2 pt 6 dt 2 \
    title 'tensor-mass, batches of '.b, \
  for [b in '10 100'] '' using 2:(series('precomputed', b + 0)) with linespoints lw 2 pt 5 dt 3 \
    title 'pre-computed, batches of '.b

set terminal pngcairo size 1000,620 font 'sans,11'
set output 'kernels.png'
set datafile separator ','
set datafile missing NaN
set logscale x
set yrange [0:60]
set grid
set key outside right
set xlabel 'tetrahedra'
set ylabel 'ns per tetrahedron, one thread'
of(m, k, p) = (strcol(10) eq m && strcol(1) eq k && strcol(2) eq p && column(3) == 1) ? column(5) : NaN
series(k, p) = of('cube', k, p)
set linetype 1 lc '#0060ad'
set linetype 2 lc '#c02020'
set linetype 3 lc '#20a0d0'
set linetype 4 lc '#2e8b30'
set linetype 5 lc '#e08000'
set linetype 6 lc '#8040a0'
kernels = 'svk svk_stored svk_volume svk_guard tensor_mass corotational step svk_nodal_pressure svk_smoothed svk_smoothed_pressure svk_fibre neo_hookean'
plot 'kernels.csv' using 4:(series('reference', 'double')) with linespoints lw 2 lc 'black' dt 2 title 'reference, double', \
  '' using 4:(of('shuffled', 'svk', 'single')) with linespoints lw 1 lc 1 pt 1 title 'svk, single, shuffled', \
  for [i=1:words(kernels)] '' using 4:(series(word(kernels, i), 'single')) with linespoints lw 2 lc i pt 7 \
    title word(kernels, i).', single' noenhanced, \
  for [i=1:words(kernels)] '' using 4:(series(word(kernels, i), 'double')) with linespoints lw 2 lc i pt 6 dt 2 \
    title word(kernels, i).', double' noenhanced

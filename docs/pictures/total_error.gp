# "Which model and element": processor time per simulated second against total error, of the undeclared gesture without
# its cut. Drawn from benchmarks/results by `./dev plots`; plain tetrahedra, single precision, one thread.
set terminal pngcairo noenhanced size 900,520 font 'sans,11'
set output 'docs/pictures/total_error.png'
set datafile separator ','
set datafile missing NaN
set logscale xy
set xrange [0.009:30]
set yrange [0.8:30]
set grid lc '#dddddd'
set xtics (0.01, 0.03, 0.1, 0.3, 1, 3, 10)
set ytics (1, 2, 5, 10, 20)
set xlabel 'processor time per simulated second [s]: left of 1 is faster than real time'
set ylabel 'total error, against a refined mesh [%]'
set key left bottom
set arrow 1 from 1,0.8 to 1,30 nohead lc '#888888' lw 2
table = 'benchmarks/results/accuracy_undeclared.csv'
set label 1 '2,103' at 0.0225,11 textcolor '#555555'
set label 2 '10,299' at 0.2,5.7 textcolor '#555555'
set label 3 '50,244' at 1.7,2.35 textcolor '#555555'
set label 4 '200,712 tetrahedra' at 1.9,0.92 textcolor '#555555'
plot for [i=1:6] '< grep -h "^'.word('tensor_mass hybrid_gradient_50 svk_volume selective_mass_corrected reduced_corrected reduced', i).',single" '.table \
  using (column(9) == 0.9 ? $5 : NaN):(100*$7) with linespoints pt 7 ps 1.6 lw 2 \
  lc rgb word('#999999 #e6a03c #d62728 #1b9e77 #7570b3 #1f77b4', i) \
  title word('"all tensor-mass" "half tensor-mass" "all non-linear" "selective masses, corrected" "reduced, corrected" reduced', i)

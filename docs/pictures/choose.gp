# "Which model should I choose": speed-up of a step or frame over all non-linear, against the error it costs.
# Drawn from benchmarks/results by `./dev plots`; the liver of 10,299 tetrahedra, single precision, one thread.
set terminal pngcairo noenhanced size 900,560 font 'sans,11'
set output 'docs/pictures/choose.png'
set datafile separator ','
set datafile missing NaN
set logscale xy
set xrange [0.4:24]
set yrange [0.4:40]
set grid lc '#dddddd'
set xtics (0.5, 1, 2, 3, 4, 6, 8, 10, 15)
set ytics ('0.5' 0.5, '1' 1, '2' 2, '5' 5, '10' 10, '20' 20)
set xlabel 'times as fast as all non-linear'
set ylabel 'error against all non-linear [%]'
unset key
set label 1 'filled: largest error of any frame, quick gestures' at 3.3,0.75
set label 2 'hollow: error in equilibrium, after a slow gesture' at 3.3,0.57
set arrow 1 from 1,0.4 to 1,40 nohead lc '#888888' lw 2
set label 3 'all non-linear: error 0' at 1.04,0.48 textcolor '#555555'
folder = 'benchmarks/results/'
gesture(name) = strcol(1) eq 'liver_undeclared' && column(2) == 10299 && column(13) == 0.02 && strcol(3) eq name ? column(5) : NaN
static(name) = column(2) == 10299 && strcol(4) eq name ? column(7) : NaN
plot folder.'gestures.csv' using (gesture('selective-mass-corrected')):(100*$8) with points pt 7 ps 2 lc '#1b9e77', \
  '' using (gesture('selective-mass-corrected')):(100*$8):('  selective masses, corrected') with labels left textcolor '#1b9e77', \
  '' using (gesture('selective-mass-alone')):(100*$8) with points pt 7 ps 2 lc '#66c2a5', \
  '' using (gesture('selective-mass-alone')):(100*$8):('  selective masses, not corrected') with labels left textcolor '#66c2a5', \
  '' using (gesture('proposed')):(100*$8) with points pt 7 ps 2 lc '#d95f02', \
  '' using (gesture('proposed')):(100*$8):('tensor-mass, proposed  ') with labels right textcolor '#d95f02', \
  '' using (gesture('proposed-corrected')):(100*$8) with points pt 7 ps 2 lc '#fc8d62', \
  '' using (gesture('proposed-corrected')):(100*$8):('tensor-mass, corrected  ') with labels right textcolor '#fc8d62', \
  '' using (gesture('precomputed-alone')):(100*$8) with points pt 7 ps 2 lc '#8da0cb', \
  '' using (gesture('precomputed-alone')):(100*$8*0.8):('pre-computed, not corrected') with labels left textcolor '#8da0cb', \
  '' using (gesture('precomputed-corrected')):(100*$8) with points pt 7 ps 2 lc '#7570b3', \
  '' using (gesture('precomputed-corrected')):(100*$8):('  pre-computed, corrected') with labels left textcolor '#7570b3', \
  folder.'hybrid.csv' using (static('precomputed')):(100*$8) with linespoints pt 6 ps 2 lc '#7570b3', \
  '' using (static('precomputed')):(100*$8*0.85):(sprintf('     %.0f %% pre-computed', 100*$3)) with labels left textcolor '#7570b3', \
  '' using (static('tensor-mass')):(100*$8) with linespoints pt 6 ps 2 lc '#d95f02', \
  '' using (static('tensor-mass')):($3 > 0.9 ? 100*$8*1.17 : NaN):('62, 80, 93 % tensor-mass') with labels left textcolor '#d95f02'

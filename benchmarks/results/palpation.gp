set terminal pngcairo noenhanced size 900,560 font 'sans,11'
set output 'palpation.png'
set datafile separator ','
set datafile missing NaN
set grid
set key top left
set xlabel 'indentation [mm]'
set ylabel 'force on the finger [N]'
places = "'right of the tumour' 'over the tumour' 'left of the tumour'"
colours = '#0060ad #c02020 #2a8a3a'
of(place, tumour) = strcol(1) eq place && strcol(2) eq tumour ? column(4) : NaN
plot for [i=1:3] 'palpation.csv' using 3:(of(word(places, i), 'yes')) with linespoints pt 7 ps 0.7 lw 2 \
    lc rgb word(colours, i) title word(places, i), \
  for [i=1:3] '' using 3:(of(word(places, i), 'no')) with lines dt 2 lw 2 lc rgb word(colours, i) \
    title word(places, i).', without a tumour'

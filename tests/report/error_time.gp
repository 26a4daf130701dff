# error_time.gp - a panel of error against cost. rows, front, column (3 milliseconds, 6 triangles), xlabel_, x0, x1, y0,
# y1, title_.
set title title_ font ",13"
set logscale xy
set xrange [x0:x1]
set yrange [y0:y1]
set xlabel xlabel_
set ylabel "99.9 % of pixels within, px"
set format y "%g"
set format x (column == 3 ? "%g" : "%.0s%c")
unset key
of(name) = strcol(1) eq name ? $7 : NaN
plot front using 1:2 with lines linewidth 1.5 dashtype 2 linecolor rgb "#222222" title "front", \
     rows using column:(of("brute")) with points pointtype 5 pointsize 0.8 linecolor rgb grey title "brute", \
     rows using column:(of("square-no-morph")) with points pointtype 6 pointsize 0.8 linewidth 1.5 linecolor rgb pale title "square, morph off", \
     rows using column:(of("square")) with points pointtype 7 pointsize 0.7 linecolor rgb blue title "square", \
     rows using column:(of("square")):(sprintf("%d", $2)) with labels offset 0.3,0.7 font ",9" textcolor rgb blue title "n of squares", \
     rows using column:(of("rings-ch06")) with points pointtype 10 pointsize 0.9 linewidth 1.5 linecolor rgb orange title "rings-ch06", \
     rows using column:(of("rings")) with points pointtype 9 pointsize 0.8 linecolor rgb green title "rings", \
     rows using column:(of("rings")):(sprintf("%d", $2)) with labels offset 0.3,-0.8 font ",9" textcolor rgb green title "steps around"

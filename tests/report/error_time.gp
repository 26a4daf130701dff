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
if (x1 / x0 < 300) set for [e = -1:8] xtics add (tic(2, e), tic(5, e))
if (y1 / y0 < 300) set for [e = -7:4] ytics add (tic(2, e), tic(5, e))
unset key
of(name) = strcol(1) eq name ? $7 : NaN
set style line 1 linecolor rgb grey pointtype 5 pointsize 0.8
set style line 2 linecolor rgb pale pointtype 6 pointsize 0.8 linewidth 1.5
set style line 3 linecolor rgb blue pointtype 7 pointsize 0.7
set style line 4 linecolor rgb orange pointtype 10 pointsize 0.9 linewidth 1.5
set style line 5 linecolor rgb green pointtype 9 pointsize 0.8
set style line 7 linecolor rgb "#b02a8f" pointtype 13 pointsize 1
set style line 6 linecolor rgb "#222222" linewidth 1.5 dashtype 2
number(name) = strcol(1) eq name ? sprintf("%d", $2) : ""
plot front using 1:2 with lines linestyle 6 title "front", \
     rows using column:(of("brute")) with points linestyle 1 title "brute", \
     rows using column:(of("square-no-morph")) with points linestyle 2 title "square, morph off", \
     rows using column:(of("square")) with points linestyle 3 title "square", \
     rows using column:(of("square")):(number("square")) with labels offset 0.3,0.7 font ",9" textcolor rgb blue \
         title "n of squares", \
     rows using column:(of("square-error")) with points linestyle 7 title "square-error", \
     rows using column:(of("rings-ch06")) with points linestyle 4 title "rings-ch06", \
     rows using column:(of("rings")) with points linestyle 5 title "rings", \
     rows using column:(of("rings")):(number("rings")) with labels offset 0.3,-0.8 font ",9" textcolor rgb green \
         title "steps around"

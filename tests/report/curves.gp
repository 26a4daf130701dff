# curves.gp - curves of one table: `blocks` blocks in data, two blank lines between them, each a line with its name and
# lines "x y". xlog, ylog: 1 for logarithms where the largest number is 5 times the smallest (xspread, yspread);
# xlabel_, ylabel_, title_.
set title title_ font ",13"
xlog = xlog && xspread >= 5
ylog = ylog && yspread >= 5
if (xlog) set logscale x
if (ylog) set logscale y
set format "%g"
set xlabel xlabel_ offset 0,0.3
set ylabel ylabel_
set key below maxrows 5
set autoscale fix
set offsets graph 0.04, graph 0.04, graph 0.08, graph 0.08
if (xlog) set for [e = -7:9] xtics add (sprintf("%g", tic(2, e)) tic(2, e), sprintf("%g", tic(5, e)) tic(5, e))
if (ylog) set for [e = -7:9] ytics add (sprintf("%g", tic(2, e)) tic(2, e), sprintf("%g", tic(5, e)) tic(5, e))
plot for [i = 0:blocks - 1] data index i using 1:2 with linespoints pointtype (i % 8 + 4) pointsize 0.6 linewidth 1.5 \
     linecolor rgb palette_[i % 10 + 1] title columnheader(1)

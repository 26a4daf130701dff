# precision.gp - CH06's figure 12: error by level of both map transforms. data: level, exact, ch06; ylabel_, goal (0:
# none).
set logscale y
set format y "%.0e"
set xlabel "level of rings (1: widest)"
set ylabel ylabel_
set key below
if (goal > 0) {
    set arrow 1 from graph 0, first goal to graph 1, first goal nohead dashtype 2 linecolor rgb red
    set label 1 sprintf("goal: %g", goal) at graph 0.99, first goal offset 0,0.5 right font ",10" textcolor rgb red
}
set style line 1 linecolor rgb orange linewidth 1.5 pointtype 10
set style line 2 linecolor rgb blue linewidth 1.5 pointtype 7 pointsize 0.6
plot data using 1:3 with linespoints linestyle 1 title "CH06's transform, as the paper has it", \
     data using 1:2 with linespoints linestyle 2 title "exact transform"

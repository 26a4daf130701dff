# style.gp - what all plots have in common. Given on gnuplot's command line: out, width, height.
set terminal svg size width, height dynamic noenhanced background "#ffffff" \
    font "DejaVu Sans,Helvetica,Arial,sans-serif,12"
set output out
set border 3 linecolor rgb "#8a939c"
set grid linecolor rgb "#dfe3e8" linewidth 1
set tics nomirror textcolor rgb "#333333" scale 0.6
set key font ",11" textcolor rgb "#333333" samplen 2 spacing 1.1
set encoding utf8
set datafile missing "?"
tic(value, e) = value * 10.0 ** e # between powers of ten
blue = "#0b6fb8"; pale = "#7db8e0"; green = "#1a8a4a"; orange = "#d06418"; grey = "#666666"; red = "#c62828"
array palette_[10] = [blue, orange, green, "#8e44ad", red, "#00838f", "#a1730a", "#d81b60", grey, pale]

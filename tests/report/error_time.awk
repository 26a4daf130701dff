# error_time.awk - error_time.csv for plots and tables: awk -v out=FOLDER -f csv.awk -f error_time.awk frames.csv
# error_time.csv (frames.csv may be missing). In FOLDER:
#   panels                 a line a panel: number|terrain|title|limits of milliseconds|of triangles|of pixels
#   N.rows, N.ms, N.tris   points of panel N (series n ms low high triangles pixels), its fronts against both costs
#   table.csv              all rows, with spread and whether no other row of the panel is both faster and nearer
# A panel is a scene; "-no-morph" rows belong to the scene without that. Errors below those of all schemes, and
# below `least`, are drawn at the lower edge.

function least_of(a, b) { return a == "" || b + 0 < a + 0 ? b : a }
function most_of(a, b) { return a == "" || b + 0 > a + 0 ? b : a }

FNR == 1 {
    split("", at)
    csv_header($0, at)
    is_error = "err_p999_px" in at
    next
}
{
    split("", f)
    csv_split($0, f)
    key = f[at["scene"]] "," f[at["scheme"]] "," f[at["n"]] "," ("tolerance_px" in at ? f[at["tolerance_px"]] : "")
    if (!is_error) {
        low[key] = f[at["frame_low_ms"]]
        high[key] = f[at["frame_high_ms"]]
        next
    }
    r = ++rows
    scene[r] = f[at["scene"]]; scheme[r] = f[at["scheme"]]; n[r] = f[at["n"]]
    base[r] = scene[r]
    morph[r] = sub(/-no-morph/, "", base[r]) ? "off" : "on"
    series[r] = scheme[r] (morph[r] == "off" ? "-no-morph" : "")
    tris[r] = f[at["triangles"]]; ms[r] = f[at["frame_ms"]]; brute[r] = f[at["brute_ms"]]
    rms[r] = f[at["err_rms_px"]]; p999[r] = f[at["err_p999_px"]]; max[r] = f[at["err_max_px"]]
    ms_low[r] = key in low ? low[key] : ""
    ms_high[r] = key in high ? high[key] : ""
    if (!(base[r] in panel)) {
        panel[base[r]] = ++panels
        name[panels] = base[r]
        terrain[panels] = base[r]
        frame = sub(/-1080p$/, "", terrain[panels]) ? ", 1920 x 1080" : ""
        where = match(terrain[panels], /-[0-9.]+k?m$/)
        title[panels] = (where ? substr(terrain[panels], RSTART + 1) : base[r]) frame
        sub(/[km]/, " &", title[panels])
        if (where)
            terrain[panels] = substr(terrain[panels], 1, RSTART - 1)
        terrain[panels] = terrain[panels] frame
    }
    in_panel[r] = panel[base[r]]
    t = terrain[in_panel[r]]
    ms0[t] = least_of(ms0[t], ms[r]); ms1[t] = most_of(ms1[t], ms[r])
    tr0[t] = least_of(tr0[t], tris[r]); tr1[t] = most_of(tr1[t], tris[r])
    px1[t] = most_of(px1[t], p999[r])
    if (scheme[r] != "brute" && p999[r] + 0 >= least)
        px0[t] = least_of(px0[t], p999[r])
}

# Where an error stands in its panel: what is below all schemes' errors (brute force has none) at the lower edge.
function drawn(p, pixels,    floor_of) {
    floor_of = (px0[terrain[p]] == "" ? least : px0[terrain[p]]) / 2
    return pixels + 0 < floor_of ? floor_of : pixels + 0
}

# Whether no row of the panel costs at most as much with at most the error, and less of one of them.
function best(r, cost,    q) {
    for (q = 1; q <= rows; q++)
        if (in_panel[q] == in_panel[r] && cost[q] + 0 <= cost[r] + 0 && p999[q] + 0 <= p999[r] + 0 &&
            (cost[q] + 0 < cost[r] + 0 || p999[q] + 0 < p999[r] + 0))
            return 0
    return 1
}

# The front of a panel as steps, sorted by cost.
function front(p, cost, file,    r, count, i, k, order) {
    printf "" >file
    count = 0
    for (r = 1; r <= rows; r++)
        if (in_panel[r] == p && best(r, cost)) {
            for (i = count++; i > 0 && cost[order[i]] + 0 > cost[r] + 0; i--)
                order[i + 1] = order[i]
            order[i + 1] = r
        }
    for (k = 1; k <= count; k++) {
        if (k > 1)
            print cost[order[k]], drawn(p, p999[order[k - 1]]) >file
        print cost[order[k]], drawn(p, p999[order[k]]) >file
    }
    close(file)
}

END {
    table = out "/table.csv"
    print "scene,scheme,morph,n,triangles,frame_ms,frame_low_ms,frame_high_ms,brute_ms,brute_times,err_rms_px," \
        "err_p999_px,err_max_px,best" >table
    for (r = 1; r <= rows; r++) {
        file = out "/" in_panel[r] ".rows"
        print series[r], n[r], ms[r], ms_low[r] == "" ? ms[r] : ms_low[r], ms_high[r] == "" ? ms[r] : ms_high[r], \
            tris[r], drawn(in_panel[r], p999[r]) >file
        quotient = is_number(brute[r]) && ms[r] > 0 ? sprintf("%.2f", brute[r] / ms[r]) : ""
        of_scene = base[r]
        gsub(/"/, "\"\"", of_scene)
        print "\"" of_scene "\"," scheme[r] "," (scheme[r] == "square" ? morph[r] : "") "," \
            (scheme[r] == "brute" ? "" : n[r]) "," tris[r] "," ms[r] "," ms_low[r] "," ms_high[r] "," brute[r] "," \
            quotient "," rms[r] "," p999[r] "," max[r] "," (best(r, ms) ? "yes" : "") >table
    }
    for (p = 1; p <= panels; p++) {
        front(p, ms, out "/" p ".ms")
        front(p, tris, out "/" p ".tris")
        t = terrain[p]
        gsub(/\|/, "/", t)
        gsub(/\|/, "/", title[p])
        t0 = terrain[p]
        edge = drawn(p, 0)
        print p "|" t "|" title[p] "|" ms0[t0] / 1.4 ":" ms1[t0] * 1.4 "|" tr0[t0] / 1.4 ":" tr1[t0] * 1.4 "|" \
            edge / 1.3 ":" (px1[t0] + 0 > edge ? px1[t0] : edge) * 2 >(out "/panels")
    }
}

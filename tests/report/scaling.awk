# scaling.awk - scaling.csv a row a plotted point: what,value,cost,ms; what is said as the axis is to say it.
FNR == 1 {
    csv_header($0, at)
    axis["size"] = "size: samples a side"
    axis["levels"] = "levels of detail"
    axis["n"] = "n: samples a side of a window"
    axis["speed"] = "speed: samples a frame, in memory"
    axis["speed_packed"] = "speed: samples a frame, packed"
    axis["pack_threads"] = "threads that pack"
    axis["decode_threads"] = "threads that decode"
    print "what,value,cost,ms"
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    what = f[at["what"]]
    if (what == "teleport") # has but one value
        next
    name = what in axis ? axis[what] : what
    gsub(/"/, "\"\"", name)
    put("frame", f[at["frame_ms"]])
    put(what ~ /threads$/ ? "all of it" : "update", f[at["update_ms"]])
}
function put(cost, ms) {
    if (is_number(ms) && ms > 0)
        print "\"" name "\"," f[at["value"]] "," cost "," ms
}

# space.awk - LH04's space and ours: awk -v paper=LH04 -v table=NAME -v papers=FILE -f csv.awk -f paper.awk -f space.awk
# papers.csv space.csv. "table 3": scheme,samples,bytes,bytes_per_sample. "compression": terrain,samples,spacing_m,
# raw_bytes,packed_bytes,factor,bits_per_sample,rms_m,rms_percent,psnr_db,msps.
FNR == 1 {
    split("", at)
    csv_header($0, at)
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    if (FILENAME == papers)
        of_paper(f)
    else if (("view_bytes" in at) && ("packed_bytes" in at))
        own[++count] = table == "table 3" ? own_view() : own_packed()
}

function own_view(    samples) {
    samples = f[at["width"]] * f[at["height"]]
    return as_field("ours: " f[at["terrain"]]) "," samples "," f[at["view_bytes"]] "," \
        (samples > 0 ? f[at["view_bytes"]] / samples : "")
}

function own_packed(    samples, spacing, rms, range, seconds) {
    samples = f[at["width"]] * f[at["height"]]; rms = f[at["rms_m"]]
    spacing = ("spacing_m" in at) ? f[at["spacing_m"]] : ""
    range = ("range_m" in at) ? f[at["range_m"]] : ""
    seconds = ("pack_cpu_s" in at) ? f[at["pack_cpu_s"]] : ""
    return as_field("ours: " f[at["terrain"]]) "," samples "," spacing "," f[at["raw_bytes"]] "," \
        f[at["packed_bytes"]] "," ratio(f[at["raw_bytes"]], f[at["packed_bytes"]]) "," f[at["bits_per_sample"]] "," \
        rms "," ratio(100 * rms, spacing) "," (range > 0 && rms > 0 ? 20 * log(range / rms) / log(10) : "") "," \
        ratio(samples / 1e6, seconds)
}

function ratio(a, b) {
    return is_number(b) && b > 0 ? a / b : ""
}

function known(quantity) {
    return ((name, quantity) in paper_value) ? paper_value[name, quantity] : ""
}

END {
    if (table == "table 3")
        print "scheme,samples,bytes,bytes_per_sample"
    else
        print "terrain,samples,spacing_m,raw_bytes,packed_bytes,factor,bits_per_sample,rms_m,rms_percent,psnr_db,msps"
    for (i = 1; i <= paper_subjects; i++) {
        name = paper_subject[i]
        if (table == "table 3")
            print as_field(name) "," known("samples") * 1e6 "," known("run-time space") * 1e6 "," known("bytes a sample")
        else
            print as_field(name) "," known("samples") * 1e6 "," known("spacing") "," \
                known("16 bits a sample") * 1e6 "," known("compressed") * 1e6 "," \
                ratio(known("16 bits a sample"), known("compressed")) "," known("bits a sample") "," known("rms") "," \
                known("rms of the spacing") "," known("PSNR") "," ratio(known("samples"), known("packing") * 3600)
    }
    for (i = 1; i <= count; i++)
        print own[i]
}

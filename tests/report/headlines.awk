# headlines.awk - the tiles at the top of the page, computed from all tables given.

# verdict: met, missed, plain (no goal), none (no figures).
function tile(verdict, value, label, text) {
    print "<div class=\"tile " verdict "\"><span class=\"label\">" html(label) "</span><b>" html(value) "</b><span>" \
        html(text) \
        (verdict == "none" || verdict == "plain" ? "" : " <span class=\"verdict\">" verdict "</span>") "</span></div>"
}

function absent(label, file) { tile("none", "not measured", label, "there is no " file) }

function judged(good) { return good ? "met" : "missed" }

function percent(part, whole) { return whole > 0 ? sprintf("%.0f %%", 100 * part / whole) : "" }

# Median of list[1 .. count], which it sorts.
function median(list, count,    i, j, v) {
    for (i = 2; i <= count; i++) {
        v = list[i]
        for (j = i - 1; j >= 1 && list[j] > v; j--)
            list[j + 1] = list[j]
        list[j + 1] = v
    }
    return count % 2 ? list[(count + 1) / 2] : (list[count / 2] + list[count / 2 + 1]) / 2
}

FNR == 1 {
    split("", at)
    csv_header($0, at)
    kind = "other"
    count = split("err_p999_px error err_over_radius precision copy_ratio update verdict extreme codec rate " \
                  "p999_px levels saved_ms left view_over_raw space to_horizon triangles ssim fidelity " \
                  "state runs", kinds, " ")
    for (i = 1; i < count; i += 2)
        if (kinds[i] in at)
            kind = kinds[i + 1]
    seen[kind] = 1
    next
}
/./ {
    split("", f)
    csv_split($0, f)
    if (kind == "error") error_row()
    else if (kind == "precision") precision_row(f[at["variant"]], f[at["err_px"]] + 0)
    else if (kind == "update") update_us[f[1]] = f[at["us"]] + 0
    else if (kind == "extreme") verdicts[f[at["verdict"]]]++
    else if (kind == "rate") rate(f[at["dataset"]], f[at["codec"]])
    else if (kind == "levels") levels_row()
    else if (kind == "left") left_row(f[at["saved_ms"]], f[at["saved_bytes"]])
    else if (kind == "space") space_row()
    else if (kind == "runs") run_row(f[at["name"]], f[at["state"]], f[at["renderer"]])
    else if (kind == "triangles" && f[at["scheme"]] == "rings") {
        views++
        fewer += f[at["to_horizon"]] + 0 <= f[at["paper"]] + 0 # CH06 culls by nothing but the horizon
        views_text = views_text (views > 1 ? "; " : "") grouped(f[at["to_horizon"]]) " to the horizon, CH06's " \
            grouped(f[at["paper"]]) ", " grouped(f[at["drawn"]]) " drawn"
    } else if (kind == "fidelity" && is_number(f[at["ssim"]]) && (ssim == "" || f[at["ssim"]] + 0 < ssim + 0)) {
        ssim = f[at["ssim"]]
        ssim_of = f[1]
    }
}

function error_row(    scene, scheme, n, pixels, which) {
    scene = f[at["scene"]]; scheme = f[at["scheme"]]; n = f[at["n"]] + 0; pixels = f[at["err_p999_px"]] + 0
    if (scene ~ /no-morph/)
        return
    which = scheme == "square" && n == 255 ? "square" : scheme == "rings" && n == 512 ? "rings" : ""
    if (which == "")
        return
    real = scene !~ /^default/
    if ((which, real) in worst == 0 || pixels > worst[which, real]) {
        worst[which, real] = pixels
        worst_of[which, real] = scene
        worst_ms[which, real] = f[at["frame_ms"]] + 0
    }
    frame[which, real, ++scenes[which, real]] = f[at["frame_ms"]] + 0
    if (is_number(f[at["brute_ms"]]) && f[at["frame_ms"]] + 0 > 0)
        brute[which, ++brutes[which]] = f[at["brute_ms"]] / f[at["frame_ms"]]
}

function precision_row(variant, pixels) {
    if (!(variant in precision) || pixels > precision[variant])
        precision[variant] = pixels
}

function levels_row() {
    levels++
    levels_within += f[at["rms_px"]] + 0 < 0.2 && f[at["p999_px"]] + 0 < 1
    if (f[at["p999_px"]] + 0 > levels_worst) {
        levels_worst = f[at["p999_px"]] + 0
        levels_worst_of = f[at["terrain"]] ", level " f[at["level"]]
    }
}

function run_row(name, state, renderer) {
    if (name == "left_out")
        left_by_processors = renderer ~ /llvmpipe|softpipe|swrast/
    if (name ~ /^extreme_/ && state ~ /^(failed|missing)$/)
        broken = broken (broken_count++ ? ", " : "") substr(name, 9)
}

function left_row(ms, bytes) {
    once = f[at["feature"]] ~ /^(GDAL|OpenImageIO|GLFW|thread)/ # when the program starts, not a frame
    if (!once && is_number(ms) && ms + 0 > left_ms + 0) {
        left_ms = ms
        left_ms_of = f[at["feature"]] ", " f[at["scene"]]
    }
    if (is_number(bytes) && bytes + 0 > left_bytes + 0) {
        left_bytes = bytes
        left_bytes_of = f[at["feature"]] ", " f[at["scene"]]
    }
}

function space_row() {
    if (f[at["raw_bytes"]] + 0 > space_raw + 0) {
        space_raw = f[at["raw_bytes"]]
        space_text = f[at["terrain"]] ": " byte_size(f[at["packed_bytes"]]) " packed, a view takes " \
            byte_size(f[at["view_bytes"]])
        space_part = f[at["packed_bytes"]] / space_raw
    }
}

function rate(dataset, codec) {
    rate_row(f, at)
    if (is_number(f[at["decode_msps"]]) && is_number(f[at["rms_m"]])) {
        speed_rms[dataset, codec, ++speeds[dataset, codec]] = f[at["rms_m"]] + 0
        speed_of[dataset, codec, speeds[dataset, codec]] = f[at["decode_msps"]] + 0
    }
}

# ---- The tiles -------------------------------------------------------------------------------------------------------

function error_tile(which, label, n,    real, i, list) {
    real = ((which, 1) in worst) ? 1 : 0
    if (!((which, real) in worst))
        return absent(label, "row of error_time.csv for it")
    for (i = 1; i <= scenes[which, real]; i++)
        list[i] = frame[which, real, i]
    tile(judged(worst[which, real] < 1), \
         digits(worst[which, real], 3) " px in " digits(worst_ms[which, real], 3) " ms", label,
         "worst 99.9 % at " n " over " scenes[which, real] " scenes of " (real ? "real data" : "the default only") \
         ": " worst_of[which, real] " and its frame; median frame of all " \
         digits(median(list, scenes[which, real]), 3) " ms; goal: below 1 px")
}

function brute_tile(which, label,    i, list, count, low) {
    count = brutes[which]
    if (!count)
        return absent(label, "brute-force time in error_time.csv")
    for (i = 1; i <= count; i++)
        list[i] = brute[which, i]
    i = median(list, count)
    tile(judged(list[1] > 1), digits(i, 3) " times", label,
         "as fast, median of " count " scenes, " digits(list[1], 2) " to " digits(list[count], 3) \
         "; goal: above 1 in each")
}

function rate_tile(codec, label, goal,    d, i, name, bits, theirs, list, count) {
    for (d = 1; d <= rate_datasets; d++) {
        name = rate_dataset_name[d]
        for (i = 1; i <= rate_count[name, "terraclip"]; i++) {
            bits = rate_bits_of[name, "terraclip", i]
            theirs = rate_at(name, codec, rate_rms_of[name, "terraclip", i])
            if (theirs < 0.1 || theirs > 2.5)
                continue
            list[++count] = 100 * bits / theirs - 100
        }
    }
    if (!count)
        return absent(label, "point of both codecs between 0.1 and 2.5 bits in rate_distortion.csv")
    i = median(list, count)
    tile(judged(i <= goal), sprintf("%+.1f %%", i), label,
         "our bytes at equal rms, median of " count " points at 0.1 to 2.5 bits, worst " sprintf("%+.1f", list[count]) \
         " %; goal: " goal " % or less")
}

# Each of our decodings against theirs at the nearest rms.
function speed_tile(codec, label,    key, d, i, k, name, near, list, count) {
    for (d = 1; d <= rate_datasets; d++) {
        name = rate_dataset_name[d]
        for (i = 1; i <= speeds[name, "terraclip"]; i++) {
            if (speed_rms[name, "terraclip", i] <= 0)
                continue
            near = 0
            for (k = 1; k <= speeds[name, codec]; k++)
                if (speed_rms[name, codec, k] > 0 &&
                    (!near || distance(name, codec, k, i) < distance(name, codec, near, i)))
                    near = k
            if (near && distance(name, codec, near, i) < log(1.25))
                list[++count] = speed_of[name, "terraclip", i] / speed_of[name, codec, near]
        }
    }
    if (!count)
        return absent(label, "pair of decodings at about equal rms in rate_distortion.csv")
    tile(judged(median(list, count) >= 5), digits(median(list, count), 3) " times", label,
         "as fast at about equal rms, median of " count ", least " digits(list[1], 2) "; goal: 5")
}

function distance(name, codec, k, i,    d) {
    d = log(speed_rms[name, codec, k] / speed_rms[name, "terraclip", i])
    return d < 0 ? -d : d
}

END {
    error_tile("square", "Error of squares", "n = 255")
    error_tile("rings", "Error of rings", "512 steps around")
    brute_tile("square", "Squares against brute force")
    brute_tile("rings", "Rings against brute force")
    if (seen["fidelity"] && ssim != "")
        tile("plain", digits(ssim, 4), "Fidelity", "lowest SSIM against cast pictures: " ssim_of)
    else
        absent("Fidelity", seen["fidelity"] ? "column ssim in fidelity.csv" : "fidelity.csv")
    if (seen["levels"])
        tile(judged(levels_within == levels), levels_within " of " levels, "Levels within the bar",
             "rms below 0.2 px and 99.9 % below 1 px; worst " digits(levels_worst, 3) " px: " levels_worst_of)
    else
        absent("Levels within the bar", "lod_error.csv")
    if ("exact" in precision)
        tile(judged(precision["exact"] < 0.01), digits(precision["exact"], 2) " px", "Precision of the rings",
             "worst vertex of all levels; the paper's transform " digits(precision["ch06"], 3) \
             " px; goal: below 0.01 px")
    else
        absent("Precision of the rings", "precision.csv")
    whole = "whole update; from the file to the textures"
    if (whole in update_us)
        tile(judged(update_us[whole] < 26000), digits(update_us[whole] / 1000, 3) " ms", "A full level updated",
             "from the file to the textures; LH04's steps without synthesis: 26 ms")
    else
        absent("A full level updated", "whole update in update.csv")
    if (views)
        tile(judged(fewer == views), fewer " of " views, "Views with at most CH06's triangles", views_text)
    else
        absent("Views with at most CH06's triangles", "triangles.csv")
    rate_tile("jpeg2000", "Against JPEG 2000", -7)
    rate_tile("lh04", "Against LH04's codec", -25)
    speed_tile("jpeg2000", "Decoding against OpenJPEG")
    if (space_raw)
        tile("plain", percent(space_part, 1), "Of its raw size, packed", space_text)
    else
        absent("Of its raw size, packed", "space.csv")
    if (left_ms != "" || left_bytes != "")
        tile("plain", digits(left_ms + 0, 3) " ms, " byte_size(left_bytes + 0), "Most that was left out",
             (left_by_processors ? "processor time of a frame, all threads: " : "time of a frame: ") left_ms_of \
             "; memory: " left_bytes_of)
    else
        absent("Most that was left out", "left_out.csv")
    cases = verdicts["passed"] + verdicts["refused"] + verdicts["FAILED"] + verdicts["skipped"]
    if (cases || broken_count) # a program that crashed leaves the rows until then, all of which may be good
        tile(judged(verdicts["FAILED"] + broken_count == 0),
             verdicts["FAILED"] || !broken_count ? (verdicts["FAILED"] + 0) " failed" : broken_count " not finished",
             "Extreme cases", (verdicts["passed"] + 0) " passed, " (verdicts["refused"] + 0) \
             " refused as they must be, " (verdicts["skipped"] + 0) " skipped; " \
             (broken_count ? "programs that failed: " broken "; " : "") "goal: none fails")
    else
        tile("none", "not run", "Extreme cases", "make test-extreme")
}

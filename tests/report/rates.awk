# rates.awk - bits against error: points of curves, and what lies between them.

function rate_add(dataset, codec, bits, rms) {
    if (!is_number(bits) || !is_number(rms) || bits <= 0 || rms <= 0)
        return
    rate_count[dataset, codec]++
    rate_bits_of[dataset, codec, rate_count[dataset, codec]] = bits + 0
    rate_rms_of[dataset, codec, rate_count[dataset, codec]] = rms + 0
}

# Bits at which the codec has this rms, between its two nearest points, in logarithms; 0 where it has none on one side.
function rate_at(dataset, codec, rms,    i, above, below, r, b0, b1, r0, r1) {
    for (i = 1; i <= rate_count[dataset, codec]; i++) {
        r = rate_rms_of[dataset, codec, i]
        if (r >= rms && (!above || r < rate_rms_of[dataset, codec, above]))
            above = i
        if (r <= rms && (!below || r > rate_rms_of[dataset, codec, below]))
            below = i
    }
    if (!above || !below)
        return 0
    b0 = rate_bits_of[dataset, codec, below]; r0 = rate_rms_of[dataset, codec, below]
    b1 = rate_bits_of[dataset, codec, above]; r1 = rate_rms_of[dataset, codec, above]
    if (r0 == r1)
        return b0
    return exp(log(b0) + (log(b1) - log(b0)) * (log(rms) - log(r0)) / (log(r1) - log(r0)))
}

# Reads a row of rate_distortion.csv, split into f; ours are those that aim at an rms.
function rate_row(f, at,    codec) {
    codec = f[at["codec"]]
    if (codec == "terraclip" && f[at["mode"]] !~ /^rms/)
        return
    rate_add(f[at["dataset"]], codec, f[at["bits_per_sample"]], f[at["rms_m"]])
    if (!((f[at["dataset"]], codec) in rate_known)) {
        rate_known[f[at["dataset"]], codec] = 1
        if (!(f[at["dataset"]] in rate_dataset)) {
            rate_dataset[f[at["dataset"]]] = 1
            rate_dataset_name[++rate_datasets] = f[at["dataset"]]
        }
        if (!(codec in rate_codec)) {
            rate_codec[codec] = 1
            rate_codec_name[++rate_codecs] = codec
        }
    }
}

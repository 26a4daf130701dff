# equal_rms.awk - our bits at each of our rms against every other codec's there.
FNR == 1 { csv_header($0, at); print "dataset,rms_m,bits,codec,theirs,difference"; next }
/./ {
    split("", f)
    csv_split($0, f)
    rate_row(f, at)
}
END {
    for (d = 1; d <= rate_datasets; d++) {
        name = rate_dataset_name[d]
        for (i = 1; i <= rate_count[name, "terraclip"]; i++)
            for (k = 1; k <= rate_codecs; k++) {
                codec = rate_codec_name[k]
                bits = rate_bits_of[name, "terraclip", i]; rms = rate_rms_of[name, "terraclip", i]
                theirs = codec == "terraclip" ? 0 : rate_at(name, codec, rms)
                if (theirs > 0)
                    printf "%s,%.5g,%.5g,%s,%.5g,%.1f\n", name, rms, bits, codec, theirs, 100 * bits / theirs - 100
            }
    }
}

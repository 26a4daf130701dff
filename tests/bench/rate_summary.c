/* rate_summary.c - our figures against the other codecs'. */
#include "rate_summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/curves.h"
#include "tests/support/datasets.h"
#include "tests/support/measure.h"

enum { MOST_POINTS = 32 };

/* What is compared; ratios, ours over the other's but for the region, whose time is the other's over ours, so that more
 * is better for us in all speeds. */
typedef enum figure { EQUAL_RMS, EQUAL_BOUND, LOSSLESS, ENCODE, DECODE, ROI, FIGURES } figure;

typedef struct ratios {
    double value[FIGURES][MOST_POINTS];
    int count[FIGURES];
} ratios;

static void add(ratios *r, figure f, double value)
{
    if (isfinite(value) && value > 0 && r->count[f] < MOST_POINTS)
        r->value[f][r->count[f]++] = value;
}

static bool is_ours(const rate_row *row)
{
    return strcmp(row->coder->name, RATE_OURS) == 0;
}

/* Our row that another codec's is fairly held against: the same promise, or else, of those that promise an rms, the one
 * whose rms is nearest. */
static const rate_row *partner(const rate_row *rows, int count, const rate_row *other)
{
    bool promise = other->goal.aim == CODER_BOUND || other->goal.aim == CODER_LOSSLESS;
    const rate_row *best = NULL;
    double nearest = INFINITY;
    for (int i = 0; i < count; i++) {
        const rate_row *row = &rows[i];
        if (!is_ours(row) || row->terrain != other->terrain)
            continue;
        if (promise && row->goal.aim == other->goal.aim && row->goal.value == other->goal.value)
            return row;
        double off = fabs(log(row->rms / other->rms));
        if (!promise && row->goal.aim == CODER_RMS && off < nearest)
            best = row, nearest = off;
    }
    return best;
}

static ratios compare(const rate_row *rows, int count, int terrain, const coder *with)
{
    ratios r = {.count = {0}};
    curve_point curve[MOST_POINTS];
    int points = 0;
    for (int i = 0; i < count; i++) {
        const rate_row *row = &rows[i];
        if (row->terrain != terrain || row->coder != with)
            continue;
        if (points < MOST_POINTS)
            curve[points++] = (curve_point){row->bits, row->rms};
        const rate_row *ours = partner(rows, count, row);
        if (!ours)
            continue;
        if (row->goal.aim == CODER_BOUND || row->goal.aim == CODER_LOSSLESS)
            add(&r, row->goal.aim == CODER_BOUND ? EQUAL_BOUND : LOSSLESS, ours->bits / row->bits);
        add(&r, ENCODE, ours->encode / row->encode);
        add(&r, DECODE, ours->decode / row->decode);
        add(&r, ROI, row->roi / ours->roi);
    }
    for (int i = 0; i < count; i++)
        if (rows[i].terrain == terrain && is_ours(&rows[i]) && rows[i].goal.aim == CODER_RMS)
            add(&r, EQUAL_RMS, rows[i].bits / curve_bits(curve, points, rows[i].rms));
    return r;
}

static void print_ratio(figure f, double ratio)
{
    if (!isfinite(ratio))
        printf(" %10s", "-");
    else if (f <= LOSSLESS)
        printf(" %+9.1f%%", 100 * (ratio - 1));
    else
        printf(" %9.2fx", ratio);
}

static void print_heads(const char *first)
{
    printf("%-38s %-16s %10s %10s %10s %10s %10s %10s\n", first, "codec", "equal rms", "equal max", "lossless",
           "encode", "decode", "roi255");
}

/* Medians over terrains, with the worst and the best for us in brackets. */
static void print_overall(const coder *with, double (*medians)[DATASETS_MAX], const int *counts)
{
    static const char *const heads[] = {
        "bits at equal rms", "bits at equal max", "bits, lossless", "encode", "decode", "roi255"};
    for (int f = 0; f < FIGURES; f++) {
        if (counts[f] == 0)
            continue;
        measure_spread s = measure_of(medians[f], counts[f]); /* sorts them */
        double least = medians[f][0], most = medians[f][counts[f] - 1];
        printf("%-16s %-18s", with->name, heads[f]);
        print_ratio(f, s.median);
        printf("   (");
        print_ratio(f, f <= LOSSLESS ? most : least);
        printf(" ..");
        print_ratio(f, f <= LOSSLESS ? least : most);
        printf(" ) over %d terrain%s\n", counts[f], counts[f] == 1 ? "" : "s");
    }
}

void rate_summary(const rate_row *rows, int count, const char *const *names, int terrains)
{
    static double medians[64][FIGURES][DATASETS_MAX];
    static int counts[64][FIGURES];
    printf(
        "\nOurs against each codec, median over its points of a terrain. Bits: per cent, ours against the other's, at\n"
        "equal rms (the other's between its two nearest points), at an equal bound of the error, and lossless. "
        "Speeds:\n"
        "ours over the other's, of the points that promise the same or have the nearest rms; roi255: the other's time\n"
        "over ours\n");
    print_heads("terrain");
    for (int t = 0; t < terrains; t++)
        for (int n = 0; n < coder_count() && n < 64; n++) {
            ratios r = compare(rows, count, t, coder_at(n));
            if (strcmp(coder_at(n)->name, RATE_OURS) == 0 || r.count[DECODE] + r.count[LOSSLESS] == 0)
                continue;
            printf("%-38s %-16s", names[t], coder_at(n)->name);
            for (int f = 0; f < FIGURES; f++) {
                double median = measure_of(r.value[f], r.count[f]).median;
                print_ratio(f, median);
                if (r.count[f] && counts[n][f] < DATASETS_MAX)
                    medians[n][f][counts[n][f]++] = median;
            }
            printf("\n");
        }
    printf("\nThe same over all terrains: the median, and in brackets the worst and the best terrain for us\n");
    for (int n = 0; n < coder_count() && n < 64; n++)
        print_overall(coder_at(n), medians[n], counts[n]);
}

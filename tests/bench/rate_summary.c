/* rate_summary.c - our figures against the other codecs'. */
#include "rate_summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/curves.h"
#include "tests/support/datasets.h"
#include "tests/support/measure.h"

enum { MOST_POINTS = 32, MOST_CODERS = 64 };

/* By what points are found that are fairly compared, and what is compared of them. Ratios: ours over the other's; of
 * the region's time the other's over ours, so that more is better for us in all speeds. */
typedef enum ground { EQUAL_RMS, EQUAL_BOUND, LOSSLESS, GROUNDS } ground;
typedef enum figure { BITS, ENCODE, DECODE, ROI, FIGURES } figure;

typedef struct ratios {
    double value[GROUNDS][FIGURES][MOST_POINTS];
    int count[GROUNDS][FIGURES];
} ratios;

static void add(ratios *r, ground g, figure f, double value)
{
    if (isfinite(value) && value > 0 && r->count[g][f] < MOST_POINTS)
        r->value[g][f][r->count[g][f]++] = value;
}

static void add_speeds(ratios *r, ground g, const rate_row *ours, const rate_row *other)
{
    add(r, g, ENCODE, ours->encode / other->encode);
    add(r, g, DECODE, ours->decode / other->decode);
    add(r, g, ROI, other->roi / ours->roi);
}

static bool is_ours(const rate_row *row)
{
    return strcmp(row->coder->name, RATE_OURS) == 0;
}

/* Our row that promises the same as another codec's; NULL: there is none. */
static const rate_row *same_promise(const rate_row *rows, int count, const rate_row *other)
{
    for (int i = 0; i < count; i++)
        if (is_ours(&rows[i]) && rows[i].terrain == other->terrain && rows[i].goal.aim == other->goal.aim &&
            rows[i].goal.value == other->goal.value)
            return &rows[i];
    return NULL;
}

/* Our row for an rms that is nearest to the other's, and not twice or half of it; NULL: there is none. */
static const rate_row *nearest_rms(const rate_row *rows, int count, const rate_row *other)
{
    const rate_row *best = NULL;
    double nearest = log(2);
    for (int i = 0; i < count; i++) {
        double off = fabs(log(rows[i].rms / other->rms)); /* without an error it is infinite */
        if (is_ours(&rows[i]) && rows[i].terrain == other->terrain && rows[i].goal.aim == CODER_RMS && off < nearest)
            best = &rows[i], nearest = off;
    }
    return best;
}

static ratios compare(const rate_row *rows, int count, int terrain, const coder *with)
{
    ratios r = {.count = {{0}}};
    curve_point curve[MOST_POINTS];
    int points = 0;
    for (int i = 0; i < count; i++) {
        const rate_row *row = &rows[i], *ours;
        if (row->terrain != terrain || row->coder != with)
            continue;
        if (points < MOST_POINTS)
            curve[points++] = (curve_point){row->bits, row->rms};
        bool promise = row->goal.aim == CODER_BOUND || row->goal.aim == CODER_LOSSLESS;
        ground g = row->goal.aim == CODER_BOUND ? EQUAL_BOUND : LOSSLESS;
        if (promise && (ours = same_promise(rows, count, row))) {
            add(&r, g, BITS, ours->bits / row->bits);
            add_speeds(&r, g, ours, row);
        }
        if ((ours = nearest_rms(rows, count, row)))
            add_speeds(&r, EQUAL_RMS, ours, row);
    }
    for (int i = 0; i < count; i++)
        if (rows[i].terrain == terrain && is_ours(&rows[i]) && rows[i].goal.aim == CODER_RMS)
            add(&r, EQUAL_RMS, BITS, rows[i].bits / curve_bits(curve, points, rows[i].rms));
    return r;
}

static const char *const ground_names[] = {"equal rms", "equal bound", "lossless"};

static void print_ratio(figure f, double ratio)
{
    char text[32] = "-";
    if (isfinite(ratio))
        snprintf(text, sizeof text, f == BITS ? "%+.1f%%" : "%.2fx", f == BITS ? 100 * (ratio - 1) : ratio);
    printf(" %8s", text);
}

/* Medians over terrains, with the worst and the best for us in brackets. */
static void print_overall(const char *name, ground g, double (*medians)[DATASETS_MAX], const int *counts)
{
    printf("%-16s %-12s %3d", name, ground_names[g], counts[ENCODE]);
    for (int f = 0; f < FIGURES; f++) {
        measure_spread s = measure_of(medians[f], counts[f]); /* sorts them */
        double least = counts[f] ? medians[f][0] : NAN, most = counts[f] ? medians[f][counts[f] - 1] : NAN;
        print_ratio(f, s.median);
        printf(" (");
        print_ratio(f, f == BITS ? most : least);
        print_ratio(f, f == BITS ? least : most);
        printf(")");
    }
    printf("\n");
}

void rate_summary(const rate_row *rows, int count, const char *const *names, int terrains)
{
    static double medians[MOST_CODERS][GROUNDS][FIGURES][DATASETS_MAX];
    static int counts[MOST_CODERS][GROUNDS][FIGURES];
    printf(
        "\nOurs against each codec, median over its points of a terrain. Bits: ours against the other's, at equal rms\n"
        "between its two nearest points, at an equal bound of the error, and lossless. Speeds: ours over the other's,\n"
        "of the points that promise the same or, for an rms, have the nearest one; roi255: the other's time over "
        "ours\n");
    printf("%-38s %-16s %-12s %8s %8s %8s %8s\n", "terrain", "codec", "at", "bits", "encode", "decode", "roi255");
    for (int t = 0; t < terrains; t++)
        for (int n = 0; n < coder_count() && n < MOST_CODERS; n++) {
            ratios r = compare(rows, count, t, coder_at(n));
            for (int g = 0; strcmp(coder_at(n)->name, RATE_OURS) != 0 && g < GROUNDS; g++) {
                if (r.count[g][ENCODE] == 0)
                    continue;
                printf("%-38s %-16s %-12s", names[t], coder_at(n)->name, ground_names[g]);
                for (int f = 0; f < FIGURES; f++) {
                    int *have = &counts[n][g][f];
                    double median = measure_of(r.value[g][f], r.count[g][f]).median;
                    print_ratio(f, median);
                    if (r.count[g][f] && *have < DATASETS_MAX)
                        medians[n][g][f][(*have)++] = median;
                }
                printf("\n");
            }
        }
    printf("\nThe same over all terrains: their number, medians, and in brackets the worst and the best for us\n");
    printf("%-16s %-12s %3s %8s %-20s %8s %-20s %8s %-20s %8s\n", "codec", "at", "", "bits", "", "encode", "", "decode",
           "", "roi255");
    for (int n = 0; n < coder_count() && n < MOST_CODERS; n++)
        for (int g = 0; g < GROUNDS; g++)
            if (counts[n][g][ENCODE])
                print_overall(coder_at(n)->name, g, medians[n][g], counts[n][g]);
}

/* bench_rate_distortion.c - bits a sample against error, and speed, of our codecs and of all that OpenJPEG and GDAL on
 * this machine offer for heights: the rows of rate_distortion.csv.
 *
 * The same heights for all: the middle of each terrain, voids filled with the nearest height before; integers where its
 * file stores integers, else floats. Ours through the public interface alone. All write files of their own into one
 * folder, and bytes are those of whole files; errors are those of every sample that is read back. Times are medians of
 * processor time, one thread: decoding opens the file, reads all of it and closes it; a region is 255 x 255 samples at
 * random places, the same for all codecs, each time from a freshly opened file. Encoders that take long run once. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rate_summary.h"
#include "tests/support/made_files.h"
#include "tests/support/measure.h"
#include "tests/support/timed.h"

enum { SIDE = 255, MOST_GOALS = 8, MOST_ROWS = 8192 };

/* What is measured. */
typedef struct plan {
    int64_t size; /* of crops */
    double rms[MOST_GOALS], bounds[MOST_GOALS];
    int rms_count, bound_count;
    timed_limits encode, decode, roi;
    int files; /* of TERRACLIP_DATA */
} plan;

static const plan full = {.size = 1024,
                          .rms = {0.5, 1, 2, 4, 8},
                          .rms_count = 5,
                          .bounds = {1, 3, 8, 20},
                          .bound_count = 4,
                          .encode = {1, 3, 0.1},
                          .decode = {3, 5, 0.1},
                          .roi = {5, 25, 0.05},
                          .files = DATASETS_MAX};
static const plan quick = {.size = 512,
                           .rms = {1, 4},
                           .rms_count = 2,
                           .bounds = {1, 5, 20},
                           .bound_count = 3,
                           .encode = {1, 3, 0.05},
                           .decode = {3, 5, 0.03},
                           .roi = {3, 20, 0.03},
                           .files = 1};

/* All rows so far, and the names of their terrains. */
typedef struct table {
    const plan *plan;
    FILE *csv;
    rate_row *rows;
    int count, terrains;
    int broken; /* promises of ours */
    const char *names[DATASETS_MAX + 1];
} table;

/* ---- One row ---------------------------------------------------------------------------------------------------- */

typedef struct reading {
    coded *coded;
    tc_rect whole, places[TIMED_MOST];
    void *samples;
} reading;

static bool encode_once(void *context, int n)
{
    (void)n;
    return coded_encode(context);
}

static bool read_whole(void *context, int n)
{
    const reading *r = context;
    (void)n;
    return r->coded->coder->read(r->coded, r->whole, r->samples);
}

static bool read_place(void *context, int n)
{
    const reading *r = context;
    return r->coded->coder->read(r->coded, r->places[n], r->samples);
}

static const char *mode_name(const coded *c)
{
    static char name[128];
    static const char *const aims[] = {
        [CODER_RMS] = "rms", [CODER_BOUND] = "max-error", [CODER_LOSSLESS] = "lossless", [CODER_RATE] = "rate"};
    char value[32] = "";
    if (c->goal.aim != CODER_LOSSLESS)
        snprintf(value, sizeof value, " %.4g", c->goal.value);
    snprintf(name, sizeof name, "%s%s (%s%s)", aims[c->goal.aim], value, c->quantised ? "quantised; " : "",
             c->coder->layout);
    return name;
}

static void csv_number(FILE *csv, const char *format, double value)
{
    fputc(',', csv);
    if (isfinite(value))
        fprintf(csv, format, value);
}

static void write_row(const table *t, const rate_row *row, const coded *c, bool kept)
{
    printf("%-38s %-16s %-38s %8.4f %8.4f %9.4f %8.2f %8.2f %9.3f%s\n", t->names[row->terrain], row->coder->name,
           mode_name(c), row->bits, row->rms, row->max, row->encode, row->decode, row->roi, kept ? "" : " NOT KEPT");
    fflush(stdout);
    if (!t->csv)
        return;
    measure_put_text(t->csv, t->names[row->terrain]);
    fprintf(t->csv, ",%s,%s", row->coder->name, mode_name(c));
    csv_number(t->csv, "%.6g", row->bits), csv_number(t->csv, "%.6g", row->rms);
    csv_number(t->csv, "%.6g", row->max), csv_number(t->csv, "%.4g", row->encode);
    csv_number(t->csv, "%.4g", row->decode), csv_number(t->csv, "%.4g", row->roi);
    fputc('\n', t->csv);
}

/* False where the codec failed, which c->why tells. */
static bool measure(const plan *p, coded *c, rate_row *row)
{
    const tc_grid *g = &c->input->grid;
    measure_spread encode, decode, roi = {NAN, NAN, NAN, 0};
    double millions = 1e-6 * (double)(g->width * g->height);
    reading r = {.coded = c, .whole = {0, 0, g->width, g->height}};
    if (!timed_repeat(p->encode, encode_once, c, &encode))
        return false;
    terrain_error e = coded_error(c);
    r.samples = calloc((size_t)(g->width * g->height), sizeof(int32_t));
    if (!r.samples)
        puts("rate: no memory"), exit(99);
    bool places = g->width >= SIDE && g->height >= SIDE;
    test_random random = {7};
    for (int n = 0; places && n < TIMED_MOST; n++)
        r.places[n] = terrain_place(&random, g->width, g->height, SIDE);
    bool done = isfinite(e.rms) && timed_repeat(p->decode, read_whole, &r, &decode) &&
                (!places || timed_repeat(p->roi, read_place, &r, &roi));
    free(r.samples);
    if (!done) {
        snprintf(c->why, sizeof c->why, "what it wrote cannot be read back");
        return false;
    }
    row->bits = 8 * c->bytes / (1e6 * millions), row->rms = e.rms, row->max = e.max;
    row->encode = 1e3 * millions / encode.median, row->decode = 1e3 * millions / decode.median, row->roi = roi.median;
    return true;
}

static void add_row(table *t, const coder *with, const coder_input *input, coder_goal goal)
{
    coded c;
    rate_row row = {.terrain = t->terrains - 1, .coder = with, .goal = goal};
    if (!coded_begin(&c, with, input, goal) || !measure(t->plan, &c, &row)) {
        printf("%-38s %-16s %-38s refused: %s\n", t->names[row.terrain], with->name, mode_name(&c),
               *c.why ? c.why : "it gives no reason");
    } else {
        bool kept = coded_kept(&c, (terrain_error){row.rms, row.max});
        write_row(t, &row, &c, kept);
        t->broken += !kept && strcmp(with->name, RATE_OURS) == 0;
        if (t->count < MOST_ROWS)
            t->rows[t->count++] = row;
    }
    coded_end(&c);
}

/* ---- All rows of a terrain -------------------------------------------------------------------------------------- */

/* Rates around those that ours took for its rms, so that the curves lie side by side; what lies at the ends is
 * enclosed. */
static int choose_rates(const table *t, double *rates)
{
    int count = 0;
    double least = INFINITY, most = 0;
    for (int i = 0; i < t->count; i++) {
        const rate_row *row = &t->rows[i];
        if (row->terrain != t->terrains - 1 || strcmp(row->coder->name, RATE_OURS) != 0 || row->goal.aim != CODER_RMS)
            continue;
        least = fmin(least, row->bits), most = fmax(most, row->bits);
        rates[count++] = 1.1 * row->bits;
    }
    if (count > 0)
        rates[count++] = 0.85 * least, rates[count++] = 1.4 * most;
    return count;
}

static void add_coder(table *t, const coder *with, const coder_input *input)
{
    const plan *p = t->plan;
    char why[CODER_WHY];
    double rates[MOST_GOALS + 2];
    if ((p == &quick && with->effort == CODER_IN_FULL) || !coder_offered(with, why))
        return;
    if (with->aims & 1 << CODER_LOSSLESS)
        add_row(t, with, input, (coder_goal){CODER_LOSSLESS, 0});
    for (int n = 0; with->aims & 1 << CODER_BOUND && n < p->bound_count; n++)
        add_row(t, with, input, (coder_goal){CODER_BOUND, p->bounds[n]});
    bool sparse = with->effort == CODER_SLOW && p->rms_count > 2;
    for (int n = sparse; with->aims & 1 << CODER_RMS && n < p->rms_count; n += 1 + sparse)
        add_row(t, with, input, (coder_goal){CODER_RMS, p->rms[n]});
    int count = with->aims & 1 << CODER_RATE ? choose_rates(t, rates) : 0;
    for (int n = 0; n < count; n++)
        add_row(t, with, input, (coder_goal){CODER_RATE, rates[n]});
}

static void add_terrain(table *t, const dataset *set)
{
    terrain_file about;
    tc_grid crop;
    if (!terrain_file_crop(set, t->plan->size, &about, &crop))
        return;
    t->names[t->terrains++] = set->name;
    coder_input input = coder_input_of(&about, &crop);
    printf("\n%s: %lld x %lld samples, %s\n", set->name, (long long)input.grid.width, (long long)input.grid.height,
           input.stored ? "integers" : "floats");
    printf("%-38s %-16s %-38s %8s %8s %9s %8s %8s %9s\n", "terrain", "codec", "mode", "bits", "rms m", "max m",
           "enc Ms/s", "dec Ms/s", "roi255 ms");
    for (int n = 0; n < coder_count(); n++)
        add_coder(t, coder_at(n), &input);
    coder_input_free(&input);
}

static void say_what_is_offered(bool quickly)
{
    char why[CODER_WHY];
    for (int n = 0; n < coder_count(); n++) {
        const coder *c = coder_at(n);
        if (!coder_offered(c, why))
            printf("%-16s not offered: %s\n", c->name, why);
        else
            printf("%-16s offered%s\n", c->name,
                   quickly && c->effort == CODER_IN_FULL ? ", not measured with --quick" : "");
    }
    printf("Offered by GeoTIFF and not measured: %s\n", gdal_coders_unused());
}

int main(int argc, char **argv)
{
    measure_options o = measure_begin(
        argc, argv, "dataset,codec,mode,bits_per_sample,rms_m,max_error_m,encode_msps,decode_msps,roi255_ms");
    static rate_row rows[MOST_ROWS];
    atexit(coders_clean_up); /* also where a terrain cannot be loaded */
    table t = {.plan = o.quick ? &quick : &full, .csv = o.csv, .rows = rows};
    dataset sets[DATASETS_MAX];
    int count = dataset_list(sets, DATASETS_MAX), files = count - 1 < t.plan->files ? count - 1 : t.plan->files;
    printf("Rate and error: files in %s, all codecs alike\n", made_folder());
    say_what_is_offered(o.quick);
    add_terrain(&t, &sets[0]);
    for (int n = 0; n < files; n++) /* spread over all there are */
        add_terrain(&t, &sets[1 + n * (count - 1) / files]);
    rate_summary(t.rows, t.count, t.names, t.terrains);
    if (t.broken)
        fprintf(stderr, "rate: %d of our own bounds were not kept\n", t.broken);
    return measure_end(&o) || t.broken ? 1 : 0;
}

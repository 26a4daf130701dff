/* bench_pack.c - packed terrains against JPEG 2000, LH04's codec, LERC and what else was measured: bytes at equal
 * error, bytes at a bound of the error, what the default's bound costs beside its rms, and speed of reading.
 *
 * All through the public interface; bytes are those of whole files, errors those of what is read back. JPEG 2000 is
 * OpenJPEG's at its best (jpeg2000.h), given the same heights with voids filled; it stores no voids and no
 * georeference, our files do. Arguments: none for everything, or one of rate, bounds, default, decode; then, for
 * rate, the name of a file. Needs TERRACLIP_DATA. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "coders.h"
#include "tests/support/curves.h"
#include "tests/support/made_files.h"
#include "tests/support/measure.h"
#include "tests/support/terrain_files.h"
#include "tests/support/terrains.h"

static const terrain_file puget = {{"ps_height_1k.png", 160, 0.1}, TC_SAMPLE_UINT16, 0.1},
                          tatra = {{"srtm3_tatra_poland_4801.tif", 0, 0}, TC_SAMPLE_INT16, 1},
                          canyon = {{"srtm3_canyonlands_voids_2401x3601.tif", 0, 0}, TC_SAMPLE_INT16, 1},
                          moon = {{"moon_gld100_256ppd_ne_4097.png", 118.45, 0}, TC_SAMPLE_UINT16, 1},
                          moon_globe = {{"moon_gld100_global_5760x2880.tif", 0, 0}, TC_SAMPLE_INT16, 1},
                          moon_large = {{"moon_gld100_256ppd_ne_8193.tif", 0, 0}, TC_SAMPLE_INT16, 1},
                          etopo = {{"earth_etopo20_1080x540_f32.tif", 0, 0}, TC_SAMPLE_FLOAT32, 0},
                          synthetic = {{"default", 0, 0}, TC_SAMPLE_FLOAT32, 0};

/* ---- Rate and error --------------------------------------------------------------------------------------------- */

static const double rate_rms[] = {0.5, 1, 2, 5.4};
enum { RATES = sizeof rate_rms / sizeof *rate_rms, MOST_ROWS = 64 };
static const double lh04_most = 32e6; /* samples: larger terrains are left out, to save time */

typedef struct rate_row {
    double bits, rms, max, lh04_bits, lh04_rms;
} rate_row;

/* Of all rows so far. */
static struct {
    double against[MOST_ROWS]; /* our bytes over JPEG 2000's - 1, of the rows that count */
    int count;
    double lh04[MOST_ROWS]; /* our bytes over LH04's - 1, of each terrain's row nearest 0.25 bits */
    int lh04_count;
} rates;

static rate_row pack_rate(const tc_grid *grid, const terrain_file *file, double rms, tc_pack_codec codec)
{
    const char *path = made_path("rate.tclip");
    tc_pack_options options = {.mode = TC_PACK_RMS, .codec = codec, .error = rms};
    terrain_packed p = terrain_pack(grid, file, &options, path);
    terrain_error e = terrain_compare(grid, path);
    unlink(path);
    return (rate_row){.bits = 8 * p.bytes / (double)(grid->width * grid->height), .rms = e.rms, .max = e.max};
}

/* LH04's bits at our rms, along the straight line between two rows in logarithms. */
static double lh04_at(const rate_row *row, int n, double rms)
{
    const rate_row *a = &row[n], *b = &row[n + 1 < RATES ? n + 1 : n - 1];
    return curve_between((curve_point){a->lh04_bits, a->lh04_rms}, (curve_point){b->lh04_bits, b->lh04_rms}, rms);
}

static void rate_terrain(const terrain_file *file)
{
    tc_grid grid;
    if (!dataset_load(&file->set, &grid))
        return;
    rate_row row[RATES];
    bool with_paper = (double)grid.width * (double)grid.height <= lh04_most;
    int nearest = 0;
    for (int n = 0; n < RATES; n++) {
        row[n] = pack_rate(&grid, file, rate_rms[n], TC_CODEC_LIFTING);
        if (with_paper) {
            rate_row paper = pack_rate(&grid, file, rate_rms[n], TC_CODEC_LH04);
            row[n].lh04_bits = paper.bits, row[n].lh04_rms = paper.rms;
        }
        if (fabs(log(row[n].bits / 0.25)) < fabs(log(row[nearest].bits / 0.25)))
            nearest = n;
    }
    j2k_image image = j2k_image_of(&grid);
    const char *path = made_path("rate.j2k");
    double seed = 1.1;
    for (int n = 0; n < RATES; n++) {
        j2k_match match = j2k_at_rms(&image, &grid, row[n].rms, seed * row[n].bits, path);
        double against = row[n].bits / match.bits - 1;
        bool counts = match.bits >= 0.1 && match.bits <= 2.5;
        printf("%-38s %5.2f %7.4f %8.2f %8.4f %9.4f %+7.1f%s", file->set.name, rate_rms[n], row[n].rms, row[n].max,
               row[n].bits, match.bits, 100 * against, counts ? " " : "-");
        if (with_paper) {
            double paper = lh04_at(row, n, row[n].rms), against_paper = row[n].bits / paper - 1;
            printf(" %9.4f %+7.1f", paper, 100 * against_paper);
            if (n == nearest && row[n].bits > 0.125 && row[n].bits < 0.5)
                rates.lh04[rates.lh04_count++] = against_paper;
        }
        printf("%s\n", n == nearest ? " <" : "");
        fflush(stdout);
        seed = match.bits / row[n].bits;
        if (counts)
            rates.against[rates.count++] = against;
    }
    unlink(path);
    j2k_image_free(&image);
    tc_grid_free(&grid);
}

static void rate_section(const char *only)
{
    const terrain_file *files[] = {&puget, &etopo, &canyon, &synthetic, &moon, &moon_globe, &tatra, &moon_large};
    printf("\nRate at equal rms: bits a sample of whole files; per cent: our bytes against the others', - where JPEG\n"
           "2000's bits are not within 0.1 to 2.5; < the terrain's row nearest to 0.25 bits\n");
    printf("%-38s %5s %7s %8s %8s %9s %8s %9s %7s\n", "", "goal", "rms m", "max m", "bits", "JPEG 2000", "%   ", "lh04",
           "%");
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        if (!*only || strcmp(only, files[i]->set.name) == 0)
            rate_terrain(files[i]);
    double worst = -INFINITY, worst_paper = -INFINITY;
    for (int i = 0; i < rates.count; i++)
        worst = fmax(worst, rates.against[i]);
    for (int i = 0; i < rates.lh04_count; i++)
        worst_paper = fmax(worst_paper, rates.lh04[i]);
    printf("against JPEG 2000, %d rows that count: median %+.1f %% (bar -7), worst %+.1f %% (bar +1)\n", rates.count,
           100 * measure_of(rates.against, rates.count).median, 100 * worst);
    printf(
        "against LH04's codec, %d rows nearest 0.25 bits (0.125 to 0.5): median %+.1f %% (bar -25), worst %+.1f %%\n",
        rates.lh04_count, 100 * measure_of(rates.lh04, rates.lh04_count).median, 100 * worst_paper);
}

/* ---- Bounded errors and none ------------------------------------------------------------------------------------ */

/* What others take, from the codec study: bits a sample of the same crops, voids filled with the nearest height; 0: not
 * measured. JPEG XL: modular mode, effort 7; with an error of E allowed, of heights divided by 2 E + 1. */
typedef struct bound {
    double error; /* metres; 0: lossless */
    double jpeg_ls, jpeg_xl;
} bound;

static const struct bound_crop {
    const char *name;
    const terrain_file *file;
    int64_t x0, y0, size;
    bound bounds[4];
} bound_crops[] = {
    {"tatra2k", &tatra, 800, 2753, 2048, {{1, 2.33, 2.04}, {2, 1.85, 1.547}, {0, 3.71, 3.36}}},
    {"canyon2k", &canyon, 352, 1344, 2048, {{1, 2.67, 2.33}, {2, 2.10, 1.80}, {0, 0, 3.74}}},
    {"moon2k", &moon, 1000, 1000, 2048, {{1, 1.83, 1.186}, {2, 1.54, 0.921}, {4, 0, 0}, {0, 2.91, 2.07}}},
    {"ps1k", &puget, 0, 0, 1025, {{1, 0, 0}, {2, 0, 0}, {0, 8.68, 8.10}}},
};

static void percent(double ours, double other)
{
    if (other > 0)
        printf(" %9.3f %+7.1f", other, 100 * (ours / other - 1));
    else
        printf(" %9s %7s", "", "");
}

/* LERC's bits a sample, with zstd and in one block: the fewest; 0 where GDAL was built without it. */
static double lerc_bits(const coder_input *input, double error)
{
    const coder *lerc = coder_named("lerc-zstd-whole");
    coder_goal goal = {error > 0 ? CODER_BOUND : CODER_LOSSLESS, error};
    char why[CODER_WHY];
    if (!coder_offered(lerc, why))
        return 0;
    coded c;
    if (!coded_begin(&c, lerc, input, goal) || !coded_encode(&c) || !coded_kept(&c, coded_error(&c))) {
        fprintf(stderr, "LERC: %s\n", *c.why ? c.why : "the bound is not kept");
        exit(99);
    }
    double bits = 8 * c.bytes / (double)(input->grid.width * input->grid.height);
    coded_end(&c);
    return bits;
}

static void bound_row(const struct bound_crop *c, const coder_input *input, const bound *b)
{
    const tc_grid *grid = &input->grid;
    const char *path = made_path("bound.tclip");
    tc_pack_options options = {.mode = b->error > 0 ? TC_PACK_MAX_ERROR : TC_PACK_LOSSLESS, .error = b->error};
    terrain_packed p = terrain_pack(grid, c->file, &options, path);
    terrain_error e = terrain_compare(grid, path);
    unlink(path);
    double samples = (double)(grid->width * grid->height), bits = 8 * p.bytes / samples;
    char name[32];
    snprintf(name, sizeof name, b->error > 0 ? "%g m" : "lossless", b->error);
    double rounding = FLT_EPSILON * fmax(fabs((double)grid->z_min), fabs((double)grid->z_max));
    const char *verdict = e.max <= b->error ? "kept" : e.max <= b->error + rounding ? "float" : "BROKEN";
    printf("%-10s %-9s %8.4f %7.3f %-6s %8.3f", c->name, name, e.max, e.rms, verdict, bits);
    percent(bits, b->jpeg_ls);
    percent(bits, b->jpeg_xl);
    percent(bits, lerc_bits(input, b->error));
    printf("\n");
    fflush(stdout);
}

static void bound_section(void)
{
    printf(
        "\nBounds of the error: bits a sample; per cent: our bytes against the others'. JPEG-LS and JPEG XL: figures\n"
        "of the codec study\n");
    printf("%-10s %-9s %8s %7s %6s %8s %9s %7s %9s %7s %9s %7s\n", "", "bound", "max m", "rms m", "", "bits", "JPEG-LS",
           "%", "JPEG XL", "%", "LERC", "%");
    for (size_t i = 0; i < sizeof bound_crops / sizeof *bound_crops; i++) {
        const struct bound_crop *c = &bound_crops[i];
        tc_grid whole;
        if (!dataset_load(&c->file->set, &whole))
            continue;
        tc_grid grid = terrain_crop(&whole, c->x0, c->y0, c->size);
        tc_grid_free(&whole);
        coder_input input = coder_input_of(c->file, &grid);
        for (int n = 0; n < 4 && (c->bounds[n].error > 0 || c->bounds[n].jpeg_xl > 0); n++)
            bound_row(c, &input, &c->bounds[n]);
        coder_input_free(&input);
    }
}

/* ---- An rms alone, and with a bound ------------------------------------------------------------------------------ */

/* Processor seconds of reading the whole finest level, the best of a few. */
static double reading_time(const char *path, int64_t samples)
{
    enum { TIMES = 3 };
    float *z = malloc((size_t)samples * sizeof *z);
    double best = INFINITY;
    if (!z)
        exit(99);
    memset(z, 0, (size_t)samples * sizeof *z);
    for (int n = 0; n < TIMES; n++) {
        tc_field *field = terrain_open(path);
        double start = terrain_cpu();
        terrain_read(field, z, NULL);
        best = fmin(best, terrain_cpu() - start);
        tc_field_destroy(field);
    }
    free(z);
    return best;
}

static void default_row(const dataset *set)
{
    const double share = 0.06, most = 10, times = 4; /* as the packing command has them */
    const char *path = made_path("default.tclip");
    const terrain_file file = {*set, TC_SAMPLE_FLOAT32, 0};
    tc_grid grid;
    if (!dataset_load(set, &grid))
        return;
    tc_pack_options options = {.mode = TC_PACK_RMS};
    options.error = fmin(most, share * 0.5 * (grid.spacing_x + grid.spacing_y));
    terrain_packed packed[2];
    terrain_error error[2];
    double reading[2];
    for (int k = 0; k < 2; k++) {
        options.max_error = k ? times * options.error : 0;
        packed[k] = terrain_pack(&grid, &file, &options, path);
        error[k] = terrain_compare(&grid, path);
        reading[k] = reading_time(path, grid.width * grid.height);
        unlink(path);
    }
    printf("%-38s %6.2f %7.3f %7.3f %10.0f %10.0f %+6.1f %9.2f %8.2f %7.2f %7.2f\n", set->name, options.error,
           error[0].rms, error[1].rms, packed[0].bytes, packed[1].bytes, 100 * (packed[1].bytes / packed[0].bytes - 1),
           error[0].max, error[1].max, packed[1].cpu / packed[0].cpu, reading[1] / reading[0]);
    fflush(stdout);
    tc_grid_free(&grid);
}

static void default_section(void)
{
    dataset list[DATASETS_MAX];
    int count = dataset_list(list, DATASETS_MAX);
    printf("\nThe default, an rms with a bound of four times it, against the rms alone: bytes of whole files, largest\n"
           "errors, and how many times the processor time packing and reading the whole take\n");
    printf("%-38s %6s %7s %7s %10s %10s %6s %9s %8s %7s %7s\n", "", "goal", "rms m", "rms m", "bytes", "bytes", "%",
           "max m", "max m", "packing", "reading");
    for (int i = 0; i < count; i++)
        default_row(&list[i]);
}

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

enum { RUNS = 5, PLACES = 200, J2K_PLACES = 40, SIDE = 255 };

/* A terrain packed both ways with the same error. */
typedef struct both {
    tc_grid grid;
    const char *ours, *j2k;
    double bits, j2k_bits;
} both;

static bool both_make(const terrain_file *file, double rms, both *b)
{
    if (!dataset_load(&file->set, &b->grid))
        return false;
    b->ours = made_path("both.tclip"), b->j2k = made_path("both.j2k");
    tc_pack_options options = {.mode = TC_PACK_RMS, .error = rms};
    double samples = (double)(b->grid.width * b->grid.height);
    b->bits = 8 * terrain_pack(&b->grid, file, &options, b->ours).bytes / samples;
    j2k_image image = j2k_image_of(&b->grid);
    double reached = terrain_compare(&b->grid, b->ours).rms;
    b->j2k_bits = j2k_at_rms(&image, &b->grid, reached, 1.1 * b->bits, b->j2k).bits;
    j2k_image_free(&image);
    return true;
}

static void both_free(both *b)
{
    unlink(b->ours), unlink(b->j2k);
    tc_grid_free(&b->grid);
}

static void must_decode(const char *path, tc_rect rect, int32_t *v)
{
    if (!j2k_decode(path, rect, v))
        exit(99);
}

/* Best of several, in turns; processor time, which other work on the machine disturbs least. */
static void read_whole(const both *b, double *ours_ret, double *opened_ret, double *j2k_ret)
{
    int64_t count = b->grid.width * b->grid.height;
    float *z = malloc((size_t)count * sizeof *z);
    int32_t *v = malloc((size_t)count * sizeof *v);
    if (!z || !v)
        exit(99);
    memset(z, 0, (size_t)count * sizeof *z), memset(v, 0, (size_t)count * sizeof *v);
    *ours_ret = *opened_ret = *j2k_ret = INFINITY;
    for (int n = 0; n < RUNS; n++) {
        double start = terrain_cpu();
        tc_field *field = terrain_open(b->ours);
        double opened = terrain_cpu();
        terrain_read(field, z, NULL);
        double end = terrain_cpu();
        tc_field_destroy(field);
        *ours_ret = fmin(*ours_ret, end - opened), *opened_ret = fmin(*opened_ret, end - start);
        start = terrain_cpu();
        must_decode(b->j2k, (tc_rect){0, 0, b->grid.width, b->grid.height}, v);
        *j2k_ret = fmin(*j2k_ret, terrain_cpu() - start);
    }
    free(z), free(v);
}

/* Median milliseconds of SIDE x SIDE samples at random places. */
typedef struct region_times {
    double cold, opened, resident, j2k; /* opened: cold with opening; resident: the coarser level was read before */
} region_times;

static void must_read(const tc_field *field, int level, tc_rect rect, float *z)
{
    terrain_must(tc_field_read(field, level, rect, z, NULL, rect.x1 - rect.x0), &(tc_error){.text = "reading"});
}

static region_times read_regions(const both *b)
{
    static double cold[PLACES], opened[PLACES], resident[PLACES], j2k[J2K_PLACES];
    static float z[SIDE * SIDE];
    static int32_t v[SIDE * SIDE];
    test_random random = {7};
    for (int n = 0; n < PLACES; n++) {
        tc_rect rect = terrain_place(&random, b->grid.width, b->grid.height, SIDE);
        double start = terrain_cpu();
        tc_field *field = terrain_open(b->ours);
        int finest = tc_field_info(field)->levels;
        double begin = terrain_cpu();
        must_read(field, finest, rect, z);
        double end = terrain_cpu();
        cold[n] = 1e3 * (end - begin), opened[n] = 1e3 * (end - start);
        tc_field_destroy(field);

        field = terrain_open(b->ours);
        tc_level coarser = tc_field_level(field, finest - 1);
        static float around[SIDE * SIDE];
        must_read(field, finest - 1, terrain_coarser_place(rect, coarser), around);
        start = terrain_cpu();
        must_read(field, finest, rect, z);
        resident[n] = 1e3 * (terrain_cpu() - start);
        tc_field_destroy(field);
        if (n < J2K_PLACES) {
            start = terrain_cpu();
            must_decode(b->j2k, rect, v);
            j2k[n] = 1e3 * (terrain_cpu() - start);
        }
    }
    return (region_times){measure_of(cold, PLACES).median, measure_of(opened, PLACES).median,
                          measure_of(resident, PLACES).median, measure_of(j2k, J2K_PLACES).median};
}

static void decode_section(void)
{
    static const struct {
        const terrain_file *file;
        double rms;
    } rows[] = {{&tatra, 1}, {&tatra, 2}, {&tatra, 5.4}, {&canyon, 2}, {&moon, 0.5}, {&moon, 1}, {&puget, 5.4}};
    printf(
        "\nReading by one thread: the whole finest level in blocks of 1024 x 1024, best of %d (all levels decoded,\n"
        "opening not counted), against OpenJPEG's whole picture at equal rms; 255 x 255 samples at %d random places,\n"
        "median: cold (with opening in brackets), with the coarser level read before, and OpenJPEG's region\n",
        RUNS, PLACES);
    printf("%-38s %5s %7s %8s %8s %6s %16s %9s %9s %6s\n", "", "rms", "bits", "Ms/s", "OpenJPEG", "ratio", "cold ms",
           "resident", "OpenJPEG", "ratio");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        both b;
        double ours, opened, j2k;
        if (!both_make(rows[i].file, rows[i].rms, &b))
            continue;
        read_whole(&b, &ours, &opened, &j2k);
        region_times t = read_regions(&b);
        double m = 1e-6 * (double)(b.grid.width * b.grid.height);
        printf("%-38s %5.1f %7.4f %8.1f %8.1f %6.2f %7.3f (%6.3f) %9.3f %9.2f %6.1f\n", rows[i].file->set.name,
               rows[i].rms, b.bits, m / ours, m / j2k, j2k / ours, t.cold, t.opened, t.resident, t.j2k, t.j2k / t.cold);
        fflush(stdout);
        both_free(&b);
    }
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "", *data = getenv("TERRACLIP_DATA");
    if (!data || !*data) {
        printf("pack: skipped: TERRACLIP_DATA is not set\n");
        return 0;
    }
    if (!*what || strcmp(what, "rate") == 0)
        rate_section(argc > 2 ? argv[2] : "");
    if (!*what || strcmp(what, "bounds") == 0)
        bound_section();
    if (!*what || strcmp(what, "default") == 0)
        default_section();
    if (!*what || strcmp(what, "decode") == 0)
        decode_section();
    made_folder_remove();
    return 0;
}

/* bench_hillshades.c - synthesised levels looked at: hillshades of real terrains as they are, and with their two finest
 * levels dropped and made again from what is left: fitted to it, with one Gaussian a level (LH04), and by U alone.
 * hillshades.csv, and the pictures beside it, a pixel a sample of the finest level, north up.
 *
 * What is shown of a terrain is not chosen by eye: its finest level is cut into squares, and of those that have no more
 * voids than half of them it is the one whose slopes are steeper than those of three quarters. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/input/source.h"
#include "tests/support/datasets.h"
#include "tests/support/detail.h"
#include "tests/support/measure.h"

enum { SIDE = 336, DROPPED = 2 };
enum { TRUE, SYNTHESISED, GAUSSIAN, SMOOTH, PICTURES };

static const struct kind {
    const char *name;
    detail_kind made; /* but for the first */
} kinds[PICTURES] = {[TRUE] = {"true", DETAIL_NONE},
                     [SYNTHESISED] = {"synthesised", DETAIL_FITTED},
                     [GAUSSIAN] = {"gaussian", DETAIL_GAUSSIAN},
                     [SMOOTH] = {"smooth", DETAIL_NONE}};

static void die(const char *what, const char *why)
{
    fprintf(stderr, "hillshades: %s: %s\n", what, why);
    exit(1);
}

/* ---- Where ------------------------------------------------------------------------------------------------------- */

typedef struct square {
    tc_rect rect;
    int voids;
    double steep; /* mean square of slopes */
} square;

static int by_voids(const void *a, const void *b)
{
    int p = ((const square *)a)->voids, q = ((const square *)b)->voids;
    return (p > q) - (p < q);
}

static int by_steepness(const void *a, const void *b)
{
    double p = ((const square *)a)->steep, q = ((const square *)b)->steep;
    return (p > q) - (p < q);
}

/* A sample more on each side, for slopes. */
static tc_rect with_border(tc_rect r)
{
    return (tc_rect){r.x0 - 1, r.y0 - 1, r.x1 + 1, r.y1 + 1};
}

/* Slopes eastwards and northwards at sample (x, y) of a square with its border. */
static void slopes(const float *z, tc_level size, int x, int y, double *east_ret, double *north_ret)
{
    const float *p = z + (y + 1) * (SIDE + 2) + x + 1;
    *east_ret = ((double)p[1] - p[-1]) / (2 * size.spacing_x);
    *north_ret = ((double)p[SIDE + 2] - p[-(SIDE + 2)]) / (2 * size.spacing_y);
}

/* Heights with their border; how many samples are void, under which they are filled. */
static int read_square(const tc_field *field, int level, tc_rect rect, float *z)
{
    static uint8_t voids[(SIDE + 2) * (SIDE + 2)];
    if (tc_field_read(field, level, with_border(rect), z, voids, SIDE + 2))
        die("a terrain", "cannot be read");
    int count = 0;
    for (size_t i = 0; i < sizeof voids; i++)
        count += voids[i] != 0;
    return count;
}

static tc_rect choose(const tc_field *field, int level, const char *name)
{
    enum { MOST = 1024 };
    static square list[MOST];
    static float z[(SIDE + 2) * (SIDE + 2)];
    const tc_level size = tc_field_level(field, level);
    int count = 0;
    for (int64_t y = 1; y + SIDE + 1 <= size.height; y += SIDE)
        for (int64_t x = 1; x + SIDE + 1 <= size.width && count < MOST; x += SIDE) {
            square *s = &list[count++];
            *s = (square){.rect = {x, y, x + SIDE, y + SIDE}};
            s->voids = read_square(field, level, s->rect, z);
            for (int i = 0; i < SIDE * SIDE; i++) {
                double east, north;
                slopes(z, size, i % SIDE, i / SIDE, &east, &north);
                s->steep += (east * east + north * north) / (SIDE * SIDE);
            }
        }
    if (count == 0)
        die(name, "is too small");
    qsort(list, (size_t)count, sizeof *list, by_voids);
    int few = list[count / 2].voids;
    while (list[count - 1].voids > few)
        count--;
    qsort(list, (size_t)count, sizeof *list, by_steepness);
    return list[3 * (count - 1) / 4].rect;
}

/* ---- Pictures ---------------------------------------------------------------------------------------------------- */

/* Light from the north-west, 45 degrees high, on a white ground; nothing is exaggerated. */
static void shade(const float *z, tc_level size, uint8_t *rgb)
{
    const double toward[3] = {-0.5, 0.5, M_SQRT1_2};
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            double east, north;
            slopes(z, size, x, SIDE - 1 - y, &east, &north);
            double light = (toward[2] - east * toward[0] - north * toward[1]) / sqrt(1 + east * east + north * north);
            memset(rgb + 3 * (y * SIDE + x), (int)lrint(255 * fmax(light, 0)), 3);
        }
}

static void write_picture(const measure_options *o, const char *name, const uint8_t *rgb)
{
    const char *slash = strrchr(o->path, '/');
    char path[4096];
    tc_error error;
    snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash + 1 - o->path) : 0, o->path, name);
    if (tc_write_picture(path, SIDE, SIDE, rgb, &error))
        die(name, error.text);
}

static double rms_of(const float *a, const float *b)
{
    double sum = 0;
    for (int i = 0; i < (SIDE + 2) * (SIDE + 2); i++)
        sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
    return sqrt(sum / ((SIDE + 2) * (SIDE + 2)));
}

/* false: the terrain is not there. */
static bool show(const measure_options *o, const dataset *d, int number)
{
    static float z[PICTURES][(SIDE + 2) * (SIDE + 2)];
    static uint8_t rgb[3 * SIDE * SIDE];
    tc_grid grid;
    tc_field *real;
    tc_error error;
    if (!dataset_load(d, &grid))
        return false;
    if (tc_field_build(&grid, 0, &real, &error))
        die(d->name, error.text);
    int m = tc_field_info(real)->levels;
    const tc_level size = tc_field_level(real, m);
    const tc_rect rect = choose(real, m, d->name);
    for (int k = 0; k < PICTURES; k++) {
        tc_synthesis_fit fit;
        tc_field *made = k == TRUE ? NULL : detail_synthesise(real, DROPPED, kinds[k].made, &fit);
        read_square(made ? made : real, m, rect, z[k]);
        if (made)
            tc_field_destroy(made);
    }
    tc_field_destroy(real);
    printf("%s: %d x %d samples from (%lld, %lld); rms that the levels add:", d->name, SIDE, SIDE, (long long)rect.x0,
           (long long)rect.y0);
    if (o->csv)
        measure_put_text(o->csv, d->name), fprintf(o->csv, ",%.3g,%lld,%lld,%d", fmin(size.spacing_x, size.spacing_y),
                                                   (long long)rect.x0, (long long)rect.y0, SIDE);
    for (int k = 0; k < PICTURES; k++) {
        char name[64];
        double rms = rms_of(z[k], z[SMOOTH]);
        printf(" %s %.2f m", kinds[k].name, rms);
        snprintf(name, sizeof name, "hillshade-%d-%s.png", number, kinds[k].name);
        shade(z[k], size, rgb);
        if (o->csv)
            write_picture(o, name, rgb), fprintf(o->csv, ",%s,%.3f", name, rms);
    }
    puts("");
    if (o->csv)
        fputc('\n', o->csv);
    return true;
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"N37W119.hgt",
                                        "N37W120.hgt",
                                        "N46E008.tif",
                                        "ps_height_1k.png",
                                        "srtm3_canyonlands_voids_2401x3601.tif",
                                        "srtm3_tatra_poland_4801.tif"};
    measure_options o = measure_begin(argc, argv,
                                      "terrain,spacing_m,west,south,side,true,true_rms_m,synthesised,synthesised_rms_m,"
                                      "gaussian,gaussian_rms_m,smooth,smooth_rms_m");
    dataset list[DATASETS_MAX];
    int count = dataset_list(list, DATASETS_MAX), shown = 0;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        for (int n = 0; n < count; n++)
            if (strcmp(list[n].name, names[k]) == 0)
                shown += show(&o, &list[n], shown + 1);
    if (shown == 0)
        puts("skipped: TERRACLIP_DATA has none of the terrains");
    return measure_end(&o);
}

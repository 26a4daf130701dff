/* bench_atlas.c - what the samples of an atlas are worth: bench_atlas [--quick] [--csv FILE] [PLANET...]
 *
 * A planet in longitude and latitude, with its caps, and resampled to the faces of an octahedron and of a cube of as
 * many cells along the equator; levels of each against the source's own samples: root mean square by area and largest,
 * of what is drawn between samples of that level (bilinear, or triangles). Beside it the samples that the level has.
 * Without a planet ETOPO and the Moon (quick: ETOPO) of TERRACLIP_DATA. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/app/load.h"
#include "common/base/parallel.h"
#include "tests/support/measure.h"

enum { LEVELS = 4 };
static const tc_atlas *const atlases[] = {&tc_atlas_lonlat, &tc_atlas_hex, &tc_atlas_cube};

typedef struct comparison {
    const tc_map *source, *map;
    int coarser;
    int64_t step;
    double *square, *weight, *most; /* of rows */
} comparison;

/* What the map has there on a level, by the shares of its charts. */
static double height_at(const tc_map *map, int coarser, const double place[3])
{
    double normal[3], share[TC_MAP_CHARTS], z = 0;
    map->body.class->normal(&map->body, place, normal);
    tc_map_shares(map, normal, share);
    for (int k = 0; k < map->charts; k++) {
        const tc_chart *c = &map->chart[k];
        double x, y, part = 0;
        bool there;
        if (!(share[k] > 0))
            continue;
        c->class->from_place(c, place[0], place[1], &x, &y);
        if (c->class->height(c, tc_field_info(c->field)->levels - coarser, x, y, &there, &part))
            exit(1);
        z += share[k] * part;
    }
    return z;
}

static void compare_row(void *context, int64_t n)
{
    const comparison *c = context;
    const tc_chart *grid = &c->source->chart[0];
    int levels = tc_field_info(grid->field)->levels;
    int64_t row = n * c->step, width = tc_field_level(grid->field, levels).width;
    float *z = malloc((size_t)width * sizeof *z);
    uint8_t *voids = malloc((size_t)width);
    double y = grid->y0 + (double)row * grid->dy;
    if (!z || !voids || tc_field_read(grid->field, levels, (tc_rect){0, row, width, row + 1}, z, voids, width))
        exit(1);
    for (int64_t i = n % c->step; i < width; i += c->step) {
        const double place[3] = {grid->x0 + (double)i * grid->dx, fmin(fmax(y, -M_PI / 2), M_PI / 2), 0};
        double off = voids[i] ? 0 : fabs(height_at(c->map, c->coarser, place) - (double)z[i]), weight = cos(place[1]);
        c->square[n] += weight * off * off, c->weight[n] += weight, c->most[n] = fmax(c->most[n], off);
    }
    free(z), free(voids);
}

static void compare(const char *name, const tc_map *source, const tc_map *map, const char *atlas, int64_t step,
                    FILE *csv)
{
    int64_t rows = tc_field_level(source->chart[0].field, tc_field_info(source->chart[0].field)->levels).height;
    rows = (rows + step - 1) / step;
    for (int k = 0; k < LEVELS; k++) {
        double *sums = calloc(3 * (size_t)rows, sizeof *sums), square = 0, weight = 0, most = 0;
        comparison c = {source, map, k, step, sums, sums + rows, sums + 2 * rows};
        if (!sums)
            exit(1);
        tc_parallel_for(0, rows, compare_row, &c);
        for (int64_t n = 0; n < rows; n++)
            square += c.square[n], weight += c.weight[n], most = fmax(most, c.most[n]);
        free(sums);
        int64_t samples = 0, caps = 0;
        for (int chart = 0; chart < map->charts; chart++) {
            const tc_field *field = map->chart[chart].field;
            const tc_level size = tc_field_level(field, tc_field_info(field)->levels - k);
            *(chart > 0 && map->chart[0].wraps ? &caps : &samples) += size.width * size.height;
        }
        printf("%-34s %-7s m - %d %10lld + %8lld samples, rms %8.3f m, largest %8.1f m\n", name, atlas, k,
               (long long)samples, (long long)caps, sqrt(square / weight), most);
        if (csv) {
            measure_put_text(csv, name);
            fprintf(csv, ",%s,%d,%lld,%lld,%.5f,%.3f\n", atlas, k, (long long)samples, (long long)caps,
                    sqrt(square / weight), most);
        }
    }
}

static void look_at(const char *path, bool quick, FILE *csv)
{
    const tc_load_options how = {.body = &tc_sphere_body, .whole = true};
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    tc_error error;
    tc_map *source;
    if (tc_map_load(path, NULL, &how, &source, &error)) {
        fprintf(stderr, "bench_atlas: %s\n", error.text);
        exit(1);
    }
    for (int a = 0; a < 3; a++) {
        tc_map *map = source;
        if (atlases[a]->class->seam && tc_map_resample(source, atlases[a], 0, &map, &error)) {
            fprintf(stderr, "bench_atlas: %s\n", error.text);
            exit(1);
        }
        compare(name, source, map, atlases[a]->name, quick ? 8 : 3, csv);
        if (map != source)
            tc_map_destroy(map);
    }
    tc_map_destroy(source);
}

int main(int argc, char **argv)
{
    char *options_of[4];
    int count = 0, files = 0;
    for (int i = 0; i < argc && count < 4; i++) /* options first, then files */
        if (i == 0 || argv[i][0] == '-' || (i > 1 && strcmp(argv[i - 1], "--csv") == 0))
            options_of[count++] = argv[i];
    measure_options options =
        measure_begin(count, options_of, "planet,atlas,coarser,samples,cap_samples,rms_m,max_error_m");
    for (int i = 1; i < argc; i++)
        if (argv[i][0] != '-' && strcmp(argv[i - 1], "--csv") != 0)
            look_at(argv[i], options.quick, options.csv), files++;
    for (int i = 0; files == 0 && i < (options.quick ? 1 : 2); i++) {
        static const char *const kept[] = {"earth_etopo20_1080x540_f32.tif", "moon_gld100_global_5760x2880.tif"};
        const char *folder = getenv("TERRACLIP_DATA");
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder ? folder : "", kept[i]);
        if (folder && *folder && access(path, R_OK) == 0)
            look_at(path, options.quick, options.csv);
        else
            printf("%s: skipped: not in TERRACLIP_DATA\n", kept[i]);
    }
    return measure_end(&options);
}

/* bench_codec.c - rate, error and speed of the codec, against JPEG 2000.
 *
 * Terrains are cropped and measured as in the project's codec study, from which the JPEG 2000 column comes: OpenJPEG
 * 2.5, 9/7, one tile, heights scaled by 16 first, at the same rms. (Its canyon2k had voids filled with the nearest
 * height, ours are filled smoothly: not quite the same input.) Bytes are all that a file would need for its
 * streams (tests/support/packed.h). Speeds are of one thread: training and encoding (without the transform), decoding
 * of the finest level and of all levels, without AVX2, of the finest level's tiles alone; then times of 255 x 255
 * samples with the coarser level at hand, and cold, through all levels. Arguments: none for the tables, or a dataset's
 * name ("more" for those without JPEG 2000 figures), an rms, and q / rms where it is known; or "models", which trains
 * the built-in models and prints the tables of detail_builtin.c. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "tests/support/datasets.h"
#include "tests/support/packed.h"
#include "tests/support/terrain_files.h"

typedef struct crop {
    const char *name;
    dataset set;
    int64_t x0, y0, size; /* in the file's rows, north to south */
    double rms[4], j2k[4];
} crop;

static const crop crops[] = {
    {"tatra2k", {"srtm3_tatra_poland_4801.tif", 0, 0}, 800, 2753, 2048, {1, 2, 5.4, 9}, {1.671, 0.806, 0.1943, 0.0832}},
    {"canyon2k", {"srtm3_canyonlands_voids_2401x3601.tif", 0, 0}, 352, 1344, 2048, {1, 2, 5.4}, {2.156, 1.151, 0.3456}},
    {"moon2k",
     {"moon_gld100_256ppd_ne_4097.png", 0, 0},
     1000,
     1000,
     2048,
     {0.5, 1, 2, 7},
     {0.755, 0.2879, 0.1410, 0.0416}},
    {"ps1k", {"ps_height_1k.png", 160, 0.1}, 0, 0, 1025, {1, 9.6, 16}, {3.942, 0.849, 0.376}},
    /* Nothing was trained on these. */
    {"beskid2k", {"srtm3_tatra_poland_4801.tif", 0, 0}, 2700, 300, 2048, {1, 5.4}, {0}},
    {"alps1k", {"N46E008.tif", 0, 0}, 0, 0, 1201, {1, 5.4}, {0}},
    {"sierra1k", {"N37W120.hgt", 0, 0}, 0, 0, 1201, {1, 5.4}, {0}},
    {"moonb2k", {"moon_gld100_256ppd_ne_8193.tif", 0, 0}, 5000, 5000, 2048, {0.5, 1, 2}, {0}},
    {"moong2k", {"moon_gld100_global_5760x2880.tif", 0, 0}, 2000, 500, 2048, {20, 100}, {0}},
    {"etopo1k", {"earth_etopo20_1080x540_f32.tif", 0, 0}, 0, 0, 1080, {50, 200}, {0}},
};

enum { STEPS = 64 }; /* units to a step of norm 1 */

typedef struct result {
    packed p;
    double rms, max, bits;
} result;

static result pack(const float *z, int64_t w, int64_t h, double q)
{
    result r = {0};
    double unit = q / STEPS, sum = 0;
    int32_t *v = calloc((size_t)(w * h), sizeof *v);
    for (int64_t i = 0; i < w * h; i++)
        v[i] = (int32_t)lrint(z[i] / unit);
    r.p = packed_new(v, w, h, &(packed_options){.q = STEPS, .threads = 1});
    for (int64_t i = 0; i < w * h; i++) {
        double e = r.p.level[0].fine.z[i] * unit - z[i];
        sum += e * e, r.max = fmax(r.max, fabs(e));
    }
    r.rms = sqrt(sum / (double)(w * h)), r.bits = 8.0 * (double)packed_bytes(&r.p) / (double)(w * h);
    free(v);
    return r;
}

static double time_read(const packed_level *l, tc_rect rect, tc_simd simd, int runs)
{
    tc_plane out = packed_plane(rect);
    void *scratch = malloc(tc_codec_read_scratch(l->codec, rect));
    double best = 1e9;
    for (int n = 0; n < runs; n++) {
        double start = terrain_cpu();
        tc_codec_read(l->codec, &l->coarse, packed_source, (void *)l, &out, scratch, NULL, simd);
        best = fmin(best, terrain_cpu() - start);
    }
    free(out.z), free(scratch);
    return best;
}

/* Every tile of a level into planes of its own. */
static double time_tiles(const packed_level *l, int runs)
{
    const tc_codec *c = l->codec;
    tc_tile_work *work = malloc(tc_tile_work_bytes());
    static int32_t z[TC_BANDS][TC_TILE * TC_TILE];
    double best = 1e9;
    for (int n = 0; n < runs; n++) {
        double start = terrain_cpu();
        for (int64_t ty = 0; ty < c->tiles_y; ty++)
            for (int64_t tx = 0; tx < c->tiles_x; tx++) {
                tc_rect r = tc_codec_tile_rect(c, tx, ty, 0);
                tc_plane band[TC_BANDS] = {{z[0], TC_TILE, r}, {z[1], TC_TILE, r}, {z[2], TC_TILE, r}};
                int64_t k = ty * c->tiles_x + tx;
                tc_codec_decode_tile(c, tx, ty, 0, l->tile[k], l->tile_size[k], &l->coarse, band, work, TC_SIMD_AUTO);
            }
        best = fmin(best, terrain_cpu() - start);
    }
    free(work);
    return best;
}

/* rect of level n from nothing but the coarsest level. */
static double time_cold(const packed *p, tc_rect rect, int runs)
{
    tc_plane plane[PACKED_LEVELS + 1];
    size_t scratch_size = 0;
    for (int n = 0; n < p->levels; n++) {
        plane[n] = packed_plane(rect);
        size_t size = tc_codec_read_scratch(p->level[n].codec, rect);
        scratch_size = size > scratch_size ? size : scratch_size;
        rect = tc_codec_read_needs(p->level[n].codec, rect);
    }
    plane[p->levels] = p->level[p->levels - 1].coarse;
    void *scratch = malloc(scratch_size + 1);
    double best = 1e9;
    for (int k = 0; k < runs; k++) {
        double start = terrain_cpu();
        for (int n = p->levels - 1; n >= 0; n--)
            tc_codec_read(p->level[n].codec, &plane[n + 1], packed_source, (void *)&p->level[n], &plane[n], scratch,
                          NULL, TC_SIMD_AUTO);
        best = fmin(best, terrain_cpu() - start);
    }
    for (int n = 0; n < p->levels; n++)
        free(plane[n].z);
    free(scratch);
    return best;
}

static void measure(const crop *c, const float *z, int64_t w, int64_t h, double rms, double j2k, double ratio)
{
    double q = (ratio > 0 ? ratio : 3.2) * rms, lo = 0, lo_rms = 0;
    result r = pack(z, w, h, q);
    for (int n = 0; n < 8 && fabs(r.rms / rms - 1) > 0.0005 && ratio == 0; n++) {
        double slope = lo > 0 && fabs(q - lo) > 1e-9 ? log(r.rms / lo_rms) / log(q / lo) : 0.8;
        slope = fmin(fmax(slope, 0.3), 1.2);
        lo = q, lo_rms = r.rms;
        q *= exp(log(rms / r.rms) / slope);
        packed_free(&r.p);
        r = pack(z, w, h, q);
    }
    const packed_level *f = &r.p.level[0];
    double finest = time_read(f, f->fine.rect, TC_SIMD_AUTO, 7), plain = time_read(f, f->fine.rect, TC_SIMD_NONE, 3);
    double all = finest, tiles = time_tiles(f, 7);
    for (int n = 1; n < r.p.levels; n++)
        all += time_read(&r.p.level[n], r.p.level[n].fine.rect, TC_SIMD_AUTO, 5);
    tc_rect roi = {w / 3, h / 3, w / 3 + 255, h / 3 + 255};
    double near = time_read(f, roi, TC_SIMD_AUTO, 31), cold = time_cold(&r.p, roi, 31);
    double m = 1e-6 * (double)(w * h);
    printf("codec: %-8s rms %7.3f max %7.2f m %7.4f bits", c->name, r.rms, r.max, r.bits);
    if (j2k > 0)
        printf(" J2K %+6.1f %%", 100 * (r.bits / j2k - 1));
    printf("  train %5.3f s encode %5.1f both %5.1f  decode %5.1f all %5.1f plain %5.1f tiles %5.1f Ms/s  255^2 %5.3f "
           "cold %5.3f ms  q/rms %.3f",
           r.p.train_s, m / r.p.encode_s, m / (r.p.encode_s + r.p.train_s), m / finest, m / all, m / plain, m / tiles,
           1e3 * near, 1e3 * cold, q / rms);
    for (int n = 0; n < 4 && n < r.p.levels; n++)
        printf(" %02x:%zu", r.p.level[n].header[0], r.p.level[n].header_size);
    printf("\n");
    fflush(stdout);
    packed_free(&r.p);
}

/* ---- Built-in models ----------------------------------------------------------------------------------------- */

/* What each set learns from. Terrains of one set have the same size, so that their tiles can stand in one level. */
static const struct lesson {
    int set, depth;
    const char *name;
    double rms, ratio;
} lessons[] = {
    {0, 0, "tatra2k", 1, 3.57},   {0, 0, "tatra2k", 2, 4.2},    {0, 0, "canyon2k", 1, 3.41},
    {0, 0, "canyon2k", 5.4, 6.2}, {1, 0, "moon2k", 0.5, 3.75},  {1, 0, "moon2k", 0.25, 3.5},
    {1, 0, "moon2k", 1, 6.87},    {2, 3, "tatra2k", 1, 3.57},   {2, 3, "tatra2k", 5.4, 7.6},
    {2, 3, "canyon2k", 2, 4},     {2, 3, "canyon2k", 5.4, 6.2}, {2, 3, "moon2k", 0.5, 3.75},
    {2, 3, "moon2k", 2, 10},      {2, 3, "moon2k", 7, 18.4},
};
enum { LESSON_TILES = 32, MOST_TILES = 512 };

static tc_plane copy(const tc_plane *from, tc_rect rect)
{
    tc_plane to = packed_plane(rect);
    for (int64_t y = rect.y0; y < rect.y1; y++)
        memcpy(tc_plane_at(&to, rect.x0, y), tc_plane_at(from, rect.x0, y), (size_t)to.stride * sizeof *to.z);
    return to;
}

/* Appends tiles of a lesson; returns how many there are then. */
static int learn(const struct lesson *l, tc_lifting_level *level, tc_training_tile *tiles, int count)
{
    const crop *c = crops;
    while (strcmp(c->name, l->name) != 0)
        c++;
    int64_t w, h;
    float *z = dataset_crop(&c->set, c->x0, c->y0, c->size, &w, &h);
    if (!z)
        exit(1);
    double q = l->rms * l->ratio;
    result r = pack(z, w, h, q);
    tc_plane fine = packed_plane((tc_rect){0, 0, w, h});
    for (int64_t i = 0; i < w * h; i++)
        fine.z[i] = (int32_t)lrint(z[i] / (q / STEPS));
    for (int n = 0; n <= l->depth; n++) {
        *level = r.p.level[n].codec->level;
        tc_rect half = {0, 0, tc_coarse_size(level->width), tc_coarse_size(level->height)};
        tc_plane low = packed_plane(half), band[TC_BANDS];
        for (int b = 0; b < TC_BANDS; b++)
            band[b] = packed_plane(half);
        int32_t *scratch = malloc(tc_lifting_analyse_scratch(level, half.y1) * sizeof *scratch);
        tc_lifting_analyse(level, &fine, 0, half.y1, &low, band, scratch);
        int more = n == l->depth ? tc_codec_sample(level, LESSON_TILES, tiles + count) : 0;
        for (tc_training_tile *t = tiles + count; t < tiles + count + more; t++) {
            t->coarse = copy(&r.p.level[n].coarse, t->coarse.rect);
            for (int b = 0; b < TC_BANDS; b++)
                t->band[b] = copy(&band[b], t->band[b].rect);
        }
        count += more;
        for (int b = 0; b < TC_BANDS; b++)
            free(band[b].z);
        free(scratch), free(fine.z);
        fine = low;
    }
    free(fine.z), free(z);
    packed_free(&r.p);
    return count;
}

static void print_models(void)
{
    static tc_training_tile tiles[MOST_TILES];
    static tc_detail_model model[TC_BUILTIN_MODELS];
    for (int set = 0; set < TC_BUILTIN_MODELS; set++) {
        int count = 0, depth = 0;
        tc_lifting_level level = {0};
        for (size_t i = 0; i < sizeof lessons / sizeof *lessons; i++)
            if (lessons[i].set == set)
                count = learn(&lessons[i], &level, tiles, count), depth = lessons[i].depth;
        tc_detail_model_builtin(set, &model[set]);
        for (int b = 0; b < TC_BANDS; b++)
            model[set].step[b] = (int32_t)rint(STEPS / tc_lifting_norm(b, depth));
        for (int n = 0; n < 4; n++)
            if (tc_codec_train(&level, tiles, count, 0, &model[set]))
                exit(1);
    }
    printf("static const int16_t predict[TC_BUILTIN_MODELS][2][TC_PREDICT] = {\n");
    for (int set = 0; set < TC_BUILTIN_MODELS; set++)
        for (int b = 0; b < 2; b++) {
            printf("%s{", b ? "" : "{");
            for (int k = 0; k < TC_PREDICT; k++)
                printf("%d,", model[set].predict[b][k]);
            printf("},%s", b ? "},\n" : "\n");
        }
    printf("};\nstatic const uint16_t scale[TC_BUILTIN_MODELS][TC_BANDS][TC_PHASES][TC_SCALE] = {\n");
    for (int set = 0; set < TC_BUILTIN_MODELS; set++)
        for (int b = 0; b < TC_BANDS; b++)
            for (int p = 0; p < TC_PHASES; p++) {
                printf("%s%s{", b || p ? "" : "{", p ? "" : "{");
                for (int k = 0; k < TC_SCALE; k++)
                    printf("%d,", model[set].scale[b][p][k]);
                printf("},%s%s", p ? "}," : "\n", p && b == TC_BANDS - 1 ? "},\n" : "");
            }
    printf("};\nstatic const uint16_t symbols[TC_BUILTIN_MODELS][TC_BINS][TC_RANS_SYMBOLS] = {\n");
    for (int set = 0; set < TC_BUILTIN_MODELS; set++)
        for (int b = 0; b < TC_BINS; b++) {
            printf("%s{", b ? "" : "{");
            for (int s = 0; s < TC_RANS_SYMBOLS; s++)
                printf("%d,", model[set].symbols[b].of[s]);
            printf("},%s", b == TC_BINS - 1 ? "},\n" : "\n");
        }
    printf("};\n");
}

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "models") == 0) {
        print_models();
        return 0;
    }
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        const crop *c = &crops[i];
        int64_t w, h;
        float *z;
        bool anchored = c->j2k[0] > 0;
        if (*name && strcmp(name, c->name) != 0 && !(strcmp(name, "more") == 0 && !anchored) &&
            strcmp(name, "all") != 0)
            continue;
        if ((!*name && !anchored) || !(z = dataset_crop(&c->set, c->x0, c->y0, c->size, &w, &h)))
            continue;
        for (int n = 0; n < 4 && c->rms[n] > 0; n++)
            if (argc < 3 || fabs(atof(argv[2]) - c->rms[n]) < 1e-6)
                measure(c, z, w, h, c->rms[n], c->j2k[n], argc > 3 ? atof(argv[3]) : 0);
        free(z);
    }
    return 0;
}

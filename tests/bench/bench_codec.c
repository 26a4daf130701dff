/* bench_codec.c - rate, error and speed of the codec, against JPEG 2000.
 *
 * Terrains are cropped and measured as in the project's codec study, from which the JPEG 2000 column comes: OpenJPEG
 * 2.5, 9/7, one tile, heights scaled by 16 first, at the same rms. (Its canyon2k had voids filled with the nearest
 * height, ours are filled smoothly: not quite the same input.) Bytes are all that a file would need for its
 * streams (tests/support/packed.h). Arguments: none for the tables, or a dataset's name and an rms for one row. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "common/core/base/rect.h"
#include "tests/support/datasets.h"
#include "tests/support/packed.h"

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
};

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static float *load(const crop *c, int64_t *width_ret, int64_t *height_ret)
{
    tc_grid g;
    if (!dataset_load(&c->set, &g))
        return NULL;
    int64_t w = tc_min64(c->size, g.width), h = tc_min64(c->size, g.height), y0 = tc_max64(g.height - c->y0 - h, 0);
    float *z = malloc((size_t)(w * h) * sizeof *z);
    for (int64_t y = 0; y < h; y++)
        memcpy(z + y * w, g.z + (y0 + y) * g.width + c->x0, (size_t)w * sizeof *z);
    tc_grid_free(&g);
    *width_ret = w, *height_ret = h;
    return z;
}

enum { STEPS = 64 }; /* units to a step of norm 1 */

typedef struct result {
    packed p;
    double rms, max, bits, encode_s;
} result;

static result pack(const float *z, int64_t w, int64_t h, double q)
{
    result r = {0};
    double unit = q / STEPS, sum = 0;
    int32_t *v = malloc((size_t)(w * h) * sizeof *v);
    for (int64_t i = 0; i < w * h; i++)
        v[i] = (int32_t)lrint(z[i] / unit);
    double start = now();
    r.p = packed_new(v, w, h, &(packed_options){.q = STEPS, .threads = 1});
    r.encode_s = now() - start;
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
        double start = now();
        tc_codec_read(l->codec, &l->coarse, packed_source, (void *)l, &out, scratch, NULL, simd);
        best = fmin(best, now() - start);
    }
    free(out.z), free(scratch);
    return best;
}

static void measure(const crop *c, const float *z, int64_t w, int64_t h, double rms, double j2k)
{
    double q = 3.2 * rms, lo = 0, lo_rms = 0;
    result r = pack(z, w, h, q);
    for (int n = 0; n < 6 && fabs(r.rms / rms - 1) > 0.002; n++) {
        double slope = lo > 0 && fabs(q - lo) > 1e-9 ? log(r.rms / lo_rms) / log(q / lo) : 0.8;
        slope = fmin(fmax(slope, 0.3), 1.2);
        lo = q, lo_rms = r.rms;
        q *= exp(log(rms / r.rms) / slope);
        packed_free(&r.p);
        r = pack(z, w, h, q);
    }
    const packed_level *f = &r.p.level[0];
    double finest = time_read(f, f->fine.rect, TC_SIMD_AUTO, 3), plain = time_read(f, f->fine.rect, TC_SIMD_NONE, 2);
    double all = finest;
    for (int n = 1; n < r.p.levels; n++)
        all += time_read(&r.p.level[n], r.p.level[n].fine.rect, TC_SIMD_AUTO, 3);
    double roi = time_read(f, (tc_rect){w / 3, h / 3, w / 3 + 255, h / 3 + 255}, TC_SIMD_AUTO, 21);
    double m = 1e-6 * (double)(w * h);
    printf("codec: %-9s rms %6.3f m max %7.2f m  %7.4f bits  J2K %7.4f  %+6.1f %%  encode %5.1f decode %6.1f all %6.1f "
           "plain %6.1f Ms/s  255^2 %6.3f ms  q/rms %.2f parts",
           c->name, r.rms, r.max, r.bits, j2k, j2k > 0 ? 100 * (r.bits / j2k - 1) : 0, m / r.encode_s, m / finest,
           m / all, m / plain, 1e3 * roi, q / rms);
    for (int n = 0; n < 4 && n < r.p.levels; n++)
        printf(" %02x:%zu", r.p.level[n].header[0], r.p.level[n].header_size);
    printf("\n");
    fflush(stdout);
    packed_free(&r.p);
}

int main(int argc, char **argv)
{
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        const crop *c = &crops[i];
        int64_t w, h;
        float *z;
        if ((argc > 1 && strcmp(argv[1], c->name) != 0) || !(z = load(c, &w, &h)))
            continue;
        for (int n = 0; n < 4 && c->rms[n] > 0; n++)
            if (argc < 3 || fabs(atof(argv[2]) - c->rms[n]) < 1e-6)
                measure(c, z, w, h, c->rms[n], c->j2k[n]);
        free(z);
    }
    return 0;
}

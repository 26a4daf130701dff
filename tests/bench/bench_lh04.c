/* bench_lh04.c - the paper's pyramid of residuals side by side with the lifting codec: bytes at equal rms.
 *
 * Terrains and byte counts as in bench_codec.c. Both codecs are driven to the same rms of the finest level, to 0.2 %
 * of it; columns: the lifting codec, LH04 with one step for all levels (the paper), LH04 with steps that
 * fall by 0.8 from each level to the next coarser one (better than the paper at low rates). Arguments: none for the
 * table, or a terrain's name and an rms for one row; a third one is the second LH04's factor, 0 for none. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "tests/support/datasets.h"
#include "tests/support/lh04_packed.h"
#include "tests/support/terrain_files.h"

typedef struct crop {
    const char *name;
    dataset set;
    int64_t x0, y0, size; /* in the file's rows, north to south */
    double rms[6];
} crop;

static const crop crops[] = {
    {"tatra2k", {"srtm3_tatra_poland_4801.tif", 0, 0}, 800, 2753, 2048, {1, 2, 4.5, 5.4, 9}},
    {"canyon2k", {"srtm3_canyonlands_voids_2401x3601.tif", 0, 0}, 352, 1344, 2048, {1, 2, 5.4, 6.5}},
    {"moon2k", {"moon_gld100_256ppd_ne_4097.png", 0, 0}, 1000, 1000, 2048, {0.5, 1, 2, 7}},
    {"ps1k", {"ps_height_1k.png", 160, 0.1}, 0, 0, 1025, {1, 9.6, 16, 20}},
};

enum { STEPS = 64 }; /* units to a step */

typedef struct result {
    double q, rms, max, bits, encode_s, decode_s;
} result;

/* finer: of LH04; 0: the lifting codec. */
static result pack(const float *z, int64_t w, int64_t h, double q, double finer)
{
    result r = {.q = q};
    double unit = q / STEPS, sum = 0, start;
    int32_t *v = malloc((size_t)(w * h) * sizeof *v);
    for (int64_t i = 0; i < w * h; i++)
        v[i] = (int32_t)lrint(z[i] / unit);
    start = terrain_cpu();
    packed p = finer > 0 ? lh04_new(v, w, h, &(lh04_options){.q = STEPS, .finer = finer})
                         : packed_new(v, w, h, &(packed_options){.q = STEPS, .threads = 1});
    r.encode_s = terrain_cpu() - start;
    const tc_plane *fine = &p.level[0].fine;
    for (int64_t i = 0; i < w * h; i++) {
        double e = fine->z[i] * unit - z[i];
        sum += e * e, r.max = fmax(r.max, fabs(e));
    }
    r.rms = sqrt(sum / (double)(w * h));
    r.bits = 8.0 * (double)packed_bytes(&p) / (double)(w * h);
    r.decode_s = 1e9;
    for (int n = 0; n < 3; n++) {
        tc_plane out = packed_plane(fine->rect);
        start = terrain_cpu();
        if (finer > 0)
            lh04_read(&p.level[0], &out, TC_SIMD_AUTO);
        else
            packed_read(&p.level[0], &out, NULL, TC_SIMD_AUTO);
        r.decode_s = fmin(r.decode_s, terrain_cpu() - start);
        free(out.z);
    }
    packed_free(&p);
    free(v);
    return r;
}

/* Drives the step to the rms; what remains is interpolated between the nearest results below and above, or
 * extrapolated by the least that theory has a rate fall where there is but one. */
static result drive(const float *z, int64_t w, int64_t h, double rms, double finer)
{
    result r = pack(z, w, h, 3.2 * rms, finer), below = {0}, above = {0};
    for (int n = 0;; n++) {
        if (r.rms <= rms && (below.q == 0 || r.rms > below.rms))
            below = r;
        if (r.rms >= rms && (above.q == 0 || r.rms < above.rms))
            above = r;
        if (n == 6 || fabs(r.rms / rms - 1) <= 0.002)
            break;
        double q = r.q * pow(rms / r.rms, 1.2);
        if (below.q > 0 && above.q > 0 && above.rms > below.rms)
            q = below.q * pow(above.q / below.q, log(rms / below.rms) / log(above.rms / below.rms));
        r = pack(z, w, h, q, finer);
    }
    if (below.q > 0 && above.q > 0 && above.rms > below.rms)
        r.bits = below.bits * pow(above.bits / below.bits, log(rms / below.rms) / log(above.rms / below.rms));
    else
        r.bits *= r.rms / rms;
    return r;
}

static void row(const char *name, const char *codec, const result *r, double samples, double against)
{
    printf(
        "lh04: %-9s %-13s rms %7.3f max %7.2f m  %7.4f bits  %+6.1f %%  encode %5.1f decode %6.1f Ms/s  q/rms %.2f\n",
        name, codec, r->rms, r->max, r->bits, 100 * (against / r->bits - 1), 1e-6 * samples / r->encode_s,
        1e-6 * samples / r->decode_s, r->q / r->rms);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    double finer = argc > 3 ? atof(argv[3]) : 0.8;
    puts("lh04: percentages: bytes of the lifting codec against those of the row");
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        const crop *c = &crops[i];
        int64_t w, h;
        float *z;
        if ((argc > 1 && strcmp(argv[1], c->name) != 0) || !(z = dataset_crop(&c->set, c->x0, c->y0, c->size, &w, &h)))
            continue;
        for (int n = 0; n < 6 && c->rms[n] > 0; n++) {
            if (argc > 2 && fabs(atof(argv[2]) - c->rms[n]) > 1e-6)
                continue;
            result lifting = drive(z, w, h, c->rms[n], 0), paper = drive(z, w, h, c->rms[n], 1);
            row(c->name, "lifting", &lifting, (double)(w * h), lifting.bits);
            row(c->name, "LH04", &paper, (double)(w * h), lifting.bits);
            if (finer > 0) {
                result better = drive(z, w, h, c->rms[n], finer);
                row(c->name, "LH04 finer", &better, (double)(w * h), lifting.bits);
            }
        }
        free(z);
    }
    return 0;
}

/* packing.c - terrains for the tests of packed files. */
#include "packing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/field/fill.h"
#include "terrains.h"

static void *get(size_t bytes)
{
    void *p = malloc(bytes + 1);
    if (!p)
        puts("packing: no memory"), exit(99);
    return p;
}

static double unit_of(const packing *p)
{
    return p->unit > 0 ? p->unit : 1;
}

static double height(const packing *p, test_random *r, int64_t x, int64_t y)
{
    double turn = 2 * M_PI * (double)x / (double)p->width, along = 0.05 * (double)x, across = 0.31 * (double)x;
    if (p->wraps)
        along = 7 * turn, across = 45 * turn;
    double hills = 300 * sin(along) * cos(0.04 * (double)y) + 40 * sin(across + 0.62 * (double)y);
    double noise = test_random_range(r, -4, 4);
    switch (p->kind) {
    case PACKING_INTEGERS: return unit_of(p) * rint(hills + noise);
    case PACKING_CONSTANT: return 1234.5;
    case PACKING_SLOPE: return 0.5 * (double)x - 0.25 * (double)y;
    case PACKING_NEEDLE: return x == p->width / 2 && y == p->height / 3 ? 5000 : 10;
    case PACKING_WALLS: return (x / 5 + y / 3) % 2 ? 1e6 : -1e6;
    case PACKING_NOISE: return 50 * noise;
    case PACKING_SPIKES: return hills + noise + (test_random_unit(r) < 1. / 300 ? test_random_range(r, -120, 120) : 0);
    case PACKING_DUST: return 1e-3 * rint(hills) / 300;
    default: return hills + noise;
    }
}

static bool is_void(const packing *p, int64_t x, int64_t y)
{
    bool lake =
        hypot((double)(x - p->width / 3), (double)(y - p->height / 2)) < 0.2 * (double)p->height ||
        (p->wraps && hypot((double)tc_min64(x, p->width - x), (double)(y - p->height / 2)) < 0.1 * (double)p->height);
    switch (p->voids) {
    case PACKING_LAKES: return lake || (x + 7 * y) % 53 == 5 || x == p->width - 2;
    case PACKING_LAKE: return lake;
    case PACKING_ONE_LEFT: return x != p->width / 2 || y != p->height / 2;
    case PACKING_ALL_VOID: return true;
    default: return false;
    }
}

float *packing_heights(const packing *p, uint8_t **voids_ret)
{
    float *z = get((size_t)(p->width * p->height) * sizeof *z);
    uint8_t *v = *voids_ret = get((size_t)(p->width * p->height));
    test_random r = {(uint64_t)(p->width * 1000 + p->height)};
    for (int64_t y = 0; y < p->height; y++)
        for (int64_t x = 0; x < p->width; x++) {
            z[y * p->width + x] = (float)(height(p, &r, x, y) + (p->based ? 0 : p->offset));
            v[y * p->width + x] = is_void(p, x, y);
        }
    return z;
}

tc_pack_terrain packing_terrain(const packing *p)
{
    return (tc_pack_terrain){.width = p->width,
                             .height = p->height,
                             .wraps_x = p->wraps,
                             .spacing_x = 10,
                             .spacing_y = 12,
                             .z_base = p->based ? p->offset : 0,
                             .georef = {.known = true, .transform = {5, 10, 0, 7, 0, -12}, .crs_wkt = (char *)"LOCAL"},
                             .sample_type = p->type,
                             .unit = unit_of(p),
                             .offset = p->offset,
                             .has_nodata = true,
                             .nodata = -9999};
}

tc_pack_options packing_options(const packing *p)
{
    return (tc_pack_options){.mode = p->mode,
                             .codec = p->codec,
                             .error = p->error,
                             .max_error = p->max_error,
                             .max_error_may_yield = p->max_error_may_yield,
                             .price_lossless = p->price_lossless,
                             .synthesis_fit = p->synthesis_fit,
                             .threads = p->threads};
}

tc_status packing_write(const packing *p, const char *path, tc_pack_result *result_ret, tc_error *error)
{
    uint8_t *voids;
    float *z = packing_heights(p, &voids);
    tc_pack_terrain terrain = packing_terrain(p);
    tc_pack_options options = packing_options(p);
    tc_packer *packer = NULL;
    tc_status status = tc_packer_create(path, &terrain, &options, &packer, error);
    if (!status)
        status = tc_packer_put(packer, (tc_rect){0, 0, p->width, p->height}, z, voids, p->width, error);
    if (!status)
        status = tc_packer_finish(packer, result_ret, error);
    tc_packer_destroy(packer);
    free(z), free(voids);
    return status;
}

void packing_fill(float *z, uint8_t *voids, int64_t width, int64_t height, bool wraps)
{
    /* Around a globe, rows that go on from the other side. */
    int64_t beyond = wraps ? tc_min64(width / 2, 512) / 64 * 64 : 0, w = width + 2 * beyond;
    float *y = get((size_t)(w * height) * sizeof *y);
    uint8_t *v = get((size_t)(w * height));
    for (int64_t i = 0; i < w * height; i++) {
        int64_t from = i / w * width + (i % w + width - beyond) % width;
        y[i] = z[from], v[i] = voids[from];
    }
    if (tc_fill_voids(y, v, w, height))
        puts("packing: no filling"), exit(99);
    for (int64_t i = 0; i < width * height; i++)
        z[i] = y[i / width * w + beyond + i % width];
    free(y), free(v);
}

tc_field *packing_truth(const packing *p)
{
    tc_grid g = {.width = p->width, .height = p->height, .spacing_x = 10, .spacing_y = 12, .wraps_x = p->wraps};
    g.z = packing_heights(p, &g.voids);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t i = 0; i < g.width * g.height; i++) {
        g.void_count += g.voids[i];
        if (!g.voids[i])
            g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    if (g.void_count == 0)
        free(g.voids), g.voids = NULL;
    tc_field *field;
    if (g.void_count)
        packing_fill(g.z, g.voids, g.width, g.height, p->wraps);
    if (tc_field_build(&g, 1, &field, NULL))
        puts("packing: no truth"), exit(99);
    return field;
}

float *packing_read(const tc_field *field, int level, uint8_t **voids_ret)
{
    tc_level size = tc_field_level(field, level);
    size_t samples = (size_t)(size.width * size.height);
    float *z = get(samples * sizeof *z);
    uint8_t *voids = get(samples);
    tc_rect all = {0, 0, size.width, size.height};
    if (tc_field_read(field, level, all, z, voids, size.width)) {
        free(z), free(voids);
        z = NULL, voids = NULL;
    }
    if (voids_ret)
        *voids_ret = voids;
    else
        free(voids);
    return z;
}

void packing_error(const float *z, const float *truth, const uint8_t *voids, int64_t count, double *rms_ret,
                   double *most_ret)
{
    double sum = 0;
    int64_t valid = 0;
    *most_ret = 0;
    for (int64_t i = 0; i < count; i++)
        if (!voids[i]) {
            double e = fabs((double)z[i] - truth[i]);
            e = isnan(e) ? INFINITY : e; /* which fmax() would leave out */
            sum += e * e, *most_ret = fmax(*most_ret, e), valid++;
        }
    *rms_ret = valid ? sqrt(sum / (double)valid) : 0;
}

uint8_t *packing_bytes(const char *path, size_t *size_ret)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    *size_ret = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = get(*size_ret);
    if (fread(bytes, 1, *size_ret, file) != *size_ret)
        puts("packing: cannot be read"), exit(99);
    fclose(file);
    return bytes;
}

/* stub.c - NOT COMMITTED: a fake packer, to try the tool with. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "common/core/base/status.h"
#include "common/core/pyramid/fill.h"
#include "common/core/pyramid/pyramid.h"

static const char magic[8] = {(char)0x89, 'T', 'C', 'L', 'I', 'P', '\r', '\n'};

struct tc_packer {
    tc_pack_terrain terrain;
    tc_pack_options options;
    float *z;
    uint8_t *voids, *given;
    int64_t disagreeing;
    double largest;
    char path[];
};

tc_status tc_packer_create(const char *path, const tc_pack_terrain *terrain, const tc_pack_options *options,
                           tc_packer **packer_ret, tc_error *error)
{
    (void)error;
    tc_packer *p = calloc(1, sizeof *p + strlen(path) + 1);
    strcpy(p->path, path);
    p->terrain = *terrain;
    p->terrain.georef.crs_wkt = terrain->georef.crs_wkt ? strdup(terrain->georef.crs_wkt) : NULL;
    p->options = *options;
    size_t n = (size_t)(terrain->width * terrain->height);
    p->z = calloc(n, 4);
    p->voids = malloc(n);
    memset(p->voids, 1, n);
    *packer_ret = p;
    return TC_OK;
}

tc_status tc_packer_put(tc_packer *p, tc_rect r, const float *z, const uint8_t *voids, ptrdiff_t stride,
                        tc_error *error)
{
    if (r.x0 < 0 || r.y0 < 0 || r.x1 > p->terrain.width || r.y1 > p->terrain.height)
        return tc_fail(error, TC_ERR_USAGE, "fake: rect outside");
    for (int64_t y = r.y0; y < r.y1; y++)
        for (int64_t x = r.x0; x < r.x1; x++) {
            ptrdiff_t k = (y - r.y0) * stride + x - r.x0;
            int64_t i = y * p->terrain.width + x;
            if ((voids && voids[k]) || !isfinite(z[k]))
                continue;
            if (!p->voids[i]) {
                if (p->z[i] != z[k]) {
                    p->disagreeing++;
                    p->largest = fmax(p->largest, fabs((double)p->z[i] - z[k]));
                }
                continue;
            }
            p->z[i] = z[k];
            p->voids[i] = 0;
        }
    if (p->options.progress && !p->options.progress(p->options.progress_context, 0.1))
        return tc_fail(error, TC_ERR_IO, "stopped");
    return TC_OK;
}

tc_status tc_packer_finish(tc_packer *p, tc_pack_result *result_ret, tc_error *error)
{
    if (getenv("FAKE_SLOW"))
        for (int i = 0; i < 100; i++) {
            struct timespec t = {0, 50000000};
            nanosleep(&t, NULL);
            if (p->options.progress && !p->options.progress(p->options.progress_context, 0.1 + 0.009 * i))
                return tc_fail(error, TC_ERR_IO, "stopped");
        }
    char temporary[4096];
    snprintf(temporary, sizeof temporary, "%s.fake", p->path);
    FILE *f = fopen(temporary, "wb");
    if (!f)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written", p->path);
    size_t n = (size_t)(p->terrain.width * p->terrain.height);
    size_t w = p->terrain.georef.crs_wkt ? strlen(p->terrain.georef.crs_wkt) : 0;
    fwrite(magic, 8, 1, f);
    fwrite(&p->terrain, sizeof p->terrain, 1, f);
    fwrite(&p->options, sizeof p->options, 1, f);
    fwrite(&w, sizeof w, 1, f);
    fwrite(p->terrain.georef.crs_wkt, 1, w, f);
    fwrite(p->z, 4, n, f);
    fwrite(p->voids, 1, n, f);
    int64_t bytes = ftell(f);
    fclose(f);
    rename(temporary, p->path);
    int64_t voids = 0;
    for (size_t i = 0; i < n; i++)
        voids += p->voids[i];
    *result_ret = (tc_pack_result){(int64_t)n, voids, bytes, 0, 0, p->disagreeing, p->largest};
    return TC_OK;
}

void tc_packer_destroy(tc_packer *p)
{
    if (!p)
        return;
    free(p->z);
    free(p->voids);
    free(p->terrain.georef.crs_wkt);
    free(p);
}

typedef struct fake {
    tc_pyramid head;
    tc_pyramid *inner;
    tc_packed_info info;
    int64_t decoded;
} fake;

static tc_status f_read(const tc_pyramid *p, int level, tc_rect r, float *z, uint8_t *voids, ptrdiff_t stride)
{
    ((fake *)p)->decoded += (r.x1 - r.x0) * (r.y1 - r.y0);
    return tc_pyramid_read(((const fake *)p)->inner, level, r, z, voids, stride);
}
static void f_bounds(const tc_pyramid *p, int level, tc_rect r, float *a, float *b)
{
    tc_pyramid_bounds(((const fake *)p)->inner, level, r, a, b);
}
static size_t f_bytes(const tc_pyramid *p)
{
    return tc_pyramid_bytes(((const fake *)p)->inner);
}
static void f_destroy(tc_pyramid *p)
{
    tc_pyramid_destroy(((fake *)p)->inner);
    free(((fake *)p)->info.terrain.georef.crs_wkt);
    free(p);
}
static const tc_pyramid_class fake_class = {f_read, f_bounds, f_bytes, f_destroy};

tc_status tc_pyramid_open(const char *path, const tc_open_options *options, tc_pyramid **pyramid_ret, tc_error *error)
{
    FILE *f = fopen(path, "rb");
    char sig[8];
    if (!f)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened", path);
    if (fread(sig, 8, 1, f) != 1 || memcmp(sig, magic, 8) != 0) {
        fclose(f);
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected a packed terrain, found something else", path);
    }
    fake *p = calloc(1, sizeof *p);
    tc_pack_options packed;
    size_t w;
    tc_pack_terrain *t = &p->info.terrain;
    if (fread(t, sizeof *t, 1, f) != 1 || fread(&packed, sizeof packed, 1, f) != 1 || fread(&w, sizeof w, 1, f) != 1) {
        fclose(f);
        free(p);
        return tc_fail(error, TC_ERR_FORMAT, "%s: damaged or truncated: the header is cut off", path);
    }
    t->georef.crs_wkt = w ? calloc(1, w + 1) : NULL;
    (void)!fread(t->georef.crs_wkt, 1, w, f);
    if (options && options->has_policy) {
        t->voids = options->voids;
        t->void_constant = options->void_constant;
    }
    tc_grid g = {.width = t->width, .height = t->height, .spacing_x = t->spacing_x, .spacing_y = t->spacing_y};
    size_t n = (size_t)(t->width * t->height);
    g.z = calloc(n, 4);
    g.voids = calloc(n, 1);
    g.z_base = t->z_base;
    g.georef.semi_major = t->georef.semi_major;
    (void)!fread(g.z, 4, n, f);
    (void)!fread(g.voids, 1, n, f);
    p->info.bytes = ftell(f);
    fclose(f);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        g.void_count += g.voids[i];
        if (!g.voids[i])
            g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    if (g.void_count) {
        tc_fill_voids(g.z, g.voids, g.width, g.height);
        g.voids_flat = t->voids == TC_VOIDS_CONSTANT;
        g.void_height = (float)(t->void_constant - t->z_base);
    }
    if (!g.void_count) {
        free(g.voids);
        g.voids = NULL;
    }
    tc_status status = tc_pyramid_build(&g, 0, &p->inner, error);
    if (status)
        return status;
    p->head = *p->inner;
    p->head.class = &fake_class;
    p->info.version = 1;
    p->info.mode = packed.mode;
    p->info.codec = packed.codec;
    p->info.error = packed.error;
    *pyramid_ret = &p->head;
    return TC_OK;
}

const tc_packed_info *tc_pyramid_packed_info(const tc_pyramid *p)
{
    return p->class == &fake_class ? &((const fake *)p)->info : NULL;
}
tc_packed_level tc_pyramid_packed_level(const tc_pyramid *p, int level)
{
    (void)p;
    return (tc_packed_level){.bytes = 100 * level};
}
int64_t tc_pyramid_damaged(const tc_pyramid *p)
{
    (void)p;
    return getenv("FAKE_DAMAGED") ? 3 : 0;
}
int64_t tc_pyramid_bytes_decoded(const tc_pyramid *p)
{
    return p->class == &fake_class ? ((const fake *)p)->decoded : 0;
}

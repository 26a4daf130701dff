/* bench_voids.c - room and time that real void masks take, and what filling voids by rows costs and loses. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/codec/mask/void_mask.h"
#include "common/field/fill.h"
#include "tests/support/datasets.h"
#include "tests/support/memory_rows.h"
#include "tests/support/terrain_files.h"

static const dataset sets[] = {
    {"srtm3_canyonlands_voids_2401x3601.tif", 0, 0},
    {"N46E008.tif", 0, 0},
    {"N37W119.hgt", 0, 0},
    {"N37W120.hgt", 0, 0},
};
enum { SETS = sizeof sets / sizeof *sets };

/* ---- Masks --------------------------------------------------------------------------------------------------- */

/* What the generic regions of JBIG2 (ITU-T T.88, template 0, sixteen neighbours) take for a whole mask, in bytes, with
 * ideal arithmetic coding. */
static double jbig2_bytes(const tc_mask_plane *p)
{
    static const int neighbours[16][2] = {{-1, 0}, {-2, 0}, {-3, 0}, {-4, 0},  {-3, -1}, {-2, -1}, {-1, -1}, {0, -1},
                                          {1, -1}, {2, -1}, {3, -1}, {-1, -2}, {0, -2},  {1, -2},  {-2, -2}, {2, -2}};
    double(*seen)[2] = calloc(1 << 16, sizeof *seen), bits = 0;
    for (int64_t y = 0; y < p->rect.y1; y++) {
        for (int64_t x = 0; x < p->rect.x1; x++) {
            unsigned context = 0;
            for (int k = 0; k < 16; k++) {
                int64_t i = x + neighbours[k][0], j = y + neighbours[k][1];
                context = 2 * context + (i >= 0 && i < p->rect.x1 && j >= 0 ? p->v[j * p->stride + i] : 0);
            }
            int bit = p->v[y * p->stride + x];
            bits -= log2((seen[context][bit] + 0.1) / (seen[context][0] + seen[context][1] + 0.2));
            seen[context][bit]++;
        }
    }
    free(seen);
    return bits / 8;
}

static void mask_row(const dataset *d)
{
    tc_grid g;
    if (!dataset_load(d, &g))
        return;
    tc_mask_plane fine = {g.voids, g.width, {0, 0, g.width, g.height}};
    double finest = jbig2_bytes(&fine), encoding = 0, decoding = 0;
    int64_t tiles = 0, coded = 0;
    size_t bytes = 0, first = 0;
    while (fine.rect.x1 > 1 || fine.rect.y1 > 1) {
        tc_lifting_level level = {fine.rect.x1, fine.rect.y1, false};
        tc_mask_plane coarse = {NULL, (level.width + 1) / 2, {0, 0, (level.width + 1) / 2, (level.height + 1) / 2}};
        coarse.v = malloc((size_t)tc_rect_area(coarse.rect));
        tc_mask_downsample(&fine, &coarse);
        for (int64_t ty = 0; ty * 2 * TC_TILE < level.height; ty++) {
            for (int64_t tx = 0; tx * 2 * TC_TILE < level.width; tx++, tiles++) {
                tc_rect tile = tc_mask_tile_rect(&level, tx, ty, 0);
                if (tc_mask_classify(tile, &fine) != TC_MASK_CODED)
                    continue;
                uint8_t stream[TC_MASK_BOUND], back[4 * TC_TILE * TC_TILE];
                double start = terrain_cpu();
                size_t size = tc_mask_encode(&level, tile, &coarse, &fine, stream);
                double between = terrain_cpu();
                tc_mask_plane out = {back, 2 * TC_TILE, tile};
                tc_mask_decode(&level, tile, TC_MASK_CODED, &coarse, stream, size, &out);
                decoding += terrain_cpu() - between, encoding += between - start;
                bytes += size, coded++;
            }
        }
        first = first ? first : bytes;
        if (fine.v != g.voids)
            free(fine.v);
        fine = coarse;
    }
    if (fine.v != g.voids)
        free(fine.v);
    printf("%-38s %9lld %9zu %9zu %11.0f %6lld %6lld %10.0f %10.0f\n", d->name, (long long)g.void_count, bytes, first,
           finest, (long long)tiles, (long long)coded, 1e6 * encoding / (double)coded, 1e6 * decoding / (double)coded);
    tc_grid_free(&g);
}

/* ---- Filling ------------------------------------------------------------------------------------------------- */

typedef struct roughness {
    double inside,
        across; /* rms of second differences along rows and columns: of voids only, of voids and valid ones */
} roughness;

static roughness measure(const float *z, const uint8_t *voids, int64_t width, int64_t height)
{
    double sum[2] = {0, 0};
    int64_t count[2] = {0, 0};
    for (int64_t y = 0; y < height; y++) {
        for (int64_t x = 0; x < width; x++) {
            for (int axis = 0; axis < 2; axis++) {
                int64_t step = axis ? width : 1, i = y * width + x;
                if (axis ? y == 0 || y + 1 == height : x == 0 || x + 1 == width)
                    continue;
                int n = voids[i - step] + voids[i] + voids[i + step];
                if (n == 0)
                    continue;
                double d = (double)z[i - step] + z[i + step] - 2. * z[i];
                sum[n < 3] += d * d, count[n < 3]++;
            }
        }
    }
    return (roughness){sqrt(sum[0] / fmax((double)count[0], 1)), sqrt(sum[1] / fmax((double)count[1], 1))};
}

static void fill_rows(const dataset *d, bool disc)
{
    tc_grid g;
    if (!dataset_load(d, &g))
        return;
    int64_t count = g.width * g.height, voids = 0;
    float *z = malloc((size_t)count * sizeof *z), *membrane = malloc((size_t)count * sizeof *membrane);
    if (!g.voids)
        g.voids = calloc((size_t)count, 1);
    for (int64_t i = 0; i < count; i++) {
        int64_t x = i % g.width - g.width / 2, y = i / g.width - g.height / 2, r = g.width / 3;
        g.voids[i] |= disc && x * x + y * y < r * r;
        voids += g.voids[i];
    }
    memcpy(membrane, g.z, (size_t)count * sizeof *membrane);
    double start = terrain_cpu();
    tc_fill_voids(membrane, g.voids, g.width, g.height);
    double seconds = terrain_cpu() - start;
    roughness r = measure(membrane, g.voids, g.width, g.height);
    printf("%-38s %s %lld voids\n  in memory             %8s %8s %8.3f %8.3f %9.2f %9.0f\n", d->name,
           disc ? "+ disc" : "", (long long)voids, "", "", r.inside, r.across, 1e9 * seconds / (double)count,
           1e9 * seconds / (double)voids);
    for (int pulls = 1; pulls <= 6; pulls++) {
        for (int64_t i = 0; i < count; i++)
            z[i] = g.voids[i] ? NAN : g.z[i];
        row_store store;
        tc_fill_rows rows = row_store_begin(&store, z, g.width, g.height);
        tc_fill_options options = {.memory_samples = (g.width >> pulls) * (g.height >> pulls) * 11 / 10};
        start = terrain_cpu();
        tc_status status = tc_fill_void_rows(&rows, row_store_scratch, &store, &options);
        seconds = terrain_cpu() - start;
        double sum = 0, largest = 0;
        for (int64_t i = 0; i < count; i++) {
            double e = fabs((double)z[i] - membrane[i]);
            sum += e * e, largest = fmax(largest, e);
        }
        r = measure(z, g.voids, g.width, g.height);
        printf("  %d levels pulled%s       %8.3f %8.2f %8.3f %8.3f %9.2f %9.0f\n", store.count - 1,
               status ? ": failed" : "", sqrt(sum / (double)voids), largest, r.inside, r.across,
               1e9 * seconds / (double)count, 1e9 * seconds / (double)voids);
        row_store_end(&store);
    }
    free(z), free(membrane), tc_grid_free(&g);
}

int main(void)
{
    printf(
        "Void masks: bytes of all levels, of the finest (given the next), of the finest alone in JBIG2; tiles of all\n"
        "levels, coded ones; microseconds to encode and decode a coded tile\n");
    printf("%-38s %9s %9s %9s %11s %6s %6s %10s %10s\n", "", "voids", "all", "finest", "JBIG2", "tiles", "coded",
           "encode", "decode");
    for (int s = 0; s < SETS; s++)
        mask_row(&sets[s]);
    printf("\nFilling by rows against filling in memory: difference over voids (rms, largest, metres), roughness\n"
           "(rms of second differences, metres) within voids and across their borders; nanoseconds a sample, a void\n");
    printf("  %-21s %8s %8s %8s %8s %9s %9s\n", "", "rms", "largest", "within", "across", "a sample", "a void");
    for (int s = 0; s < 2 * SETS; s++)
        fill_rows(&sets[s / 2], s % 2);
    return 0;
}

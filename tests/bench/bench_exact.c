/* bench_exact.c - rate and speed of the exact codec, lossless and with a bounded error, on real terrains.
 *
 * Crops as in bench_codec.c. Bits are those of a whole file: the coarser levels by the lossy codec
 * (tests/support/packed.h), the finest exactly, its header, and 8 bytes for every tile. The column to compare with is
 * JPEG XL (modular, effort 7; of heights divided by 2E + 1 where an error of E is allowed), measured once; its files
 * hold no coarser levels. `corrected` is the lossy codec with corrections at the same bounds. Arguments: none for the
 * tables; a dataset's name, for its share of them, and E in lattice units, q of the coarser levels in steps, height
 * units a lattice unit; or a name, "corrected", E, q / E. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/codec/lifting/codec_correction.h"
#include "common/codec/exact/codec_exact.h"
#include "tests/support/datasets.h"
#include "tests/support/packed.h"
#include "tests/support/terrain_files.h"

typedef struct crop {
    const char *name;
    dataset set;
    double lattice; /* metres */
    int64_t x0, y0, size;
    double jxl[3]; /* at E = 0, 1, 2 */
} crop;

static const crop crops[] = {
    {"tatra2k", {"srtm3_tatra_poland_4801.tif", 0, 0}, 1, 800, 2753, 2048, {3.36, 2.04, 1.547}},
    {"canyon2k", {"srtm3_canyonlands_voids_2401x3601.tif", 0, 0}, 1, 352, 1344, 2048, {3.74, 2.33, 1.80}},
    {"moon2k", {"moon_gld100_256ppd_ne_4097.png", 0, 0}, 1, 1000, 1000, 2048, {2.07, 1.186, 0.921}},
    {"ps1k", {"ps_height_1k.png", 160, 0.1}, 0.1, 0, 0, 1025, {8.10, 0, 0}},
};

/* Heights in lattice units. */
static tc_plane load(const crop *c)
{
    tc_grid g;
    if (!dataset_load(&c->set, &g))
        return (tc_plane){0};
    int64_t w = tc_min64(c->size, g.width), h = tc_min64(c->size, g.height), y0 = tc_max64(g.height - c->y0 - h, 0);
    tc_plane z = packed_plane((tc_rect){0, 0, w, h});
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++)
            *tc_plane_at(&z, x, y) = (int32_t)lrint(g.z[(y0 + y) * g.width + c->x0 + x] / c->lattice);
    tc_grid_free(&g);
    return z;
}

/* Bytes of all levels of a packed terrain but the finest. */
static size_t coarser_bytes(packed *p)
{
    packed_level *f = &p->level[0];
    size_t header = f->header_size, *size = f->tile_size;
    int64_t tiles = f->codec->tiles_x * f->codec->tiles_y;
    f->header_size = 0, f->tile_size = calloc((size_t)tiles, sizeof *size);
    size_t bytes = packed_bytes(p) - (size_t)tiles / 8;
    free(f->tile_size);
    f->header_size = header, f->tile_size = size;
    return bytes;
}

/* The filtered source on the next coarser level, and the mean size of the finest level's details. */
static tc_plane analyse(const tc_plane *source, double *detail_ret)
{
    tc_lifting_level level = {source->rect.x1, source->rect.y1, false};
    tc_rect r = {0, 0, tc_coarse_size(level.width), tc_coarse_size(level.height)};
    tc_plane ll = packed_plane(r), band[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        band[b] = packed_plane(r);
    int32_t *scratch = malloc(tc_lifting_analyse_scratch(&level, r.y1) * sizeof *scratch);
    tc_lifting_analyse(&level, source, 0, r.y1, &ll, band, scratch);
    double sum = 0;
    for (int b = 0; b < TC_BANDS; b++) {
        for (int64_t i = 0; i < tc_rect_area(r); i++)
            sum += abs(band[b].z[i]);
        free(band[b].z);
    }
    free(scratch);
    *detail_ret = sum / (double)(TC_BANDS * tc_rect_area(r));
    return ll;
}

static double rms(const tc_plane *a, const tc_plane *b)
{
    double sum = 0;
    for (int64_t i = 0; i < tc_rect_area(a->rect); i++)
        sum += pow((double)a->z[i] - b->z[i], 2);
    return sqrt(sum / (double)tc_rect_area(a->rect));
}

/* q: of the coarser levels, in steps; 0: as a packer should choose it. */
static void measure(const crop *c, const tc_plane *z, int bound, double q, int units)
{
    int64_t w = z->rect.x1, h = z->rect.y1, n = w * h;
    int32_t step = (2 * bound + 1) * units;
    tc_plane source = packed_plane(z->rect), fine = packed_plane(z->rect), out = packed_plane(z->rect);
    for (int64_t i = 0; i < n; i++) {
        source.z[i] = z->z[i] * units;
        fine.z[i] = (int32_t)lrint((double)z->z[i] / (2 * bound + 1)) * step;
    }
    double detail;
    tc_plane filtered = analyse(&source, &detail);
    q = q > 0 ? q : 8 * fmax(1, detail / step);
    packed p = packed_new(source.z, w, h, &(packed_options){.q = q * step, .threads = 2});
    double coarse_bits = 8.0 * (double)coarser_bytes(&p) / (double)n;
    tc_lifting_level level = {w, h, false};
    tc_plane coarse = p.level[1].fine;
    double start = terrain_cpu();
    tc_exact *codec = malloc(sizeof *codec);
    tc_exact_work *work = malloc(tc_exact_work_bytes());
    tc_exact_model model = {.step = step};
    tc_exact_init(codec, &level, &model);
    enum { TRAINING = 32 };
    tc_exact_tile tile[TRAINING];
    int64_t tiles = codec->tiles_x * codec->tiles_y;
    int count = (int)tc_min64(TRAINING, tiles);
    for (int i = 0; i < count; i++) {
        int64_t t = i * tiles / count;
        tile[i] = (tc_exact_tile){t % codec->tiles_x, t / codec->tiles_x, coarse, fine};
    }
    if (tc_exact_train(&level, tile, count, step, 0, &model))
        exit(1);
    uint8_t *header = malloc(tc_exact_model_bound());
    size_t bytes = tc_exact_model_write(&model, header), header_bytes = bytes;
    if (tc_exact_model_read(header, bytes, &model))
        puts("exact: header"), exit(1);
    tc_exact_init(codec, &level, &model);
    double train_s = terrain_cpu() - start, decode_s = 0;
    uint8_t *buffer = malloc(tc_exact_tile_bound() * 1), **stream = calloc((size_t)tiles, sizeof *stream);
    size_t *size = calloc((size_t)tiles, sizeof *size);
    start = terrain_cpu();
    for (int64_t t = 0; t < tiles; t++) {
        if (tc_exact_encode_tile(codec, t % codec->tiles_x, t / codec->tiles_x, &coarse, &fine, buffer, &size[t], work))
            puts("exact: not encoded"), exit(1);
        stream[t] = malloc(size[t] + 1);
        memcpy(stream[t], buffer, size[t]);
        bytes += size[t] + 8;
    }
    double encode_s = terrain_cpu() - start;
    start = terrain_cpu();
    for (int64_t t = 0; t < tiles; t++)
        if (tc_exact_decode_tile(codec, t % codec->tiles_x, t / codec->tiles_x, stream[t], size[t], &coarse, &out,
                                 work))
            puts("exact: not decoded"), exit(1);
    decode_s = terrain_cpu() - start;
    if (memcmp(out.z, fine.z, (size_t)n * sizeof *out.z) != 0)
        puts("exact: not the same heights"), exit(1);
    double bits = coarse_bits + 8.0 * (double)bytes / (double)n, jxl = bound < 3 ? c->jxl[bound] : 0;
    printf("exact: %-9s E %d q/step %6.1f units %d  coarser %6.4f (rms %.2f m) + %6.4f (header %zu B) = "
           "%6.4f bits  JPEG XL %5.3f "
           "%+5.1f %%  train %.2f s  encode %5.1f decode %5.1f Ms/s\n",
           c->name, bound, q, units, coarse_bits, rms(&coarse, &filtered) / units * c->lattice, bits - coarse_bits,
           header_bytes, bits, jxl, jxl > 0 ? 100 * (bits / jxl - 1) : 0, train_s, 1e-6 * (double)n / encode_s,
           1e-6 * (double)n / decode_s);
    fflush(stdout);
    for (int64_t t = 0; t < tiles; t++)
        free(stream[t]);
    free(stream), free(size), free(buffer), free(header), free(work), free(codec);
    free(source.z), free(fine.z), free(out.z), free(filtered.z);
    packed_free(&p);
}

/* The lossy codec with q = ratio * E, and corrections. */
static void measure_corrected(const crop *c, const tc_plane *z, int bound, double ratio, int units)
{
    int64_t w = z->rect.x1, h = z->rect.y1, n = w * h;
    tc_plane source = packed_plane(z->rect);
    for (int64_t i = 0; i < n; i++)
        source.z[i] = z->z[i] * units;
    packed p = packed_new(source.z, w, h, &(packed_options){.q = ratio * bound * units, .threads = 2});
    const packed_level *f = &p.level[0];
    double plain = 8.0 * (double)packed_bytes(&p) / (double)n, sum = 0;
    int64_t worst = 0, some = 0;
    for (int64_t i = 0; i < n; i++) {
        int64_t got = lrint((double)f->fine.z[i] / units), k = lrint((double)(z->z[i] - got) / (2 * bound + 1));
        int64_t e = got + k * (2 * bound + 1) - z->z[i];
        worst = tc_max64(worst, e < 0 ? -e : e), sum += (double)(e * e), some += k != 0;
        source.z[i] = (int32_t)k;
    }
    tc_correction *correction = malloc(sizeof *correction);
    tc_correction_init(correction, true);
    uint8_t *bytes = malloc(tc_correction_bound());
    tc_tile_work *work = malloc(tc_tile_work_bytes());
    size_t all = 0;
    double spent = 0;
    for (int64_t ty = 0; ty < f->codec->tiles_y; ty++)
        for (int64_t tx = 0; tx < f->codec->tiles_x; tx++) {
            tc_rect positions = tc_codec_tile_rect(f->codec, tx, ty, 0);
            tc_plane band[TC_BANDS], out;
            for (int b = 0; b < TC_BANDS; b++)
                band[b] = packed_plane(positions);
            const uint8_t *stream;
            size_t size;
            packed_source((void *)f, tx, ty, &stream, &size);
            if (tc_codec_decode_tile(f->codec, tx, ty, 0, stream, size, &f->coarse, band, work, TC_SIMD_AUTO))
                puts("correction: tile"), exit(1);
            tc_rect r = {2 * positions.x0, 2 * positions.y0, tc_min64(2 * positions.x1, w),
                         tc_min64(2 * positions.y1, h)};
            tc_plane k = {tc_plane_at(&source, r.x0, r.y0), source.stride, r};
            out = packed_plane(r);
            const int32_t *step = f->codec->model.step;
            if (tc_correction_encode(correction, band, step, &k, bytes, tc_correction_bound(), &size))
                puts("correction: not encoded"), exit(1);
            double start = terrain_cpu();
            if (tc_correction_decode(correction, band, step, bytes, size, &out))
                puts("correction: not decoded"), exit(1);
            spent += terrain_cpu() - start;
            for (int64_t y = r.y0; y < r.y1; y++)
                if (memcmp(tc_plane_at(&k, r.x0, y), tc_plane_at(&out, r.x0, y), (size_t)(r.x1 - r.x0) * 4) != 0)
                    puts("correction: not the same"), exit(1);
            all += size + (size > 0 ? 8 : 1);
            for (int b = 0; b < TC_BANDS; b++)
                free(band[b].z);
            free(out.z);
        }
    double bits = 8.0 * (double)all / (double)n;
    printf(
        "corrected: %-9s E %d q/E %4.2f  lossy %6.4f + %6.4f = %6.4f bits  corrected %.2f %%  rms %.3f max %d  decode "
        "%.1f Ms/s\n",
        c->name, bound, ratio, plain, bits, plain + bits, 100.0 * (double)some / (double)n, sqrt(sum / (double)n),
        (int)worst, 1e-6 * (double)n / spent);
    fflush(stdout);
    free(bytes), free(work), free(correction), free(source.z);
    packed_free(&p);
}

int main(int argc, char **argv)
{
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        const crop *c = &crops[i];
        if (argc > 1 && strcmp(argv[1], c->name) != 0)
            continue;
        tc_plane z = load(c);
        if (!z.z)
            continue;
        bool corrected = argc > 2 && strcmp(argv[2], "corrected") == 0;
        if (corrected)
            measure_corrected(c, &z, argc > 3 ? atoi(argv[3]) : 2, argc > 4 ? atof(argv[4]) : 2.8, 16);
        else if (argc > 2)
            measure(c, &z, atoi(argv[2]), argc > 3 ? atof(argv[3]) : 0, argc > 4 ? atoi(argv[4]) : 4);
        for (int bound = 0; bound < 3 && argc < 3; bound++)
            if (c->jxl[bound] > 0)
                measure(c, &z, bound, 0, 4);
        for (int bound = 1; bound < 5 && argc < 3 && c->lattice == 1; bound *= 2)
            measure_corrected(c, &z, bound, 2.8, 16);
        free(z.z);
    }
    return 0;
}

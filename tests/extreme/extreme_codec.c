/* extreme_codec.c - packing at its ends: sixteen coded levels, white noise, nothing at all, errors from a micrometre to
 * a thousand kilometres; and the same bytes whatever the threads, the instructions and the compiler. */
#include "tests/support/extreme.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/packed/read/packed_internal.h"
#include "tests/support/lh04_packed.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/sweep.h"

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "codec: %s\n", error->text);
        exit(99);
    }
}

/* fmax() leaves out what is no number. */
static double larger(double a, double b)
{
    return isnan(b) ? INFINITY : fmax(a, b);
}

static const char *const mode_name[] = {"rms", "max-error", "lossless", "lh04"};
enum { MODES = 4, LH04 = 3 };

/* A terrain to be packed in one of the four ways. */
static packing packing_of(int mode, int64_t width, int64_t height, packing_kind kind, double error)
{
    return (packing){.width = width,
                     .height = height,
                     .kind = kind,
                     .mode = mode == LH04 ? TC_PACK_RMS : (tc_pack_mode)mode,
                     .codec = mode == LH04 ? TC_CODEC_LH04 : TC_CODEC_LIFTING,
                     .type = TC_SAMPLE_INT16,
                     .error = error};
}

/* ---- Sixteen levels ---------------------------------------------------------------------------------------------- */

/* Of two rows, so that they are few samples, but coded one against the other 16 times. */
static void sixteen_levels(int mode)
{
    enum { COLUMNS = 530001, ROWS = 2 };
    packing p = packing_of(mode, COLUMNS, ROWS, PACKING_INTEGERS, 4);
    tc_pack_result result;
    tc_field *file, *truth = packing_truth(&p);
    tc_error error;
    const char *path = made_path("levels.tclip");
    must(packing_write(&p, path, &result, &error), &error);
    must(tc_field_open(path, NULL, &file, &error), &error);
    int levels = tc_field_info(file)->levels, coded = 0;
    double unit = tc_field_container(file)->z_unit, excess = 0, drift = 0, worst = 0;
    for (int l = 1; l <= levels; l++) {
        tc_packed_level declared = tc_field_packed_level(file, l);
        tc_level size = tc_field_level(file, l);
        uint8_t *voids;
        float *z = packing_read(file, l, &voids), *true_z = packing_read(truth, l, NULL);
        double rms, most;
        packing_error(z, true_z, voids, size.width * size.height, &rms, &most);
        free(z), free(true_z), free(voids);
        if (!declared.bytes)
            continue;
        coded++;
        /* Coarser levels are declared against the filtered source in height units, which the truth in floats is off by
         * two or so; the finest against the source itself. */
        double slack = l < levels ? 2.5 * unit : 1e-4;
        excess = larger(excess, (most - declared.max_error) / slack);
        drift = larger(drift, (rms - declared.rms) / slack);
        worst = larger(worst, most);
    }
    char name[80];
    snprintf(name, sizeof name, "16 levels, closed loop, %s", mode_name[mode]);
    extreme_at_most(name, "levels short of 16", 16 - coded, 0, "%d x %d samples, %d levels, %d of them coded", COLUMNS,
                    ROWS, levels, coded);
    extreme_at_most(name, "largest error beyond the level's declared one, slacks", fmax(excess, drift), 1,
                    "at most %.3g m on any level; a slack is 2.5 height units of %.3g m, 1e-4 m on the finest", worst,
                    unit);
    double bound = mode == TC_PACK_MAX_ERROR ? p.error : mode == TC_PACK_LOSSLESS ? 0 : INFINITY;
    extreme_at_most(name,
                    mode == TC_PACK_LOSSLESS || mode == TC_PACK_MAX_ERROR ? "finest level off by, metres"
                                                                          : "finest level's rms, metres",
                    bound < INFINITY ? result.max_error : result.rms, fmin(bound, p.error), "%lld bytes",
                    (long long)result.bytes);
    tc_field_destroy(file), tc_field_destroy(truth);
}

/* ---- Noise and nothing ------------------------------------------------------------------------------------------- */

static void white_noise(int64_t side, bool whole_range)
{
    tc_pack_terrain terrain = {.width = side, .height = side, .spacing_x = 1, .spacing_y = 1};
    terrain.sample_type = TC_SAMPLE_UINT16, terrain.unit = 1;
    tc_pack_options options = {.mode = TC_PACK_LOSSLESS};
    tc_rect all = {0, 0, side, side};
    float *z = packed_memory((size_t)(side * side) * sizeof *z);
    test_random r = {21};
    for (int64_t i = 0; i < side * side; i++)
        z[i] = (float)(whole_range ? test_random_bits(&r) >> 48 : (test_random_bits(&r) & 1) * 65535);
    tc_packer *packer;
    tc_pack_result result;
    tc_error error;
    must(tc_packer_create(made_path("noise.tclip"), &terrain, &options, &packer, &error), &error);
    must(tc_packer_put(packer, all, z, NULL, side, &error), &error);
    must(tc_packer_finish(packer, &result, &error), &error);
    tc_packer_destroy(packer);
    free(z);
    tc_field *file;
    must(tc_field_open(made_path("noise.tclip"), NULL, &file, &error), &error);
    int64_t finest = tc_field_packed_level(file, tc_field_info(file)->levels).bytes;
    tc_field_destroy(file);
    double raw = (whole_range ? 2. : 1. / 8) * (double)(side * side);
    char name[80];
    snprintf(name, sizeof name, "white noise, %s, lossless, %lld a side", whole_range ? "16 bits" : "0 or 65535",
             (long long)side);
    double longer = 100 * ((double)result.bytes / raw - 1);
    if (!whole_range) {
        /* What the models of so small a file take, and coarser levels, of which a filter makes more than two values. */
        extreme_at_most(name, "longer than 1 bit a sample, %", longer, 30,
                        "%lld bytes for %.0f, %lld of them the finest level's; off by %g", (long long)result.bytes, raw,
                        (long long)finest, result.max_error);
        return;
    }
    /* Raw tiles; what is left is the head with the base level, the index, and errors of levels: 1,099 bytes. */
    extreme_at_most(name, "longer than raw 16 bits, %", longer, 0.16,
                    "%lld bytes for %.0f, %lld of them the finest level's; off by %g", (long long)result.bytes, raw,
                    (long long)finest, result.max_error);
}

/* Bytes of a file's tiles, and of its directories and index pages. */
static void count_tiles(tc_packed_file *file, int64_t *tiles_ret, int64_t *tile_bytes_ret, int64_t *index_bytes_ret)
{
    const tc_container *c = &file->container;
    tc_error error = {.text = "an index entry"};
    *tiles_ret = *tile_bytes_ret = *index_bytes_ret = 0;
    for (int l = c->base + 1; l <= c->levels; l++) {
        tc_pages pages = tc_level_pages(&c->level[l - 1]);
        int64_t bytes = 0;
        for (int64_t n = 0; n < pages.tiles_x * pages.tiles_y; n++) {
            tc_tile_entry entry;
            must(tc_packed_file_entry(file, l, n % pages.tiles_x, n / pages.tiles_x, &entry), &error);
            bytes += tc_tile_bytes(&entry);
        }
        *tiles_ret += pages.tiles_x * pages.tiles_y, *tile_bytes_ret += bytes;
        *index_bytes_ret += c->record[l - 1].end - c->record[l - 1].begin - bytes;
    }
}

static void constant(int mode)
{
    packing p = packing_of(mode, 900, 700, PACKING_CONSTANT, 0.01);
    p.type = TC_SAMPLE_FLOAT32, p.unit = 0.5;
    tc_pack_result result;
    tc_packed_file file;
    tc_error error;
    const char *path = made_path("constant.tclip");
    must(packing_write(&p, path, &result, &error), &error);
    must(tc_packed_file_open(path, &file, &error), &error);
    int64_t tiles, tile_bytes, index_bytes;
    count_tiles(&file, &tiles, &tile_bytes, &index_bytes);
    char name[80];
    snprintf(name, sizeof name, "constant terrain, %s", mode_name[mode]);
    extreme_at_most(name, "bytes of tiles", (double)tile_bytes, 0, "%lld tiles; directories and index %lld, file %lld",
                    (long long)tiles, (long long)index_bytes, (long long)result.bytes);
    extreme_at_most(name, "off by, metres", result.max_error, 0, "1234.5 m");
    tc_packed_file_close(&file);
}

/* ---- Errors asked for -------------------------------------------------------------------------------------------- */

/* least: the decade from which on it must be taken; what is finer may be refused. */
static void asked_for(int mode, packing_kind kind, const char *terrain, int least)
{
    for (int decade = -6; decade <= 6; decade += sweep_whole() ? 1 : 3) {
        packing p = packing_of(mode, 131, 99, kind, pow(10, decade));
        p.type = TC_SAMPLE_FLOAT32;
        if (kind == PACKING_DUST) /* which floats so high up do not hold */
            p.based = true, p.offset = 1e6;
        tc_pack_result result;
        tc_error error = {0};
        char name[100];
        snprintf(name, sizeof name, "%s of 1e%d m, %s", mode_name[mode], decade, terrain);
        tc_status status = packing_write(&p, made_path("asked.tclip"), &result, &error);
        if (status) {
            if (decade < least)
                extreme_refused(name, status, TC_ERR_UNSUPPORTED, error.text);
            else
                extreme_at_most(name, "error over what was asked for", NAN, 1, "refused: %s", error.text);
            continue;
        }
        tc_field *file;
        must(tc_field_open(made_path("asked.tclip"), NULL, &file, &error), &error);
        uint8_t *voids, *given_voids;
        float *z = packing_read(file, tc_field_info(file)->levels, &voids), *given = packing_heights(&p, &given_voids);
        double rms, most;
        packing_error(z, given, voids, p.width * p.height, &rms, &most);
        extreme_at_most(name, "error over what was asked for", (mode == TC_PACK_MAX_ERROR ? most : rms) / p.error,
                        1 + 1e-6, "%lld bytes, declared %.3g", (long long)result.bytes,
                        mode == TC_PACK_MAX_ERROR ? result.max_error : result.rms);
        free(z), free(given), free(voids), free(given_voids);
        tc_field_destroy(file);
    }
}

/* ---- The same bytes ---------------------------------------------------------------------------------------------- */

static void threads(int mode)
{
    static const int count[] = {1, 8, 3, 2, 5};
    int counts = sweep_whole() ? 5 : 3;
    packing p = packing_of(mode, 420, 300, PACKING_INTEGERS, mode == TC_PACK_MAX_ERROR ? 3 : 1.5);
    p.voids = PACKING_LAKES;
    uint8_t *first = NULL;
    size_t first_size = 0;
    int differ = 0;
    for (int k = 0; k < counts; k++) {
        size_t size;
        tc_pack_result result;
        tc_error error;
        p.threads = count[k];
        must(packing_write(&p, made_path("threads.tclip"), &result, &error), &error);
        uint8_t *bytes = packing_bytes(made_path("threads.tclip"), &size);
        if (k == 0)
            first = bytes, first_size = size;
        else
            differ += size != first_size || memcmp(bytes, first, size) != 0;
        if (k > 0)
            free(bytes);
    }
    free(first);
    char name[80];
    snprintf(name, sizeof name, "%s threads, %s", sweep_whole() ? "1, 2, 3, 5 and 8" : "1, 3 and 8", mode_name[mode]);
    extreme_at_most(name, "files that differ", differ, 0, "%zu bytes", first_size);
}

/* An empty tile has no bytes, and a null pointer to them is none for memcmp(). */
static bool bytes_apart(const uint8_t *a, size_t a_size, const uint8_t *b, size_t b_size)
{
    return a_size != b_size || (a_size > 0 && memcmp(a, b, a_size) != 0);
}

static int64_t heights_apart(const tc_plane *a, const tc_plane *b)
{
    int64_t apart = 0;
    for (int64_t i = 0; i < tc_rect_area(a->rect); i++)
        apart += a->z[i] != b->z[i];
    return apart;
}

static void instructions(void)
{
    if (!__builtin_cpu_supports("avx2")) {
        extreme_skipped("AVX2 against none", "this processor has no AVX2");
        return;
    }
    int64_t bytes = 0, heights = 0, tiles = 0;
    test_random r = {31};
    for (int k = 0; k < 2 * PACKED_KINDS; k++) {
        int64_t w = test_random_int(&r, 150, 400), h = test_random_int(&r, 150, 400);
        int32_t *z = packed_heights(&r, k % PACKED_KINDS, w, h, 100000);
        packed_options o = {.q = exp(test_random_range(&r, -3, 9)), .threads = 1, .training_tiles = 2};
        packed a = packed_new(z, w, h, &o);
        o.simd = TC_SIMD_NONE;
        packed b = packed_new(z, w, h, &o);
        for (int n = 0; n < a.levels; n++) {
            const packed_level *l = &a.level[n], *m = &b.level[n];
            bytes += bytes_apart(l->header, l->header_size, m->header, m->header_size);
            for (int64_t t = 0; t < l->tiles; t++, tiles++)
                bytes += bytes_apart(l->tile[t], l->tile_size[t], m->tile[t], m->tile_size[t]);
            tc_plane other = packed_plane(l->fine.rect);
            packed_read(l, &other, NULL, TC_SIMD_NONE);
            heights += heights_apart(&l->fine, &other);
            free(other.z);
        }
        packed c = lh04_new(z, w, h, &(lh04_options){.q = fmax(o.q, 1), .training_tiles = 2});
        for (int n = 0; n < c.levels; n++) {
            tc_plane other = packed_plane(c.level[n].fine.rect);
            lh04_read(&c.level[n], &other, TC_SIMD_NONE);
            heights += heights_apart(&c.level[n].fine, &other);
            free(other.z);
        }
        packed_free(&a), packed_free(&b), packed_free(&c);
        free(z);
    }
    extreme_at_most("AVX2 against none", "tiles and models that differ", (double)bytes, 0,
                    "%lld tiles of the lifting codec", (long long)tiles);
    extreme_at_most("AVX2 against none", "heights read that differ", (double)heights, 0,
                    "lifting and LH04, all levels");
}

/* What compilers.sh says: lines of "NAME: SUMS", the first from the library that is tested. */
static void compilers(void)
{
    const char *build = getenv("TERRACLIP_BUILD");
    build = build && *build ? build : "build";
    char command[1024], first[1024] = "", line[1024];
    snprintf(command, sizeof command, "sh tests/extreme/compilers.sh '%s/extreme/compilers' '%s/libterraclip.a'", build,
             build);
    FILE *lines = strstr(build, "sanitize") ? NULL : popen(command, "r");
    int seen = 0;
    while (lines && fgets(line, sizeof line, lines)) {
        char *sums = strchr(line, ':'), name[100];
        if (!sums)
            continue;
        *sums = '\0', sums += 2;
        sums[strcspn(sums, "\n")] = '\0';
        snprintf(name, sizeof name, "7 files packed by %.40s against the library", line);
        if (strncmp(sums, "skipped", 7) == 0)
            extreme_skipped(name, sums);
        else if (seen++ == 0)
            snprintf(first, sizeof first, "%s", sums);
        else
            extreme_at_most(name, "files that differ", strcmp(first, sums) != 0 || strlen(sums) < 7 * 10, 0, "%.60s...",
                            sums);
    }
    if (lines)
        pclose(lines);
    if (seen < 2)
        extreme_skipped("files packed by other compilers",
                        "tests/extreme/compilers.sh has built none; not for sanitizers, "
                        "and only in the repository's root");
}

int main(void)
{
    extreme_begin("codec");
    for (int mode = 0; mode < MODES; mode++)
        sixteen_levels(mode);
    white_noise(1024, true);
    white_noise(256, false);
    for (int mode = 0; mode < MODES; mode++)
        constant(mode);
    asked_for(TC_PACK_RMS, PACKING_HILLS, "hills of 300 m", -4);
    asked_for(TC_PACK_RMS, PACKING_WALLS, "walls of 2000 km", 0);
    asked_for(TC_PACK_RMS, PACKING_DUST, "dust of 2 mm", -6);
    asked_for(TC_PACK_MAX_ERROR, PACKING_HILLS, "hills of 300 m", -2);
    asked_for(TC_PACK_MAX_ERROR, PACKING_WALLS, "walls of 2000 km", -6);
    asked_for(TC_PACK_MAX_ERROR, PACKING_DUST, "dust of 2 mm", -6);
    for (int mode = 0; mode < MODES; mode++)
        threads(mode);
    instructions();
    compilers();
    made_folder_remove();
    return extreme_end();
}

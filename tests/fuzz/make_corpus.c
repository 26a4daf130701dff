/* make_corpus.c - the seeds of the fuzzers: make_corpus FOLDER. Tiny terrains packed in every mode, whole for
 * fuzz_reader and by parts for fuzz_tile. Linked with no_crc.c. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "common/packed/file/packed_file.h"
#include "fuzz_tile.h"

static void stop(const char *what)
{
    fprintf(stderr, "make_corpus: %s\n", what);
    exit(1);
}

static void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file))
        stop(path);
}

static float height(int64_t x, int64_t y)
{
    double rough = (double)((uint32_t)(x * 73856093 ^ y * 19349663) % 1000u) / 100;
    return (float)rint(500 + 80 * sin(0.2 * (double)x) * cos(0.13 * (double)y) + rough);
}

static void pack(const char *path, int64_t w, int64_t h, tc_pack_mode mode, tc_pack_codec codec, double error,
                 bool voids)
{
    tc_pack_terrain t = {.width = w, .height = h, .spacing_x = 10, .spacing_y = 10, .unit = 1};
    t.sample_type = voids ? TC_SAMPLE_FLOAT32 : TC_SAMPLE_INT16;
    t.georef.crs_wkt = voids ? (char *)"LOCAL_CS[\"x\"]" : NULL;
    tc_pack_options o = {.mode = mode, .codec = codec, .error = error, .threads = 1};
    float *z = malloc((size_t)(w * h) * sizeof *z);
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error why;
    for (int64_t i = 0; i < w * h; i++) {
        int64_t x = i % w, y = i / w;
        bool is_void = voids && (hypot((double)x - 20, (double)y - 11) < 9 || (x + 3 * y) % 61 == 0);
        z[i] = is_void ? NAN : height(x, y);
    }
    if (tc_packer_create(path, &t, &o, &packer, &why) ||
        tc_packer_put(packer, (tc_rect){0, 0, w, h}, z, NULL, w, &why) || tc_packer_finish(packer, &result, &why))
        stop(why.text);
    tc_packer_destroy(packer);
    free(z);
}

/* A seed of fuzz_tile. */
static void write_part(const char *folder, const char *name, int kind, const tc_level *level, unsigned seed,
                       const uint8_t *model, size_t model_size, const uint8_t *bytes, size_t size)
{
    char path[512];
    tc_byte_writer w = {0};
    tc_put(&w, (uint64_t)kind, 1), tc_put(&w, (uint64_t)(3 * (level->width / 2) / 2), 1);
    tc_put(&w, (uint64_t)level->height - 1, 1), tc_put(&w, 0, 1), tc_put(&w, seed, 1), tc_put(&w, model_size, 2);
    tc_put_bytes(&w, model, model_size), tc_put_bytes(&w, bytes, size);
    snprintf(path, sizeof path, "%s/tile/%s", folder, name);
    write_file(path, w.bytes, w.size);
    free(w.bytes);
}

static void split(const char *folder, const char *path, const char *name)
{
    tc_packed_file f;
    char part[128];
    if (tc_packed_file_open(path, &f, NULL))
        stop(path);
    const tc_container *c = &f.container;
    int m = c->levels;
    const tc_level_record *r = &c->record[m - 1];
    uint8_t *bytes = malloc((size_t)f.source.size);
    FILE *file = fopen(path, "rb");
    if (!bytes || !file || fread(bytes, 1, (size_t)f.source.size, file) != (size_t)f.source.size)
        stop(path);
    fclose(file);
    snprintf(part, sizeof part, "head-%s", name);
    write_part(folder, part, FUZZ_HEAD, &c->level[m - 1], 0, NULL, 0, bytes, (size_t)c->record[c->base].begin);
    tc_tile_entry entry;
    if (tc_packed_file_entry(&f, m, 0, 0, &entry))
        stop("no entry");
    const uint8_t *page = bytes + r->begin + tc_load(bytes + r->begin, 8), *tile = bytes + entry.offset;
    tc_page_form told = tc_level_form(r, c->steps);
    unsigned form =
        told.corrections | (unsigned)told.mask << 1 | (unsigned)told.step << 2 | (unsigned)told.repeats << 3;
    snprintf(part, sizeof part, "page-%s", name);
    write_part(folder, part, FUZZ_PAGE, &(tc_level){1, 1, 1, 1}, form, NULL, 0, page, tc_load(bytes + r->begin + 8, 4));
    snprintf(part, sizeof part, "tile-%s", name);
    write_part(folder, part, (int)r->coder, &c->level[m - 1], 3, r->model, r->model_size, tile,
               entry.size[0] + entry.size[1]);
    snprintf(part, sizeof part, "mask-%s", name);
    if (entry.size[2])
        write_part(folder, part, FUZZ_MASK, &c->level[m - 1], TC_MASK_CODED, c->base_void, 30,
                   tile + entry.size[0] + entry.size[1], entry.size[2]);
    free(bytes);
    tc_packed_file_close(&f);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        int64_t w, h;
        tc_pack_mode mode;
        tc_pack_codec codec;
        double error;
        bool voids;
    } seeds[] = {
        {"rms", 40, 33, TC_PACK_RMS, TC_CODEC_LIFTING, 1.5, false},
        {"rms-voids", 60, 21, TC_PACK_RMS, TC_CODEC_LIFTING, 3, true},
        {"bound", 37, 40, TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 30, false},
        {"bound-voids", 33, 34, TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 12, true},
        {"lossless", 23, 18, TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, false},
        {"lossless-voids", 31, 22, TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, true},
        {"lh04", 41, 38, TC_PACK_RMS, TC_CODEC_LH04, 2, false},
        {"lh04-voids", 33, 20, TC_PACK_RMS, TC_CODEC_LH04, 4, true},
        {"base", 5, 16, TC_PACK_RMS, TC_CODEC_LIFTING, 1, true},
        {"tiles", 300, 20, TC_PACK_RMS, TC_CODEC_LIFTING, 8, true},
    };
    if (argc != 2)
        stop("expected a folder");
    char path[512];
    const char *const folders[] = {"reader", "tile"};
    for (int k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%s/%s", argv[1], folders[k]);
        mkdir(path, 0777);
    }
    for (size_t k = 0; k < sizeof seeds / sizeof *seeds; k++) {
        snprintf(path, sizeof path, "%s/reader/%s", argv[1], seeds[k].name);
        pack(path, seeds[k].w, seeds[k].h, seeds[k].mode, seeds[k].codec, seeds[k].error, seeds[k].voids);
        if (seeds[k].w > 16 && seeds[k].w < 256)
            split(argv[1], path, seeds[k].name);
    }
    return 0;
}

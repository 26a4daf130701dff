/* make_corpus.c - the seeds of the fuzzers: make_corpus FOLDER. Tiny terrains and planets packed in every mode, whole
 * for fuzz_reader, of all versions of the format, and by parts for fuzz_tile. Linked with no_crc.c. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "common/chart/atlas.h"
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
    double rough = (double)(((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u) % 1000u) / 100;
    return (float)rint(500 + 80 * sin(0.2 * (double)x) * cos(0.13 * (double)y) + rough);
}

/* A terrain to be packed. */
typedef struct seed {
    const char *name;
    int64_t w, h;
    tc_pack_mode mode;
    tc_pack_codec codec;
    double error;
    enum { WHOLE, VOIDS, NOISE } kind;
    bool planet, fit;
    const char *atlas; /* NULL: the planet's own */
    double flattening;
} seed;

static tc_pack_terrain terrain_of(const seed *s)
{
    tc_pack_terrain t = {.width = s->w, .height = s->h, .spacing_x = 10, .spacing_y = 10, .unit = 1};
    t.sample_type = s->kind == VOIDS ? TC_SAMPLE_FLOAT32 : TC_SAMPLE_INT16;
    t.georef.crs_wkt = s->kind == VOIDS ? (char *)"LOCAL_CS[\"x\"]" : NULL;
    if (s->planet) {
        double dx = 360.0 / (double)s->w, dy = 180.0 / (double)s->h;
        t.radius = 6371000, t.flattening = s->flattening, t.wraps_x = true;
        t.georef.known = t.georef.geographic = true;
        memcpy(t.georef.transform, (double[]){-180, dx, 0, 90, 0, -dy}, sizeof t.georef.transform);
    }
    return t;
}

static void pack(const char *path, const seed *s)
{
    tc_pack_terrain t = terrain_of(s);
    tc_pack_options o = {.mode = s->mode,
                         .codec = s->codec,
                         .error = s->error,
                         .threads = 1,
                         .synthesis_fit = s->fit,
                         .atlas = s->atlas};
    float *z = malloc((size_t)(s->w * s->h) * sizeof *z);
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error why;
    for (int64_t i = 0; i < s->w * s->h; i++) {
        int64_t x = i % s->w, y = i / s->w;
        bool is_void = s->kind == VOIDS && (hypot((double)x - 20, (double)y - 11) < 9 || (x + 3 * y) % 61 == 0);
        uint32_t random = (uint32_t)i * 2654435761u;
        z[i] = is_void ? NAN : s->kind == NOISE ? (float)((random ^ random >> 15) * 2246822519u >> 24) : height(x, y);
    }
    if (tc_packer_create(path, &t, &o, &packer, &why) ||
        tc_packer_put(packer, (tc_rect){0, 0, s->w, s->h}, z, NULL, s->w, &why) ||
        tc_packer_finish(packer, &result, &why))
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

/* ---- Older versions ---------------------------------------------------------------------------------------------- */

static uint8_t *read_file(const char *path, size_t *size_ret)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = malloc(1 << 20);
    size_t size = file && bytes ? fread(bytes, 1, 1 << 20, file) : 0;
    if (!size || size == 1 << 20)
        stop(path);
    fclose(file);
    *size_ret = size;
    return bytes;
}

typedef struct memory {
    const uint8_t *bytes;
} memory;

static tc_status read_memory(void *context, int64_t offset, void *bytes, size_t size)
{
    memcpy(bytes, ((const memory *)context)->bytes + offset, size);
    return TC_OK;
}

/* A level of so few tiles that all are of one page, which says nothing of steps. */
static void put_level(tc_packed_file *f, int l, const uint8_t *bytes, tc_byte_writer *w)
{
    const tc_level_record *r = &f->container.record[l - 1];
    tc_pages pages = tc_level_pages(&f->container.level[l - 1]);
    if (pages.pages_x * pages.pages_y != 1)
        stop("expected one page");
    tc_tile_entry entry[TC_PAGE_TILES];
    uint8_t page[TC_PAGE_TILES * 128];
    int count = (int)(pages.tiles_x * pages.tiles_y);
    for (int n = 0; n < count; n++)
        if (tc_packed_file_entry(f, l, n % pages.tiles_x, n / pages.tiles_x, &entry[n]))
            stop("no entry");
    size_t size = tc_page_write(tc_level_form(r, false), entry, count, page), directory = w->size;
    tc_put(w, (uint64_t)tc_directory_bytes(&pages), 8), tc_put(w, size, 4), tc_put(w, 0, 4), tc_put(w, 0, 4);
    if (w->size - directory != (size_t)tc_directory_bytes(&pages))
        stop("expected a directory of one entry");
    tc_put_bytes(w, page, size);
    for (int n = 0; n < count; n++)
        tc_put_bytes(w, bytes + entry[n].offset, tc_tile_bytes(&entry[n]));
}

/* The container of a chart of a file of version 3, as one of its own, with containers of caps behind it. */
static void put_chart(const uint8_t *bytes, size_t size, int chart, const tc_byte_writer cap[TC_CAP_CHARTS],
                      tc_byte_writer *w)
{
    memory m = {bytes};
    tc_byte_source source = {&m, (int64_t)size, read_memory, NULL};
    tc_packed_file f;
    if (tc_packed_file_open_bytes("seed", &source, chart, &f, NULL))
        stop("a seed cannot be opened");
    tc_container c = f.container; /* what it owns is the file's */
    tc_byte_writer head = {0}, body = {0};
    c.info.charts = chart == 0 ? c.info.charts : 1;
    for (int n = 0; n < c.info.charts - 1; n++)
        c.cap_bytes[n] = (int64_t)cap[n].size;
    for (int pass = 0; pass < 2; pass++) {
        int64_t before = (int64_t)head.size;
        head.size = body.size = 0;
        for (int l = c.base + 1; l <= c.levels; l++) {
            c.record[l - 1].begin = before + (int64_t)body.size;
            put_level(&f, l, bytes, &body);
            c.record[l - 1].end = before + (int64_t)body.size;
        }
        c.info.bytes = before + (int64_t)body.size + c.cap_bytes[0] + c.cap_bytes[1];
        if (tc_container_write(&c, &head))
            stop("a head cannot be written");
    }
    tc_put_bytes(w, head.bytes, head.size), tc_put_bytes(w, body.bytes, body.size);
    for (int n = 0; n < c.info.charts - 1; n++)
        tc_put_bytes(w, cap[n].bytes, cap[n].size);
    free(head.bytes), free(body.bytes);
    tc_packed_file_close(&f);
}

/* What a program of version 1 or 2 would have written of the same tiles. */
static void write_older(const char *path, const char *older, const seed *s)
{
    size_t size;
    uint8_t *bytes = read_file(path, &size);
    tc_byte_writer w = {0}, cap[TC_CAP_CHARTS] = {{0}, {0}};
    for (int n = 0; n < TC_CAP_CHARTS && s->planet; n++)
        put_chart(bytes, size, 1 + n, NULL, &cap[n]);
    put_chart(bytes, size, 0, cap, &w);
    write_file(older, w.bytes, w.size);
    free(w.bytes), free(cap[0].bytes), free(cap[1].bytes), free(bytes);
}

/* A seed reads, all of it, as what it shall be. */
static void check(const char *path, int version, int charts)
{
    tc_map *map;
    if (tc_map_open(path, NULL, &map, NULL) || tc_map_charts(map) != charts)
        stop(path);
    for (int n = 0; n < charts; n++) {
        const tc_field *field = tc_map_field(map, n);
        const tc_level level = tc_field_level(field, tc_field_info(field)->levels);
        float *z = malloc((size_t)(level.width * level.height) * sizeof *z);
        const tc_packed_info *info = tc_field_packed_info(field);
        if (info->cut_short || info->levels_missing || (n == 0 && info->version != version) || !z ||
            tc_field_read(field, tc_field_info(field)->levels, (tc_rect){0, 0, level.width, level.height}, z, NULL,
                          level.width) ||
            tc_field_tell(field).damaged)
            stop(path);
        free(z);
    }
    tc_map_destroy(map);
}

/* ---- Parts ------------------------------------------------------------------------------------------------------- */

static void split(const char *folder, const char *path, const char *name)
{
    tc_packed_file f;
    char part[128];
    if (tc_packed_file_open(path, &f, NULL))
        stop(path);
    const tc_container *c = &f.container;
    int m = c->levels;
    const tc_level_record *r = &c->record[m - 1];
    size_t all;
    uint8_t *bytes = read_file(path, &all);
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
    static const seed seeds[] = {
        {"rms", 40, 33, TC_PACK_RMS, TC_CODEC_LIFTING, 1.5, WHOLE, false},
        {"rms-voids", 60, 21, TC_PACK_RMS, TC_CODEC_LIFTING, 3, VOIDS, false},
        {"bound", 37, 40, TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 30, WHOLE, false},
        {"bound-voids", 33, 34, TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 12, VOIDS, false},
        {"lossless", 23, 18, TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, WHOLE, false},
        {"lossless-voids", 31, 22, TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, VOIDS, false},
        {"lh04", 41, 38, TC_PACK_RMS, TC_CODEC_LH04, 2, WHOLE, false},
        {"lh04-voids", 33, 20, TC_PACK_RMS, TC_CODEC_LH04, 4, VOIDS, false},
        {"base", 5, 16, TC_PACK_RMS, TC_CODEC_LIFTING, 1, VOIDS, false},
        {"tiles", 300, 20, TC_PACK_RMS, TC_CODEC_LIFTING, 8, VOIDS, false},
        {"raw", 24, 18, TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, NOISE, false},
        {"raw-tiles", 258, 3, TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, NOISE, false},
        {"planet", 80, 42, TC_PACK_RMS, TC_CODEC_LIFTING, 9, VOIDS, true},
        {"planet-bound", 80, 42, TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 30, WHOLE, true},
        {"planet-lossless", 36, 20, TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, VOIDS, true},
        {"planet-lh04", 66, 41, TC_PACK_RMS, TC_CODEC_LH04, 20, WHOLE, true},
        {"fit", 140, 131, TC_PACK_RMS, TC_CODEC_LIFTING, 40, WHOLE, false, true},
        {"planet-fit", 80, 42, TC_PACK_RMS, TC_CODEC_LIFTING, 30, WHOLE, true, true},
        {"faces-hex", 96, 48, TC_PACK_RMS, TC_CODEC_LIFTING, 9, WHOLE, true, false, "hex"},
        {"faces-cube", 72, 36, TC_PACK_RMS, TC_CODEC_LIFTING, 9, VOIDS, true, false, "cube"},
        {"faces-fit", 80, 40, TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 30, WHOLE, true, true, "hex"},
        {"planet-flattened", 66, 41, TC_PACK_RMS, TC_CODEC_LIFTING, 30, WHOLE, true, false, NULL, 0.1},
    };
    if (argc != 2)
        stop("expected a folder");
    char path[512], older[512];
    const char *const folders[] = {"reader", "tile"};
    for (int k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%s/%s", argv[1], folders[k]);
        mkdir(path, 0777);
    }
    for (size_t k = 0; k < sizeof seeds / sizeof *seeds; k++) {
        const seed *s = &seeds[k];
        snprintf(path, sizeof path, "%s/reader/%s", argv[1], s->name);
        pack(path, s);
        check(path, 3, s->atlas ? tc_atlas_named(s->atlas)->charts : s->planet ? 3 : 1);
        snprintf(older, sizeof older, "%s/reader/v%d-%s", argv[1], s->planet ? 2 : 1, s->name);
        /* Those versions have no raw tiles, and corrections that are no longer written: their seeds (and those of
         * tiles, corrections*) are kept as they are. */
        if (s->fit || s->atlas) /* in newer heads alone */
            continue;
        if (s->kind != NOISE && s->mode != TC_PACK_MAX_ERROR) {
            write_older(path, older, s);
            check(older, s->planet ? 2 : 1, s->planet ? 3 : 1);
        }
        if (s->w > 16 && s->w < 256)
            split(argv[1], path, s->name);
    }
    return 0;
}

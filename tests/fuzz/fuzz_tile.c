/* fuzz_tile.c - the decoders of parts, given arbitrary bytes: models and tiles of all coders, corrections, masks of
 * voids, index pages, heads. The input:
 *
 *     kind | width | height | tile | seed of the coarser level | bytes of the model, 2 | model | the tile's bytes */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/packed/file/level_coder.h"
#include "fuzz_tile.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void expect(int good, const char *what)
{
    if (!good) {
        fprintf(stderr, "fuzz_tile: %s\n", what);
        abort();
    }
}

static void *get(size_t bytes)
{
    void *p = malloc(bytes + 1);
    expect(p != NULL, "no memory");
    return p;
}

/* A plane of something that goes up and down, from seed 0, flat, to heights at the limit. */
static tc_plane coarse_plane(tc_rect rect, unsigned seed)
{
    size_t samples = (size_t)tc_rect_area(rect);
    tc_plane p = {get(samples * sizeof *p.z), rect.x1 - rect.x0, rect};
    uint32_t state = seed + 1, scale = seed % 16 ? 1u << (seed % 16 + 9) : 0;
    for (size_t i = 0; i < samples; i++) {
        state = state * 1664525 + 1013904223;
        int64_t z = scale ? (int64_t)(state >> 8) % scale - scale / 2 + (seed & 64 ? TC_LIFTING_LIMIT / 2 : 0) : 1000;
        p.z[i] = (int32_t)tc_clamp64(z, -TC_LIFTING_LIMIT, TC_LIFTING_LIMIT);
    }
    return p;
}

/* A tile of a level, read as the pyramid does, and what it must come to where it is found damaged. */
static void decode_tile(const fuzz_tile *f)
{
    tc_lifting_level size = {f->width, f->height, false};
    tc_level_record record = {.coder = (tc_coder)f->kind,
                              .correction_step = 3 + f->seed,
                              .correction_snap = 1 + f->seed % 3,
                              .model = (uint8_t *)f->model,
                              .model_size = f->model_size};
    tc_level_coder coder = {0};
    if (!tc_level_coder_init(&coder, &size, &record)) {
        int64_t tiles_x = (size.width + TC_TILE_SIDE - 1) / TC_TILE_SIDE,
                tiles_y = (size.height + TC_TILE_SIDE - 1) / TC_TILE_SIDE;
        int64_t tx = f->tile % tiles_x, ty = f->tile / tiles_x % tiles_y;
        tc_tile_entry entry = {.size = {(uint32_t)f->size}};
        if (tc_coder_corrects((tc_coder)f->kind)) {
            entry.size[1] = (uint32_t)(f->size / 3);
            entry.size[0] -= entry.size[1];
        }
        tc_plane coarse = coarse_plane(tc_level_coder_needs(&coder, tx, ty), f->seed);
        tc_decoded_tile *tile = get(tc_decoded_tile_bytes(coder.coder)), *empty = get(sizeof *empty);
        tc_decoded_tile *twin = get(tc_decoded_tile_bytes(coder.coder)), *other = get(sizeof *other);
        void *work = get(tc_level_coder_work_bytes()), *more = get(tc_level_coder_work_bytes());
        tc_level_tile one = {.tx = tx, .ty = ty, .entry = entry, .bytes = f->bytes, .to = tile, .work = work};
        tc_level_tile none = {.tx = tx, .ty = ty, .entry = entry, .to = empty, .work = work};
        tc_level_coder_decode(&coder, &one, 1, &coarse);
        tc_level_coder_decode(&coder, &none, 1, &coarse);
        tc_status status = one.status;
        expect(!status || status == TC_ERR_FORMAT, "another status than FORMAT");
        expect(none.status == TC_ERR_FORMAT, "a tile without bytes is whole");
        tc_level_tile pair[2] = {one, one};
        pair[0].to = twin, pair[1].to = other, pair[1].work = more;
        tc_level_coder_decode(&coder, pair, 2, &coarse);
        expect(pair[0].status == status && pair[1].status == status, "two at a time come to another status");
        if (coder.codec) {
            tc_rect r = tc_level_coder_positions(&coder, tx, ty);
            for (int64_t y = 0; y < r.y1 - r.y0; y++)
                for (int b = 0; b < TC_BANDS; b++) {
                    size_t bytes = (size_t)(r.x1 - r.x0) * sizeof(int32_t);
                    expect(!memcmp(tile->band[b][y], twin->band[b][y], bytes) &&
                               !memcmp(tile->band[b][y], other->band[b][y], bytes),
                           "two at a time come to other heights");
                }
        }
        if (status) {
            tc_rect r = tc_level_coder_positions(&coder, tx, ty), s = tc_level_coder_samples(&coder, tx, ty);
            for (int64_t y = 0; y < r.y1 - r.y0 && coder.codec; y++)
                for (int b = 0; b < TC_BANDS; b++)
                    expect(!memcmp(tile->band[b][y], empty->band[b][y], (size_t)(r.x1 - r.x0) * sizeof(int32_t)),
                           "a damaged tile adds something");
            for (int64_t y = 0; y < s.y1 - s.y0 && !coder.codec; y++)
                expect(!memcmp(tile->sample[y], empty->sample[y], (size_t)(s.x1 - s.x0) * sizeof(int32_t)),
                       "a damaged tile adds something");
        }
        free(coarse.z), free(tile), free(empty), free(twin), free(other), free(work), free(more);
    }
    tc_level_coder_free(&coder);
}

static void decode_mask(const fuzz_tile *f)
{
    tc_lifting_level level = {f->width, f->height, false};
    int64_t tiles_x = (level.width + TC_TILE_SIDE - 1) / TC_TILE_SIDE,
            tiles_y = (level.height + TC_TILE_SIDE - 1) / TC_TILE_SIDE;
    tc_rect r = tc_mask_tile_rect(&level, f->tile % tiles_x, f->tile / tiles_x % tiles_y, 0);
    tc_rect need = tc_mask_tile_needs(&level, r);
    tc_mask_plane coarse = {get((size_t)tc_rect_area(need)), need.x1 - need.x0, need};
    for (int64_t i = 0; i < tc_rect_area(need); i++)
        coarse.v[i] = f->model_size ? f->model[(size_t)i / 8 % f->model_size] >> i % 8 & 1 : f->seed & 1;
    tc_mask_plane fine = {get((size_t)tc_rect_area(r)), r.x1 - r.x0, r};
    tc_status status = tc_mask_decode(&level, r, (tc_mask_class)(f->seed % 3), &coarse, f->bytes, f->size, &fine);
    expect(!status || status == TC_ERR_FORMAT, "another status than FORMAT");
    for (int64_t i = 0; i < tc_rect_area(r); i++)
        expect(fine.v[i] <= 1, "no mask");
    free(coarse.v), free(fine.v);
}

static void read_page(const fuzz_tile *f)
{
    int count = 1 + (f->width + f->tile) % TC_PAGE_TILES;
    tc_page_form form = {f->seed & 1, f->seed & 2, f->seed & 4, f->seed & 8};
    tc_tile_entry *entry = get((size_t)count * sizeof *entry), *again = get((size_t)count * sizeof *again);
    if (!tc_page_read(form, f->bytes, f->size, entry, count)) {
        uint8_t *bytes = get(tc_page_bound());
        for (int i = 0; i < count; i++)
            expect(entry[i].low <= entry[i].high && entry[i].mask_class <= TC_MASK_CODED, "nonsense in a page");
        size_t size = tc_page_write(form, entry, count, bytes);
        expect(size <= tc_page_bound() && !tc_page_read(form, bytes, size, again, count), "a page cannot be written");
        for (int i = 0; i < count; i++)
            expect(!memcmp(entry[i].size, again[i].size, sizeof entry->size) && entry[i].crc == again[i].crc &&
                       entry[i].mask_class == again[i].mask_class && again[i].low <= entry[i].low &&
                       again[i].high >= entry[i].high,
                   "a page written again is another");
        free(bytes);
    }
    free(entry), free(again);
}

/* The head of a file of version 3 that is read comes out as one that can be read, and lays its levels out as they are.
 */
static void read_envelope(const fuzz_tile *f)
{
    tc_envelope *e, *again = NULL;
    size_t needed = 0;
    if (tc_envelope_read("fuzz", f->bytes, f->size, &e, &needed, NULL))
        return;
    expect(e->charts >= 1 && e->charts <= TC_MOST_CHARTS && e->rank_end[0] <= e->bytes, "nonsense in a head");
    tc_byte_writer w = {0};
    expect(!tc_envelope_write(e, &w), "a head cannot be written");
    /* Sloppily written base levels and sections that were skipped make it shorter the second time. */
    expect(w.size != needed || !tc_envelope_read("fuzz", w.bytes, w.size, &again, &needed, NULL),
           "a head written again cannot be read");
    tc_envelope_free(again);
    tc_envelope_free(e);
    free(w.bytes);
}

/* A head that is read comes out the same when written. */
static void read_head(const fuzz_tile *f)
{
    if (f->size >= TC_HEAD_FIXED && tc_envelope_is(f->bytes)) {
        read_envelope(f);
        return;
    }
    tc_container c;
    size_t needed = 0;
    if (tc_container_read("fuzz", f->bytes, f->size, &c, &needed, NULL))
        return;
    tc_byte_writer w = {0};
    expect(!tc_container_write(&c, &w), "a head cannot be written");
    tc_container again;
    tc_status status = tc_container_read("fuzz", w.bytes, w.size, &again, &needed, NULL);
    /* A sloppily written base level can be shorter the second time; then what lies behind moves. */
    expect(w.size != needed || status == TC_OK || c.record[c.base].begin != (int64_t)w.size,
           "a head written again cannot be read");
    if (!status)
        tc_container_free(&again);
    tc_container_free(&c);
    free(w.bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_tile f;
    if (!fuzz_tile_read(data, size, &f))
        return 0;
    switch (f.kind) {
    case FUZZ_MASK: decode_mask(&f); break;
    case FUZZ_PAGE: read_page(&f); break;
    case FUZZ_HEAD: read_head(&f); break;
    default: decode_tile(&f); break;
    }
    return 0;
}

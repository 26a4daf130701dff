/* containers.c - heads of packed files made up. */
#include "containers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/crc32c.h"

/* All but the terrain and the charts. */
static void fill(tc_container *c, test_random *r)
{
    size_t length = (size_t)test_random_int(r, 0, 40000);
    if (length && (c->info.terrain.georef.crs_wkt = calloc(length + 1, 1)))
        memset(c->info.terrain.georef.crs_wkt, 'x', length);
    c->z_unit = exp2((double)test_random_int(r, -12, 5)), c->z_origin = test_random_range(r, -1e5, 1e5);
    c->z_min = -17.25, c->z_max = 1e4, c->info.mean = 3, c->info.deviation = 4;
    c->voids = test_random_int(r, 0, c->info.terrain.width * c->info.terrain.height - 1);
    tc_container_set_levels(c);
    const tc_level *base = &c->level[c->base - 1];
    int32_t most = test_random_int(r, 0, 1) ? TC_LIFTING_LIMIT : 100;
    for (int64_t i = 0; i < base->width * base->height; i++) {
        c->base_z[i] = (int32_t)test_random_int(r, -most, most);
        c->base_void[i] = c->voids > 0 && test_random_int(r, 0, 1);
    }
    for (int l = c->base; l < c->levels; l++) {
        tc_level_record *record = &c->record[l];
        *record = (tc_level_record){.coder = (tc_coder)test_random_int(r, 0, TC_CODERS - 1)};
        record->mask = test_random_int(r, 0, 1), record->lowest = (int32_t)test_random_int(r, -9000, 0);
        record->highest = (int32_t)test_random_int(r, 0, 9000), record->rms = (float)test_random_unit(r);
        record->max_error = (float)test_random_unit(r), record->residual_variance = (float)test_random_unit(r);
        record->correction_snap = (int32_t)test_random_int(r, 1, 9);
        record->correction_step = (int32_t)test_random_int(r, 1, 99);
        record->model_size = (size_t)test_random_int(r, 0, 3000);
        record->model = calloc(record->model_size + 1, 1);
        if (!record->model)
            exit(99);
        for (size_t i = 0; i < record->model_size; i++)
            record->model[i] = (uint8_t)test_random_bits(r);
    }
    tc_byte_writer w = {0};
    if (tc_container_write(c, &w))
        exit(99);
    int64_t at = (int64_t)w.size;
    for (int l = c->base; l < c->levels; l++) {
        tc_pages pages = tc_level_pages(&c->level[l]);
        c->record[l].begin = at;
        c->record[l].end = at += tc_directory_bytes(&pages) + test_random_int(r, 0, 1000);
    }
    c->info.bytes = at + c->cap_bytes[0] + c->cap_bytes[1];
    free(w.bytes);
}

tc_container container_make(test_random *r)
{
    tc_container c = {0};
    tc_pack_terrain *t = &c.info.terrain;
    c.info.mode = (tc_pack_mode)test_random_int(r, 0, 2), c.info.codec = (tc_pack_codec)test_random_int(r, 0, 1);
    c.info.error = test_random_unit(r);
    *t = (tc_pack_terrain){.width = test_random_int(r, 1, 3000), .height = test_random_int(r, 1, 3000)};
    t->spacing_x = test_random_range(r, 0.1, 90), t->spacing_y = test_random_range(r, 0.1, 90);
    t->z_base = test_random_range(r, -1e6, 1e6), t->sample_type = (tc_sample_type)test_random_int(r, 0, 7);
    t->area_registered = test_random_int(r, 0, 1), t->unit = test_random_range(r, 0.01, 3);
    t->offset = test_random_range(r, -100, 100), t->has_nodata = test_random_int(r, 0, 1);
    t->nodata = test_random_int(r, 0, 1) ? NAN : -32768, t->voids = (tc_void_policy)test_random_int(r, 0, 2);
    t->void_constant = test_random_range(r, -9, 9), t->georef.known = test_random_int(r, 0, 1);
    t->georef.geographic = test_random_int(r, 0, 1), t->georef.semi_major = test_random_range(r, 0, 7e6);
    for (int i = 0; i < 6; i++)
        t->georef.transform[i] = test_random_range(r, -1e6, 1e6);
    t->wraps_x = test_random_int(r, 0, 1);
    if (test_random_int(r, 0, 1)) { /* a planet, with caps or none */
        t->height += 3;
        double dx = 360.0 / (double)t->width, dy = 180.0 / (double)t->height;
        const double transform[6] = {-180, dx, 0, 90, 0, -dy};
        memcpy(t->georef.transform, transform, sizeof transform);
        t->wraps_x = t->georef.known = t->georef.geographic = true;
        t->radius = 1 + 1e7 * test_random_unit(r);
        c.info.charts = test_random_int(r, 0, 1) ? 3 : 1;
        for (int k = 0; k < c.info.charts - 1; k++)
            c.cap_bytes[k] = test_random_int(r, 20, 1 << 30);
    }
    fill(&c, r);
    return c;
}

tc_container container_make_cap(test_random *r, int64_t side, double z_base)
{
    tc_container c = {.info = {.charts = 1, .mode = TC_PACK_RMS, .error = 1}};
    c.info.terrain = (tc_pack_terrain){
        .width = side, .height = side, .spacing_x = 9, .spacing_y = 9, .z_base = z_base, .unit = 1, .sample_type = 3};
    fill(&c, r);
    return c;
}

/* ---- Envelopes --------------------------------------------------------------------------------------------------- */

enum { HEAD_AT = 31, ROW = 154, CHARTS_AT = 28, SECTIONS_AT = 29, CRC_AT = 16 };

size_t envelope_row_at(int chart)
{
    return HEAD_AT + (size_t)chart * ROW;
}

size_t envelope_head_at(const uint8_t *bytes, int chart)
{
    size_t at = envelope_row_at((int)bytes[CHARTS_AT]);
    for (uint64_t n = tc_load(bytes + SECTIONS_AT, 2); n > 0; n--)
        at += 8 + tc_load(bytes + at + 4, 4);
    for (int n = 0; n < chart; n++)
        at += tc_load(bytes + envelope_row_at(n) + ROW - 4, 4);
    return at;
}

static void sign(uint8_t *head)
{
    memset(head + CRC_AT, 0, 4);
    tc_store(head + CRC_AT, tc_crc32c(0, head, (size_t)tc_load(head + TC_HEAD_SIZE_AT, 4)), 4);
}

void envelope_sign(uint8_t *bytes)
{
    for (int n = 0; n < bytes[CHARTS_AT]; n++)
        sign(bytes + envelope_head_at(bytes, n));
    sign(bytes);
}

tc_byte_writer envelope_bytes(tc_envelope *e, bool lay_out)
{
    tc_byte_writer w = {0};
    tc_envelope_place(e);
    if (tc_envelope_write(e, &w))
        exit(99);
    if (lay_out) {
        tc_envelope_lay_out(e, w.size);
        w.size = 0;
        if (tc_envelope_write(e, &w))
            exit(99);
    }
    return w;
}

tc_byte_writer envelope_of_one(const tc_container *c, bool lay_out)
{
    tc_envelope *e = calloc(1, sizeof *e);
    if (!e)
        exit(99);
    e->charts = 1, e->chart[0].container = *c, e->bytes = c->info.bytes;
    e->errors = c->errors && !lay_out; /* which stand behind the last level, where it is */
    tc_byte_writer w = envelope_bytes(e, lay_out);
    free(e);
    return w;
}

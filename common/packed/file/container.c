/* container.c - the head of a packed file, to and from bytes. docs/format.md is the specification. */
#include "container.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

#include "common/base/crc32c.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/base/wkt.h"
#include "common/codec/entropy/binary_coder.h"

enum { MOST_MODEL = UINT16_MAX };

void tc_container_set_levels(tc_container *c)
{
    tc_field p = {0};
    const tc_pack_terrain *t = &c->info.terrain;
    tc_field_set_levels(&p, (tc_level){t->width, t->height, t->spacing_x, t->spacing_y});
    c->levels = p.info.levels;
    memcpy(c->level, p.level, sizeof c->level);
    c->base = 1;
    while (c->base < c->levels && tc_max64(c->level[c->base].width, c->level[c->base].height) <= TC_BASE_SIZE)
        c->base++;
    /* A level wraps as long as the halvings on the way to it left no odd column over. */
    c->wraps_from = c->levels + 1;
    for (int k = 0; t->wraps_x && k < c->levels && t->width % ((int64_t)1 << k) == 0; k++)
        c->wraps_from = c->levels - k;
}

tc_lifting_level tc_container_lifting(const tc_container *c, int l)
{
    return (tc_lifting_level){c->level[l - 1].width, c->level[l - 1].height, l - 1 >= c->wraps_from};
}

int64_t tc_container_cap_begin(const tc_container *c, int n)
{
    int64_t at = c->info.bytes;
    for (int k = n; k < TC_CAP_CHARTS; k++)
        at -= c->cap_bytes[k];
    return at;
}

bool tc_terrain_globe(const tc_pack_terrain *t, tc_lonlat *globe_ret)
{
    tc_lonlat globe;
    if (!tc_lonlat_of(&t->georef, t->width, t->height, &globe) || !globe.within)
        return false;
    globe.poles &= t->height >= TC_LEAST_CAP_ROWS;
    tc_lonlat_close(&globe);
    *globe_ret = globe;
    return true;
}

void tc_container_free(tc_container *c)
{
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        free(c->record[l].model);
    free(c->info.terrain.georef.crs_wkt);
    free(c->info.terrain.credits);
    free(c->synthesis);
    memset(c, 0, sizeof *c);
}

static int64_t ceil_div(int64_t a, int64_t b)
{
    return (a + b - 1) / b;
}

tc_pages tc_level_pages(const tc_level *level)
{
    tc_pages p = {ceil_div(level->width, 2 * TC_TILE), ceil_div(level->height, 2 * TC_TILE), 0, 0};
    p.pages_x = ceil_div(p.tiles_x, TC_PAGE_COLUMNS), p.pages_y = ceil_div(p.tiles_y, TC_PAGE_ROWS);
    return p;
}

int64_t tc_directory_bytes(const tc_pages *p)
{
    int64_t entries = p->pages_x * p->pages_y;
    return entries * TC_DIRECTORY_ENTRY + 4 * ceil_div(entries, TC_DIRECTORY_CHUNK);
}

void tc_directory_put(uint8_t *directory, int64_t number, uint64_t offset, size_t size, uint32_t crc)
{
    uint8_t *entry = directory + tc_directory_chunk_offset(number / TC_DIRECTORY_CHUNK) +
                     number % TC_DIRECTORY_CHUNK * TC_DIRECTORY_ENTRY;
    tc_store(entry, offset, 8), tc_store(entry + 8, size, 4), tc_store(entry + 12, crc, 4);
}

void tc_directory_seal(uint8_t *directory, int64_t count)
{
    for (int64_t first = 0, chunk = 0; first < count; first += TC_DIRECTORY_CHUNK, chunk++) {
        uint8_t *bytes = directory + tc_directory_chunk_offset(chunk);
        const size_t size = (size_t)tc_min64(count - first, TC_DIRECTORY_CHUNK) * TC_DIRECTORY_ENTRY;
        tc_store(bytes + size, tc_crc32c(0, bytes, size), 4);
    }
}

tc_rect tc_page_tiles(const tc_pages *p, int64_t px, int64_t py)
{
    return (tc_rect){px * TC_PAGE_COLUMNS, py * TC_PAGE_ROWS, tc_min64((px + 1) * TC_PAGE_COLUMNS, p->tiles_x),
                     tc_min64((py + 1) * TC_PAGE_ROWS, p->tiles_y)};
}

/* ---- Base level ---------------------------------------------------------------------------------------------- */

enum { BASE_ROOM = TC_BASE_SIZE * TC_BASE_SIZE * 12 + 64 };

/* The sample to the left, below where there is none, 0 for the first. */
static int32_t base_guess(const tc_container *c, int64_t w, int64_t i, int64_t j)
{
    return i > 0 ? c->base_z[j * w + i - 1] : j > 0 ? c->base_z[(j - 1) * w] : 0;
}

static void write_base(const tc_container *c, tc_byte_writer *w)
{
    uint8_t bytes[BASE_ROOM];
    tc_bit_encoder e;
    tc_number_model model;
    tc_number_reset(&model);
    tc_bit_encode_begin(&e, bytes, sizeof bytes);
    int64_t width = c->level[c->base - 1].width, height = c->level[c->base - 1].height;
    for (int64_t j = 0; j < height; j++)
        for (int64_t i = 0; i < width; i++)
            tc_number_encode(&e, &model, tc_zigzag(c->base_z[j * width + i] - base_guess(c, width, i, j)));
    for (int64_t k = 0; k < width * height && c->voids > 0; k++)
        tc_bit_encode_raw(&e, c->base_void[k], 1);
    size_t size = tc_bit_encode_end(&e);
    tc_put(w, size, 2);
    tc_put_bytes(w, bytes, size);
}

static bool read_base(tc_container *c, tc_byte_reader *r)
{
    size_t size = (size_t)tc_get(r, 2);
    const uint8_t *bytes = tc_get_bytes(r, size);
    if (!bytes)
        return false;
    tc_bit_decoder d;
    tc_number_model model;
    tc_number_reset(&model);
    tc_bit_decode_begin(&d, bytes, size);
    int64_t width = c->level[c->base - 1].width, height = c->level[c->base - 1].height;
    for (int64_t j = 0; j < height; j++)
        for (int64_t i = 0; i < width; i++) {
            int64_t z = (int64_t)base_guess(c, width, i, j) + tc_unzigzag(tc_number_decode(&d, &model));
            if (z < -TC_LIFTING_LIMIT || z > TC_LIFTING_LIMIT)
                return false;
            c->base_z[j * width + i] = (int32_t)z;
        }
    for (int64_t k = 0; k < width * height && c->voids > 0; k++)
        c->base_void[k] = (uint8_t)tc_bit_decode_raw(&d, 1);
    return tc_bit_decode_end(&d);
}

/* ---- Head ---------------------------------------------------------------------------------------------------- */

static void write_terrain(const tc_pack_terrain *t, tc_byte_writer *w)
{
    tc_put(w, (uint64_t)t->width, 8), tc_put(w, (uint64_t)t->height, 8);
    tc_put_f64(w, t->spacing_x), tc_put_f64(w, t->spacing_y), tc_put_f64(w, t->z_base);
    tc_put(w, t->sample_type, 1), tc_put(w, t->area_registered, 1);
    tc_put_f64(w, t->unit), tc_put_f64(w, t->offset);
    tc_put(w, t->has_nodata, 1), tc_put_f64(w, t->nodata);
    tc_put(w, t->voids, 1), tc_put_f64(w, t->void_constant);
    tc_put(w, t->georef.known, 1), tc_put(w, t->georef.geographic, 1);
    for (int i = 0; i < 6; i++)
        tc_put_f64(w, t->georef.transform[i]);
    tc_put_f64(w, t->georef.semi_major);
    size_t length = t->georef.crs_wkt ? strlen(t->georef.crs_wkt) : 0;
    tc_put(w, length, 4);
    tc_put_bytes(w, t->georef.crs_wkt, length);
}

static bool positive(double v)
{
    return isfinite(v) && v > 0;
}

/* A byte that stands for one of `count` things. */
static unsigned get_choice(tc_byte_reader *r, unsigned count, bool *bad)
{
    unsigned v = (unsigned)tc_get(r, 1);
    *bad |= v >= count;
    return v < count ? v : 0;
}

/* TC_ERR_FORMAT, TC_ERR_MEMORY: so do all that read a part of the head and allocate. */
static tc_status read_terrain(tc_pack_terrain *t, tc_byte_reader *r)
{
    bool bad = false;
    t->width = (int64_t)tc_get(r, 8), t->height = (int64_t)tc_get(r, 8);
    t->spacing_x = tc_get_f64(r), t->spacing_y = tc_get_f64(r), t->z_base = tc_get_f64(r);
    t->sample_type = (tc_sample_type)get_choice(r, TC_SAMPLE_FLOAT64 + 1, &bad);
    t->area_registered = get_choice(r, 2, &bad);
    t->unit = tc_get_f64(r), t->offset = tc_get_f64(r);
    t->has_nodata = get_choice(r, 2, &bad), t->nodata = tc_get_f64(r);
    t->voids = (tc_void_policy)get_choice(r, TC_VOIDS_CONSTANT + 1, &bad), t->void_constant = tc_get_f64(r);
    t->georef.known = get_choice(r, 2, &bad), t->georef.geographic = get_choice(r, 2, &bad);
    for (int i = 0; i < 6; i++) {
        t->georef.transform[i] = tc_get_f64(r);
        bad |= !isfinite(t->georef.transform[i]);
    }
    t->georef.semi_major = tc_get_f64(r);
    size_t length = (size_t)tc_get(r, 4);
    const uint8_t *wkt = tc_get_bytes(r, length);
    const int64_t most = (int64_t)1 << 40;
    bad |= r->failed || t->width < 1 || t->height < 1 || t->width > most || t->height > most;
    bad |= !positive(t->spacing_x) || !positive(t->spacing_y) || !isfinite(t->z_base);
    bad |= !positive(t->unit) || !isfinite(t->offset) || !isfinite(t->void_constant);
    bad |= !(t->georef.semi_major >= 0 && isfinite(t->georef.semi_major)) || (wkt && memchr(wkt, 0, length));
    if (!bad && length > 0) {
        t->georef.crs_wkt = malloc(length + 1);
        if (!t->georef.crs_wkt)
            return TC_ERR_MEMORY;
        memcpy(t->georef.crs_wkt, wkt, length);
        t->georef.crs_wkt[length] = 0;
        if (t->offset != -t->georef.semi_major) /* radii of which one was taken off are heights above a sphere */
            t->georef.inverse_flattening = tc_wkt_inverse_flattening(t->georef.crs_wkt);
    }
    return bad ? TC_ERR_FORMAT : TC_OK;
}

static void write_record(const tc_level_record *l, tc_byte_writer *w)
{
    tc_put(w, l->coder, 1), tc_put(w, l->mask, 1);
    tc_put(w, (uint64_t)l->begin, 8), tc_put(w, (uint64_t)l->end, 8);
    tc_put(w, (uint32_t)l->lowest, 4), tc_put(w, (uint32_t)l->highest, 4);
    tc_put_f32(w, l->rms), tc_put_f32(w, l->max_error), tc_put_f32(w, l->residual_variance);
    tc_put(w, (uint32_t)l->correction_step, 4), tc_put(w, (uint32_t)l->correction_snap, 4);
    tc_put(w, l->model_size, 2);
    tc_put_bytes(w, l->model, l->model_size);
}

static bool not_negative(double v)
{
    return isfinite(v) && v >= 0;
}

static tc_status read_record(tc_level_record *l, tc_byte_reader *r)
{
    bool bad = false;
    l->coder = (tc_coder)get_choice(r, TC_CODERS, &bad), l->mask = get_choice(r, 2, &bad);
    l->begin = (int64_t)tc_get(r, 8), l->end = (int64_t)tc_get(r, 8);
    l->lowest = (int32_t)(uint32_t)tc_get(r, 4), l->highest = (int32_t)(uint32_t)tc_get(r, 4);
    l->rms = tc_get_f32(r), l->max_error = tc_get_f32(r), l->residual_variance = tc_get_f32(r);
    l->correction_step = (int32_t)(uint32_t)tc_get(r, 4), l->correction_snap = (int32_t)(uint32_t)tc_get(r, 4);
    l->model_size = (size_t)tc_get(r, 2);
    const uint8_t *model = tc_get_bytes(r, l->model_size);
    bad |= r->failed || l->lowest > l->highest || l->correction_step < 0 || l->correction_step > TC_MAX_STEP ||
           l->correction_snap < 0 || l->correction_snap > TC_MAX_STEP;
    bad |= tc_coder_corrects(l->coder) && (l->correction_step < 1 || l->correction_snap < 1);
    bad |= !not_negative(l->rms) || !not_negative(l->max_error) || !not_negative(l->residual_variance);
    bad |= l->lowest < -2 * TC_LIFTING_LIMIT || l->highest > 2 * TC_LIFTING_LIMIT;
    if (bad)
        return TC_ERR_FORMAT;
    if (!(l->model = malloc(l->model_size + 1)))
        return TC_ERR_MEMORY;
    memcpy(l->model, model, l->model_size);
    return TC_OK;
}

static void write_planet(const tc_container *c, tc_byte_writer *w)
{
    tc_put_f64(w, c->info.terrain.radius);
    for (int n = 0; n < c->info.charts - 1; n++)
        tc_put(w, (uint64_t)c->cap_bytes[n], 8);
}

static bool read_planet(tc_container *c, tc_byte_reader *r)
{
    tc_pack_terrain *t = &c->info.terrain;
    tc_lonlat globe;
    t->radius = tc_get_f64(r);
    bool good = positive(t->radius) && tc_terrain_globe(t, &globe) && globe.round == t->wraps_x &&
                (globe.poles || c->info.charts == 1);
    for (int n = 0; n < c->info.charts - 1; n++) {
        uint64_t bytes = tc_get(r, 8);
        good &= bytes >= TC_HEAD_FIXED && bytes <= INT64_MAX;
        c->cap_bytes[n] = good ? (int64_t)bytes : 0;
    }
    return good && !r->failed;
}

/* Older versions can hold what they could all along, and newer ones are for what older readers cannot read. */
static int version_of(const tc_container *c)
{
    return c->info.terrain.wraps_x || c->info.terrain.radius > 0 || c->info.charts > 1 ? 2 : 1;
}

tc_status tc_container_write(const tc_container *c, tc_byte_writer *w)
{
    size_t start = w->size;
    tc_head_begin(w, version_of(c));
    tc_put(w, (uint64_t)c->info.bytes, 8);
    tc_put(w, c->info.terrain.radius > 0, 1), tc_put(w, c->info.charts > 1 ? (uint64_t)c->info.charts : 1, 1);
    tc_put(w, c->info.terrain.wraps_x, 1);
    tc_put(w, c->info.mode, 1), tc_put(w, c->info.codec, 1), tc_put_f64(w, c->info.error);
    write_terrain(&c->info.terrain, w);
    tc_put_f64(w, c->z_unit), tc_put_f64(w, c->z_origin);
    tc_put_f64(w, c->z_min), tc_put_f64(w, c->z_max), tc_put_f64(w, c->info.mean), tc_put_f64(w, c->info.deviation);
    tc_put(w, (uint64_t)c->voids, 8);
    write_base(c, w);
    for (int l = c->base; l < c->levels; l++)
        write_record(&c->record[l], w);
    if (c->info.terrain.radius > 0)
        write_planet(c, w);
    return tc_head_seal(w, start);
}

/* Where the parts lie must make sense before anything trusts it. */
static bool check_layout(const tc_container *c, size_t head)
{
    int64_t at = (int64_t)head;
    for (int l = c->base; l < c->levels; l++) {
        const tc_level_record *r = &c->record[l];
        tc_pages pages = tc_level_pages(&c->level[l]);
        if (r->begin != at || r->end < r->begin || r->end - r->begin < tc_directory_bytes(&pages))
            return false;
        at = r->end;
    }
    for (int n = 0; n < c->info.charts - 1; n++) {
        if (c->cap_bytes[n] > INT64_MAX - at)
            return false;
        at += c->cap_bytes[n];
    }
    return at == c->info.bytes;
}

static bool is_float(double v)
{
    return fabs(v) <= FLT_MAX; /* false for NaN */
}

/* Heights are given as floats; whatever the tiles hold, it is an int32. */
static bool check_heights(const tc_container *c)
{
    const tc_pack_terrain *t = &c->info.terrain;
    return positive(c->z_unit) && is_float(fabs(c->z_origin) + ldexp(c->z_unit, 31)) && is_float(c->z_min) &&
           is_float(c->z_max) && c->z_min <= c->z_max && isfinite(c->info.mean) && not_negative(c->info.deviation) &&
           is_float(t->void_constant - t->z_base);
}

static tc_status read_head(tc_container *c, tc_byte_reader *r, bool *unknown_atlas)
{
    bool bad = false;
    c->info.bytes = (int64_t)tc_get(r, 8);
    uint64_t atlas = tc_get(r, 1), charts = tc_get(r, 1);
    *unknown_atlas = atlas > 1 || (charts != 1 && !(atlas == 1 && charts == 1 + TC_CAP_CHARTS));
    c->info.charts = *unknown_atlas ? 1 : (int)charts;
    c->info.terrain.wraps_x = get_choice(r, 2, &bad);
    c->info.mode = (tc_pack_mode)get_choice(r, TC_PACK_LOSSLESS + 1, &bad);
    c->info.codec = (tc_pack_codec)get_choice(r, TC_CODEC_LH04 + 1, &bad);
    c->info.error = tc_get_f64(r);
    if (bad || *unknown_atlas || !not_negative(c->info.error))
        return TC_ERR_FORMAT;
    tc_status status = read_terrain(&c->info.terrain, r);
    if (status)
        return status;
    c->z_unit = tc_get_f64(r), c->z_origin = tc_get_f64(r);
    c->z_min = tc_get_f64(r), c->z_max = tc_get_f64(r), c->info.mean = tc_get_f64(r), c->info.deviation = tc_get_f64(r);
    c->voids = (int64_t)tc_get(r, 8);
    const tc_pack_terrain *t = &c->info.terrain;
    if (r->failed || !check_heights(c) || c->voids < 0 || (double)c->voids >= (double)t->width * (double)t->height)
        return TC_ERR_FORMAT;
    tc_container_set_levels(c);
    status = read_base(c, r) ? TC_OK : TC_ERR_FORMAT;
    for (int l = c->base; l < c->levels && !status; l++)
        status = read_record(&c->record[l], r);
    if (!status && ((atlas == 1 && !read_planet(c, r)) || r->failed || r->at != r->end))
        status = TC_ERR_FORMAT;
    return status;
}

static tc_status read_container(const char *subject, const uint8_t *bytes, size_t size, bool placed,
                                tc_container *c_ret, size_t *head_size_ret, tc_error *error)
{
    *head_size_ret = 0;
    if (!tc_head_is(bytes, size))
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected a packed terrain, found %s", subject,
                       size == 0 ? "an empty file" : "something else");
    if (size < TC_HEAD_FIXED)
        return tc_fail(error, TC_ERR_FORMAT, "%s: cut short: expected a head, found %zu bytes", subject, size);
    uint64_t version = tc_head_version(bytes);
    if (version < 1 || version > TC_CONTAINER_VERSION)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected version 1 to %d of the format, found %" PRIu64, subject,
                       placed ? TC_CONTAINER_VERSION : TC_NEWEST_VERSION, version);
    tc_status status = tc_head_check(subject, bytes, size, head_size_ret, error);
    if (status)
        return status;
    size_t head = *head_size_ret;
    tc_container c = {0};
    tc_byte_reader reader = {bytes + TC_HEAD_FIXED, bytes + head, false};
    bool unknown_atlas = false;
    status = read_head(&c, &reader, &unknown_atlas);
    if (!status && version_of(&c) == (int)version && (placed || check_layout(&c, head))) {
        c.info.version = (int)version;
        *c_ret = c;
        return TC_OK;
    }
    tc_container_free(&c);
    if (status == TC_ERR_MEMORY)
        return tc_fail(error, status, "%s: not enough memory", subject);
    if (unknown_atlas)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected the atlas flat or lonlat, found another one", subject);
    return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: its head contradicts itself", subject);
}

tc_status tc_container_read(const char *subject, const uint8_t *bytes, size_t size, tc_container *c_ret,
                            size_t *head_size_ret, tc_error *error)
{
    return read_container(subject, bytes, size, false, c_ret, head_size_ret, error);
}

tc_status tc_container_read_placed(const char *subject, const uint8_t *bytes, size_t size, tc_container *c_ret,
                                   size_t *head_size_ret, tc_error *error)
{
    return read_container(subject, bytes, size, true, c_ret, head_size_ret, error);
}

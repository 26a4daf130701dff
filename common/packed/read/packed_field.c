/* packed_field.c - a pyramid read from a packed file.
 *
 * Heights of a rectangle come from the coarser level around half of it and from the tiles that it touches; the coarser
 * level's heights likewise, down to a level small enough to be held whole. What is kept between calls is decoded tiles,
 * which the thin strips of a moving clipmap ask for again and again; heights are made anew each time, which costs less
 * than keeping them. A damaged tile counts as one without details. */
#include <math.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "packed_internal.h"

/* ---- Interface --------------------------------------------------------------------------------------------------- */

static inline __attribute__((always_inline)) void metres(double origin, double unit, const int32_t *restrict k,
                                                         int64_t count, float *restrict z)
{
    for (int64_t i = 0; i < count; i++)
        z[i] = (float)(origin + unit * k[i]);
}

#if defined __x86_64__ && defined __GNUC__
__attribute__((target("avx2"))) static void metres_avx2(double origin, double unit, const int32_t *k, int64_t count,
                                                        float *z)
{
    metres(origin, unit, k, count, z);
}
#endif

static void to_metres_row(double origin, double unit, const int32_t *k, int64_t count, float *z)
{
#if defined __x86_64__ && defined __GNUC__
    if (__builtin_cpu_supports("avx2")) {
        metres_avx2(origin, unit, k, count, z);
        return;
    }
#endif
    metres(origin, unit, k, count, z);
}

static tc_status read_block(packed_field *p, int l, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                            scratch *s)
{
    const tc_container *c = &p->file.container;
    tc_plane units;
    mark m = tc_scratch_here(s);
    tc_status status = z ? tc_scratch_plane(s, rect, &units) : TC_OK;
    if (!status && z)
        status = tc_packed_units(p, l, &units, s);
    for (int64_t j = 0; j < rect.y1 - rect.y0 && z && !status; j++)
        to_metres_row(c->z_origin, c->z_unit, units.z + j * units.stride, rect.x1 - rect.x0, z + j * stride);
    bool flat = z && p->voids == TC_VOIDS_CONSTANT;
    if (!status && c->voids > 0 && (voids || flat)) {
        tc_mask_plane mask = {voids, stride, rect};
        if (!voids)
            mask = (tc_mask_plane){tc_scratch_take(s, (size_t)tc_rect_area(rect)), rect.x1 - rect.x0, rect};
        status = mask.v ? tc_packed_mask(p, l, &mask, s) : TC_ERR_MEMORY;
        for (int64_t j = 0; j < rect.y1 - rect.y0 && flat && !status; j++)
            for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
                if (mask.v[j * mask.stride + i])
                    z[j * stride + i] = p->void_height;
    }
    tc_scratch_return(s, m);
    return status;
}

/* Where a block from x on ends: where the details that it depends on end with a tile, or the next one's would be begun
 * for it, and the coarser level be made around that; but what is little longer stays whole, and none is narrow. */
static int64_t next_cut(int64_t x, int64_t end, int64_t most)
{
    enum { BEFORE = 2 * TC_LIFTING_REACH };
    if (end - x <= most + most / 4)
        return end;
    int64_t cut = (x + BEFORE + most) / most * most - BEFORE;
    return cut - x < most / 4 ? cut + most : cut;
}

static tc_status packed_read(const tc_field *field, int l, tc_rect rect, void *samples, uint8_t *voids,
                             ptrdiff_t stride)
{
    packed_field *p = (packed_field *)field;
    float *z = samples;
    scratch *s = tc_packed_borrow(p);
    if (!s)
        return TC_ERR_MEMORY;
    tc_status status = TC_OK;
    for (int64_t y = rect.y0, y1; y < rect.y1 && !status; y = y1) {
        y1 = next_cut(y, rect.y1, BLOCK_HEIGHT);
        for (int64_t x = rect.x0, x1; x < rect.x1 && !status; x = x1) {
            x1 = next_cut(x, rect.x1, BLOCK_WIDTH);
            tc_rect part = {x, y, x1, y1};
            ptrdiff_t at = (ptrdiff_t)(y - rect.y0) * stride + (x - rect.x0);
            status = read_block(p, l, part, z ? z + at : NULL, voids ? voids + at : NULL, stride, s);
            for (int64_t j = 0; j < part.y1 - part.y0 && voids && p->file.container.voids == 0; j++)
                memset(voids + at + j * stride, 0, (size_t)(part.x1 - part.x0));
        }
    }
    tc_packed_give_back(p, s);
    return status;
}

static float to_metres(const tc_container *c, int32_t k)
{
    return (float)(c->z_origin + c->z_unit * k);
}

/* As far as heights, which are told as floats, may be off the mesh of the coarser level, of which all are off by up to
 * half an ulp. */
static float step_to_metres(const tc_container *c, uint32_t step, const tc_range *heights)
{
    double rounding = 2 * ldexp(fmax(fabs((double)heights->lo), fabs((double)heights->hi)), -23);
    return step == TC_STEP_UNKNOWN ? INFINITY : nextafterf((float)(c->z_unit * step + rounding), INFINITY);
}

static tc_range piece_range(const tc_field *field, int l, tc_rect rect)
{
    enum { FINE = 2 * TC_TILE, MOST_TILES = 64 };
    packed_field *p = (packed_field *)field;
    const tc_container *c = &p->file.container;
    int32_t low = INT32_MAX, high = INT32_MIN;
    uint32_t step = 0;
    if (l <= c->base) {
        int64_t w = field->level[l - 1].width;
        step = TC_STEP_UNKNOWN;
        for (int64_t y = rect.y0; y < rect.y1; y++)
            for (int64_t x = rect.x0; x < rect.x1; x++) {
                int32_t k = p->level[l - 1].whole[y * w + x];
                low = k < low ? k : low, high = k > high ? k : high;
            }
    } else {
        tc_rect t = {rect.x0 / FINE, rect.y0 / FINE, (rect.x1 - 1) / FINE + 1, (rect.y1 - 1) / FINE + 1};
        tc_tile_entry entry;
        bool known = tc_rect_area(t) <= MOST_TILES;
        for (int64_t ty = t.y0; ty < t.y1 && known; ty++)
            for (int64_t tx = t.x0; tx < t.x1 && known; tx++) {
                known = tc_packed_file_entry(&p->file, l, tx, ty, &entry) == TC_OK;
                if (!known)
                    break;
                low = entry.low < low ? entry.low : low, high = entry.high > high ? entry.high : high;
                step = entry.step > step ? entry.step : step;
            }
        if (!known)
            low = c->record[l - 1].lowest, high = c->record[l - 1].highest, step = TC_STEP_UNKNOWN;
        if (p->damaged > 0) { /* what stands in for damaged tiles lies about within the terrain's range */
            double margin = 0.1 * (c->z_max - c->z_min);
            return (tc_range){(float)(c->z_min - margin), (float)(c->z_max + margin), INFINITY};
        }
    }
    tc_range all = {to_metres(c, low), to_metres(c, high), 0};
    all.step = step_to_metres(c, step, &all);
    if (c->voids > 0 && p->voids == TC_VOIDS_CONSTANT)
        all = (tc_range){fminf(all.lo, p->void_height), fmaxf(all.hi, p->void_height), INFINITY};
    return all;
}

static tc_range packed_range(const tc_field *field, int l, tc_rect rect)
{
    tc_rect piece[2];
    tc_range all = {INFINITY, -INFINITY, 0};
    for (int n = tc_rect_round(rect, field->level[l - 1].width, piece) - 1; n >= 0; n--) {
        tc_range one = piece_range(field, l, piece[n]);
        all = (tc_range){fminf(all.lo, one.lo), fmaxf(all.hi, one.hi), fmaxf(all.step, one.step)};
    }
    return all;
}

/* Reads ahead: what it decodes stays in the caches. */
static void read_ahead(void *context, int l, tc_rect rect)
{
    packed_field *p = context;
    size_t samples = (size_t)tc_rect_area(rect);
    float *z = malloc(samples * sizeof *z);
    uint8_t *voids = p->file.container.voids > 0 ? malloc(samples) : NULL;
    if (z)
        (void)tc_field_read(&p->head, l, rect, z, voids, rect.x1 - rect.x0); /* who reads it next learns of failures */
    free(z), free(voids);
}

static tc_ready packed_ready(const tc_field *field, int l, tc_rect rect, tc_urgency urgency)
{
    packed_field *p = (packed_field *)field;
    if (tc_packed_decoded(p, l, rect))
        return TC_READY;
    return urgency == TC_ONLY_ASK || tc_prefetch_ask(&p->prefetch, l, rect) ? TC_COMING : TC_READY;
}

static bool packed_read_ready(const tc_field *field, int l, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    return tc_packed_decoded((packed_field *)field, l, rect) &&
           packed_read(field, l, rect, samples, voids, stride) == TC_OK;
}

static void packed_tell(const tc_field *field, tc_field_stats *stats)
{
    packed_field *p = (packed_field *)field;
    stats->bytes += sizeof *p + tc_block_cache_bytes(&p->file.pages);
    size_t cached = tc_block_cache_bytes(&p->tiles) + tc_block_cache_bytes(&p->masks);
    stats->bytes += cached, stats->cache_bytes += cached;
    for (int l = 0; l < field->info.levels; l++) {
        const level_state *level = &p->level[l];
        if (!level->ready)
            continue;
        stats->bytes += tc_level_coder_bytes(&level->coder);
        if (level->whole)
            stats->bytes += (size_t)(field->level[l].width * field->level[l].height) * sizeof(int32_t);
    }
    stats->damaged += p->damaged, stats->decoded += p->decoded;
}

static const tc_container *packed_container(const tc_field *field)
{
    return &((const packed_field *)field)->file.container;
}

static void packed_destroy(tc_field *field)
{
    packed_field *p = (packed_field *)field;
    tc_prefetch_free(&p->prefetch);
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++) {
        tc_level_coder_free(&p->level[l].coder);
        free(p->level[l].whole);
        pthread_mutex_destroy(&p->level[l].mutex);
    }
    while (p->idle) {
        scratch *s = p->idle;
        p->idle = s->next;
        tc_scratch_free(s);
    }
    pthread_mutex_destroy(&p->mutex);
    tc_block_cache_free(&p->tiles), tc_block_cache_free(&p->masks);
    tc_packed_file_close(&p->file);
    free(p);
}

static const tc_field_class packed_class = {.sample = TC_FIELD_HEIGHTS,
                                            .read = packed_read,
                                            .read_ready = packed_read_ready,
                                            .ready = packed_ready,
                                            .range = packed_range,
                                            .tell = packed_tell,
                                            .container = packed_container,
                                            .destroy = packed_destroy};

/* ---- Opening ------------------------------------------------------------------------------------------------------
 */

/* Bytes that the file's coders need for a decoded tile. */
static size_t largest_tile(const tc_container *c)
{
    size_t most = 0;
    for (int l = c->base; l < c->levels; l++)
        most = tc_decoded_tile_bytes(c->record[l].coder) > most ? tc_decoded_tile_bytes(c->record[l].coder) : most;
    return most ? most : tc_decoded_tile_bytes(TC_CODER_LIFTING); /* one byte each would make for a huge table */
}

/* Heights of the base level from the head, of coarser ones by the transform's low band. */
static tc_status make_base(packed_field *p)
{
    const tc_container *c = &p->file.container;
    for (int l = c->base; l >= 1; l--) {
        level_state *state = &p->level[l - 1];
        const tc_level *size = &c->level[l - 1];
        size_t samples = (size_t)(size->width * size->height);
        if (!(state->whole = malloc(samples * sizeof(int32_t))))
            return TC_ERR_MEMORY;
        state->ready = true;
        if (l == c->base) {
            memcpy(state->whole, c->base_z, samples * sizeof(int32_t));
            continue;
        }
        int32_t memory[TC_BANDS][TC_BASE_SIZE * TC_BASE_SIZE];
        tc_lifting_level fine = tc_container_lifting(c, l + 1);
        tc_rect rect = {0, 0, size->width, size->height};
        tc_plane from = {p->level[l].whole, fine.width, {0, 0, fine.width, fine.height}}, band[TC_BANDS];
        tc_plane low = {state->whole, size->width, rect};
        for (int b = 0; b < TC_BANDS; b++)
            band[b] = (tc_plane){memory[b], size->width, rect};
        int32_t *work = malloc(tc_lifting_analyse_scratch(&fine, size->height) * sizeof *work);
        if (!work)
            return TC_ERR_MEMORY;
        tc_lifting_analyse(&fine, &from, 0, size->height, &low, band, work);
        free(work);
    }
    return TC_OK;
}

static void set_info(packed_field *p, const tc_open_options *o)
{
    const tc_container *c = &p->file.container;
    const tc_pack_terrain *t = &c->info.terrain;
    tc_terrain_info *info = &p->head.info;
    p->head.class = &packed_class;
    memcpy(p->head.level, c->level, sizeof c->level);
    info->levels = c->levels;
    info->z_base = t->z_base;
    info->z_min = (float)c->z_min, info->z_max = (float)c->z_max;
    info->void_count = c->voids;
    info->wraps_x = c->levels >= c->wraps_from;
    info->other_body = tc_is_other_body(&t->georef);
    p->head.georef = t->georef;
    p->voids = o->has_policy ? o->voids : t->voids;
    p->void_height = (float)((o->has_policy ? o->void_constant : t->void_constant) - t->z_base);
    if (p->voids == TC_VOIDS_CONSTANT && c->voids > 0) {
        info->z_min = fminf(info->z_min, p->void_height);
        info->z_max = fmaxf(info->z_max, p->void_height);
    }
}

/* Makes the pyramid p whose file was opened with `opened`; p is freed where anything has failed. */
static tc_status make_field(packed_field *p, tc_status opened, const tc_open_options *options, tc_field **field_ret,
                            tc_error *error)
{
    static const tc_open_options none = {0};
    options = options ? options : &none;
    if (opened) {
        free(p);
        return opened;
    }
    pthread_mutex_init(&p->mutex, NULL);
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        pthread_mutex_init(&p->level[l].mutex, NULL);
    tc_status status = tc_block_cache_init(&p->tiles, largest_tile(&p->file.container),
                                           options->cache_bytes ? options->cache_bytes : CACHE_BYTES);
    tc_status masks = tc_block_cache_init(&p->masks, MASK_SIDE * MASK_SIDE, MASK_BYTES);
    status = status ? status : masks;
    tc_prefetch_init(&p->prefetch, read_ahead, p);
    set_info(p, options);
    if (!status)
        status = make_base(p);
    if (status) {
        tc_fail(error, status, "%s: not enough memory", p->file.path);
        packed_destroy(&p->head);
        return status;
    }
    *field_ret = &p->head;
    return TC_OK;
}

tc_status tc_field_open(const char *path, const tc_open_options *options, tc_field **field_ret, tc_error *error)
{
    packed_field *p = calloc(1, sizeof *p);
    if (!p)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    return make_field(p, tc_packed_file_open(path, &p->file, error), options, field_ret, error);
}

tc_status tc_packed_open_chart(const char *name, const tc_byte_source *source, int chart,
                               const tc_open_options *options, tc_field **field_ret, tc_error *error)
{
    packed_field *p = calloc(1, sizeof *p);
    if (!p) {
        if (source->close)
            source->close(source->context);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    return make_field(p, tc_packed_file_open_bytes(name, source, chart, &p->file, error), options, field_ret, error);
}

tc_status tc_field_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                              tc_field **field_ret, tc_error *error)
{
    return tc_packed_open_chart(name, source, 0, options, field_ret, error);
}

/* ---- What the file's head tells beside --------------------------------------------------------------------------- */

const tc_packed_info *tc_field_packed_info(const tc_field *field)
{
    const tc_container *c = tc_field_container(field);
    return c ? &c->info : NULL;
}

int64_t tc_packed_chart_bytes(const tc_field *field)
{
    const tc_container *c = tc_field_container(field);
    int64_t bytes = 0;
    if (c && c->info.version < TC_ENVELOPE_VERSION)
        return tc_container_cap_begin(c, 0);
    for (int l = c ? c->base : 0; c && l < c->levels; l++)
        bytes += c->record[l].end - c->record[l].begin;
    return bytes;
}

tc_packed_level tc_field_packed_level(const tc_field *field, int level)
{
    const tc_container *c = tc_field_container(field);
    if (!c || level < 1 || level > c->levels)
        return (tc_packed_level){0};
    const tc_level_record *r = &c->record[level - 1];
    if (level <= c->base) { /* rounding to height units, which keep a lossless source's own values */
        bool exact = c->info.mode == TC_PACK_LOSSLESS && level == c->levels && c->levels == c->base;
        return (tc_packed_level){0, exact ? 0 : 0.5 * c->z_unit, exact ? 0 : 0.5 * c->z_unit, 0};
    }
    return (tc_packed_level){r->end - r->begin, r->rms, r->max_error, r->residual_variance};
}

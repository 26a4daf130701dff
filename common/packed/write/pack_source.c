/* pack_source.c - the heights as they are given, in any order, and their voids. */
#include <math.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/fill_rows.h"
#include "pack_internal.h"

/* The spool starts as zeros, which must mean void, since nothing else can be had for free; a height of zero is written
 * as minus zero. */
static const uint32_t VOID_BITS = 0, ZERO_BITS = 0x80000000u;

static uint32_t to_bits(float z)
{
    uint32_t bits;
    memcpy(&bits, &z, sizeof bits);
    return bits == VOID_BITS ? ZERO_BITS : bits;
}

static float from_bits(uint32_t bits)
{
    float z;
    memcpy(&z, &bits, sizeof z);
    return bits == VOID_BITS ? NAN : z;
}

/* ---- Lattices ------------------------------------------------------------------------------------------------ */

/* Units that floating-point heights are tried for. */
static const double units[] = {1,       0.5,      0.25,  0.2,       0.125,     0.1,      1. / 16, 0.05,
                               1. / 32, 0.025,    0.02,  1. / 64,   0.01,      1. / 128, 0.005,   1. / 256,
                               0.002,   1. / 512, 0.001, 1. / 1024, 1. / 2048, 1. / 4096};
enum { UNITS = sizeof units / sizeof *units };

static bool is_integer(tc_sample_type type)
{
    return type < TC_SAMPLE_FLOAT32;
}

static bool on_lattice(float z, double unit, double origin)
{
    double k = rint((z - origin) / unit);
    return fabs(k) <= TC_LIFTING_LIMIT && (float)(origin + unit * k) == z;
}

/* Strikes units that the heights are no multiples of. */
static unsigned strike_lattices(unsigned left, const float *z, const uint8_t *voids, int64_t count, double origin)
{
    for (int64_t i = 0; i < count && left; i++)
        if ((!voids || !voids[i]) && isfinite(z[i]))
            for (unsigned n = 0; n < UNITS; n++)
                if (left >> n & 1 && !on_lattice(z[i], units[n], origin))
                    left &= ~(1u << n);
    return left;
}

double tc_pack_lattice(const tc_packer *p, double *origin_ret)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    *origin_ret = 0;
    if (p->options.lattice > 0)
        return p->options.lattice;
    if (is_integer(t->sample_type)) {
        *origin_ret = t->offset - t->z_base;
        return t->unit;
    }
    for (unsigned n = 0; n < UNITS; n++)
        if (p->lattices >> n & 1)
            return units[n];
    return 0;
}

/* ---- Put ----------------------------------------------------------------------------------------------------- */

static bool remember(tc_packer *p, tc_rect rect)
{
    tc_rect *last = p->given_count ? &p->given[p->given_count - 1] : NULL;
    if (last && last->x0 == rect.x0 && last->x1 == rect.x1 && (rect.y1 == last->y0 || rect.y0 == last->y1)) {
        last->y0 = tc_min64(last->y0, rect.y0), last->y1 = tc_max64(last->y1, rect.y1);
        return true;
    }
    if (p->given_count == p->given_room) {
        size_t room = 2 * p->given_room + 16;
        tc_rect *given = realloc(p->given, room * sizeof *given);
        if (!given)
            return false;
        p->given = given, p->given_room = room;
    }
    p->given[p->given_count++] = rect;
    return true;
}

static bool was_given(const tc_packer *p, tc_rect rect)
{
    for (size_t i = 0; i < p->given_count; i++)
        if (!tc_rect_empty(tc_rect_intersect(rect, p->given[i])))
            return true;
    return false;
}

/* One row: bits holds what is there already (where `old`), and gets what shall be. */
static void merge_row(tc_packer *p, const float *z, const uint8_t *voids, int64_t count, bool old, uint32_t *bits)
{
    float lo = p->z_min, hi = p->z_max;
    int64_t valid = 0;
    for (int64_t i = 0; i < count; i++) {
        uint32_t before = old ? bits[i] : VOID_BITS;
        bool is_void = (voids && voids[i]) || !isfinite(z[i]);
        if (before != VOID_BITS) {
            double difference = is_void ? 0 : fabs((double)z[i] - from_bits(before));
            if (difference > 0) {
                p->result.disagreeing++;
                p->result.largest_disagreement = fmax(p->result.largest_disagreement, difference);
            }
            continue;
        }
        bits[i] = is_void && !p->filled ? VOID_BITS : to_bits(z[i]);
        if (is_void)
            continue;
        valid++;
        lo = z[i] < lo ? z[i] : lo, hi = z[i] > hi ? z[i] : hi;
    }
    p->result.samples += valid;
    p->z_min = lo, p->z_max = hi;
}

static void note_levels(tc_packer *p, const uint8_t *row, int64_t y);

/* The mask of whole rows whose heights under voids are given. */
static tc_status put_mask(tc_packer *p, tc_rect rect, const uint8_t *voids, ptrdiff_t stride, tc_error *error)
{
    for (int64_t y = rect.y0; y < rect.y1; y++)
        note_levels(p, voids + (y - rect.y0) * stride, y);
    tc_status status = TC_OK;
    if (p->mask.file < 0)
        status = tc_spool_create(p->path, p->source.width, p->source.height, 1, &p->mask, error);
    return status ? status : tc_spool_write(&p->mask, rect, voids, stride, error);
}

tc_status tc_packer_put(tc_packer *p, tc_rect rect, const float *z, const uint8_t *voids, ptrdiff_t stride,
                        tc_error *error)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    int64_t count = rect.x1 - rect.x0;
    if (tc_rect_empty(rect))
        return TC_OK;
    if (!tc_rect_within(rect, (tc_rect){0, 0, t->width, t->height}))
        return tc_fail(error, TC_ERR_USAGE, "%s: samples beyond the terrain's %lld x %lld", p->path,
                       (long long)t->width, (long long)t->height);
    /* A few rows at a time: one write each costs more than copying. */
    int64_t rows = tc_clamp64(((int64_t)1 << 20) / count, 1, rect.y1 - rect.y0);
    uint32_t *bits = malloc((size_t)(rows * count) * sizeof *bits);
    if (!bits)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    tc_status status = TC_OK;
    bool old = was_given(p, rect);
    for (int64_t y = rect.y0; y < rect.y1 && !status; y += rows) {
        tc_rect part = {rect.x0, y, rect.x1, tc_min64(y + rows, rect.y1)};
        if (old)
            status = tc_spool_read(&p->source, part, bits, count, error);
        for (int64_t j = 0; j < part.y1 - part.y0 && !status; j++) {
            ptrdiff_t at = (ptrdiff_t)(y + j - rect.y0) * stride;
            const uint8_t *v = voids ? voids + at : NULL;
            merge_row(p, z + at, v, count, old, bits + j * count);
            if (p->lattices)
                p->lattices = strike_lattices(p->lattices, z + at, v, count, 0);
        }
        if (!status)
            status = tc_spool_write(&p->source, part, bits, count, error);
    }
    free(bits);
    if (!status && p->filled && voids)
        status = put_mask(p, rect, voids, stride, error);
    if (!status && !remember(p, rect))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    double share = TC_SHARE_PUT * (double)tc_rect_area(rect) / ((double)t->width * (double)t->height);
    return status ? status : tc_pack_progress(p, fmin(share, TC_SHARE_PUT - p->done), error);
}

tc_status tc_pack_source_rows(const tc_packer *p, int64_t y0, int64_t y1, float *z, tc_error *error)
{
    int64_t width = p->container.info.terrain.width;
    tc_status status = tc_spool_read(&p->source, (tc_rect){0, y0, width, y1}, z, width, error);
    for (int64_t i = 0; i < (y1 - y0) * width && !status; i++) {
        uint32_t bits;
        memcpy(&bits, &z[i], sizeof bits);
        z[i] = from_bits(bits);
    }
    return status;
}

tc_status tc_pack_moments(tc_packer *p, double *mean_ret, double *deviation_ret, tc_error *error)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    int64_t w = t->width, h = t->height, rows = tc_clamp64(((int64_t)1 << 20) / w, 1, h), valid = 0;
    double base = 0.5 * ((double)p->z_min + p->z_max), sum = 0, square = 0;
    bool masked = p->filled && p->mask.file >= 0;
    float *z = malloc((size_t)(rows * w) * sizeof *z);
    uint8_t *voids = masked ? malloc((size_t)(rows * w)) : NULL;
    tc_status status = TC_OK;
    if (!z || (masked && !voids))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (int64_t y = 0; y < h && !status; y++) {
        if (y % rows == 0)
            status = tc_pack_source_rows(p, y, tc_min64(y + rows, h), z, error);
        if (y % rows == 0 && masked && !status)
            status = tc_pack_mask(p, p->container.levels, (tc_rect){0, y, w, tc_min64(y + rows, h)}, voids, w, error);
        double row_sum = 0, row_square = 0;
        for (int64_t i = y % rows * w; i < (y % rows + 1) * w && !status; i++)
            if (!isnan(z[i]) && !(masked && voids[i])) {
                double d = z[i] - base;
                row_sum += d, row_square += d * d, valid++;
            }
        sum += row_sum, square += row_square;
    }
    free(z), free(voids);
    double mean = valid ? sum / (double)valid : 0;
    *mean_ret = mean + base;
    *deviation_ret = valid ? sqrt(fmax(square / (double)valid - mean * mean, 0)) : 0;
    return status;
}

/* ---- Voids --------------------------------------------------------------------------------------------------- */

/* Notes which levels have a void, a level's mask being the finest one's on the same spots. */
static void note_levels(tc_packer *p, const uint8_t *row, int64_t y)
{
    tc_container *c = &p->container;
    for (int k = 0; k < c->levels - c->base && (y & (((int64_t)1 << k) - 1)) == 0; k++) {
        tc_level_record *record = &c->record[c->levels - 1 - k];
        for (int64_t i = 0; i < c->info.terrain.width && !record->mask; i += (int64_t)1 << k)
            record->mask = row[i];
    }
}

/* Rows of the source, or of a coarser level, for the filling. Around a globe the source's rows go on beyond either end
 * by so many columns: a void on the seam is filled from both sides, and its surface meets there. */
typedef struct fill_context {
    const tc_packer *p;
    tc_spool *spool;
    int64_t beyond;
    tc_error *error;
} fill_context;

/* More than most voids are wide, but no more than the globe is. A multiple of what coarser levels of the filling halve
 * first, so that they have the same samples on both sides. */
static int64_t columns_beyond(const tc_pack_terrain *t)
{
    enum { MOST = 512, MULTIPLE = 64 };
    return t->wraps_x ? tc_min64(t->width / 2, MOST) / MULTIPLE * MULTIPLE : 0;
}

static tc_status read_source(void *context, int64_t y0, int64_t rows, float *z)
{
    const fill_context *f = context;
    int64_t w = f->spool->width, b = f->beyond, stride = w + 2 * b;
    if (b == 0)
        return tc_pack_source_rows(f->p, y0, y0 + rows, z, f->error);
    float *row = malloc((size_t)w * sizeof *row);
    tc_status status = row ? TC_OK : TC_ERR_MEMORY;
    for (int64_t j = 0; j < rows && !status; j++) {
        status = tc_pack_source_rows(f->p, y0 + j, y0 + j + 1, row, f->error);
        memcpy(z + j * stride, row + w - b, (size_t)b * sizeof *z);
        memcpy(z + j * stride + b, row, (size_t)w * sizeof *z);
        memcpy(z + j * stride + b + w, row, (size_t)b * sizeof *z);
    }
    free(row);
    return status;
}

static tc_status write_source(void *context, int64_t y0, int64_t rows, const float *z)
{
    const fill_context *f = context;
    uint32_t bits[1024];
    for (int64_t y = y0; y < y0 + rows; y++)
        for (int64_t x = 0; x < f->spool->width; x += 1024) {
            int64_t count = tc_min64(1024, f->spool->width - x);
            for (int64_t i = 0; i < count; i++)
                bits[i] = to_bits(z[(y - y0) * (f->spool->width + 2 * f->beyond) + f->beyond + x + i]);
            tc_status status = tc_spool_write(f->spool, (tc_rect){x, y, x + count, y + 1}, bits, count, f->error);
            if (status)
                return status;
        }
    return TC_OK;
}

static tc_status read_level(void *context, int64_t y0, int64_t rows, float *z)
{
    const fill_context *f = context;
    return tc_spool_read(f->spool, (tc_rect){0, y0, f->spool->width, y0 + rows}, z, f->spool->width, f->error);
}

static tc_status write_level(void *context, int64_t y0, int64_t rows, const float *z)
{
    const fill_context *f = context;
    return tc_spool_write(f->spool, (tc_rect){0, y0, f->spool->width, y0 + rows}, z, f->spool->width, f->error);
}

/* Spools for the coarser levels. */
typedef struct fill_levels {
    fill_context context[TC_MAX_FIELD_LEVELS];
    tc_spool spool[TC_MAX_FIELD_LEVELS];
    int count;
} fill_levels;

static tc_status make_level(void *context, int64_t width, int64_t height, tc_fill_rows *rows_ret)
{
    fill_levels *f = context;
    if (f->count == TC_MAX_FIELD_LEVELS)
        return TC_ERR_MEMORY;
    fill_context *c = &f->context[f->count];
    *c = (fill_context){f->context[0].p, &f->spool[f->count], 0, f->context[0].error};
    tc_status status = tc_spool_create(c->p->path, width, height, sizeof(float), c->spool, c->error);
    if (!status) {
        f->count++;
        *rows_ret = (tc_fill_rows){c, width, height, read_level, write_level};
    }
    return status;
}

static tc_status make_mask(tc_packer *p, tc_error *error)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    int64_t w = t->width, h = t->height, rows = tc_clamp64(((int64_t)1 << 20) / w, 1, h);
    tc_status status = tc_spool_create(p->path, w, h, 1, &p->mask, error);
    if (status)
        return status;
    float *z = malloc((size_t)(rows * w) * sizeof *z);
    uint8_t *voids = malloc((size_t)(rows * w));
    if (!z || !voids)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (int64_t y = 0; y < h && !status; y += rows) {
        int64_t y1 = tc_min64(y + rows, h);
        if ((status = tc_pack_source_rows(p, y, y1, z, error)))
            break;
        bool some = false;
        for (int64_t i = 0; i < (y1 - y) * w; i++)
            some |= voids[i] = isnan(z[i]);
        for (int64_t j = y; j < y1 && some; j++)
            note_levels(p, voids + (j - y) * w, j);
        if (some)
            status = tc_spool_write(&p->mask, (tc_rect){0, y, w, y1}, voids, w, error);
    }
    free(z), free(voids);
    return status;
}

tc_status tc_pack_fill(tc_packer *p, tc_error *error)
{
    tc_status status = make_mask(p, error);
    fill_levels *levels = calloc(1, sizeof *levels);
    if (!status && !levels)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    if (!status) {
        tc_error why = {TC_OK, ""};
        int64_t beyond = columns_beyond(&p->container.info.terrain);
        levels->context[0] = (fill_context){p, &p->source, beyond, &why};
        levels->spool[0] = p->source;
        levels->count = 1;
        tc_fill_rows rows = {&levels->context[0], p->source.width + 2 * beyond, p->source.height, read_source,
                             write_source};
        if ((status = tc_fill_void_rows(&rows, make_level, levels, NULL)))
            tc_fail(error, status, "%s: its voids cannot be filled: %s", p->path,
                    why.status ? why.text : tc_status_text(status));
        for (int i = 1; i < levels->count; i++)
            tc_spool_close(&levels->spool[i]);
    }
    free(levels);
    return status;
}

/* pack_source.c - the heights as they are given, in any order, and their voids. */
#include <math.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
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

/* What a thread finds in a run of the rows that are put. */
typedef struct run_found {
    int64_t valid, disagreeing;
    double largest_disagreement;
    float low, high;
    unsigned lattices;
    tc_status status;
    tc_error error;
} run_found;

enum { MOST_RUNS = 64 };

/* Rows that are put, into what is there already (where `old`), a run of them by a thread. */
typedef struct merge {
    const tc_packer *p;
    const float *z;
    const uint8_t *voids; /* or NULL */
    ptrdiff_t stride;
    tc_rect rect;
    int64_t run_rows;
    bool old;
    uint32_t *bits; /* gets what shall be there */
    run_found found[MOST_RUNS];
} merge;

static void merge_row(const merge *m, const float *z, const uint8_t *voids, uint32_t *bits, run_found *found)
{
    const int64_t count = m->rect.x1 - m->rect.x0;
    float lo = found->low, hi = found->high;
    int64_t valid = 0;
    for (int64_t i = 0; i < count; i++) {
        uint32_t before = m->old ? bits[i] : VOID_BITS;
        bool is_void = (voids && voids[i]) || !isfinite(z[i]);
        if (before != VOID_BITS) {
            double difference = is_void ? 0 : fabs((double)z[i] - from_bits(before));
            if (difference > 0) {
                found->disagreeing++;
                found->largest_disagreement = fmax(found->largest_disagreement, difference);
            }
            continue;
        }
        bits[i] = is_void && !m->p->filled ? VOID_BITS : to_bits(z[i]);
        if (is_void)
            continue;
        valid++;
        lo = z[i] < lo ? z[i] : lo, hi = z[i] > hi ? z[i] : hi;
    }
    found->valid += valid;
    found->low = lo, found->high = hi;
}

static void merge_run(void *context, int64_t n)
{
    merge *m = context;
    run_found *f = &m->found[n];
    *f = (run_found){.low = INFINITY, .high = -INFINITY, .lattices = m->p->lattices};
    tc_rect run = m->rect;
    run.y0 += n * m->run_rows, run.y1 = tc_min64(run.y0 + m->run_rows, run.y1);
    const int64_t count = run.x1 - run.x0;
    uint32_t *bits = m->bits + (run.y0 - m->rect.y0) * count;
    if (m->old && (f->status = tc_spool_read(&m->p->source, run, bits, count, &f->error)))
        return;
    for (int64_t y = run.y0; y < run.y1; y++) {
        const float *z = m->z + (y - m->rect.y0) * m->stride;
        const uint8_t *voids = m->voids ? m->voids + (y - m->rect.y0) * m->stride : NULL;
        merge_row(m, z, voids, bits + (y - run.y0) * count, f);
        if (f->lattices)
            f->lattices = strike_lattices(f->lattices, z, voids, count, 0);
    }
    f->status = tc_spool_write(&m->p->source, run, bits, count, &f->error);
}

static tc_status merge_rows(tc_packer *p, merge *m, tc_error *error)
{
    enum { SAMPLES = 1 << 15 }; /* a run that is worth a task */
    const int64_t rows = m->rect.y1 - m->rect.y0, count = m->rect.x1 - m->rect.x0;
    m->run_rows = tc_max64((rows + MOST_RUNS - 1) / MOST_RUNS, (SAMPLES + count - 1) / count);
    const int64_t runs = (rows + m->run_rows - 1) / m->run_rows;
    tc_parallel_for(p->options.threads, runs, merge_run, m);
    for (int64_t n = 0; n < runs; n++) {
        const run_found *f = &m->found[n];
        if (f->status) {
            if (error)
                *error = f->error;
            return f->status;
        }
        p->result.samples += f->valid, p->result.disagreeing += f->disagreeing;
        p->result.largest_disagreement = fmax(p->result.largest_disagreement, f->largest_disagreement);
        p->z_min = f->low < p->z_min ? f->low : p->z_min, p->z_max = f->high > p->z_max ? f->high : p->z_max;
        p->lattices &= f->lattices;
    }
    return TC_OK;
}

/* The mask of whole rows whose heights under voids are given. */
static tc_status put_mask(tc_packer *p, tc_rect rect, const uint8_t *voids, ptrdiff_t stride, tc_error *error)
{
    for (int64_t y = rect.y0; y < rect.y1; y++)
        tc_pack_note_voids(p, voids + (y - rect.y0) * stride, y);
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
        ptrdiff_t at = (ptrdiff_t)(y - rect.y0) * stride;
        merge m = {p, z + at, voids ? voids + at : NULL, stride, part, .old = old, .bits = bits};
        status = merge_rows(p, &m, error);
    }
    free(bits);
    if (!status && p->filled && voids)
        status = put_mask(p, rect, voids, stride, error);
    if (!status && !remember(p, rect))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    double share = TC_SHARE_PUT * (double)tc_rect_area(rect) / ((double)t->width * (double)t->height);
    return status ? status : tc_pack_progress(p, fmin(share, TC_SHARE_PUT - p->done), error);
}

tc_status tc_pack_set_source(const tc_packer *p, tc_rect rect, const float *z, ptrdiff_t stride, tc_error *error)
{
    uint32_t bits[1024];
    for (int64_t y = rect.y0; y < rect.y1; y++)
        for (int64_t x = rect.x0; x < rect.x1; x += 1024) {
            int64_t count = tc_min64(1024, rect.x1 - x);
            for (int64_t i = 0; i < count; i++)
                bits[i] = to_bits(z[(y - rect.y0) * stride + x - rect.x0 + i]);
            tc_status status = tc_spool_write(&p->source, (tc_rect){x, y, x + count, y + 1}, bits, count, error);
            if (status)
                return status;
        }
    return TC_OK;
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

/* Rows in bands, whose sums any thread finds. */
typedef struct moments {
    const tc_packer *p;
    double base;
    int64_t rows; /* of a band */
    struct {
        double sum, square;
        int64_t valid;
    } * band;
    tc_pack_failure failure;
} moments;

static void add_band(void *context, int64_t n)
{
    moments *m = context;
    const tc_packer *p = m->p;
    const tc_pack_terrain *t = &p->container.info.terrain;
    int64_t w = t->width, y0 = n * m->rows, y1 = tc_min64(y0 + m->rows, t->height);
    bool masked = p->filled && p->mask.file >= 0;
    float *z = malloc((size_t)((y1 - y0) * w) * sizeof *z);
    uint8_t *voids = masked ? malloc((size_t)((y1 - y0) * w)) : NULL;
    tc_error error = {TC_OK, ""};
    tc_status status = z && (voids || !masked) ? tc_pack_source_rows(p, y0, y1, z, &error)
                                               : tc_fail(&error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    if (!status && masked)
        status = tc_pack_mask(p, p->container.levels, (tc_rect){0, y0, w, y1}, voids, w, &error);
    double sum = 0, square = 0;
    int64_t valid = 0;
    for (int64_t i = 0; i < (y1 - y0) * w && !status; i++)
        if (!isnan(z[i]) && !(masked && voids[i])) {
            double d = z[i] - m->base;
            sum += d, square += d * d, valid++;
        }
    m->band[n].sum = sum, m->band[n].square = square, m->band[n].valid = valid;
    free(z), free(voids);
    tc_pack_failure_keep(&m->failure, status, &error);
}

tc_status tc_pack_moments(tc_packer *p, double *mean_ret, double *deviation_ret, tc_error *error)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    moments m = {.p = p, .base = 0.5 * ((double)p->z_min + p->z_max), .failure = {.mutex = PTHREAD_MUTEX_INITIALIZER}};
    m.rows = tc_clamp64(((int64_t)1 << 18) / t->width, 1, t->height);
    int64_t bands = (t->height + m.rows - 1) / m.rows, valid = 0;
    double sum = 0, square = 0;
    m.band = calloc((size_t)bands, sizeof *m.band);
    if (!m.band)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    tc_parallel_for(p->options.threads, bands, add_band, &m);
    for (int64_t n = 0; n < bands; n++)
        sum += m.band[n].sum, square += m.band[n].square, valid += m.band[n].valid;
    free(m.band);
    double mean = valid ? sum / (double)valid : 0;
    *mean_ret = mean + m.base;
    *deviation_ret = valid ? sqrt(fmax(square / (double)valid - mean * mean, 0)) : 0;
    return tc_pack_failure_end(&m.failure, error);
}

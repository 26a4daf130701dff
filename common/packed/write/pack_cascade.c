/* pack_cascade.c - from the finest level's heights to the low bands of all coarser ones. */
#include <math.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_internal.h"

/* Rounds as lrint() does, but so that compilers make vectors of it: added to 3 * 2^51, a double has its integer part in
 * its low bits. */
static int32_t round_to_int(double x)
{
    double shifted = x + 6755399441055744.0;
    int64_t bits;
    memcpy(&bits, &shifted, sizeof bits);
    return (int32_t)bits;
}

static void to_units(const tc_container *c, const float *restrict z, int64_t count, int32_t *restrict k)
{
    double inverse = 1 / c->z_unit, origin = c->z_origin;
    for (int64_t i = 0; i < count; i++)
        k[i] = round_to_int((z[i] - origin) * inverse);
}

tc_status tc_pack_truth(const tc_packer *p, int l, tc_rect rect, int32_t *z, ptrdiff_t stride, tc_error *error)
{
    if (l < p->container.levels)
        return tc_spool_read_round(&p->truth[l - 1], rect, z, stride, error);
    /* Floats and integers are as long: they are turned in place. */
    tc_status status = tc_spool_read_round(&p->source, rect, z, stride, error);
    for (int64_t j = 0; j < rect.y1 - rect.y0 && !status; j++) {
        float row[1024];
        for (int64_t i = 0; i < rect.x1 - rect.x0; i += 1024) {
            int64_t count = tc_min64(1024, rect.x1 - rect.x0 - i);
            memcpy(row, z + j * stride + i, (size_t)count * sizeof *row);
            to_units(&p->container, row, count, z + j * stride + i);
        }
    }
    return status;
}

tc_status tc_pack_mask(const tc_packer *p, int l, tc_rect rect, uint8_t *voids, ptrdiff_t stride, tc_error *error)
{
    const int k = p->container.levels - l;
    if (k == 0)
        return tc_spool_read_round(&p->mask, rect, voids, stride, error);
    const int64_t w = rect.x1 - rect.x0, run = ((w - 1) << k) + 1, x = rect.x0 * ((int64_t)1 << k);
    uint8_t *row = malloc((size_t)run);
    tc_status status = row ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (int64_t y = rect.y0; y < rect.y1 && !status; y++) {
        status = tc_spool_read_round(&p->mask, (tc_rect){x, y << k, x + run, (y << k) + 1}, row, run, error);
        for (int64_t i = 0; i < w && !status; i++)
            voids[(y - rect.y0) * stride + i] = row[i << k];
    }
    free(row);
    return status;
}

/* ---- One level ----------------------------------------------------------------------------------------------- */

typedef struct step {
    tc_packer *p;
    int fine; /* level */
    tc_lifting_level level;
    int64_t rows;          /* of the coarser level at a time */
    pthread_mutex_t mutex; /* of the packer's histograms */
    tc_pack_failure failure;
} step;

static int bin_of(int32_t detail)
{
    float v = fabsf((float)detail);
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return detail == 0 ? 0 : (int)(bits >> 21) - (127 << 2) + 1; /* four to an octave */
}

double tc_detail_bin(int bin)
{
    return bin == 0 ? 0 : exp2((bin - 1) / 4.0 + 0.125);
}

void tc_pack_count(const tc_plane *band, tc_detail_histogram *h)
{
    int64_t rows = band->rect.y1 - band->rect.y0, count = band->rect.x1 - band->rect.x0;
    for (int64_t j = 0; j < rows; j++) {
        unsigned __int128 square = 0;
        for (int64_t i = 0; i < count; i++) {
            int32_t d = band->z[j * band->stride + i];
            h->count[bin_of(d)]++, square += (uint64_t)((int64_t)d * d);
        }
        h->square += square;
    }
}

static void add_histogram(tc_detail_histogram *to, const tc_detail_histogram *from)
{
    for (int i = 0; i < TC_DETAIL_BINS; i++)
        to->count[i] += from->count[i];
    to->square += from->square;
}

typedef struct band_memory {
    int32_t *fine, *low, *band[TC_BANDS], *scratch;
    tc_detail_histogram histogram[TC_BANDS];
} band_memory;

static void release(band_memory *m)
{
    free(m->fine), free(m->low), free(m->scratch);
    for (int b = 0; b < TC_BANDS; b++)
        free(m->band[b]);
    free(m);
}

static band_memory *reserve(const step *s)
{
    size_t w = (size_t)s->level.width, cw = (size_t)tc_coarse_size(s->level.width), rows = (size_t)s->rows;
    band_memory *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->fine = malloc(2 * (rows + 2 * TC_LIFTING_REACH) * w * sizeof(int32_t));
    m->low = malloc(rows * cw * sizeof(int32_t));
    m->scratch = malloc(tc_lifting_analyse_scratch(&s->level, s->rows) * sizeof(int32_t));
    bool good = m->fine && m->low && m->scratch;
    for (int b = 0; b < TC_BANDS; b++)
        good &= (m->band[b] = malloc(rows * cw * sizeof(int32_t))) != NULL;
    if (!good)
        release(m), m = NULL;
    return m;
}

static void analyse_rows(void *context, int64_t n)
{
    step *s = context;
    tc_error error = {TC_OK, ""};
    int64_t cw = tc_coarse_size(s->level.width), ch = tc_coarse_size(s->level.height);
    int64_t j0 = n * s->rows, j1 = tc_min64(j0 + s->rows, ch);
    band_memory *m = reserve(s);
    tc_status status = m ? TC_OK : tc_fail(&error, TC_ERR_MEMORY, "%s: not enough memory", s->p->path);
    tc_rect need = tc_lifting_support(&s->level, j0, j1), rows = {0, j0, cw, j1};
    if (!status)
        status = tc_pack_truth(s->p, s->fine, need, m->fine, s->level.width, &error);
    if (!status) {
        tc_plane fine = {m->fine, s->level.width, need}, low = {m->low, cw, rows}, band[TC_BANDS];
        for (int b = 0; b < TC_BANDS; b++)
            band[b] = (tc_plane){m->band[b], cw, rows};
        tc_lifting_analyse(&s->level, &fine, j0, j1, &low, band, m->scratch);
        for (int b = 0; b < TC_BANDS; b++)
            tc_pack_count(&band[b], &m->histogram[b]);
        status = tc_spool_write(&s->p->truth[s->fine - 2], rows, m->low, cw, &error);
    }
    pthread_mutex_lock(&s->mutex);
    for (int b = 0; b < TC_BANDS && m; b++)
        add_histogram(&s->p->histogram[s->fine - 1][b], &m->histogram[b]);
    pthread_mutex_unlock(&s->mutex);
    tc_pack_failure_keep(&s->failure, status, &error);
    if (m)
        release(m);
}

/* Mean square of what the details add to the upsampled coarser level, in square metres, as if the transform were
 * orthogonal: it nearly is. */
static double residual_variance(const tc_packer *p, int l)
{
    double sum = 0;
    int64_t samples = p->container.level[l - 1].width * p->container.level[l - 1].height;
    for (int b = 0; b < TC_BANDS; b++)
        sum += (double)p->histogram[l - 1][b].square * tc_lifting_norm(b, 0) * tc_lifting_norm(b, 0);
    return sum / (double)samples * p->container.z_unit * p->container.z_unit;
}

tc_status tc_pack_cascade(tc_packer *p, tc_error *error)
{
    enum { BUDGET = 64 << 20, THREADS = 16 };
    tc_container *c = &p->container;
    double weight = 0, all = 0;
    for (int l = c->base + 1; l <= c->levels; l++)
        all += (double)c->level[l - 1].width * (double)c->level[l - 1].height;
    for (int l = c->levels; l > c->base; l--) {
        step s = {
            .p = p, .fine = l, .level = tc_container_lifting(c, l), .failure = {.mutex = PTHREAD_MUTEX_INITIALIZER}};
        int64_t cw = tc_coarse_size(s.level.width), ch = tc_coarse_size(s.level.height);
        tc_status status = tc_spool_create(p->path, cw, ch, sizeof(int32_t), &p->truth[l - 2], error);
        if (status)
            return status;
        /* About 60 bytes of working memory for each coarse sample. */
        s.rows = tc_clamp64(BUDGET / (cw * 60), 8, 256);
        pthread_mutex_init(&s.mutex, NULL);
        int threads = p->options.threads > THREADS || p->options.threads <= 0 ? THREADS : p->options.threads;
        if (p->options.threads <= 0)
            threads = 0;
        tc_parallel_for(threads, (ch + s.rows - 1) / s.rows, analyse_rows, &s);
        pthread_mutex_destroy(&s.mutex);
        if ((status = tc_pack_failure_end(&s.failure, error)))
            return status;
        c->record[l - 1].residual_variance = (float)residual_variance(p, l);
        weight = (double)s.level.width * (double)s.level.height / all;
        if ((status = tc_pack_progress(p, TC_SHARE_CASCADE * weight, error)))
            return status;
    }
    /* The base goes into the head. */
    const tc_level *base = &c->level[c->base - 1];
    tc_status status =
        tc_pack_truth(p, c->base, (tc_rect){0, 0, base->width, base->height}, c->base_z, base->width, error);
    if (!status && c->voids > 0)
        status = tc_pack_mask(p, c->base, (tc_rect){0, 0, base->width, base->height}, c->base_void, base->width, error);
    return status;
}

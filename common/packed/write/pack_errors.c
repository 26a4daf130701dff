/* pack_errors.c - how far levels are off the finest one, measured on what has been packed as whoever opens it would,
 * and put behind the last level, in whose bytes the format has room. */
#include <errno.h>
#include <math.h>
#include <sys/mman.h>
#include <unistd.h>

#include "common/base/crc32c.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/packed/file/error_store.h"
#include "common/packed/read/tile_store.h"
#include "pack_internal.h"

/* Errors of a chart's leaves, in a file without a name that is mapped: they need not stay in memory. */
typedef struct leaves {
    tc_packer *p;
    const tc_container *container;
    void *bytes;
    size_t size;
    float *error[TC_MAX_FIELD_LEVELS]; /* [l - 1], l > 1: row by row */
    double share;
} leaves;

static int64_t leaves_across(int64_t samples)
{
    return tc_ceil_shift(samples, TC_ERROR_TILE_SHIFT);
}

static tc_status reserve(leaves *m, tc_error *error)
{
    const tc_container *c = m->container;
    int64_t count = 0, at = 0;
    for (int l = 2; l <= c->levels; l++)
        count += leaves_across(c->level[l - 1].width) * leaves_across(c->level[l - 1].height);
    m->size = (size_t)count * sizeof(float);
    tc_status status = tc_spool_map(m->p->path, m->size, &m->bytes, error);
    for (int l = 2; l <= c->levels && !status; l++) {
        m->error[l - 1] = (float *)m->bytes + at;
        at += leaves_across(c->level[l - 1].width) * leaves_across(c->level[l - 1].height);
    }
    return status;
}

static void raise_leaves(void *context, int level, tc_rect r, const float *error, ptrdiff_t stride)
{
    const leaves *m = context;
    const int64_t across = leaves_across(m->container->level[level - 1].width);
    for (int64_t y = r.y0; y < r.y1; y++)
        for (int64_t x = r.x0; x < r.x1; x++) {
            float *to = &m->error[level - 1][y * across + x];
            *to = fmaxf(*to, error[(y - r.y0) * stride + x - r.x0]);
        }
}

static bool go_on(void *context, double share)
{
    const leaves *m = context;
    return tc_pack_progress(m->p, m->share * share, NULL) == TC_OK;
}

/* No less than the finer level's. */
static void add_finer(const leaves *m, int l)
{
    const tc_level *level = m->container->level;
    const int64_t nx = leaves_across(level[l - 1].width), fine_x = leaves_across(level[l].width),
                  fine_y = leaves_across(level[l].height);
    for (int64_t y = 0; y < fine_y; y++)
        for (int64_t x = 0; x < fine_x; x++) {
            float *to = &m->error[l - 1][y / 2 * nx + x / 2];
            *to = fmaxf(*to, m->error[l][y * fine_x + x]);
        }
}

/* ---- Into the file ---------------------------------------------------------------------------------------------- */

/* The largest of what was measured of a leaf. */
static float leaf_error(const leaves *m, int l, int shift, int64_t x, int64_t y)
{
    const tc_level *level = &m->container->level[l - 1];
    const int more = shift - TC_ERROR_TILE_SHIFT;
    const int64_t across = leaves_across(level->width), x1 = tc_min64((x + 1) << more, across),
                  y1 = tc_min64((y + 1) << more, leaves_across(level->height));
    float most = 0;
    for (int64_t j = y << more; j < y1; j++)
        for (int64_t i = x << more; i < x1; i++)
            most = fmaxf(most, m->error[l - 1][j * across + i]);
    return most;
}

/* A page's codes; returns the bytes written. */
static size_t code_page(const leaves *m, int l, tc_rect page, const tc_error_place *place, uint8_t *codes,
                        uint8_t *bytes)
{
    const int64_t w = page.x1 - page.x0;
    for (int64_t y = page.y0; y < page.y1; y++)
        for (int64_t x = page.x0; x < page.x1; x++)
            codes[(y - page.y0) * w + x - page.x0] = tc_error_code(place->most, leaf_error(m, l, place->shift, x, y));
    return tc_error_page_write(codes, w, page.y1 - page.y0, bytes);
}

/* A coded level's: directory and pages, from `at` of the file on. */
static tc_status write_level(const leaves *m, int l, int file, tc_error_place *place, tc_error *error)
{
    const tc_level *level = &m->container->level[l - 1];
    const tc_pages pages = tc_level_pages(level);
    const int64_t count = pages.pages_x * pages.pages_y;
    const size_t size = (size_t)tc_directory_bytes(&pages);
    uint8_t *directory = calloc(size, 1), *codes = malloc(TC_ERROR_PAGE_LEAVES), *bytes = malloc(tc_error_page_bound());
    tc_status status = TC_OK;
    if (!directory || !codes || !bytes)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", m->p->path);
    place->bytes = (int64_t)size;
    for (int64_t n = 0; n < count && !status; n++) {
        const tc_rect page = tc_error_page_leaves(level, place->shift, n % pages.pages_x, n / pages.pages_x);
        const size_t written = code_page(m, l, page, place, codes, bytes);
        tc_directory_put(directory, n, (uint64_t)place->bytes, written, tc_crc32c(0, bytes, written));
        status = tc_pack_write(file, bytes, written, place->begin + place->bytes, m->p->path, error);
        place->bytes += (int64_t)written;
    }
    if (!status) {
        tc_directory_seal(directory, count);
        status = tc_pack_write(file, directory, size, place->begin, m->p->path, error);
    }
    free(directory), free(codes), free(bytes);
    return status;
}

static float largest(const float *error, int64_t count)
{
    float most = 0;
    for (int64_t n = 0; n < count; n++)
        most = fmaxf(most, error[n]);
    return most;
}

static int leaf_shift(const tc_container *c, int l, int larger)
{
    const int finer = larger - (c->levels - l);
    return TC_ERROR_TILE_SHIFT + (finer > 0 ? finer : 0);
}

/* Leaves of 16 samples, but for the finest levels, which have the most of them and matter only close by: as small ones
 * as keep to a share of the chart's bytes, about. */
static int finest_leaves(const tc_container *c)
{
    enum { MOST = 4, SHARE = 64 };
    const double leaf = 5.5 / 8; /* bytes */
    int64_t bytes = 0;
    for (int l = c->base + 1; l <= c->levels; l++)
        bytes += c->record[l - 1].end - c->record[l - 1].begin;
    int larger = 0;
    for (; larger < MOST; larger++) {
        int64_t count = 0;
        for (int l = c->base + 1; l <= c->levels; l++) {
            const int shift = leaf_shift(c, l, larger);
            count += tc_ceil_shift(c->level[l - 1].width, shift) * tc_ceil_shift(c->level[l - 1].height, shift);
        }
        if ((double)count * leaf * SHARE <= (double)bytes)
            break;
    }
    return larger;
}

/* From *at on, which is moved. */
static tc_status write_chart(leaves *m, int file, tc_container *to, int64_t *at, tc_error *error)
{
    const tc_container *c = m->container;
    const int larger = finest_leaves(c);
    tc_status status = TC_OK;
    for (int l = c->levels - 1; l > 1; l--)
        add_finer(m, l);
    for (int l = 2; l <= c->levels; l++)
        to->error[l - 1].most =
            largest(m->error[l - 1], leaves_across(c->level[l - 1].width) * leaves_across(c->level[l - 1].height));
    to->errors = c->levels < 2 || isfinite(to->error[1].most);
    for (int l = c->base + 1; l <= c->levels && !status && to->errors; l++) {
        tc_error_place *place = &to->error[l - 1];
        place->shift = leaf_shift(c, l, larger), place->begin = *at;
        status = write_level(m, l, file, place, error);
        *at += place->bytes;
    }
    return status;
}

static tc_status read_file(void *context, int64_t offset, void *bytes, size_t size)
{
    char *to = bytes;
    while (size > 0) {
        const ssize_t n = pread(*(const int *)context, to, size, offset);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return TC_ERR_IO;
        to += n, offset += n, size -= (size_t)n;
    }
    return TC_OK;
}

tc_status tc_pack_errors(tc_packer *p, int file, tc_envelope *e, tc_error *error)
{
    const tc_byte_source source = {&file, e->bytes, read_file, NULL};
    int64_t at = e->bytes;
    double samples = 0;
    tc_status status = TC_OK;
    for (int n = 0; n < e->charts; n++)
        samples += (double)e->chart[n].container.level[e->chart[n].container.levels - 1].width *
                   (double)e->chart[n].container.level[e->chart[n].container.levels - 1].height;
    for (int n = 0; n < e->charts && !status; n++) {
        tc_container *c = &e->chart[n].container;
        const tc_level *finest = &c->level[c->levels - 1];
        leaves m = {.p = p, .container = c};
        tc_field *field = NULL;
        m.share = TC_SHARE_ERRORS * (double)finest->width * (double)finest->height / samples;
        if (c->levels > 1)
            status = reserve(&m, error);
        if (!status)
            status = tc_packed_open_chart(p->path, &source, n, NULL, NULL, &field, error);
        if (!status &&
            (status = tc_measure_errors_to(field, &(tc_error_sink){&m, raise_leaves, go_on}, p->options.threads)))
            tc_fail(error, status, "%s: %s", p->path, status == TC_ERR_IO ? "interrupted" : tc_status_text(status));
        tc_field_destroy(field);
        if (!status)
            status = write_chart(&m, file, c, &at, error);
        if (m.bytes)
            munmap(m.bytes, m.size);
    }
    bool all = true; /* else some are so far apart that floats do not hold it */
    for (int n = 0; n < e->charts; n++)
        all &= e->chart[n].container.errors;
    e->chart[0].container.errors = all;
    if (!status && !all && ftruncate(file, e->bytes) != 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", p->path, strerror(errno));
    tc_envelope_append(e, all ? at - e->bytes : 0);
    return status;
}

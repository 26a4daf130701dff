/* pack_fill.c - voids of the heights as they are given: their mask, and the surface that is laid over them. */
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/fill_rows.h"
#include "pack_internal.h"

void tc_pack_note_voids(tc_packer *p, const uint8_t *row, int64_t y)
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
    int64_t w = f->spool->width;
    return tc_pack_set_source(f->p, (tc_rect){0, y0, w, y0 + rows}, z + f->beyond, w + 2 * f->beyond, f->error);
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
            tc_pack_note_voids(p, voids + (j - y) * w, j);
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

/* pack_synthesis.c - how a terrain's detail goes on below its samples, fitted to the heights as they were given: the
 * packed ones have lost some of it. Only what the fit looks at is filtered, so that no pyramid of floats is needed. */
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/filter.h"
#include "common/synthesis/synthesis_store.h"
#include "pack_internal.h"

/* The heights given, as a field. */
typedef struct given {
    tc_field head;
    const tc_packer *p;
    tc_error why;
} given;

/* Samples around a coarse one that it is made of, at the finer level, and somewhat more: an even number. */
enum { AROUND = 8 };

/* Heights of level l over rect, of which columns may stick out where the level wraps. */
static tc_status heights(given *g, int l, tc_rect rect, float *z, ptrdiff_t stride)
{
    const tc_packer *p = g->p;
    const tc_container *c = &p->container;
    if (l == c->levels) {
        tc_status status = tc_spool_read_round(&p->source, rect, z, stride, &g->why);
        for (int64_t j = 0; j < rect.y1 - rect.y0 && !status; j++)
            for (int64_t i = 0; i < rect.x1 - rect.x0; i++) /* minus zero stands for zero there */
                z[j * stride + i] += 0;
        return status;
    }
    /* Enough of the finer level that where it is cut does not tell: as of a terrain of its own, with its borders where
     * the level's are. */
    const tc_level fine = c->level[l];
    const bool wraps = l >= c->wraps_from;
    tc_rect all = {0, 0, fine.width, fine.height};
    tc_rect part = tc_rect_grown((tc_rect){2 * rect.x0, 2 * rect.y0, 2 * rect.x1, 2 * rect.y1}, AROUND);
    if (wraps)
        all.x0 = part.x0, all.x1 = part.x1;
    part = tc_rect_intersect(part, all);
    const int64_t w = part.x1 - part.x0, h = part.y1 - part.y0, cw = tc_coarse_size(w);
    const int64_t x = rect.x0 - part.x0 / 2, y = rect.y0 - part.y0 / 2, rows = rect.y1 - rect.y0;
    float *from = malloc((size_t)(w * h) * sizeof *from), *to = malloc((size_t)(cw * rows) * sizeof *to);
    float *scratch = malloc(tc_downsample_scratch(w, rows) * sizeof *scratch);
    tc_status status = from && to && scratch ? heights(g, l + 1, part, from, w) : TC_ERR_MEMORY;
    if (!status) {
        tc_downsample(from, w, h, false, y, y + rows, to, scratch);
        for (int64_t j = 0; j < rows; j++)
            memcpy(z + j * stride, to + j * cw + x, (size_t)(rect.x1 - rect.x0) * sizeof *z);
    }
    free(from), free(to), free(scratch);
    return status;
}

static tc_status given_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                            ptrdiff_t stride)
{
    given *g = (given *)field;
    tc_status status = samples ? heights(g, level, rect, samples, stride) : TC_OK;
    if (!status && voids && g->p->container.voids > 0)
        status = tc_pack_mask(g->p, level, rect, voids, stride, &g->why);
    for (int64_t j = 0; voids && g->p->container.voids == 0 && j < rect.y1 - rect.y0; j++)
        memset(voids + j * stride, 0, (size_t)(rect.x1 - rect.x0));
    return status;
}

tc_status tc_pack_synthesis(tc_packer *p, tc_error *error)
{
    static const tc_field_class class = {.sample = TC_FIELD_HEIGHTS, .read = given_read};
    tc_container *c = &p->container;
    given g = {.head.class = &class, .p = p, .why = {TC_OK, ""}};
    tc_synthesis_fit fit;
    g.head.info.levels = c->levels, g.head.info.wraps_x = c->levels >= c->wraps_from;
    memcpy(g.head.level, c->level, sizeof c->level);
    tc_status status = tc_synthesis_learn(&g.head, &fit, error);
    if (status)
        return g.why.status ? tc_fail(error, g.why.status, "%s: %s", p->path, g.why.text)
                            : tc_fail(error, status, "%s: not enough memory", p->path);
    tc_synthesis_number beyond;
    if (!tc_synthesis_can_put(&fit, &beyond))
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: fit for synthesis: %s: expected %g to %g, found %g", p->path,
                       beyond.name, beyond.least, beyond.most, beyond.value);
    c->synthesis = malloc(sizeof fit);
    if (!c->synthesis)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    *c->synthesis = fit;
    return TC_OK;
}

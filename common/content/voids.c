/* voids.c - the mask of samples without a height: 255, else 0. Beyond the terrain's sides it goes on as at its border.
 */
#include "beyond.h"
#include "ground.h"
#include "torus.h"

static size_t scratch_bytes(int n)
{
    return (size_t)(n + 1) * (size_t)(n + 2); /* and a row */
}

static tc_status fill(const tc_fill *f)
{
    const tc_field *field = tc_clipmap_field(f->clipmap);
    int level = tc_clipmap_field_level(f->clipmap, f->level);
    bool wraps = tc_clipmap_level(f->clipmap, f->level)->wraps;
    tc_level size = tc_field_level(field, level);
    tc_rect r = f->rect, part = r; /* what there is of it */
    if (!wraps)
        part.x0 = tc_nearest_sample(r.x0, size.width), part.x1 = tc_nearest_sample(r.x1 - 1, size.width) + 1;
    part.y0 = tc_nearest_sample(r.y0, size.height), part.y1 = tc_nearest_sample(r.y1 - 1, size.height) + 1;
    int64_t w = part.x1 - part.x0, mask = f->size - 1;
    uint8_t *in = f->scratch, *row = in + (part.y1 - part.y0) * w;
    tc_status status = tc_fill_read(f, level, part, NULL, in, w);
    if (status)
        return status;
    for (int64_t y = r.y0; y < r.y1; y++) {
        const uint8_t *from = in + (tc_nearest_sample(y, size.height) - part.y0) * w;
        for (int64_t x = r.x0; x < r.x1; x++)
            row[x - r.x0] = from[(wraps ? x : tc_nearest_sample(x, size.width)) - part.x0] ? 255 : 0;
        tc_torus_store((uint8_t *)f->texels + (y & mask) * f->size, r.x0, mask, row, r.x1 - r.x0, 1);
    }
    return TC_OK;
}

const tc_content_class tc_voids_content = {.name = "voids",
                                           .format = TC_TEXEL_R8,
                                           .scale = 1,
                                           .reach_finer = -1,
                                           .scratch_bytes = scratch_bytes,
                                           .fill = fill};

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
    const tc_clamped c = tc_clamped_rows(f);
    const tc_rect r = f->rect;
    int64_t w = c.part.x1 - c.part.x0, h = c.part.y1 - c.part.y0, mask = f->size - 1;
    uint8_t *in = f->scratch, *row = in + h * w;
    tc_status status = tc_fill_read(f, tc_clipmap_field_level(f->clipmap, f->level), c.part, NULL, in, w);
    if (status)
        return status;
    for (int64_t i = 0; i < h * w; i++)
        in[i] = in[i] ? 255 : 0;
    for (int64_t y = r.y0; y < r.y1; y++) {
        tc_clamped_row(&c, in, 1, y, r, row);
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

/* colours.c - a field's colours as they are. Beyond its sides they go on as at its border. */
#include "colours.h"

#include "beyond.h"
#include "torus.h"

enum { BYTES = 4 };

static size_t scratch_bytes(int n)
{
    return (size_t)(n + 1) * (size_t)(n + 2) * BYTES; /* and a row */
}

static tc_status fill(const tc_fill *f)
{
    const tc_clamped c = tc_clamped_rows(f);
    const tc_rect r = f->rect;
    int64_t w = c.part.x1 - c.part.x0, h = c.part.y1 - c.part.y0, mask = f->size - 1;
    uint8_t(*in)[BYTES] = f->scratch, (*row)[BYTES] = in + h * w;
    tc_status status = tc_fill_read(f, tc_clipmap_field_level(f->clipmap, f->level), c.part, in, NULL, w);
    if (status)
        return status;
    for (int64_t y = r.y0; y < r.y1; y++) {
        tc_clamped_row(&c, in, BYTES, y, r, row);
        tc_torus_store((uint8_t(*)[BYTES])f->texels + (y & mask) * f->size, r.x0, mask, row, r.x1 - r.x0, BYTES);
    }
    return TC_OK;
}

const tc_content_class tc_colours_content = {.name = "colours",
                                             .format = TC_TEXEL_SRGB8_ALPHA8,
                                             .scale = 1,
                                             .reach_finer = -1,
                                             .scratch_bytes = scratch_bytes,
                                             .fill = fill};

/* stripes.c - a content that only tests know. */
#include "stripes.h"

#include "common/base/rect.h"

uint8_t stripe(const tc_content *content, int level, int64_t x, int64_t y)
{
    return (uint8_t)((int64_t)content->parameter * (x ^ 3 * y) + level);
}

static size_t no_scratch(int n)
{
    (void)n;
    return 0;
}

static tc_status fill(const tc_fill *f)
{
    uint8_t *texels = f->texels;
    for (int64_t y = 2 * f->rect.y0 - 1; y < 2 * f->rect.y1; y++)
        for (int64_t x = 2 * f->rect.x0 - 1; x < 2 * f->rect.x1; x++)
            texels[(y & (f->size - 1)) * f->size + (x & (f->size - 1))] = stripe(f->content, f->level, x, y);
    return TC_OK;
}

const tc_content_class stripes = {.name = "stripes",
                                  .format = TC_TEXEL_R8,
                                  .scale = 2,
                                  .border = 1,
                                  .reach_finer = -1,
                                  .scratch_bytes = no_scratch,
                                  .fill = fill};

void stripes_want(const tc_clipmap *c, int64_t x, int64_t y, tc_rect wanted[TC_MAX_LEVELS])
{
    int n = tc_clipmap_n(c);
    for (int l = 1; l <= tc_clipmap_levels(c); l++) {
        const tc_clip_level *v = tc_clipmap_level(c, l);
        int64_t i = ((x >> v->shift) - n / 2) & ~(int64_t)1, j = ((y >> v->shift) - n / 2) & ~(int64_t)1;
        wanted[l - 1] = tc_rect_intersect((tc_rect){i, j, i + n, j + n}, v->extent);
    }
}

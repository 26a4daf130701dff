/* codec_lh04_level.c - the fine level from the coarser one and its residual: U in integers. */
#include "codec_lh04_tile.h"

tc_rect tc_lh04_needs(const tc_lifting_level *level, tc_rect rect)
{
    int64_t cw = tc_coarse_size(level->width), ch = tc_coarse_size(level->height);
    tc_rect r = {tc_floor_shift(rect.x0, 1) - 1, tc_floor_shift(rect.y0, 1) - 1, tc_floor_shift(rect.x1 - 1, 1) + 3,
                 tc_floor_shift(rect.y1 - 1, 1) + 3};
    if (tc_rect_empty(rect))
        return (tc_rect){0, 0, 0, 0};
    if (!level->wrap_x)
        r.x0 = tc_max64(r.x0, 0), r.x1 = tc_min64(r.x1, cw);
    r.y0 = tc_max64(r.y0, 0), r.y1 = tc_min64(r.y1, ch);
    return r;
}

TC_LH04_INLINE int32_t four_point(uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    return (int32_t)(9 * (b + c) - (a + d) + 8) >> 4;
}

/* edge + steps * (edge - inner): the straight line beyond a border. */
TC_LH04_INLINE int32_t beyond(int32_t edge, int32_t inner, int64_t steps)
{
    return (int32_t)((uint32_t)edge + (uint32_t)steps * ((uint32_t)edge - (uint32_t)inner));
}

enum { CHUNK = 256, LINE = CHUNK / 2 + 8 }; /* fine columns at once; coarse ones */

/* Row j of the coarser level, columns x0 .. x0 + count - 1; `made` takes it where it lies beyond a border. */
TC_LH04_INLINE const int32_t *coarse_row(const tc_plane *coarse, int64_t ch, int64_t j, int64_t x0, int count,
                                         int32_t made[LINE])
{
    if (j >= 0 && j < ch)
        return tc_plane_at(coarse, x0, j);
    int64_t edge = j < 0 ? 0 : ch - 1, inner = j < 0 ? ch > 1 : ch - 1 - (ch > 1);
    const int32_t *e = tc_plane_at(coarse, x0, edge), *n = tc_plane_at(coarse, x0, inner);
    for (int i = 0; i < count; i++)
        made[i] = beyond(e[i], n[i], j < 0 ? -j : j - edge);
    return made;
}

/* U and the sum for at most CHUNK columns. */
TC_LH04_INLINE void assemble(const tc_lifting_level *level, const tc_plane *coarse, const tc_plane *residual,
                             const tc_plane *fine, tc_rect r)
{
    tc_rect need = tc_lh04_needs(level, r);
    int64_t cw = tc_coarse_size(level->width), ch = tc_coarse_size(level->height), i0 = tc_floor_shift(r.x0, 1);
    int count = (int)(need.x1 - need.x0), evens = (int)(tc_floor_shift(r.x1 - 1, 1) - i0) + 1;
    int from = (int)(need.x0 - (i0 - 1)); /* columns i0 - 1 .. are needed */
    for (int64_t y = r.y0; y < r.y1; y++) {
        int32_t made[4][LINE], line[LINE], out[CHUNK + 2]; /* line[0]: column i0 - 1 */
        int64_t j = tc_floor_shift(y, 1);
        int32_t *row = line + from;
        if (y % 2 == 0) {
            memcpy(row, tc_plane_at(coarse, need.x0, j), (size_t)count * sizeof *row);
        } else {
            const int32_t *a = coarse_row(coarse, ch, j - 1, need.x0, count, made[0]);
            const int32_t *b = coarse_row(coarse, ch, j, need.x0, count, made[1]);
            const int32_t *c = coarse_row(coarse, ch, j + 1, need.x0, count, made[2]);
            const int32_t *d = coarse_row(coarse, ch, j + 2, need.x0, count, made[3]);
            for (int i = 0; i < count; i++)
                row[i] = four_point((uint32_t)a[i], (uint32_t)b[i], (uint32_t)c[i], (uint32_t)d[i]);
        }
        if (!level->wrap_x) {
            int64_t first = 0 - (i0 - 1), last = cw - 1 - (i0 - 1); /* the borders in line[] */
            if (first == 1)
                line[0] = beyond(line[1], line[1 + (cw > 1)], 1);
            for (int64_t i = last + 1; i < evens + 3; i++)
                line[i] = beyond(line[last], line[last - (cw > 1)], i - last);
        }
        for (int i = 0; i < evens; i++) {
            const uint32_t *e = (const uint32_t *)line + i;
            out[2 * i] = line[i + 1];
            out[2 * i + 1] = four_point(e[0], e[1], e[2], e[3]);
        }
        const int32_t *u = out + (r.x0 - 2 * i0), *more = residual ? tc_plane_at(residual, r.x0, y) : NULL;
        int32_t *z = tc_plane_at(fine, r.x0, y);
        for (int64_t i = 0; i < r.x1 - r.x0; i++)
            z[i] = (int32_t)((uint32_t)u[i] + (more ? (uint32_t)more[i] : 0));
    }
}

void tc_lh04_assemble(const tc_lifting_level *level, const tc_plane *coarse, const tc_plane *residual,
                      const tc_plane *fine)
{
    tc_rect r = fine->rect;
    for (int64_t x = r.x0; x < r.x1; x += CHUNK)
        assemble(level, coarse, residual, fine, (tc_rect){x, r.y0, tc_min64(x + CHUNK, r.x1), r.y1});
}

/* fine_voids.c - a sample lies in one of the two triangles of a cell of the data. */
#include "fine_voids.h"

#include "common/base/rect.h"

void tc_fine_voids(const uint8_t *data, tc_rect around, int k, tc_rect rect, uint8_t *voids, ptrdiff_t stride)
{
    int64_t w = around.x1 - around.x0, one = (int64_t)1 << k;
    for (int64_t y = rect.y0; y < rect.y1; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++) {
            int64_t i = tc_floor_shift(x, k), j = tc_floor_shift(y, k), tx = x - i * one, ty = y - j * one;
            const uint8_t *c = data + (j - around.y0) * w + (i - around.x0);
            bool lower = tx + ty <= one;
            int v = lower ? (tx + ty < one && c[0]) : (tx + ty > one && c[w + 1]);
            v |= (lower ? tx : one - ty) > 0 && c[1];
            v |= (lower ? ty : one - tx) > 0 && c[w];
            voids[(y - rect.y0) * stride + (x - rect.x0)] = (uint8_t)v;
        }
}

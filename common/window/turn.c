/* turn.c - row by row, each by way of a copy, since what is taken may lie where other parts of it go. */
#include "turn.h"

#include <string.h>

#include "common/base/rect.h"

void tc_turn_texels(void *texels, int64_t size, size_t bytes, tc_rect rect, int64_t first, int64_t period, void *row)
{
    unsigned char *copy = row;
    int64_t mask = size - 1, begin = rect.x0 - tc_turn(rect.x0 - first, period);
    for (int64_t y = rect.y0; y < rect.y1; y++) {
        unsigned char *line = (unsigned char *)texels + (size_t)((y & mask) * size) * bytes;
        for (int64_t x = rect.x0, from = begin; x < rect.x1; x++) {
            memcpy(copy + (size_t)(x - rect.x0) * bytes, line + (size_t)(from & mask) * bytes, bytes);
            from = from + 1 < first + period ? from + 1 : first;
        }
        for (int64_t x = rect.x0; x < rect.x1; x++)
            memcpy(line + (size_t)(x & mask) * bytes, copy + (size_t)(x - rect.x0) * bytes, bytes);
    }
}

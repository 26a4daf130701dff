/* pyramid.h - the reader interface behind tc_pyramid: what a kind of pyramid (in memory, packed) implements. */
#ifndef TC_PYRAMID_H
#define TC_PYRAMID_H

#include "common/terraclip.h"

/* Rectangles are not empty and lie within the level: what sticks out of a level that wraps is cut into pieces before,
 * but for `ready`: pieces would take turns in pushing each other out of a cache. */
typedef struct tc_pyramid_class {
    tc_status (*read)(const tc_pyramid *pyramid, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride);
    void (*bounds)(const tc_pyramid *pyramid, int level, tc_rect rect, float *z_min_ret, float *z_max_ret);
    bool (*ready)(const tc_pyramid *pyramid, int level, tc_rect rect); /* NULL: always */
    size_t (*bytes)(const tc_pyramid *pyramid);
    void (*destroy)(tc_pyramid *pyramid);
} tc_pyramid_class;

enum { TC_MAX_PYRAMID_LEVELS = 48 };

/* The head of every kind of pyramid. */
struct tc_pyramid {
    const tc_pyramid_class *class;
    tc_terrain_info info;
    tc_level level[TC_MAX_PYRAMID_LEVELS]; /* [l - 1] */
};

/* Fills in the sizes and spacings of all levels and info.levels from the finest. */
void tc_pyramid_set_levels(tc_pyramid *pyramid, tc_level finest);

/* Whether reading rect (cut to the level where that does not wrap) would take no time to speak of. Where it would, a
 * thread begins to see to it that it soon does not. */
bool tc_pyramid_ready(const tc_pyramid *pyramid, int level, tc_rect rect);

#endif

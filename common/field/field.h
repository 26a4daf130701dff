/* pyramid.h - the reader interface behind tc_field: what a kind of pyramid (in memory, packed) implements. */
#ifndef TC_FIELD_H
#define TC_FIELD_H

#include "common/terraclip.h"

/* Rectangles are not empty and lie within the level: what sticks out of a level that wraps is cut into pieces before,
 * but for `ready`: pieces would take turns in pushing each other out of a cache. */
typedef struct tc_field_class {
    tc_status (*read)(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride);
    void (*bounds)(const tc_field *field, int level, tc_rect rect, float *z_min_ret, float *z_max_ret);
    bool (*ready)(const tc_field *field, int level, tc_rect rect); /* NULL: always */
    size_t (*bytes)(const tc_field *field);
    void (*destroy)(tc_field *field);
} tc_field_class;

enum { TC_MAX_FIELD_LEVELS = 48 };

/* The head of every kind of pyramid. */
struct tc_field {
    const tc_field_class *class;
    tc_terrain_info info;
    tc_level level[TC_MAX_FIELD_LEVELS]; /* [l - 1] */
};

/* Fills in the sizes and spacings of all levels and info.levels from the finest. */
void tc_field_set_levels(tc_field *field, tc_level finest);

/* Whether reading rect (cut to the level where that does not wrap) would take no time to speak of. Where it would, a
 * thread begins to see to it that it soon does not. */
bool tc_field_ready(const tc_field *field, int level, tc_rect rect);

#endif

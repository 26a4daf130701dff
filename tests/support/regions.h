/* regions.h - what must be true of a clipmap after every update. */
#ifndef REGIONS_H
#define REGIONS_H

#include "common/content/ground.h"
#include "terrains.h"

/* LH04's four constraints of section 5, and that no region leaves its window or the terrain; NULL, or what is broken.
 */
const char *regions_broken(const tc_clipmap *clipmap);

/* Every height of every level held against the pyramid; NULL, or what differs. */
const char *heights_broken(const tc_clipmap *clipmap);

/* The same of windows over a field of colours, of one level. */
const char *colours_broken(const tc_clipmap *clipmap, int level);

/* All that a level holds against the pyramid: heights (also on the terrain's edge), morph targets, voids, and normals
 * computed anew in double. NULL, or what differs. Every `step`th row only. */
const char *content_broken(const tc_clipmap *clipmap, int level, int64_t first_row, int64_t step);

/* A random move of a viewer (x, y, height): steps, sprints, reversals, teleports, far outside. */
typedef struct wanderer {
    test_random random;
    tc_camera camera;
    double vx, vy;
    double size_x, size_y; /* metres of the terrain */
    double spacing;
} wanderer;
wanderer wanderer_start(const tc_field *field, uint64_t seed);
void wanderer_move(wanderer *w, const tc_field *field);

#endif

/* ground.h - the contents of a terrain's windows: heights always, normals and voids where a scene needs them. */
#ifndef TC_GROUND_H
#define TC_GROUND_H

#include <math.h>

#include "common/window/clipmap.h"

extern const tc_content_class tc_heights_content; /* pairs (z, z_c), metres above z_base */
/* (x, y) of the level's own normal and of the coarser level's on the same spot, in 1/127. Its parameter is `relief`. */
extern const tc_content_class tc_normals_content;
extern const tc_content_class tc_fine_normals_content; /* the same in 1/32767, instead */
extern const tc_content_class tc_voids_content;        /* 255 where there is no height, else 0 */

/* How a chart's axes lie where charts are sheared, so that they meet at an angle on both sides of a seam: at chart
 * coordinates 0 to 1 the share of y in what is neither across nor along seams (chart.h). Normals then are made of
 * differences along that and across it, which are the same from both sides. */
typedef struct tc_shear {
    double (*turn)(double x, double y);
} tc_shear;

typedef struct tc_ground_options {
    int n, max_levels, coarsest; /* as in tc_clipmap_options, and so wraps and spacing_* */
    bool normals;                /* keep normals, too, at twice the resolution, */
    bool fine_normals;           /* and fine ones */
    bool holes;                  /* keep the void mask, too */
    bool wraps;
    double spacing_x, spacing_y;
    /* Metres: levels of spacing g keep slopes times tc_normal_relief(g, relief), since slopes between samples far apart
     * are gentle and would be lost in eight bits. 0: as they are. */
    double relief;
    const tc_shear *shear; /* outlives the clipmap; NULL: axes go on across sides as they are */
} tc_ground_options;

/* By how much a level's normals are steeper than the terrain; at least 1. */
static inline double tc_normal_relief(double spacing, double relief)
{
    return relief > 0 && spacing > relief ? sqrt(spacing / relief) : 1;
}

tc_status tc_ground_create(const tc_field *field, const tc_ground_options *options, tc_clipmap **clipmap_ret,
                           tc_error *error);

/* Toroidal arrays of a level, row stride n+1 (normals: 2(n+1)); NULL where not kept. */
static inline const float (*tc_ground_heights(const tc_clipmap *clipmap, int level))[2]
{
    return (const float(*)[2])tc_clipmap_texels(clipmap, &tc_heights_content, level);
}
static inline const int8_t (*tc_ground_normals(const tc_clipmap *clipmap, int level))[4]
{
    return (const int8_t(*)[4])tc_clipmap_texels(clipmap, &tc_normals_content, level);
}
static inline const uint8_t *tc_ground_voids(const tc_clipmap *clipmap, int level)
{
    return tc_clipmap_texels(clipmap, &tc_voids_content, level);
}

/* Bytes held by heights with their void masks and working space, and by normals. */
void tc_ground_bytes(const tc_clipmap *clipmap, size_t *heights_ret, size_t *normals_ret);

#endif

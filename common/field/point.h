/* point.h - a level of a field between its samples. */
#ifndef TC_POINT_H
#define TC_POINT_H

#include "common/terraclip.h"

/* The cell of a level around a point: heights of its corners, metres above z_base, south-west, south-east, north-west,
 * north-east; those of a level of one row or column twice. voids are 0 where they were not asked for. */
typedef struct tc_cell {
    tc_rect rect; /* its samples: 2 x 2, or fewer where there are no more */
    float z[4];
    uint8_t voids[4];
    double tx, ty; /* where in it the point lies, 0 to 1 */
} tc_cell;

/* Where that of the point (u, v) lies, without heights; and what makes it whole once those of rect were read with a
 * stride of 2. */
tc_cell tc_cell_at(const tc_field *field, int level, double u, double v);
void tc_cell_complete(tc_cell *cell);

/* u on the first turn of a level that wraps; as it is on others. */
double tc_cell_turn(const tc_field *field, int level, double u);

/* Of the point (u, v), in samples of the level; beyond its last samples that of the nearest point, where it does not
 * wrap. Thread-safe. */
tc_status tc_field_cell(const tc_field *field, int level, double u, double v, bool voids, tc_cell *cell_ret);

/* Height there of the mesh of triangles, which is what is drawn on a plane; and interpolated bilinearly, as on a globe.
 */
double tc_cell_mesh(const tc_cell *cell);
double tc_cell_bilinear(const tc_cell *cell);

/* Both for the mesh; where the level wraps, u is anywhere. */
tc_status tc_field_mesh_height(const tc_field *field, int level, double u, double v, double *z_ret);

/* Whether a corner that is void has a share in the mesh there. */
bool tc_cell_void(const tc_cell *cell);

#endif

/* flooded_field.c - heights, or the sea where they are below it. Samples and bounds are cut by the same float, so that
 * bounds stay bounds. */
#include "flooded_field.h"

#include <math.h>

#include "changed_field.h"

/* sea: above z_base. */
static void flood(float sea, tc_rect rect, float *z, ptrdiff_t stride)
{
    for (int64_t j = 0; j < rect.y1 - rect.y0; j++)
        for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
            z[j * stride + i] = z[j * stride + i] < sea ? sea : z[j * stride + i];
}

/* How far a mesh of heights that are cut may be from the mesh, cut, in a triangle across the shore, where its corners
 * are within lo and hi: as far as a line from the one to the other where that is at the sea. */
static float kink(float lo, float hi, float sea)
{
    return lo < sea && sea < hi ? (hi - sea) * ((sea - lo) / (hi - lo)) : 0;
}

/* Bounds of the next coarser level's samples that make the mesh over a rectangle of a level. */
static tc_range mesh_range(const tc_field *base, int level, tc_rect rect)
{
    const tc_rect corners = {rect.x0 >> 1, rect.y0 >> 1, ((rect.x1 - 1) >> 1) + 2, ((rect.y1 - 1) >> 1) + 2};
    tc_range r = tc_field_range(base, level - 1, corners);
    const tc_level *size = &base->level[level - 2];
    if (corners.x1 > size->width ||
        corners.y1 > size->height) { /* it goes on in a straight line there, of heights that are cut before */
        const float relief = 4 * (r.hi - r.lo);
        r.lo -= relief, r.hi += relief;
    }
    return r;
}

/* Places keep their distance or come nearer as they are cut; the rest is the coarser mesh's kinks. What lies under the
 * sea lies on one plane. */
static float flooded_error(float error, tc_range mesh, float sea)
{
    const float over = mesh.hi + error - sea;
    return over <= 0 ? 0 : fminf(error + kink(mesh.lo, mesh.hi, sea), over);
}

static tc_range flooded_range(float sea, const tc_field *base, int level, tc_rect rect)
{
    tc_range r = base->class->range(base, level, rect);
    if (level > 1) {
        const tc_range mesh = mesh_range(base, level, rect);
        r.step = flooded_error(r.step, mesh, sea);
        r.error = flooded_error(r.error, mesh, sea);
    }
    r.lo = fmaxf(r.lo, sea), r.hi = fmaxf(r.hi, sea);
    return r;
}

tc_field *tc_flooded_field_create(tc_field *base, double sea)
{
    static const tc_change change = {flood, flooded_range, .measures = true};
    const float above = (float)(sea - base->info.z_base);
    tc_field *field = tc_changed_field_create(base, &change, above);
    if (field)
        field->info.z_max = fmaxf(field->info.z_max, above);
    return field;
}

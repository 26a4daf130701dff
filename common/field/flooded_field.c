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

/* How far a mesh of heights that are cut may be from a mesh that is cut, where heights are within lo and hi: in a
 * triangle across the shore by no more than it has above the sea, nor than it has below it. */
static float kink(float lo, float hi, float sea)
{
    return fmaxf(fminf(hi - sea, sea - lo), 0);
}

/* Places keep their distance or come nearer as they are cut; the rest is kinks of the two meshes that a bound is of.
 * The other one's samples are as far off as it says, those of a coarser cell next to the rectangle, too. */
static tc_range flooded_range(float sea, const tc_field *base, int level, tc_rect rect)
{
    tc_range r = base->class->range(base, level, rect);
    const tc_range next = tc_field_range(base, level, (tc_rect){rect.x0 - 1, rect.y0 - 1, rect.x1 + 1, rect.y1 + 1});
    r.step += kink(next.lo - next.step, next.hi + next.step, sea);
    r.error += kink(r.lo, r.hi, sea) + kink(r.lo - r.error, r.hi + r.error, sea);
    r.lo = fmaxf(r.lo, sea), r.hi = fmaxf(r.hi, sea);
    return r;
}

tc_field *tc_flooded_field_create(tc_field *base, double sea)
{
    static const tc_change change = {flood, flooded_range};
    const float above = (float)(sea - base->info.z_base);
    tc_field *field = tc_changed_field_create(base, &change, above);
    if (field)
        field->info.z_max = fmaxf(field->info.z_max, above);
    return field;
}

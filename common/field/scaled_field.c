/* scaled_field.c - heights times a factor. Samples and bounds are multiplied alike, by one float, so that bounds stay
 * bounds. */
#include "scaled_field.h"

#include <float.h>
#include <math.h>

#include "changed_field.h"

static void scale(float factor, tc_rect rect, float *z, ptrdiff_t stride)
{
    for (int64_t j = 0; j < rect.y1 - rect.y0; j++)
        for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
            z[j * stride + i] *= factor;
}

/* Products are rounded, and with them how far a sample is from a mesh of others. */
static tc_range scaled_range(float factor, const tc_field *base, int level, tc_rect rect)
{
    const tc_range r = base->class->range(base, level, rect);
    const float lo = factor * r.lo, hi = factor * r.hi, rounding = FLT_EPSILON * fmaxf(fabsf(lo), fabsf(hi));
    return (tc_range){lo, hi, factor * r.step + rounding, factor * r.error + rounding};
}

tc_field *tc_scaled_field_create(tc_field *base, double factor)
{
    static const tc_change change = {scale, scaled_range, .measures = false};
    tc_field *field = tc_changed_field_create(base, &change, (float)factor);
    if (!field)
        return NULL;
    field->info.z_base *= (double)(float)factor; /* by the very factor that samples have */
    field->info.z_min *= (float)factor;
    field->info.z_max *= (float)factor;
    field->info.rms *= factor;
    return field;
}

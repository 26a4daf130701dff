/* curves.c - bits against error of a codec. */
#include "curves.h"

#include <math.h>
#include <stddef.h>

double curve_between(curve_point a, curve_point b, double rms)
{
    return a.bits * pow(b.bits / a.bits, log(rms / a.rms) / log(b.rms / a.rms));
}

double curve_bits(const curve_point *points, int count, double rms)
{
    const curve_point *below = NULL, *above = NULL;
    for (int i = 0; i < count; i++) {
        const curve_point *p = &points[i];
        if (!(p->rms > 0) || !(p->bits > 0))
            continue;
        if (p->rms == rms)
            return p->bits;
        if (p->rms < rms && (!below || p->rms > below->rms))
            below = p;
        if (p->rms > rms && (!above || p->rms < above->rms))
            above = p;
    }
    return below && above ? curve_between(*below, *above, rms) : NAN;
}

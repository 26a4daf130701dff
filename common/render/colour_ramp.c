/* colour_ramp.c - which colour a height has. */
#include "colour_ramp.h"

#include <math.h>

void tc_colour_ramp_at(const tc_colour_ramp *ramp, double height, double low, double high, double rgba_ret[4])
{
    /* The nearest stops on both sides; few, and in any order, since shares and metres may be mixed. */
    const tc_colour_stop *below = 0, *above = 0;
    double z_below = -INFINITY, z_above = INFINITY;
    for (int i = 0; i < ramp->count; i++) {
        const tc_colour_stop *s = &ramp->stop[i];
        double z = s->share ? low + s->at * (high - low) : s->at;
        if (z <= height && z >= z_below)
            below = s, z_below = z;
        if (z > height && z < z_above)
            above = s, z_above = z;
    }
    below = below ? below : above, above = above ? above : below;
    double t = below == above ? 0 : (height - z_below) / (z_above - z_below);
    for (int c = 0; c < 4; c++)
        rgba_ret[c] = (below->rgba[c] + t * (above->rgba[c] - below->rgba[c])) / 255;
}

/* lonlat.c - where a grid of longitude and latitude lies on a globe. */
#include "lonlat.h"

#include <math.h>

#include "common/base/rect.h"

int64_t tc_lonlat_width(int64_t width, int64_t height)
{
    int halvings = 0;
    while (tc_ceil_shift(tc_max64(width, height), halvings) > TC_MOST_ODD)
        halvings++;
    return tc_ceil_shift(width, halvings) << halvings;
}

bool tc_lonlat_round(int64_t columns, double turn)
{
    return fabs((double)columns - turn) <= 0.5 + 1e-6;
}

bool tc_lonlat_of(const tc_georef *georef, int64_t width, int64_t height, tc_lonlat *lonlat_ret)
{
    const double degree = M_PI / 180, slack = 1e-3; /* of a row */
    const double *t = georef->transform;
    if (!georef->known || !georef->geographic || t[2] != 0 || t[4] != 0 || !(t[1] > 0 && t[5] < 0))
        return false;
    double south = t[3] + ((double)height - 0.5) * t[5], north = t[3] + 0.5 * t[5];
    tc_lonlat l = {.width = width, .height = height, .turn = 360 / t[1]};
    l.x0 = degree * (t[0] + 0.5 * t[1]), l.y0 = degree * south;
    l.dx = degree * t[1], l.dy = -degree * t[5];
    l.south = (south + 90) / -t[5], l.north = (90 - north) / -t[5];
    l.round = tc_lonlat_round(width, l.turn);
    l.within = l.south >= -slack && l.north >= -slack && ((double)width < l.turn || l.round) && fabs(t[0]) <= 1e4;
    l.poles = l.round && l.south <= 1 + slack && l.north <= 1 + slack;
    *lonlat_ret = l;
    return true;
}

void tc_lonlat_close(tc_lonlat *lonlat)
{
    if (lonlat->round)
        lonlat->dx = 2 * M_PI / (double)lonlat->width;
}

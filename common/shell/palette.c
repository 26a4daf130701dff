/* palette.c - height ramps, interpolated between a few named stops. */
#include "palette.h"

#include <math.h>

typedef struct stop {
    double at;          /* 0 .. 1 of its range */
    uint8_t rgb[3];     /* sRGB-like, as seen */
} stop;

static const stop sea[] = {{0.0, {34, 58, 88}}, {0.6, {48, 84, 116}}, {0.93, {78, 122, 146}}, {1.0, {104, 150, 164}}};
static const stop land[] = {{0.00, {142, 152, 110}}, {0.10, {124, 142, 92}},  {0.25, {112, 130, 82}},
                            {0.40, {132, 138, 96}},  {0.54, {158, 148, 116}}, {0.68, {150, 140, 126}},
                            {0.76, {168, 164, 158}}, {0.84, {232, 234, 236}}, {1.00, {252, 253, 254}}};
static const stop dust[] = {{0.0, {88, 84, 80}}, {0.35, {128, 123, 116}}, {0.7, {164, 158, 150}}, {1.0, {204, 199, 192}}};

enum { HALF = TC_RAMP_SIZE / 2 };

/* The squares of the colours, which interpolate like light does; the shader takes the root. */
static void fill(uint8_t (*ramp)[4], const stop *stops)
{
    for (int i = 0; i < HALF; i++) {
        double at = (double)i / (HALF - 1);
        const stop *s = stops;
        while (at > s[1].at)
            s++;
        double t = (at - s[0].at) / (s[1].at - s[0].at);
        for (int c = 0; c < 3; c++) {
            double v = (s[0].rgb[c] + t * (s[1].rgb[c] - s[0].rgb[c])) / 255;
            ramp[i][c] = (uint8_t)lrint(255 * v * v);
        }
        ramp[i][3] = 255;
    }
}

tc_palette tc_palette_make(const tc_terrain_info *info)
{
    const double SUMMITS = 2600; /* metres above the lowest land, at least, where the ramp ends: no snow on hills */
    const double SHORE = 0.0008; /* of the land's height */
    tc_palette p = {.natural = !info->other_body};
    double lo = info->z_min + info->z_base, hi = info->z_max + info->z_base;
    p.water = p.natural && lo <= 0 && hi > 0;
    double bottom = p.natural ? fmax(lo, 0) : lo;
    double top = p.natural ? fmax(hi, bottom + SUMMITS) : fmax(hi, lo + 1e-3);
    fill(p.ramp, p.natural ? sea : dust);
    fill(p.ramp + HALF, p.natural ? land : dust);
    p.heights[0] = (float)(bottom - info->z_base);
    p.heights[1] = (float)(1 / fmax(-lo, 100));
    p.heights[2] = (float)(1 / (top - bottom));
    p.heights[3] = (float)(SHORE * (hi - bottom));
    return p;
}

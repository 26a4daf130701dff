/* palette.c - height ramps, interpolated between a few named stops. */
#include "palette.h"

#include <math.h>

typedef struct stop {
    double at;      /* 0 .. 1 of its range */
    uint8_t rgb[3]; /* sRGB-like, as seen */
} stop;

static const stop sea[] = {{0.0, {24, 48, 82}}, {0.6, {36, 74, 112}}, {0.93, {64, 112, 140}}, {1.0, {92, 142, 158}}};
static const stop land[] = {{0.00, {124, 134, 92}},  {0.06, {104, 124, 74}},  {0.22, {86, 108, 60}},
                            {0.38, {108, 116, 74}},  {0.52, {140, 128, 98}},  {0.66, {130, 120, 108}},
                            {0.75, {154, 150, 146}}, {0.82, {230, 232, 235}}, {1.00, {252, 253, 254}}};
static const stop dust[] = {
    {0.0, {88, 84, 80}}, {0.35, {128, 123, 116}}, {0.7, {164, 158, 150}}, {1.0, {204, 199, 192}}};

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
    static const float sky[2][2][3] = {{{0.004f, 0.004f, 0.005f}, {0.001f, 0.001f, 0.002f}},
                                       {{0.56f, 0.66f, 0.78f}, {0.055f, 0.17f, 0.45f}}};
    for (int c = 0; c < 3; c++) {
        p.horizon[c] = sky[p.natural][0][c];
        p.zenith[c] = sky[p.natural][1][c];
    }
    double lo = info->z_min + info->z_base, hi = info->z_max + info->z_base;
    /* What lies wholly below 0 is a sea's bottom where it is deep, else a dry depression. */
    p.water = p.natural && lo <= 0 && (hi > 0 || lo < -1000);
    double bottom = !p.natural ? lo : p.water ? 0 : hi > 0 ? fmax(lo, 0) : lo;
    double top = p.natural ? fmax(hi, bottom + SUMMITS) : fmax(hi, lo + 1e-3);
    fill(p.ramp, p.natural ? sea : dust);
    fill(p.ramp + HALF, p.natural ? land : dust);
    p.heights[0] = (float)(bottom - info->z_base);
    p.heights[1] = (float)(1 / fmax(-lo, 100));
    p.heights[2] = (float)(1 / (top - bottom));
    p.heights[3] = (float)(SHORE * fmax(hi - bottom, 0));
    return p;
}

tc_terrain_info tc_palette_heights(const tc_terrain_info *drawn, double exaggeration)
{
    tc_terrain_info info = *drawn;
    info.z_base /= exaggeration;
    info.z_min = (float)((double)info.z_min / exaggeration);
    info.z_max = (float)((double)info.z_max / exaggeration);
    return info;
}

void tc_palette_exaggerate(tc_palette *p, double exaggeration, bool degrees)
{
    p->heights[0] = (float)((double)p->heights[0] * exaggeration);
    p->heights[1] = (float)((double)p->heights[1] / exaggeration);
    if (degrees)
        return;
    p->heights[2] = (float)((double)p->heights[2] / exaggeration);
    p->heights[3] = (float)((double)p->heights[3] * exaggeration);
}

/* The colour, as seen, that a height above the sea has without a user's. */
static void own_colour(const tc_palette *p, double above_sea, double rgb[3])
{
    bool under = p->water && above_sea <= (double)p->heights[3];
    double share = fmin(fmax(under ? -above_sea * (double)p->heights[1] : above_sea * (double)p->heights[2], 0), 1);
    int at = under ? (int)lrint((1 - share) * (HALF - 1)) : HALF + (int)lrint(share * (HALF - 1));
    for (int c = 0; c < 3; c++)
        rgb[c] = sqrt(p->ramp[at][c] / 255.0);
}

static void set_texel(uint16_t texel[4], const double rgb[3])
{
    for (int c = 0; c < 3; c++)
        texel[c] = (uint16_t)lrint(65535 * rgb[c] * rgb[c]);
    texel[3] = 65535;
}

void tc_palette_give_degrees(tc_palette *palette, const tc_shade *shade, uint16_t ramp[TC_GIVEN_SIZE][4])
{
    for (int i = 0; i < TC_GIVEN_SIZE; i++) {
        double rgba[4];
        tc_colour_ramp_at(&shade->colours, shade->degrees * i / (TC_GIVEN_SIZE - 1), 0, shade->degrees, rgba);
        set_texel(ramp[i], rgba);
    }
    palette->water = false;
    palette->heights[2] = (float)(1 / shade->degrees);
    palette->heights[3] = 0;
}

void tc_palette_give(tc_palette *palette, const tc_terrain_info *info, const tc_colour_ramp *colours,
                     uint16_t ramp[TC_GIVEN_SIZE][4])
{
    const tc_palette own = *palette;
    double low = info->z_min + info->z_base, high = fmax(info->z_max + info->z_base, low + 1e-3);
    double level = (double)own.heights[0] + info->z_base;
    for (int i = 0; i < TC_GIVEN_SIZE; i++) {
        double height = low + (high - low) * i / (TC_GIVEN_SIZE - 1), rgba[4], rgb[3];
        tc_colour_ramp_at(colours, height, low, high, rgba);
        own_colour(&own, height - level, rgb);
        for (int c = 0; c < 3; c++)
            rgb[c] += rgba[3] * (rgba[c] - rgb[c]);
        set_texel(ramp[i], rgb);
    }
    palette->water = false;
    palette->heights[2] = (float)(1 / (high - low));
    palette->heights[3] = (float)(low - level);
}

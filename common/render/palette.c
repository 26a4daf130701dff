/* palette.c - height ramps, interpolated between a few named stops. */
#include "palette.h"

#include <math.h>
#include <string.h>

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
/* Dark basins, bright highlands: most of either lies in the middle of all heights. */
static const stop moon[] = {{0.0, {62, 61, 60}},     {0.28, {84, 83, 81}},    {0.42, {122, 120, 117}},
                            {0.54, {164, 161, 157}}, {0.72, {200, 197, 192}}, {1.0, {236, 234, 230}}};
static const stop mars[] = {{0.0, {92, 58, 44}},   {0.2, {134, 80, 54}},   {0.4, {176, 108, 68}},
                            {0.6, {200, 132, 86}}, {0.8, {220, 170, 124}}, {1.0, {240, 222, 202}}};

/* Bodies by their radius: what they are made of, and what is above it. The last one is all others. */
static const struct body {
    double least, most; /* metres; a radius that is not known is 0 */
    bool natural, air;
    const stop *land;
    float horizon[3], zenith[3], wall[3]; /* squares, as in tc_palette */
} bodies[] = {
    {0, 0, true, true, land, {0.56f, 0.66f, 0.78f}, {0.055f, 0.17f, 0.45f}, {0.36f, 0.255f, 0.165f}},
    {6.3e6, 6.45e6, true, true, land, {0.56f, 0.66f, 0.78f}, {0.055f, 0.17f, 0.45f}, {0.36f, 0.255f, 0.165f}},
    {3.36e6, 3.42e6, false, true, mars, {0.60f, 0.45f, 0.31f}, {0.27f, 0.17f, 0.105f}, {0.26f, 0.12f, 0.065f}},
    {1.73e6,
     1.745e6,
     false,
     false,
     moon,
     {0.0012f, 0.0012f, 0.0015f},
     {0.001f, 0.001f, 0.002f},
     {0.17f, 0.165f, 0.16f}},
    {0, INFINITY, false, false, dust, {0.004f, 0.004f, 0.005f}, {0.001f, 0.001f, 0.002f}, {0.16f, 0.15f, 0.14f}}};

static const struct body *body_of(const tc_terrain_info *info)
{
    const struct body *b = bodies, *others = bodies + sizeof bodies / sizeof *bodies - 1;
    while (b < others && (info->semi_major < b->least || info->semi_major > b->most || b->natural == info->other_body))
        b++;
    return b;
}

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

double tc_sea_noise(const tc_terrain_info *info)
{
    const double MOST = 2; /* rms; of a sea that is level less than one sample in fifty is further off */
    return (double)info->z_min + info->z_base >= -info->rms ? MOST * info->rms : 0;
}

tc_palette tc_palette_make(const tc_terrain_info *info)
{
    const double SUMMITS = 2600; /* metres above the lowest land, at least, where the ramp ends: no snow on hills */
    const double SHORE = 0.0008; /* of the land's height */
    const double NO_DEPTH = 1e5; /* metres of a sea whose depths are noise */
    const double FLOATS = 1e-6;  /* of heights that are told by them, as of all that lies at the sea */
    const struct body *body = body_of(info);
    tc_palette p = {.natural = body->natural, .air = body->air};
    memcpy(p.horizon, body->horizon, sizeof p.horizon);
    memcpy(p.zenith, body->zenith, sizeof p.zenith);
    memcpy(p.wall, body->wall, sizeof p.wall);
    double lo = info->z_min + info->z_base, hi = info->z_max + info->z_base;
    /* What lies wholly below 0 is a sea's bottom where it is deep, else a dry depression. */
    p.water = p.natural && lo <= 0 && (hi > 0 || lo < -1000);
    double bottom = !p.natural ? lo : p.water ? 0 : hi > 0 ? fmax(lo, 0) : lo;
    double top = p.natural ? fmax(hi, bottom + SUMMITS) : fmax(hi, lo + 1e-3);
    fill(p.ramp, p.natural ? sea : body->land);
    fill(p.ramp + HALF, body->land);
    p.heights[0] = (float)(bottom - info->z_base);
    const double noise = p.water ? tc_sea_noise(info) : 0;
    p.heights[1] = (float)(1 / (noise > 0 ? NO_DEPTH : fmax(-lo, 100)));
    p.heights[2] = (float)(1 / (top - bottom));
    p.heights[3] = (float)(fmax(SHORE * fmax(hi - bottom, 0), noise) + FLOATS * fmax(fabs(lo), fabs(hi)));
    return p;
}

tc_terrain_info tc_palette_heights(const tc_terrain_info *drawn, double exaggeration)
{
    tc_terrain_info info = *drawn;
    info.z_base /= exaggeration;
    info.z_min = (float)((double)info.z_min / exaggeration);
    info.z_max = (float)((double)info.z_max / exaggeration);
    info.rms /= exaggeration;
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

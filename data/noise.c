/* noise.c - hashes and gradient noise that give the same bits on every machine.
 *
 * Gradient noise with the quintic fade of Perlin, "Improving Noise" (SIGGRAPH 2002). Two differences: the gradients
 * come from a hash of the lattice point instead of a permutation table, so that nothing repeats on a large terrain, and
 * they are 32 unit vectors turned off the axes, since the paper's axis and diagonal ones show as straight ridges once
 * the noise is eroded. Ridged multifractal: Musgrave in Ebert et al., "Texturing and Modeling", 3rd ed., ch. 16, with
 * the weight clamped.
 *
 * Only + - * and integer arithmetic are used, and the build forbids contraction to fused multiply-add; libm's
 * functions differ in their last bits between machines. Coordinates are double, since a lattice coordinate can exceed
 * the 2^24 steps of a float over a large terrain; what happens inside one lattice cell is float. */
#include "noise.h"

/* Unit vectors at (k + 1/3) * 360/32 degrees. */
static const float gradient[32][2] = {
    {0.997858923f, 0.065403129f},   {0.965925826f, 0.258819045f},   {0.896872742f, 0.442288690f},
    {0.793353340f, 0.608761429f},   {0.659345815f, 0.751839807f},   {0.500000000f, 0.866025404f},
    {0.321439465f, 0.946930129f},   {0.130526192f, 0.991444861f},   {-0.065403129f, 0.997858923f},
    {-0.258819045f, 0.965925826f},  {-0.442288690f, 0.896872742f},  {-0.608761429f, 0.793353340f},
    {-0.751839807f, 0.659345815f},  {-0.866025404f, 0.500000000f},  {-0.946930129f, 0.321439465f},
    {-0.991444861f, 0.130526192f},  {-0.997858923f, -0.065403129f}, {-0.965925826f, -0.258819045f},
    {-0.896872742f, -0.442288690f}, {-0.793353340f, -0.608761429f}, {-0.659345815f, -0.751839807f},
    {-0.500000000f, -0.866025404f}, {-0.321439465f, -0.946930129f}, {-0.130526192f, -0.991444861f},
    {0.065403129f, -0.997858923f},  {0.258819045f, -0.965925826f},  {0.442288690f, -0.896872742f},
    {0.608761429f, -0.793353340f},  {0.751839807f, -0.659345815f},  {0.866025404f, -0.500000000f},
    {0.946930129f, -0.321439465f},  {0.991444861f, -0.130526192f},
};

static inline uint32_t hash_point(uint32_t seed, uint32_t x, uint32_t y)
{
    uint32_t h = seed ^ (x * 0x9E3779B1u) ^ ((y * 0x85EBCA77u) << 13 | (y * 0x85EBCA77u) >> 19);
    h = (h ^ (h >> 16)) * 0x7FEB352Du;
    h = (h ^ (h >> 15)) * 0x846CA68Bu;
    return h ^ (h >> 16);
}

uint32_t tc_hash_point(uint32_t seed, int32_t x, int32_t y)
{
    return hash_point(seed, (uint32_t)x, (uint32_t)y);
}

static inline int32_t floor_int(double x)
{
    int32_t i = (int32_t)x;
    return i - (x < i);
}

static inline float fade(float t)
{
    return t * t * t * (t * (t * 6 - 15) + 10);
}

/* Noise inside one lattice cell, whose corner gradients are g[0..3] (south-west, south-east, north-west, north-east).
 */
static inline float in_cell(const float *const g[4], float fx, float fy, float v)
{
    float a = g[0][0] * fx + g[0][1] * fy;
    float b = g[1][0] * (fx - 1) + g[1][1] * fy;
    float c = g[2][0] * fx + g[2][1] * (fy - 1);
    float d = g[3][0] * (fx - 1) + g[3][1] * (fy - 1);
    float u = fade(fx);
    float south = a + u * (b - a), north = c + u * (d - c);
    return south + v * (north - south);
}

static inline void corners(uint32_t seed, int32_t ix, int32_t iy, const float *g[4])
{
    for (int k = 0; k < 4; k++)
        g[k] = gradient[hash_point(seed, (uint32_t)ix + (k & 1), (uint32_t)iy + (k >> 1)) >> 27];
}

float tc_noise(uint32_t seed, double x, double y)
{
    int32_t ix = floor_int(x), iy = floor_int(y);
    const float *g[4];
    corners(seed, ix, iy, g);
    float fy = (float)(y - iy);
    return in_cell(g, (float)(x - ix), fy, fade(fy));
}

void tc_noise_row(uint32_t seed, double x, double dx, double y, int64_t count, float gain, float *out)
{
    int32_t iy = floor_int(y), cell = 0;
    float fy = (float)(y - iy), v = fade(fy);
    const float *g[4] = {0};
    for (int64_t i = 0; i < count; i++) {
        double xi = x + (double)i * dx;
        int32_t ix = floor_int(xi);
        if (i == 0 || ix != cell)
            corners(seed, cell = ix, iy, g);
        out[i] += gain * in_cell(g, (float)(xi - ix), fy, v);
    }
}

float tc_fbm(uint32_t seed, double x, double y, int octaves, float gain)
{
    float sum = 0, amplitude = 1;
    for (int k = 0; k < octaves; k++) {
        sum += amplitude * tc_noise(seed + (uint32_t)k * 0x632BE5ABu, x, y);
        amplitude *= gain;
        x = 2 * x + 0.37; /* or all octaves would vanish at the coarsest one's lattice points */
        y = 2 * y + 0.61;
    }
    return sum;
}

/* ---- In space --------------------------------------------------------------------------------------------------- */

/* Unit vectors to the corners of an icosahedron and a dodecahedron, turned off the axes. */
static const float gradient3[32][4] = {
    {-0.233854237f, 0.092848457f, -0.967828166f, 0},  {0.231535552f, -0.771903856f, -0.592077465f, 0},
    {-0.763505470f, -0.554641825f, -0.330804842f, 0}, {0.847937750f, -0.486499859f, 0.210521873f, 0},
    {-0.762072444f, -0.134962508f, 0.633269857f, 0},  {0.094921253f, 0.912698776f, -0.397455533f, 0},
    {-0.847937750f, 0.486499859f, -0.210521873f, 0},  {0.762072444f, 0.134962508f, -0.633269857f, 0},
    {-0.094921253f, -0.912698776f, 0.397455533f, 0},  {0.233854237f, -0.092848457f, 0.967828166f, 0},
    {-0.231535552f, 0.771903856f, 0.592077465f, 0},   {0.763505470f, 0.554641825f, 0.330804842f, 0},
    {-0.321239894f, -0.517498388f, -0.793095423f, 0}, {0.412989580f, -0.910711329f, 0.006669541f, 0},
    {-0.385609985f, 0.184527209f, -0.904021376f, 0},  {0.365541008f, -0.657492199f, -0.658850346f, 0},
    {-0.698245262f, -0.684196584f, -0.210543555f, 0}, {-0.995617486f, -0.085196137f, 0.038567346f, 0},
    {-0.261388012f, -0.478409078f, 0.838332310f, 0},  {0.802398258f, -0.451704694f, 0.390025518f, 0},
    {-0.725624857f, 0.041987536f, 0.686808280f, 0},   {0.244466492f, 0.927215546f, -0.283738376f, 0},
    {0.261388012f, 0.478409078f, -0.838332310f, 0},   {0.995617486f, 0.085196137f, -0.038567346f, 0},
    {-0.802398258f, 0.451704694f, -0.390025518f, 0},  {0.725624857f, -0.041987536f, -0.686808280f, 0},
    {-0.244466492f, -0.927215546f, 0.283738376f, 0},  {-0.412989580f, 0.910711329f, -0.006669541f, 0},
    {0.321239894f, 0.517498388f, 0.793095423f, 0},    {0.385609985f, -0.184527209f, 0.904021376f, 0},
    {-0.365541008f, 0.657492199f, 0.658850346f, 0},   {0.698245262f, 0.684196584f, 0.210543555f, 0},
};

/* Lattices are turned, each octave's against the one before, or creases would run along the axes, and a sphere is
 * tangent to their planes. A rotation by whole numbers over 39, times two. */
static const double turn3[3][3] = {
    {2 * 19 / 39.0, 2 * 2 / 39.0, 2 * 34 / 39.0},
    {2 * 22 / 39.0, 2 * 29 / 39.0, 2 * -14 / 39.0},
    {2 * -26 / 39.0, 2 * 26 / 39.0, 2 * 13 / 39.0},
};

float tc_noise3(uint32_t seed, double x, double y, double z)
{
    int32_t ix = floor_int(x), iy = floor_int(y), iz = floor_int(z);
    float fx = (float)(x - ix), fy = (float)(y - iy), fz = (float)(z - iz);
    uint32_t hx = (uint32_t)ix * 0x9E3779B1u, hy = (uint32_t)iy * 0x85EBCA77u, hz = (uint32_t)iz * 0xC2B2AE3Du;
    float corner[8];
    for (int k = 0; k < 8; k++) {
        uint32_t a = k & 1 ? hx + 0x9E3779B1u : hx, b = k & 2 ? hy + 0x85EBCA77u : hy;
        uint32_t c = k & 4 ? hz + 0xC2B2AE3Du : hz;
        uint32_t h = seed ^ a ^ (b << 13 | b >> 19) ^ (c << 21 | c >> 11);
        h = (h ^ (h >> 16)) * 0x7FEB352Du;
        h = (h ^ (h >> 15)) * 0x846CA68Bu;
        const float *g = gradient3[h >> 27];
        corner[k] = g[0] * (k & 1 ? fx - 1 : fx) + g[1] * (k & 2 ? fy - 1 : fy) + g[2] * (k & 4 ? fz - 1 : fz);
    }
    float u = fade(fx), v = fade(fy), w = fade(fz);
    for (int k = 0; k < 8; k += 2)
        corner[k] += u * (corner[k + 1] - corner[k]);
    float south = corner[0] + v * (corner[2] - corner[0]), north = corner[4] + v * (corner[6] - corner[4]);
    return south + w * (north - south);
}

static void turn(const double p[3], double scale, double shift, double at[3])
{
    double x = p[0], y = p[1], z = p[2];
    at[0] = scale * (turn3[0][0] * x + turn3[0][1] * y + turn3[0][2] * z) + 0.37 * shift;
    at[1] = scale * (turn3[1][0] * x + turn3[1][1] * y + turn3[1][2] * z) + 0.61 * shift;
    at[2] = scale * (turn3[2][0] * x + turn3[2][1] * y + turn3[2][2] * z) + 0.83 * shift;
}

void tc_first_octave3(const double p[3], double frequency, double at[3])
{
    turn(p, 0.5 * frequency, 0, at);
}

void tc_next_octave3(double at[3])
{
    turn(at, 1, 1, at);
}

float tc_fbm3(uint32_t seed, const double p[3], double frequency, int octaves, float gain)
{
    double at[3];
    tc_first_octave3(p, frequency, at);
    float sum = 0, amplitude = 1;
    for (int k = 0; k < octaves; k++) {
        sum += amplitude * tc_noise3(seed + (uint32_t)k * 0x632BE5ABu, at[0], at[1], at[2]);
        amplitude *= gain;
        tc_next_octave3(at);
    }
    return sum;
}

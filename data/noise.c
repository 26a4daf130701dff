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

uint64_t tc_hash64(uint64_t seed, uint64_t number)
{
    /* splitmix64's finaliser over a Weyl step. */
    uint64_t h = seed + (number + 1) * 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    return h ^ (h >> 31);
}

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

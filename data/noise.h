/* noise.h - hashes and gradient noise that give the same bits on every machine. */
#ifndef TC_NOISE_H
#define TC_NOISE_H

#include "common/base/hash.h"

/* A well mixed 32-bit value of an integer lattice point. */
uint32_t tc_hash_point(uint32_t seed, int32_t x, int32_t y);

/* Gradient noise at (x, y) in lattice units: 0 at lattice points, about -0.7..0.7, rms 0.25. */
float tc_noise(uint32_t seed, double x, double y);

/* The same at (x + i * dx, y) for i in 0..count-1, added to out[i] times gain: bit for bit gain * tc_noise(), in less
 * time where dx is well below 1. */
void tc_noise_row(uint32_t seed, double x, double dx, double y, int64_t count, float gain, float *out);

/* Sum of octaves of tc_noise, each at twice the frequency and gain times the amplitude of the one before; not
 * normalised: the first has amplitude 1. */
float tc_fbm(uint32_t seed, double x, double y, int octaves, float gain);

/* Gradient noise at (x, y, z) in lattice units: 0 at lattice points, about -0.8..0.8, rms 0.25. */
float tc_noise3(uint32_t seed, double x, double y, double z);

/* Sum of octaves of tc_noise3 at frequency * p, as tc_fbm. */
float tc_fbm3(uint32_t seed, const double p[3], double frequency, int octaves, float gain);

/* Where p is in the lattice of the first octave, and from there to the next one's, of twice the frequency and another
 * orientation. */
void tc_first_octave3(const double p[3], double frequency, double at[3]);
void tc_next_octave3(double at[3]);

/* 0 below a, 1 above b, a cubic in between. */
static inline float tc_smoothstep(float a, float b, float x)
{
    float t = (x - a) / (b - a);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}

#endif

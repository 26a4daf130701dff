/* synthesis_level.h - one level of synthesised heights from the coarser one: pure functions of planes. */
#ifndef TC_SYNTHESIS_LEVEL_H
#define TC_SYNTHESIS_LEVEL_H

#include "synthesis.h"
#include "synthesis_rows.h"

/* Heights or amplitudes over a rectangle of a level. */
typedef struct tc_patch {
    float *z;
    int64_t stride;
    tc_rect rect;
} tc_patch;

static inline float *tc_patch_at(const tc_patch *p, int64_t i, int64_t j)
{
    return p->z + (j - p->rect.y0) * p->stride + (i - p->rect.x0);
}

enum {
    TC_COARSE_REACH = 6,    /* samples of the coarser level around a cell's that its heights depend on */
    TC_AMPLITUDE_REACH = 3, /* cells around that their noise comes from */
    TC_ENERGY_REACH = 5     /* samples around one that its energy and slope are taken from */
};

/* Samples of the coarser level that fine ones over rect depend on, and where they need amplitudes. */
tc_rect tc_synthesis_needs(tc_rect fine, int reach);

/* What a level is made with. */
typedef struct tc_level_recipe {
    const tc_synthesis_fit *fit;
    uint64_t seed;              /* of chart and level */
    int64_t width, height;      /* of the coarser level */
    bool wraps;                 /* in x */
    float spacing_x, spacing_y; /* metres, of the coarser level */
    float lowest, highest;      /* that heights are cut to */
    const tc_patch *amplitude;  /* A over a coarser grid, */
    int shift;                  /* of samples 2^shift of the coarser level apart */
} tc_level_recipe;

/* Floats of scratch that the functions below take. */
size_t tc_synthesis_scratch(void);
enum { TC_ENERGY_ROWS = 42 }; /* of TC_ROW_PITCH floats: what energies take of it */

/* Writes fine heights over rect. coarse: its heights over tc_synthesis_needs(rect, TC_COARSE_REACH), beyond the level's
 * sides too (tc_extend_beyond()). */
void tc_synthesis_level(const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect, float *z, ptrdiff_t stride,
                        float *scratch);

/* Goes on beyond the sides of a level that does not wrap, in the straight line of the last two samples. */
void tc_extend_beyond(const tc_patch *p, int64_t width, int64_t height, bool wraps);

/* log2 of energy and of squared slope (plus the fit's floors) of the samples within rect; z reaches TC_ENERGY_REACH
 * further. */
void tc_local_energy(const tc_patch *z, const tc_synthesis_fit *fit, float spacing_x, float spacing_y, tc_rect rect,
                     float *energy, float *slope, float *scratch);

/* A of level m + k from these. */
void tc_amplitudes(const tc_synthesis_fit *fit, int k, const float *energy, const float *slope, int64_t count,
                   float *amplitude);

static inline float tc_cut(float v, float lowest, float highest)
{
    v = v < lowest ? lowest : v;
    return v > highest ? highest : v;
}

/* Noise is cut there, in its own rms; and what a level adds to the upsampled coarser one, in A. */
#define TC_NOISE_MOST 6.0f
#define TC_ADDED_MOST 6.0f

/* What curvature foretells of a detail between the middle two of six samples in a row, by shares of their second and
 * their sixth difference; 0 of what is straight. */
static inline float tc_foretold(float a, float b, float c, float d, float e, float f, float second, float sixth)
{
    float middle = c + d, near = (b + e) - middle, far = (a + f) - middle;
    return (-0.0625f * second - (9.0f / 256) * sixth) * near + (3.0f / 256) * sixth * far;
}

#endif

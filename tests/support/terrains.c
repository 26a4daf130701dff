/* terrains.c - terrains for tests, made in memory. */
#include "terrains.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/synthesis/synthesis.h"
#include "data/synth_planar.h"
#include "kept.h"

uint64_t test_random_bits(test_random *r)
{
    uint64_t z = (r->state += 0x9e3779b97f4a7c15u); /* splitmix64 (Steele et al. 2014) */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double test_random_unit(test_random *r)
{
    return (double)(test_random_bits(r) >> 11) * 0x1p-53;
}

double test_random_range(test_random *r, double lo, double hi)
{
    return lo + (hi - lo) * test_random_unit(r);
}

int64_t test_random_int(test_random *r, int64_t lo, int64_t hi)
{
    return lo + (int64_t)(test_random_bits(r) % (uint64_t)(hi - lo + 1));
}

static float cliff(int64_t i, int64_t j, test_random *r)
{
    int checker = (int)((i / 8 + j / 8) & 1) ^ (int)((i + j) & (i / 64 & 1));
    return checker ? 4000.0f : (float)test_random_range(r, 0, 30);
}

static float smooth(int64_t i, int64_t j)
{
    return (float)(600 + 300 * sin((double)i * 0.011) * cos((double)j * 0.017) +
                   250 * sin((double)(i + 2 * j) * 0.0041));
}

/* What makes a default terrain. */
typedef struct landscape {
    int64_t size;
    tc_synth_planar_options options;
} landscape;

static void make_default(void *context, float *z)
{
    const landscape *l = context;
    tc_error error;
    if (tc_synth_planar(l->size, &l->options, z, &error)) {
        fprintf(stderr, "default terrain: %s\n", error.text);
        exit(99);
    }
}

static void default_terrain(int64_t size, double spacing, uint64_t seed, float *z)
{
    landscape l = {size, {.seed = seed, .spacing = spacing}};
    char name[128];
    snprintf(name, sizeof name, "default-%lld-%.17g-%llu", (long long)size, spacing, (unsigned long long)seed);
    kept_heights(name, (size_t)(size * size), make_default, &l, z);
}

tc_grid terrain_grid(terrain_kind kind, int64_t width, int64_t height, double spacing, uint64_t seed)
{
    tc_grid g = {.width = width, .height = height, .spacing_x = spacing, .spacing_y = spacing};
    g.z = malloc((size_t)(width * height) * sizeof *g.z);
    if (!g.z)
        exit(99);
    test_random r = {seed};
    if (kind == TERRAIN_DEFAULT && width != height)
        exit(99);
    if (kind == TERRAIN_DEFAULT)
        default_terrain(width, spacing, seed, g.z);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t j = 0; j < height; j++)
        for (int64_t i = 0; i < width; i++) {
            float *z = &g.z[j * width + i];
            if (kind == TERRAIN_CLIFF)
                *z = cliff(i, j, &r);
            else if (kind == TERRAIN_SMOOTH)
                *z = smooth(i, j);
            else if (kind == TERRAIN_SLOPE)
                *z = (float)(0.25 * (double)i * spacing + 0.5 * (double)j * spacing);
            g.z_min = fminf(g.z_min, *z);
            g.z_max = fmaxf(g.z_max, *z);
        }
    return g;
}

tc_field *terrain_field(terrain_kind kind, int64_t width, int64_t height, double spacing, uint64_t seed)
{
    tc_grid grid = terrain_grid(kind, width, height, spacing, seed);
    tc_field *field;
    if (tc_field_build(&grid, 0, &field, NULL))
        exit(99);
    return field;
}

tc_field *terrain_synthesised(tc_field *field, int levels)
{
    tc_synthesis_fit fit;
    tc_error error;
    if (levels > 0 && (tc_synthesis_learn(field, &fit, &error) ||
                       tc_synthesis_create(field, levels, &fit, 0, (tc_synthesis_share){NULL, NULL}, &field, &error))) {
        fprintf(stderr, "terrain: %s\n", error.text);
        exit(99);
    }
    return field;
}

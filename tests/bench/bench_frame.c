/* bench_frame.c - what a frame costs, as ratios within this run.
 *
 * (a) triangles after culling against all; (b) the whole frame, update and upload included, against a frame that draws
 * the same triangles from ready-made positions with a position-only shader; (c) against the brute-force mesh of all
 * samples; (d) against the same view of smaller and larger terrains around the same place. Pairs of frames alternate;
 * the median of their ratios is reported. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/clock.h"
#include "planar/square_internal.h"
#include "tests/support/measure.h"
#include "tests/support/plain_mesh.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

enum { WIDTH = 640, HEIGHT = 480, PAIRS = 21 };

static double plain_frame(const tc_gl *gl, const plain_mesh *m, const tc_camera *camera, bool one_sided)
{
    double start = tc_clock_ms();
    plain_draw(gl, m, camera, 1e-4, one_sided);
    gl->Finish();
    return tc_clock_ms() - start;
}

/* The positions that the scene's vertex shader computes for this camera, relative to the eye, for every draw. */
static void plain_from_scene(const tc_gl *gl, scene *s, const tc_camera *camera, plain_mesh *m)
{
    tc_frame frame;
    tc_frame_options options = {0};
    if (!tc_frame_allocate(s->surface, &frame))
        exit(1);
    s->surface->draws(scene_look(s, camera, &options), &tc_renderer_used(s->renderer).textures->layers, &frame);
    const tc_geometry *g = &s->surface->geometry;
    square_viewer viewer = tc_square_viewer(s->clipmap, camera, true);
    int count = frame.strip_draws + frame.list_draws;
    int64_t mask = tc_clipmap_n(s->clipmap);
    tc_level finest = tc_field_level(s->field, tc_field_info(s->field)->levels);
    float(*positions)[3] = malloc((size_t)count * (size_t)g->vertex_count * sizeof *positions);
    tc_draw *draws = malloc((size_t)count * sizeof *draws);
    size_t used = 0;
    for (int d = 0; d < count; d++) {
        const int32_t *v = frame.instances[d].v;
        int level = v[3] + 1;
        const tc_clip_level *l = tc_clipmap_level(s->clipmap, level);
        square_morph morph = tc_square_morph(s->clipmap, level, &viewer, &options);
        draws[d] = frame.draws[d];
        draws[d].base_vertex = (int32_t)used;
        draws[d].base_instance = 0;
        uint32_t last = 0;
        for (uint32_t k = 0; k < draws[d].count; k++) {
            uint32_t index = tc_index(g, draws[d].first_index + k);
            last = index > last ? index : last;
        }
        for (uint32_t k = 0; k <= last; k++) {
            const uint16_t *vertex = (const uint16_t *)g->vertices + 2 * k;
            int64_t rx = v[0] + ((int64_t)vertex[0] << l->shift), ry = v[1] + ((int64_t)vertex[1] << l->shift);
            int64_t i = (rx + viewer.snap_x) >> l->shift, j = (ry + viewer.snap_y) >> l->shift;
            const float *z = tc_ground_heights(s->clipmap, level)[(j & mask) * (mask + 1) + (i & mask)];
            double cell = ldexp(1, l->shift), a = tc_square_alpha(&morph, (double)rx / cell, (double)ry / cell);
            positions[used][0] = (float)((double)rx * finest.spacing_x - viewer.rest_x);
            positions[used][1] = (float)((double)ry * finest.spacing_y - viewer.rest_y);
            positions[used][2] = (float)((1 - a) * (double)z[0] + a * (double)z[1] - camera->z);
            used++;
        }
    }
    plain_create(gl, WIDTH, HEIGHT, m, (const float(*)[3])positions, used, g->indices, g->index_count, draws,
                 frame.strip_draws, frame.list_draws);
    free(positions);
    free(draws);
    tc_frame_free(&frame);
}

static double scene_frame(scene *s, const tc_camera *camera)
{
    double start = tc_clock_ms();
    scene_draw(s, camera, false);
    return tc_clock_ms() - start;
}

/* Median ratio of the scene's frame to the mesh's, in pairs. */
static double ratio(const tc_gl *gl, scene *s, const plain_mesh *m, const tc_camera *camera, bool one_sided, int pairs,
                    double *frame_ms, double *plain_ms)
{
    double ratios[PAIRS], a[PAIRS], b[PAIRS];
    scene_draw(s, camera, true), plain_frame(gl, m, camera, one_sided);
    for (int i = 0; i < pairs; i++) {
        a[i] = scene_frame(s, camera);
        b[i] = plain_frame(gl, m, camera, one_sided);
        ratios[i] = a[i] / b[i];
    }
    *frame_ms = measure_of(a, pairs).median, *plain_ms = measure_of(b, pairs).median;
    return measure_of(ratios, pairs).median;
}

/* A square of `size` samples around the middle of a terrain repeated in mirror images. */
static tc_field *cut_out(const tc_grid *from, int64_t size)
{
    tc_grid g = {.width = size,
                 .height = size,
                 .spacing_x = from->spacing_x,
                 .spacing_y = from->spacing_y,
                 .z_min = from->z_min,
                 .z_max = from->z_max};
    g.z = malloc((size_t)(size * size) * sizeof *g.z);
    int64_t period = 2 * (from->width - 1), offset = (from->width - size) / 2;
    for (int64_t j = 0; j < size; j++)
        for (int64_t i = 0; i < size; i++) {
            int64_t x = ((i + offset) % period + period) % period, y = ((j + offset) % period + period) % period;
            x = x < from->width ? x : period - x, y = y < from->height ? y : period - y;
            g.z[j * size + i] = from->z[y * from->width + x];
        }
    tc_field *p;
    if (tc_field_build(&g, 0, &p, NULL))
        exit(99);
    return p;
}

static void sizes(const tc_context *context, const tc_grid *terrain)
{
    const int64_t size[3] = {1025, 4097, 8193};
    tc_scene_options options = {.background_set = true};
    tc_field *p[3];
    scene s[3];
    tc_camera camera[3];
    for (int k = 0; k < 3; k++) {
        p[k] = cut_out(terrain, size[k]);
        s[k] = scene_create(context, p[k], 255, &options);
        double middle = (double)(size[k] - 1) / 2 * terrain->spacing_x, ground;
        tc_field_height(p[k], middle, middle, &ground);
        camera[k] = (tc_camera){.x = middle,
                                .y = middle - 2000,
                                .z = 4200,
                                .heading = 0.3,
                                .pitch = -55 * M_PI / 180,
                                .fov = M_PI / 3,
                                .width = WIDTH,
                                .height = HEIGHT};
        scene_draw(&s[k], &camera[k], true);
    }
    double ms[3][PAIRS], r[3][PAIRS];
    for (int i = 0; i < PAIRS; i++)
        for (int k = 0; k < 3; k++) {
            ms[k][i] = scene_frame(&s[k], &camera[k]);
            r[k][i] = ms[k][i] / ms[0][i];
        }
    for (int k = 0; k < 3; k++) {
        tc_frame_stats stats = scene_draw(&s[k], &camera[k], false);
        printf("frame: %lld x %lld: %.2f ms, %lld triangles, ratio to 1025 x 1025 %.3f\n", (long long)size[k],
               (long long)size[k], measure_of(ms[k], PAIRS).median, (long long)stats.triangles,
               measure_of(r[k], PAIRS).median);
        scene_destroy(&s[k]);
        tc_field_destroy(p[k]);
    }
}

int main(void)
{
    tc_context *context = scene_context();
    if (!context)
        return 1;
    const tc_gl *gl = tc_context_gl(context);
    tc_grid terrain = terrain_grid(TERRAIN_DEFAULT, 4097, 4097, 30, 1);
    tc_field *p = cut_out(&terrain, 4097);
    double middle = 2048 * 30, ground;
    tc_field_height(p, middle, middle, &ground);
    tc_camera camera = {.x = middle,
                        .y = middle,
                        .z = ground + 30,
                        .heading = 0.5,
                        .pitch = -0.05,
                        .fov = M_PI / 2,
                        .width = WIDTH,
                        .height = HEIGHT};
    printf("frame: %s, 4097 x 4097, n 255, 90 degrees, %d x %d, 30 m above ground\n", tc_context_backend(context),
           WIDTH, HEIGHT);
    for (int lit = 0; lit < 2; lit++) {
        tc_scene_options options = {.unlit = !lit, .background_set = !lit};
        scene s = scene_create(context, p, 255, &options);
        tc_frame_stats stats = scene_draw(&s, &camera, true);
        plain_mesh same;
        double ms, plain_ms;
        plain_from_scene(gl, &s, &camera, &same);
        double r = ratio(gl, &s, &same, &camera, false, PAIRS, &ms, &plain_ms);
        if (!lit)
            printf("frame: %lld of %lld triangles after culling: %.3f; %d draws, %d levels\n",
                   (long long)stats.triangles, (long long)stats.triangles_unculled,
                   (double)stats.triangles / (double)stats.triangles_unculled, stats.draws, stats.levels_active);
        printf("frame: %s: %.2f ms, position-only %.2f ms, ratio %.3f\n", lit ? "lit, sky and haze" : "unlit", ms,
               plain_ms, r);
        r = ratio(gl, &s, &same, &camera, true, PAIRS, &ms, &plain_ms);
        printf("frame: %s, the other frame leaving out backs of triangles, too: %.2f ms, ratio %.3f\n",
               lit ? "lit" : "unlit", plain_ms, r);
        plain_destroy(gl, &same);
        if (lit) {
            plain_mesh brute;
            if (!plain_brute_flat(gl, p, &camera, &brute))
                return 1;
            r = ratio(gl, &s, &brute, &camera, false, 5, &ms, &plain_ms);
            printf("frame: brute force, %lld triangles: %.0f ms, %.1f times the lit frame\n",
                   (long long)brute.triangles, plain_ms, 1 / r);
            plain_destroy(gl, &brute);
        }
        scene_destroy(&s);
    }
    tc_field_destroy(p);
    sizes(context, &terrain);
    tc_grid_free(&terrain);
    tc_context_destroy(context);
    return 0;
}

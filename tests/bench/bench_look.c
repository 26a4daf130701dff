/* bench_look.c - what a planet's view costs the processor in a window's loop, beside windows and OpenGL: the view of a
 * camera, the windows that it wants, the draws, and the five heights around the
 * eye that moving it asks for (flight.c). Rings of 256 steps, as in a window on a
 * software renderer, of held windows over the default planet; microseconds a frame, the least of some. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "tests/support/measure.h"
#include "tests/support/planet_scene.h"

enum { COLUMNS = 4096, REPEATS = 7, FRAMES = 300, HEIGHTS = 5 };

typedef struct bench {
    scene s;
    tc_view *view;
    tc_frame frame;
} bench;

static void frame_of(bench *b, const tc_camera *c)
{
    static const double dx[HEIGHTS] = {0, -1, 1, 0, 0}, dy[HEIGHTS] = {0, 0, 0, -1, 1};
    static tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    const tc_surface *surface = b->s.surface;
    const tc_renderer_use use = tc_renderer_used(b->s.renderer);
    double z;
    surface->look(surface, use.windows, c, &(tc_frame_options){0}, false, b->view);
    surface->wanted(b->view, wanted);
    surface->draws(b->view, &use.textures->layers, &b->frame);
    for (int k = 0; k < HEIGHTS; k++)
        surface->height(b->view, c->x + dx[k] * 1e-6, c->y + dy[k] * 1e-6, &z);
}

static double thread_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

int main(void)
{
    const tc_scene_options options = {.background_set = true, .budget = -1};
    const double heights[] = {2, 100, 3e3, 50e3, 500e3, 5e6};
    tc_context *context = scene_context();
    if (!context)
        return 0;
    tc_map *map = planet_made(PLANET_DEFAULT, COLUMNS, 6371000, 1);
    bench b = {.s = planet_scene(context, map, &(tc_rings_options){.n_phi = 256}, &options)};
    b.view = tc_view_allocate(b.s.surface);
    if (!b.view || !tc_frame_allocate(b.s.surface, &b.frame))
        return 1;
    double sum = 0;
    for (size_t h = 0; h < sizeof heights / sizeof *heights; h++) {
        tc_camera c = {.x = 0.3, .y = 0.6, .pitch = -0.1, .fov = 1.3, .width = 1280, .height = 720};
        double least = INFINITY;
        tc_map_height(map, c.x, c.y, &c.z);
        c.z += heights[h];
        scene_draw(&b.s, &c, true);
        for (int r = 0; r < REPEATS; r++) {
            double start = thread_ms();
            for (int i = 0; i < FRAMES; i++)
                frame_of(&b, &c);
            least = fmin(least, (thread_ms() - start) * 1e3 / FRAMES);
        }
        printf("%10g m: %8.1f us\n", heights[h], least);
        sum += least;
    }
    printf("%12s: %8.1f us\n", "all", sum);
    tc_frame_free(&b.frame);
    free(b.view);
    scene_destroy(&b.s);
    tc_map_destroy(map);
    tc_context_destroy(context);
    return 0;
}

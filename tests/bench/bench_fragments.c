/* bench_fragments.c - what fragments of rings and squares cost: the processor time of all threads of a frame less that
 * of the same frame whose fragments have one colour, so that nothing of a surface is computed for them.
 *
 * TERRACLIP_OLDER names a folder with shaders of another version: then its frames take turns with ours, and pictures
 * are held against each other. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "common/gl/program.h"
#include "planar/square.h"
#include "tests/support/measure.h"
#include "tests/support/planet_scene.h"
#include "tests/support/terrains.h"

enum { WIDTH = 640, HEIGHT = 480, MOST_TURNS = 15, SIDES = 3, MOST_FILES = 64 };
#define DEGREE (M_PI / 180)

typedef struct tc_shader_file shader_file;

typedef struct bench {
    measure_options options;
    tc_context *context;
    shader_file older[MOST_FILES], flat[2];
    bool compared;
} bench;

typedef struct view {
    const char *name;
    double longitude, latitude, height, heading, pitch, fov; /* degrees; metres above ground */
} view;

static const view globe_views[] = {
    {"2 m", 10.3, 46.4, 2, 30, -5, 60},         {"10 km", 10.3, 46.4, 10e3, 30, -25, 60},
    {"1,000 km", 10.3, 46.4, 1e6, 30, -50, 60}, {"10,000 km", 10.3, 46.4, 1e7, 30, -90, 60},
    {"cap, 10 km", 40, 75, 10e3, 30, -25, 60},  {"both, 10 km", 40, 57.5, 10e3, 30, -25, 60},
    {"pole, 1,000 km", 0, 89, 1e6, 0, -60, 60}};
static const view flat_views[] = {{"30 m", 0, 0, 30, 30, -3, 90}, {"3 km", 0, 0, 3000, 30, -50, 90}};

static double processor_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static double frame_ms(scene *s, const tc_camera *c)
{
    const double start = processor_ms();
    scene_draw(s, c, true);
    return processor_ms() - start;
}

/* How many pixels of two frames differ by more than 1 of 255, and the most that any does. */
static void compare(scene *a, scene *b, const tc_camera *c, int *count_ret, int *most_ret)
{
    scene_draw(a, c, true), scene_draw(b, c, true);
    uint8_t *p = scene_pixels(a, c), *q = scene_pixels(b, c);
    *count_ret = *most_ret = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int most = 0;
        for (int k = 0; k < 3; k++)
            most = abs(p[3 * i + k] - q[3 * i + k]) > most ? abs(p[3 * i + k] - q[3 * i + k]) : most;
        *count_ret += most > 1;
        *most_ret = most > *most_ret ? most : *most_ret;
    }
    free(p), free(q);
}

static void measure_view(bench *b, scene sides[SIDES], const tc_camera *c, const char *name, const char *lit)
{
    const int turns = b->options.quick ? 5 : MOST_TURNS, count = b->compared ? 3 : 2;
    double own[MOST_TURNS], share[MOST_TURNS], ratio[MOST_TURNS], all[MOST_TURNS];
    for (int k = 0; k < count; k++)
        scene_draw(&sides[k], c, true), scene_draw(&sides[k], c, true);
    for (int i = 0; i < turns; i++) {
        double ms[SIDES] = {0};
        for (int k = 0; k < count; k++)
            ms[k] = frame_ms(&sides[k], c);
        all[i] = ms[0], own[i] = ms[0] - ms[1], share[i] = ms[0] / ms[1];
        ratio[i] = (ms[0] - ms[1]) / (ms[2] - ms[1]);
    }
    printf("%-8s %-6s %-15s %7.2f ms, of fragments %7.2f ms, %.3f of one colour's", sides[0].surface->name, lit, name,
           measure_of(all, turns).median, measure_of(own, turns).median, measure_of(share, turns).median);
    if (b->compared) {
        const measure_spread r = measure_of(ratio, turns);
        int differ, most;
        compare(&sides[0], &sides[2], c, &differ, &most);
        printf("; %.3f (%.3f to %.3f) of the older ones; %d pixels differ, by at most %d", r.median, r.low, r.high,
               differ, most);
    }
    putchar('\n');
    fflush(stdout);
}

static void give_texts(const bench *b, tc_surface *surface, int side)
{
    if (side)
        surface->texts = side == 1 ? b->flat : b->older;
}

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "fragments: %s\n", error->text);
        exit(1);
    }
}

static void measure_globe(bench *b, const tc_map *map, bool lit)
{
    const tc_scene_options look = {.unlit = !lit, .background_set = !lit, .budget = -1};
    scene sides[SIDES];
    for (int k = 0; k < SIDES; k++) {
        tc_surface *surface = planet_rings(map, &(tc_rings_options){.n_phi = 512}, &look);
        give_texts(b, surface, k);
        sides[k] = planet_scene_of(b->context, map, surface, &look);
    }
    for (size_t i = 0; i < sizeof globe_views / sizeof *globe_views; i++) {
        const view *v = &globe_views[i];
        tc_camera c = {.x = v->longitude * DEGREE,
                       .y = v->latitude * DEGREE,
                       .heading = v->heading * DEGREE,
                       .pitch = v->pitch * DEGREE,
                       .fov = v->fov * DEGREE,
                       .width = WIDTH,
                       .height = HEIGHT};
        tc_error error = {0};
        must(tc_map_height(map, c.x, c.y, &c.z), &error);
        c.z += v->height;
        measure_view(b, sides, &c, v->name, lit ? "lit" : "unlit");
    }
    for (int k = 0; k < SIDES; k++)
        scene_destroy(&sides[k]);
}

static void measure_plane(bench *b, const tc_field *field, bool lit)
{
    const tc_scene_options look = {.unlit = !lit, .background_set = !lit, .budget = -1};
    const tc_scene_needs needs = tc_scene_needs_of(&look, tc_field_info(field));
    scene sides[SIDES];
    for (int k = 0; k < SIDES; k++) {
        tc_error error;
        scene s = {.field = field};
        must(
            tc_square_create(field, &(tc_ground_options){.n = 255, .normals = needs.normals}, NULL, &s.surface, &error),
            &error);
        give_texts(b, s.surface, k);
        must(tc_renderer_create(tc_context_gl(b->context), s.surface, &look, &s.renderer, &error), &error);
        s.clipmap = tc_renderer_used(s.renderer).windows->clipmap[0];
        sides[k] = s;
    }
    const tc_level l = tc_field_level(field, tc_field_info(field)->levels);
    for (size_t i = 0; i < sizeof flat_views / sizeof *flat_views; i++) {
        const view *v = &flat_views[i];
        tc_camera c = {.x = 0.5 * (double)(l.width - 1) * l.spacing_x,
                       .y = 0.5 * (double)(l.height - 1) * l.spacing_y,
                       .heading = v->heading * DEGREE,
                       .pitch = v->pitch * DEGREE,
                       .fov = v->fov * DEGREE,
                       .width = WIDTH,
                       .height = HEIGHT};
        tc_error error = {0};
        must(tc_field_height(field, c.x, c.y, &c.z), &error);
        c.z += v->height;
        measure_view(b, sides, &c, v->name, lit ? "lit" : "unlit");
    }
    for (int k = 0; k < SIDES; k++)
        scene_destroy(&sides[k]);
}

/* The files of `folder` that shaders are built from. */
static void read_older(bench *b, const char *folder)
{
    int count = 0;
    for (const shader_file *f = tc_shader_files; f->name && count < MOST_FILES - 1; f++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, f->name);
        FILE *file = fopen(path, "rb");
        enum { MOST = 1 << 16 };
        char *text = file ? calloc(1, MOST) : NULL;
        if (!text)
            continue;
        if (fread(text, 1, MOST - 1, file) > 0)
            b->older[count++] = (shader_file){f->name, text};
        fclose(file);
    }
    b->compared = count > 0;
}

int main(int argc, char **argv)
{
    bench b = {.options = measure_begin(argc, argv, ""),
               .flat = {{"renderer.frag", "layout(location = 0) out vec4 colour;\n"
                                          "void main() { colour = encoded(vec3(0.5)); }\n"}}};
    const char *older = getenv("TERRACLIP_OLDER");
    if (older)
        read_older(&b, older);
    b.context = scene_context();
    if (!b.context)
        return 1;
    tc_map *map = planet_made(PLANET_DEFAULT, 2048, 6371000, 4);
    for (int lit = 0; lit < 2; lit++)
        measure_globe(&b, map, lit);
    tc_map_destroy(map);
    tc_field *field = terrain_field(TERRAIN_DEFAULT, 4097, 4097, 30, 1);
    for (int lit = 0; lit < 2; lit++)
        measure_plane(&b, field, lit);
    tc_field_destroy(field);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}

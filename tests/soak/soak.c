/* soak.c - a long flight, FRAMES of it: memory stays flat and windows stay true.
 *
 * Most of the frames over a plane, the others, which take longer, over a planet, both packed, with detail
 * finer than the data down to a tenth of a metre and a picture over them. A viewer flies about at random, low and high,
 * leaps, and changes what a frame may update. Nothing waits, as in a window: a thread reads ahead of the heights,
 * another of the colours, and a third, as a host may, asks the map for heights meanwhile. Every so often all that
 * windows hold is held against the fields, which are read anew for it. Frames are tiny: it is not about pixels. */
#include <malloc.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/clock.h"
#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/imagery/imagery.h"
#include "common/render/drape.h"
#include "tests/support/draped.h"
#include "tests/support/made_files.h"
#include "tests/support/packed_map.h"
#include "tests/support/planet_scene.h"
#include "tests/support/process.h"
#include "tests/support/regions.h"

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
enum { SANITIZED = 1 }; /* takes ten times as long, and has memory of its own that grows */
#else
enum { SANITIZED = 0 };
#endif

enum { WIDTH = 64, HEIGHT = 36, CHECKED = SANITIZED ? 100 : 500, TENTHS = 10, WARM = 2 };

/* Samples along the sides of the terrains, pixels of their pictures, levels finer than the data. */
enum { PLANE = SANITIZED ? 257 : 513, PLANET = SANITIZED ? 256 : 1024, PICTURE = SANITIZED ? 512 : 2048 };
enum { FINER = SANITIZED ? 5 : TC_SYNTHESIS_AUTO };

/* Between the resident bytes after the first WARM tenths of the frames and after all of them; of so many frames at
 * least, since before caches are not full. */
static const double MOST_GROWTH = 3 << 20;
static const int64_t LEAST_FRAMES = 20000;

static const double RADIUS = 6371000;

/* What is flown over. */
typedef struct world {
    const char *name;
    tc_map *map;
    tc_imagery *imagery;
    scene scene;
    wanderer wanderer; /* over the plane */
    test_random random;
    tc_camera camera;
    double heading, step, climb; /* over the planet: radians and shares of the height, a frame */
    int64_t checks, samples, wrong;
    char first[240]; /* that was wrong */
} world;

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "soak: %s\n", error->text);
        exit(99);
    }
}

/* ---- Worlds ------------------------------------------------------------------------------------------------------ */

static world world_open(const tc_context *context, bool planet)
{
    const tc_open_options open = {.cache_bytes = 4 << 20}; /* soon full */
    const char *path = made_path(planet ? "planet.tclip" : "plane.tclip");
    world w = {.name = planet ? "planet" : "plane", .random = {planet ? 2 : 1}, .step = 0.1};
    tc_error error;
    tc_map *made = planet ? planet_made(PLANET_DEFAULT, PLANET, RADIUS, 3)
                          : tc_map_flat(terrain_field(TERRAIN_DEFAULT, PLANE, PLANE, 30, 3));
    packed_map(made, path);
    tc_map_destroy(made);
    must(tc_map_open(path, &open, &w.map, &error), &error);
    must(tc_map_synthesise(w.map, FINER, &error), &error);
    tc_image *image =
        planet ? draped_image(draped_globe, PICTURE, PICTURE / 2) : draped_image(draped_land, PICTURE, PICTURE);
    must(tc_imagery_create(w.map, &image, 1, 0, &w.imagery, &error), &error);
    const tc_scene_options options = {.budget = 1000, .imagery = w.imagery};
    w.scene = planet ? planet_scene(context, w.map, &(tc_rings_options){.n_phi = 64, .m = 4}, &options)
                     : scene_create(context, tc_map_field(w.map, 0), 31, &options);
    w.wanderer = wanderer_start(tc_map_field(w.map, 0), 3);
    w.camera = (tc_camera){.z = 1e6, .fov = 1.2, .width = WIDTH, .height = HEIGHT};
    return w;
}

static void world_close(world *w)
{
    scene_destroy(&w->scene);
    tc_imagery_destroy(w->imagery);
    tc_map_destroy(w->map);
}

/* ---- Flying ------------------------------------------------------------------------------------------------------ */

static void fly_over_plane(world *w)
{
    wanderer_move(&w->wanderer, w->scene.field);
    w->camera.x = w->wanderer.camera.x, w->camera.y = w->wanderer.camera.y, w->camera.z = w->wanderer.camera.z;
}

/* The same by steps of a share of the height, over poles and the antimeridian as they come. */
static void fly_over_planet(world *w)
{
    test_random *r = &w->random;
    tc_camera *c = &w->camera;
    double what = test_random_unit(r), ground = 0;
    if (what < 0.005)
        *c = planet_view(r, w->map, 0.5, 5 * RADIUS);
    else if (what < 0.03)
        w->heading = test_random_range(r, -M_PI, M_PI), w->step = pow(10, test_random_range(r, -3, 0.5)),
        w->climb = test_random_range(r, -0.05, 0.05);
    c->width = WIDTH, c->height = HEIGHT;
    must(tc_map_rough_height(w->map, c->x, c->y, &ground), &(tc_error){.text = "no rough height"});
    double above = fmin(fmax((c->z - ground) * (1 + w->climb), 0.5), 5 * RADIUS), angle = w->step * above / RADIUS;
    c->y += fmin(angle, 1) * cos(w->heading);
    c->x += fmin(angle, 1) * sin(w->heading) / fmax(cos(c->y), 1e-6);
    if (fabs(c->y) > M_PI / 2) /* over a pole */
        c->y = copysign(M_PI, c->y) - c->y, c->x += M_PI, w->heading = M_PI - w->heading;
    c->x = remainder(c->x, 2 * M_PI);
    must(tc_map_rough_height(w->map, c->x, c->y, &ground), &(tc_error){.text = "no rough height"});
    c->z = ground + above;
}

static void fly(world *w)
{
    test_random *r = &w->random;
    tc_scene_options options = {.imagery = w->imagery};
    tc_frame_stats stats;
    tc_error error;
    if (w->map->body.radius > 0)
        fly_over_planet(w);
    else
        fly_over_plane(w);
    if (test_random_unit(r) < 0.02) {
        int64_t n = w->scene.surface->n;
        options.budget = test_random_int(r, n, n * n / 8);
        options.frame.no_morph = test_random_unit(r) < 0.2;
        tc_renderer_set_options(w->scene.renderer, &options);
        w->camera.heading = test_random_range(r, 0, 2 * M_PI), w->camera.pitch = test_random_range(r, -1.5, 0.3);
    }
    must(tc_renderer_frame(w->scene.renderer, &w->camera, false, &stats, &error), &error);
    must(stats.failed || stats.imagery_failed ? TC_ERR_IO : TC_OK, &(tc_error){.text = "something cannot be read"});
}

/* From next to the ground, of all charts: textures have room for all levels then, and grow no more. */
static void see_all(world *w)
{
    static const double places[][2] = {{0.1, 0.1}, {0, M_PI / 2}, {0, -M_PI / 2}};
    const tc_level finest = tc_field_level(w->scene.field, tc_field_info(w->scene.field)->levels);
    for (int k = 0; k < w->map->charts; k++) {
        tc_camera c = w->camera;
        c.pitch = -0.5, c.x = places[k][0], c.y = places[k][1];
        if (w->map->body.radius == 0)
            c.x = 0.5 * (double)finest.width * finest.spacing_x, c.y = 0.5 * (double)finest.height * finest.spacing_y;
        must(tc_map_height(w->map, c.x, c.y, &c.z), &(tc_error){.text = "no height"});
        c.z += 0.5;
        scene_draw(&w->scene, &c, true);
    }
}

/* All of the colours on all levels, as far as they are kept, so that what is kept of them grows no more. */
static void see_all_colours(const world *w)
{
    enum { SIDE = 256 };
    static uint8_t texels[SIDE * SIDE][4];
    for (int k = 0; k < w->map->charts; k++) {
        const tc_field *colours = tc_imagery_field(w->imagery, k);
        for (int l = 1; l <= tc_field_info(colours)->levels; l++) {
            const tc_level size = tc_field_level(colours, l);
            for (int64_t y = 0; y < size.height; y += SIDE)
                for (int64_t x = 0; x < size.width; x += SIDE) {
                    tc_rect r = tc_rect_intersect((tc_rect){x, y, x + SIDE, y + SIDE},
                                                  (tc_rect){0, 0, size.width, size.height});
                    must(tc_field_read_samples(colours, l, r, texels, NULL, SIDE), &(tc_error){.text = "no colours"});
                }
        }
    }
}

/* ---- Looking ----------------------------------------------------------------------------------------------------- */

static void look(world *w, const char *broken)
{
    if (broken && !w->wrong)
        snprintf(w->first, sizeof w->first, "; first: %s", broken);
    w->wrong += broken != NULL;
}

static int64_t held(const tc_clipmap *c)
{
    int64_t samples = 0;
    for (int l = 1; l <= tc_clipmap_levels(c); l++)
        samples += tc_rect_area(tc_clipmap_level(c, l)->clip);
    return samples;
}

/* All heights and colours that are held; on the plane, whose vertices are the samples, also some rows' normals and
 * morph targets. */
static void check(world *w)
{
    const tc_renderer_use use = tc_renderer_used(w->scene.renderer);
    for (int k = 0; k < use.windows->charts; k++) {
        const tc_clipmap *c = use.windows->clipmap[k];
        look(w, regions_broken(c));
        look(w, heights_broken(c));
        w->samples += held(c);
        int level = (int)test_random_int(&w->random, 1, tc_clipmap_levels(c));
        if (w->map->body.radius == 0)
            look(w, content_broken(c, level, test_random_int(&w->random, 0, 15), 16));
    }
    for (int k = 0; use.drape && k < use.drape->windows.charts; k++) {
        const tc_clipmap *c = use.drape->windows.clipmap[k];
        for (int l = 1; l <= tc_clipmap_levels(c); l++)
            look(w, colours_broken(c, l));
        w->samples += held(c);
    }
    w->checks++;
}

/* One height and one colour spoiled are found. Returns how many are not. */
static int unfound(world *w)
{
    const tc_renderer_use use = tc_renderer_used(w->scene.renderer);
    const tc_clipmap *heights = use.windows->clipmap[0], *colours = use.drape->windows.clipmap[0];
    const tc_clip_level *h = tc_clipmap_level(heights, 1), *c = tc_clipmap_level(colours, 1);
    int64_t n = tc_clipmap_n(heights), m = tc_clipmap_n(colours);
    float *z = (float *)tc_ground_heights(heights, 1)[(h->clip.y0 & n) * (n + 1) + (h->clip.x0 & n)];
    uint8_t *texel = (uint8_t *)tc_clipmap_texels(colours, tc_clipmap_content(colours, 0), 1);
    texel += 4 * ((c->clip.y0 & m) * (m + 1) + (c->clip.x0 & m));
    *z += 1, *texel ^= 1;
    int lost = !heights_broken(heights) + !colours_broken(colours, 1);
    *z -= 1, *texel ^= 1;
    return lost;
}

/* A host that asks for heights on a thread of its own. */
typedef struct asker {
    const tc_map *map;
    atomic_bool stop;
    int64_t asked, strange;
} asker;

static void *ask(void *context)
{
    asker *a = context;
    const tc_chart *c = &a->map->chart[0];
    const tc_level finest = tc_field_level(c->field, tc_field_info(c->field)->levels);
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < a->map->charts; k++) {
        const tc_field *field = a->map->chart[k].field;
        const int l = tc_field_info(field)->levels;
        const tc_level size = tc_field_level(field, l);
        const tc_range range = tc_field_range(field, l, (tc_rect){0, 0, size.width, size.height});
        low = fmin(low, tc_field_info(field)->z_base + (double)range.lo);
        high = fmax(high, tc_field_info(field)->z_base + (double)range.hi);
    }
    test_random r = {9};
    for (; !a->stop; a->asked++, usleep(2000)) {
        double z, x = c->x0 + test_random_unit(&r) * (double)(finest.width - 1) * c->dx,
                  y = c->y0 + test_random_unit(&r) * (double)(finest.height - 1) * c->dy;
        a->strange += tc_map_height(a->map, x, y, &z) != TC_OK || !(z >= low - 1 && z <= high + 1);
    }
    return NULL;
}

/* ---- All --------------------------------------------------------------------------------------------------------- */

/* Returns what went wrong. */
static int soak(const tc_context *context, bool planet, int64_t frames)
{
    world w = world_open(context, planet);
    asker a = {.map = w.map};
    pthread_t thread;
    double resident[TENTHS + 1] = {0}, start = tc_clock_ms(), checking = 0;
    see_all(&w), see_all_colours(&w);
    if (pthread_create(&thread, NULL, ask, &a))
        exit(99);
    for (int tenth = 1; tenth <= TENTHS; tenth++) {
        for (int64_t n = frames * (tenth - 1) / TENTHS; n < frames * tenth / TENTHS; n++) {
            fly(&w);
            if (test_random_int(&w.random, 0, CHECKED - 1) == 0 || n == frames - 1) {
                double before = tc_clock_ms();
                check(&w);
                checking += tc_clock_ms() - before;
            }
        }
        resident[tenth] = process_resident();
    }
    a.stop = true;
    pthread_join(thread, NULL);
    int lost = unfound(&w);
    double growth = resident[TENTHS] - resident[WARM], mib = 1 << 20;
    bool judged = !SANITIZED && frames >= LEAST_FRAMES;
    printf("%s: %lld frames of %d x %d in %.0f s, %.0f s of them for looking; %d levels, %d of them synthesised\n",
           w.name, (long long)frames, WIDTH, HEIGHT, 1e-3 * (tc_clock_ms() - start), 1e-3 * checking,
           tc_field_info(tc_map_field(w.map, 0))->levels, w.map->synthesised);
    printf("%s: resident, MiB, after each tenth:", w.name);
    for (int k = 1; k <= TENTHS; k++)
        printf(" %.1f", resident[k] / mib);
    printf("; grown by %.2f since the second%s\n", growth / mib, judged ? "" : ", not judged");
    printf("%s: %lld times %lld samples of windows against the fields: %lld wrong%s; %d of 2 spoiled ones not found; "
           "%lld heights asked for meanwhile, %lld strange\n",
           w.name, (long long)w.checks, (long long)(w.samples / w.checks), (long long)w.wrong, w.first, lost,
           (long long)a.asked, (long long)a.strange);
    fflush(stdout);
    world_close(&w);
    return (w.wrong > 0) + lost + (a.strange > 0) + (a.asked == 0) + (judged && growth > MOST_GROWTH);
}

int main(void)
{
    const char *asked = getenv("TERRACLIP_SOAK_FRAMES");
    int64_t frames = asked && *asked ? atoll(asked) : 100000;
    if (frames < 8 * TENTHS) {
        fprintf(stderr, "soak: TERRACLIP_SOAK_FRAMES: expected %d or more, found %s\n", 8 * TENTHS, asked);
        return 2;
    }
    mallopt(M_TRIM_THRESHOLD, 1 << 30); /* as the viewer does */
    tc_context *context = scene_context();
    if (!context)
        return 1;
    int64_t over_planet = frames / (SANITIZED ? 8 : 4);
    int wrong = soak(context, false, frames - over_planet) + soak(context, true, over_planet);
    tc_context_destroy(context);
    made_folder_remove();
    puts(wrong ? "soak: FAILED" : "soak: passed");
    return wrong > 0;
}

/* test_views.c - what a view of a surface asks for, and what it does not: ground far away, reads of the file; and that
 * a scheme which nothing but this test knows is drawn. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/field.h"
#include "common/map/map.h"
#include "planar/square.h"
#include "spherical/rings_internal.h"
#include "tests/support/made_files.h"
#include "tests/support/one_square.h"
#include "tests/support/packed_map.h"
#include "tests/support/planet_scene.h"

#define DEGREE (M_PI / 180)
enum { COLUMNS = 1024 };
static const double radius = 6371000;

static tc_context *context;
static const tc_scene_options plain = {.background_set = true};

/* ---- The horizon ------------------------------------------------------------------------------------------------- */

/* Lowlands of up to 3000 m, and where *(bool *)context says so a trench of -11 km at 150 degrees east on the equator.
 */
static double lowlands(void *trench, const double p[3])
{
    double z = 1500 + planet_smooth(&(double){1000}, p) * 0.5;
    const double at[3] = {cos(150 * DEGREE), sin(150 * DEGREE), 0};
    double angle = acos(fmin(1, p[0] * at[0] + p[1] * at[1] + p[2] * at[2]));
    return *(bool *)trench && angle < 3 * DEGREE ? -11000 : z;
}

static void a_trench_far_away_draws_no_more_rings(void **state)
{
    (void)state;
    tc_map *map[2];
    scene s[2];
    for (int k = 0; k < 2; k++) {
        map[k] = planet_atlas(COLUMNS, radius, lowlands, &(bool){k == 1});
        s[k] = planet_scene(context, map[k], &(tc_rings_options){.n_phi = 256}, &plain);
    }
    const double heights[] = {2, 30, 500, 3000, 9000, 20e3, 60e3, 120e3, 200e3, 400e3, 1e6, 3e6};
    for (int place = 0; place < 6; place++)
        for (size_t h = 0; h < sizeof heights / sizeof *heights; h++) {
            tc_camera c = {.x = (place * 17 - 60) * DEGREE, .y = (place * 29 - 70) * DEGREE, .fov = 1.2};
            c.width = 640, c.height = 400;
            double ground;
            assert_int_equal(tc_map_height(map[0], c.x, c.y, &ground), TC_OK);
            c.z = ground + heights[h];
            const rings_view *without = (const rings_view *)scene_look(&s[0], &c, NULL);
            const rings_view *with = (const rings_view *)scene_look(&s[1], &c, NULL);
            if (without->first != with->first || without->finest != with->finest)
                fail_msg("%g m above %g, %g: rings %d to %d, with a trench %d to %d", heights[h], c.x / DEGREE,
                         c.y / DEGREE, without->first, without->finest, with->first, with->finest);
        }
    for (int k = 0; k < 2; k++) {
        scene_destroy(&s[k]);
        tc_map_destroy(map[k]);
    }
}

/* ---- What is read ------------------------------------------------------------------------------------------------ */

/* A field over another one that counts what is read of it at once, whatever it takes. */
typedef struct counted {
    tc_field head;
    const tc_field *base;
    int reads;
} counted;

static tc_status count_read(const tc_field *field, int level, tc_rect rect, void *z, uint8_t *voids, ptrdiff_t stride)
{
    ((counted *)field)->reads++;
    return tc_field_read(((const counted *)field)->base, level, rect, z, voids, stride);
}

static bool read_ready(const tc_field *field, int level, tc_rect rect, void *z, uint8_t *voids, ptrdiff_t stride)
{
    const tc_field *base = ((const counted *)field)->base;
    return base->class->read_ready ? base->class->read_ready(base, level, rect, z, voids, stride)
                                   : !base->class->read(base, level, rect, z, voids, stride);
}

static tc_ready ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    return tc_field_ready(((const counted *)field)->base, level, rect, urgency);
}

static tc_range range(const tc_field *field, int level, tc_rect rect)
{
    return tc_field_range(((const counted *)field)->base, level, rect);
}

static void tell(const tc_field *field, tc_field_stats *stats)
{
    *stats = tc_field_tell(((const counted *)field)->base);
}

static void leave(tc_field *field)
{
    (void)field;
}

static const tc_field_class counted_class = {
    .read = count_read, .read_ready = read_ready, .ready = ready, .range = range, .tell = tell, .destroy = leave};

/* Puts counting fields in the place of a map's own, and back. */
static void count_reads(tc_map *map, counted *fields)
{
    for (int k = 0; k < map->charts; k++) {
        fields[k] = (counted){.head = *map->chart[k].field, .base = map->chart[k].field};
        fields[k].head.class = &counted_class;
        map->chart[k].field = &fields[k].head;
    }
}

static void count_no_more(tc_map *map, const counted *fields)
{
    for (int k = 0; k < map->charts; k++)
        map->chart[k].field = (tc_field *)fields[k].base;
}

static tc_field_stats told(const tc_map *map)
{
    tc_field_stats all = {0};
    for (int k = 0; k < map->charts; k++) {
        tc_field_stats one = tc_field_tell(map->chart[k].field);
        all.ranges += one.ranges, all.range_reads += one.range_reads, all.waits += one.waits;
    }
    return all;
}

/* A planet and a flat map, in memory and packed. */
static tc_map *made(int kind)
{
    tc_map *map = kind & 1 ? planet_made(PLANET_SMOOTH, COLUMNS, radius, 3)
                           : tc_map_flat(terrain_field(TERRAIN_SMOOTH, 1500, 1200, 30, 5));
    if (kind < 2)
        return map;
    tc_error error = {.text = ""};
    const char *path = made_path("packed.tclip");
    packed_map(map, path);
    tc_map_destroy(map);
    if (tc_map_open(path, NULL, &map, &error) != TC_OK)
        fail_msg("%s", error.text);
    return map;
}

static scene scene_of(const tc_map *map)
{
    const tc_scheme *scheme = map->body.radius > 0 ? &tc_rings_schemes[0] : &tc_square_schemes[0];
    const tc_scene_needs needs = tc_scene_needs_of(&plain, tc_field_info(tc_map_field(map, 0)));
    const tc_camera camera = {.fov = 1.2, .width = 320, .height = 200};
    const tc_surface_request request = {
        .n = map->body.radius > 0 ? 256 : 63, .needs = &needs, .camera = &camera};
    scene s = {0};
    tc_error error = {.text = ""};
    if (scheme->create(scheme, map, &request, &s.surface, &error) ||
        tc_renderer_create(tc_context_gl(context), s.surface, &plain, &s.renderer, &error))
        fail_msg("%s", error.text);
    return s;
}

/* View k of five, from high above to the ground. */
static tc_camera view_of(const tc_map *map, int k)
{
    const double above[] = {3e6, 200e3, 20e3, 2e3, 30};
    bool sphere = map->body.radius > 0;
    tc_camera c = {.x = sphere ? 0.3 : 20000, .y = sphere ? 0.6 : 15000, .pitch = -0.3, .fov = 1.2};
    c.heading = 0.7 * k, c.width = 320, c.height = 200;
    tc_map_height(map, c.x, c.y, &c.z);
    c.z += sphere ? above[k] : above[k] / 20;
    return c;
}

static void bounds_are_few_reads_of_memory(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        tc_map *map = made(kind);
        scene s = scene_of(map);
        tc_frame frame;
        assert_true(tc_frame_allocate(s.surface, &frame));
        for (int k = 0; k < 5; k++) {
            tc_camera c = view_of(map, k);
            tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
            scene_draw(&s, &c, true);
            const tc_renderer_use use = tc_renderer_used(s.renderer);
            const tc_field_stats before = told(map);
            tc_view *view = tc_view_allocate(s.surface);
            assert_non_null(view);
            s.surface->look(s.surface, use.windows, &c, &(tc_frame_options){0}, false, view);
            s.surface->wanted(view, wanted);
            s.surface->draws(view, &use.textures->layers, &frame);
            const tc_field_stats after = told(map);
            assert_true(frame.draws_unculled > 0);
            if (after.ranges - before.ranges > 4 * frame.draws_unculled ||
                after.range_reads - before.range_reads > 4 * (after.ranges - before.ranges))
                fail_msg("kind %d, view %d: %lld ranges by %lld reads for %d blocks", kind, k,
                         (long long)(after.ranges - before.ranges), (long long)(after.range_reads - before.range_reads),
                         frame.draws_unculled);
            assert_int_equal(after.waits, before.waits);
            free(view);
        }
        tc_frame_free(&frame);
        scene_destroy(&s);
        tc_map_destroy(map);
    }
}

static int reads_of(const tc_map *map, const counted *fields)
{
    int reads = 0;
    for (int k = 0; k < map->charts; k++)
        reads += fields[k].reads;
    return reads;
}

/* A flight from high above down to the ground and along it, as a window's loop draws it: only windows that fill read,
 * and what they read is decoded already. */
static void a_flight_reads_nothing_while_it_draws(void **state)
{
    (void)state;
    enum { FRAMES = 200 };
    for (int kind = 2; kind < 4; kind++) {
        tc_map *map = made(kind);
        const tc_camera end = view_of(map, 4);
        counted fields[TC_MAX_CHARTS];
        count_reads(map, fields);
        scene s = scene_of(map);
        const tc_renderer_use use = tc_renderer_used(s.renderer);
        tc_view *view = tc_view_allocate(s.surface);
        tc_frame frame;
        assert_true(view && tc_frame_allocate(s.surface, &frame));
        const int64_t waits = told(map).waits;
        for (int i = 0; i < FRAMES; i++) {
            tc_camera c = end;
            tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
            tc_frame_stats stats;
            tc_error error = {.text = ""};
            double z;
            c.z += (kind == 3 ? 200e3 : 20e3) * pow(1e-4, fmin(1, 2.0 * i / FRAMES)), c.x *= 1 + 1e-5 * i;
            if (tc_renderer_frame(s.renderer, &c, false, &stats, &error) != TC_OK)
                fail_msg("%s", error.text);
            const int before = reads_of(map, fields);
            s.surface->look(s.surface, use.windows, &c, &(tc_frame_options){0}, false, view);
            s.surface->wanted(view, wanted);
            s.surface->draws(view, &use.textures->layers, &frame);
            assert_true(s.surface->height(view, c.x, c.y, &z) && isfinite(z));
            assert_int_equal(reads_of(map, fields), before);
        }
        assert_true(reads_of(map, fields) > 0);
        assert_int_equal(told(map).waits, waits);
        free(view);
        tc_frame_free(&frame);
        scene_destroy(&s);
        count_no_more(map, fields);
        tc_map_destroy(map);
    }
}

/* ---- A scheme of the test's own ---------------------------------------------------------------------------------- */

static void a_scheme_that_only_this_test_knows_is_drawn(void **state)
{
    (void)state;
    enum { WIDTH = 200, HEIGHT = 150 };
    tc_map *map = tc_map_flat(terrain_field(TERRAIN_SMOOTH, 60, 50, 30, 1));
    const tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1};
    const tc_scene_needs needs = tc_scene_needs_of(&options, tc_field_info(tc_map_field(map, 0)));
    scene s = {0};
    tc_error error = {.text = ""};
    if (one_square_schemes[0].create(one_square_schemes, map, &(tc_surface_request){.needs = &needs}, &s.surface,
                                     &error) ||
        tc_renderer_create(tc_context_gl(context), s.surface, &options, &s.renderer, &error))
        fail_msg("%s", error.text);
    /* Its heights are those of the mesh, and straight from above its pixels those of a square of one level. */
    const tc_camera c = {
        .x = 900, .y = 750, .z = 5000, .pitch = -M_PI / 2, .fov = 0.3, .width = WIDTH, .height = HEIGHT};
    scene_draw(&s, &c, true);
    scene square = scene_create(context, tc_map_field(map, 0), 63, &options);
    scene_draw(&square, &c, true);
    uint8_t *ours = scene_pixels(&s, &c), *theirs = scene_pixels(&square, &c);
    int differ = 0, lit = 0;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        differ += abs(ours[i] - theirs[i]) > 8;
        lit += ours[i] > 0;
    }
    assert_true(lit > WIDTH * HEIGHT);
    assert_true(differ < 3 * WIDTH * HEIGHT / 50);
    free(ours), free(theirs);
    scene_destroy(&square);
    scene_destroy(&s);
    tc_map_destroy(map);
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_trench_far_away_draws_no_more_rings),
        cmocka_unit_test(bounds_are_few_reads_of_memory),
        cmocka_unit_test(a_flight_reads_nothing_while_it_draws),
        cmocka_unit_test(a_scheme_that_only_this_test_knows_is_drawn),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    made_folder_remove();
    tc_context_destroy(context);
    return failed;
}

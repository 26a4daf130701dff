/* test_rings_precision.c - vertices of the rings as the driver computes them, read back, against long double. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/feedback.h"
#include "tests/support/planet_scene.h"
#include "tests/support/rings_capture.h"
#include "tests/support/rings_views.h"
#include "tests/support/sweep.h"

/* Bounds: pixels of a frame 1280 wide, samples of the level read. */
#define PIXELS 0.01
#define TEXELS 1e-3

static tc_context *context;

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_context_destroy(context);
    return 0;
}

static void take_worst(rings_error *all, const rings_error *e)
{
    all->over_radius = fmax(all->over_radius, e->over_radius);
    all->pixels = fmax(all->pixels, e->pixels);
    all->texels = fmax(all->texels, e->texels);
    all->vertices += e->vertices, all->seen += e->seen, all->differ += e->differ;
}

/* What planets are made of. */
typedef struct relief {
    globe_function height;
    const char *name;
    int synthesised; /* levels finer than the data */
} relief;
static const relief rough = {globe_rough, "rough", 0}, smooth = {globe_smooth, "smooth", 0},
                    fine = {globe_fractal, "synthesised", 12};

/* A planet's size and shape. */
typedef struct shape {
    double radius, flattening;
} shape;

static tc_map *planet_of(const relief *f, int64_t width, shape of)
{
    return planet_flattened(planet_synthesised(globe_atlas(f->height, width, of.radius), f->synthesised),
                            of.flattening);
}

/* Places on a planet of this shape, each from `altitudes` heights: those of RINGS_ALTITUDES in turn. */
static rings_error planet(const relief *f, shape of, tc_rings_scheme scheme, int places, int altitudes)
{
    enum { SIZE = 1024 };
    const double radius = of.radius;
    tc_map *atlas = planet_of(f, SIZE, of);
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.scheme = scheme, .m = 20});
    rings_capture capture = rings_capture_create(&globe);
    rings_error all = {0}, by_altitude[RINGS_ALTITUDES] = {{0}};
    test_random r = {(uint64_t)radius};
    for (int place = 0; place < places; place++)
        for (int a = 0; a < altitudes; a++) {
            int k = (place + a * RINGS_ALTITUDES / altitudes) % RINGS_ALTITUDES;
            tc_camera c = rings_view_of(atlas, place, SIZE, rings_altitude(k, radius), &r);
            rings_error level[RINGS_MAX_LEVELS] = {{0}}, here = {0};
            rings_capture_compare(&capture, &c, 16, level);
            for (int i = 0; i < RINGS_MAX_LEVELS; i++)
                take_worst(&here, &level[i]);
            take_worst(&by_altitude[k], &here);
            if (getenv("VERBOSE") && (here.pixels > PIXELS || here.texels > TEXELS))
                fflush(stdout), printf("  place %d (%g, %g), altitude %g: %.3g pixels, %.3g texels\n", place, c.x, c.y,
                                       rings_altitude(k, radius), here.pixels, here.texels);
        }
    for (int k = 0; k < RINGS_ALTITUDES; k++)
        take_worst(&all, &by_altitude[k]);
    printf("%s, %s, radius %g m, flattening %.4f: %lld vertices, %lld in frames; worst %.2e pixels, %.2e texels; "
           "%lld elsewhere in double\n",
           scheme == TC_RINGS_CH06 ? "CH06" : "exact", f->name, radius, of.flattening, (long long)all.vertices,
           (long long)all.seen, all.pixels, all.texels, (long long)all.differ);
    printf("  altitude m/pixels/texels:");
    for (int k = 0; k < RINGS_ALTITUDES; k++)
        printf(" %.1e/%.1e/%.1e", rings_altitude(k, radius), by_altitude[k].pixels, by_altitude[k].texels);
    printf("\n");
    rings_capture_destroy(&capture);
    globe_scene_destroy(&globe);
    tc_map_destroy(atlas);
    return all;
}

static const double radii[] = {1, 1e3, 1737400, 6371000, 1e8};
enum { RADII = sizeof radii / sizeof radii[0] };

static void exact_within_bounds(const relief *f)
{
    double pixels = 0, texels = 0;
    int step = f->synthesised && !sweep_whole() ? 3 : 1; /* which takes longer */
    for (int i = 0; i < 2 * RADII; i += step) {
        /* Spheres, then ellipsoids as flat as the Earth; one on the way is flat to see. The special places come first.
         */
        const shape of = {radii[i % RADII], i < RADII ? 0 : i == RADII + 2 ? 0.1 : WGS84_FLATTENING};
        rings_error e = planet(f, of, TC_RINGS_EXACT, sweep_of(RINGS_PLACES), sweep_whole() ? 3 : 1);
        assert_true(e.seen > sweep_of(50000)); /* less is in sight from the special places */
        assert_true(e.differ * 10000 < e.vertices);
        pixels = fmax(pixels, e.pixels), texels = fmax(texels, e.texels);
    }
    assert_true(pixels < PIXELS);
    assert_true(texels < TEXELS);
}

static void rough_planets_within_a_hundredth_of_a_pixel(void **state)
{
    (void)state;
    exact_within_bounds(&rough);
}

static void smooth_planets_within_a_hundredth_of_a_pixel(void **state)
{
    (void)state;
    exact_within_bounds(&smooth);
}

static void synthesised_planets_within_a_hundredth_of_a_pixel(void **state)
{
    (void)state;
    exact_within_bounds(&fine);
}

/* The paper's own transform is out of bounds, and is seen to be. */
static void the_papers_transform_is_found_out(void **state)
{
    (void)state;
    rings_error e = planet(&rough, (shape){6371000, 0}, TC_RINGS_CH06, 20, 3);
    assert_true(e.pixels > PIXELS);
    assert_true(e.texels > TEXELS);
}

/* A walk of a metre (of a sweep that is not whole, of its middle) in steps of a millimetre, 2 m above ground with
 * samples 10 km apart: points move on the screen as they do in long double. */
static void walk(double flattening)
{
    enum { MOST = 4096 };
    const int steps = sweep_of(1000);
    const double radius = 6371000;
    tc_map *atlas = planet_flattened(globe_atlas(globe_rough, 4096, radius), flattening);
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.m = 20});
    rings_capture capture = rings_capture_create(&globe);
    double(*now)[2] = calloc(MOST, sizeof *now), (*before)[2] = calloc(MOST, sizeof *before), worst = 0, jump = 0;
    int64_t seen = 0;
    assert_true(now && before);
    for (int k = 0; k < steps; k++) {
        /* Over a sample of the grid on the way, from one cell into the next. */
        tc_camera c = {.x = 40 * 2 * M_PI / 4096 + (k - steps / 2) * 0.8e-3 / radius,
                       .y = 0.7 + (k + 500 - steps / 2) * 0.6e-3 / radius,
                       .heading = 0.5,
                       .pitch = -1.2,
                       .fov = M_PI / 2,
                       .width = 1280,
                       .height = 960};
        assert_int_equal(tc_map_height(atlas, c.x, c.y, &c.z), TC_OK);
        c.z += 2;
        int count = rings_capture_offsets(&capture, &c, 64, MOST, now);
        for (int i = 0; i < count; i++) {
            if (isnan(now[i][0]))
                continue;
            seen++;
            worst = fmax(worst, hypot(now[i][0], now[i][1]));
            if (k > 0 && !isnan(before[i][0]))
                jump = fmax(jump, hypot(now[i][0] - before[i][0], now[i][1] - before[i][1]));
        }
        double(*swap)[2] = now;
        now = before, before = swap;
    }
    printf("walk: %lld points; at most %.2e pixels off, %.2e from step to step\n", (long long)seen, worst, jump);
    assert_true(seen > 100 * steps);
    assert_true(worst < PIXELS);
    assert_true(jump < 0.02);
    free(now), free(before);
    rings_capture_destroy(&capture);
    globe_scene_destroy(&globe);
    tc_map_destroy(atlas);
}

static void nothing_jitters(void **state)
{
    (void)state;
    walk(0);
    walk(WGS84_FLATTENING);
}

static double level(double longitude, double latitude)
{
    (void)longitude, (void)latitude;
    return 0;
}

/* body_offset() of the bodies' shaders, for whatever surface, against their twins in double: of pairs of normals from a
 * centimetre apart to half around the body. */
static void offsets_in_float(void **state)
{
    (void)state;
    static const char own[] = "out vec3 c_offset;\n"
                              "void main()\n"
                              "{\n"
                              "    c_offset = body_offset(vec3(in_vertex.y, -in_vertex.x, -in_vertex.z));\n"
                              "    gl_Position = vec4(0.0);\n"
                              "}\n";
    static const double flattening[] = {0, WGS84_FLATTENING, 0.1};
    for (int b = 0; b < 3; b++) {
        tc_map *atlas = planet_flattened(globe_atlas(level, 256, 6378137), flattening[b]);
        globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.n_phi = 64, .m = 4});
        const tc_body *body = &atlas->body;
        const tc_geometry *g = &globe.surface->geometry;
        const float(*vertex)[4] = g->vertices;
        float(*offset)[3] = calloc((size_t)g->vertex_count, sizeof *offset);
        GLuint program = feedback_program(globe.gl, globe.surface, "", NULL, own, (const char *[]){"c_offset", NULL});
        double worst = 0;
        int64_t pairs = 0;
        assert_non_null(offset);
        for (int place = 0; place < 40; place++) {
            test_random r = {(uint64_t)place};
            tc_camera c = rings_view_of(atlas, place, 256, 1000, &r);
            const double here[3] = {c.x, c.y, 0};
            globe_scene_frame(&globe, &c, false);
            feedback_run(globe.gl, program, 0, g->vertex_count, 3, &offset[0][0]);
            for (int i = 0; i < g->vertex_count; i++) {
                const double d[3] = {vertex[i][1], -(double)vertex[i][0], -(double)vertex[i][2]};
                double exact[3], off = 0, away = 0;
                body->class->offset(body, here, d, exact);
                for (int k = 0; k < 3; k++)
                    off = hypot(off, offset[i][k] - exact[k]), away = hypot(away, exact[k]);
                if (away > 0)
                    worst = fmax(worst, off / away), pairs++;
            }
        }
        printf("flattening %.4f: %lld pairs: offsets in float off by %.2e of the distance at most\n", flattening[b],
               (long long)pairs, worst);
        assert_true(pairs > 10000);
        assert_true(worst < 2e-7);
        free(offset);
        globe.gl->DeleteProgram(program);
        globe_scene_destroy(&globe);
        tc_map_destroy(atlas);
    }
}

/* What is captured beside positions changes no bit of them. */
static void capturing_changes_nothing(void **state)
{
    (void)state;
    tc_map *atlas = globe_atlas(globe_rough, 1024, 6371000);
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.m = 20});
    rings_capture capture = rings_capture_create(&globe);
    test_random r = {3};
    for (int place = 0; place < RINGS_PLACES; place += 7) {
        tc_camera c = rings_view_of(atlas, place, 1024, rings_altitude(place % RINGS_ALTITUDES, 6371000), &r);
        assert_int_equal(rings_capture_additions(&capture, &c), 0);
    }
    rings_capture_destroy(&capture);
    globe_scene_destroy(&globe);
    tc_map_destroy(atlas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(capturing_changes_nothing),
        cmocka_unit_test(offsets_in_float),
        cmocka_unit_test(nothing_jitters),
        cmocka_unit_test(the_papers_transform_is_found_out),
        cmocka_unit_test(smooth_planets_within_a_hundredth_of_a_pixel),
        cmocka_unit_test(rough_planets_within_a_hundredth_of_a_pixel),
        cmocka_unit_test(synthesised_planets_within_a_hundredth_of_a_pixel),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

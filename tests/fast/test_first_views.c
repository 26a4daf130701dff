/* test_first_views.c - what decides how a file is first seen: whether a sea is around it, how high the land around it
 * is, which colours its body has, and where a part of a globe is looked at from. */
#include "tests/support/test.h"

#include <math.h>
#include <string.h>

#include "common/render/palette.h"
#include "common/render/scene_needs.h"
#include "common/view/camera.h"
#include "common/view/navigation.h"

#define DEGREE (M_PI / 180)

/* ---- Edges ------------------------------------------------------------------------------------------------------- */

/* So many of a hundred heights along an edge are at this one, the others at 80, 81, ... */
static bool at_sea(int count, float height, double relief, double *depth)
{
    float z[100];
    for (int i = 0; i < 100; i++)
        z[i] = i < count ? height : (float)(80 + i);
    return tc_edge_at_sea(&(tc_edge){100, z}, relief, depth);
}

static void a_sea_is_at_the_edge_or_not(void **state)
{
    (void)state;
    double depth;
    assert_true(at_sea(10, 0, 500, &depth));
    assert_true(depth == 0);
    assert_false(at_sea(9, 0, 500, &depth));
    assert_true(at_sea(30, -40, 500, &depth));
    assert_true(depth == 40);
    assert_false(at_sea(30, 3, 500, &depth)); /* a plain beside it */
    assert_true(at_sea(30, 3, 4000, &depth)); /* of mountains that is as low as their heights are known */
    assert_false(at_sea(0, 0, 500, &depth));
    assert_false(tc_edge_at_sea(&(tc_edge){0, NULL}, 500, &depth)); /* all voids */
}

static void land_around_is_low(void **state)
{
    (void)state;
    float z[100];
    for (int i = 0; i < 100; i++)
        z[i] = (float)(1000 + 10 * i);
    double depth;
    assert_true(tc_edge_plain(&(tc_edge){100, z}, &depth) == 1050);
    assert_true(depth == -450); /* and looks like what lies at 1500 m */
    assert_true(tc_edge_plain(&(tc_edge){0, NULL}, &depth) == 0 && depth == 0);
    assert_true(tc_wall_below(1000, 100) == 100);   /* a crag */
    assert_true(tc_wall_below(10, 100000) == 2200); /* a plain */
}

/* ---- Bodies ------------------------------------------------------------------------------------------------------ */

static tc_palette palette_of(double semi_major, bool other)
{
    return tc_palette_make(
        &(tc_terrain_info){.z_min = -3000, .z_max = 5000, .other_body = other, .semi_major = semi_major});
}

static void bodies_have_their_colours(void **state)
{
    (void)state;
    static const struct {
        double semi_major;
        bool other, natural, air, water;
    } bodies[] = {{0, false, true, true, true},         {6378137, false, true, true, true},
                  {3396190, true, false, true, false},  {1737400, true, false, false, false},
                  {2439700, true, false, false, false}, {6051800, true, false, false, false},
                  {0, true, false, false, false}};
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        const tc_palette p = palette_of(bodies[i].semi_major, bodies[i].other);
        assert_int_equal(p.natural, bodies[i].natural);
        assert_int_equal(p.air, bodies[i].air);
        assert_int_equal(p.water, bodies[i].water);
    }
    const tc_palette mars = palette_of(3389500, true), moon = palette_of(1737400, true);
    for (int i = TC_RAMP_SIZE / 2; i < TC_RAMP_SIZE; i++) {
        const uint8_t *m = mars.ramp[i], *g = moon.ramp[i];
        assert_true(m[0] > m[1] && m[1] > m[2]);             /* rust */
        assert_true(g[0] >= g[2] && g[0] - g[2] <= 24);      /* grey */
        assert_true(i == TC_RAMP_SIZE / 2 || g[0] >= g[-4]); /* the higher, the brighter */
    }
    assert_true(moon.ramp[TC_RAMP_SIZE - 1][0] > 8 * moon.ramp[TC_RAMP_SIZE / 2][0]);
}

/* What was packed with an error shows neither land nor depths where the data have a level sea at 0. */
static void noise_is_no_land(void **state)
{
    (void)state;
    tc_terrain_info info = {.z_min = 0, .z_max = 1000};
    const tc_palette exact = tc_palette_make(&info);
    info.rms = 4;
    const tc_palette packed = tc_palette_make(&info);
    info.z_min = -30; /* there are depths */
    const tc_palette deep = tc_palette_make(&info);
    assert_true(exact.water && packed.water && deep.water);
    assert_true(exact.heights[3] < 1 && deep.heights[3] < 1 && packed.heights[3] >= 8 && packed.heights[3] < 9);
    assert_true(packed.heights[1] * 12 < 1e-3F && deep.heights[1] * 12 > 1e-3F);
    assert_true(tc_sea_noise(&info) == 0);
    info.z_min = 1, info.z_base = 300;
    assert_false(tc_palette_make(&info).water);
}

/* ---- What is asked for ------------------------------------------------------------------------------------------- */

static void nothing_is_around_unless_asked_for(void **state)
{
    (void)state;
    const tc_terrain_info coast = {.z_min = -100, .z_max = 900};
    tc_scene_options o = {0};
    tc_scene_needs needs = tc_scene_needs_of(&o, &coast);
    assert_false(needs.walls || needs.sea || needs.plain || needs.stars || needs.climate);
    o.around = (tc_surroundings){.walls = true, .sea = true, .stars = true, .climate = true};
    needs = tc_scene_needs_of(&o, &coast);
    assert_true(needs.walls && needs.sea && needs.stars && needs.climate);
    o.background_set = true;
    needs = tc_scene_needs_of(&o, &coast);
    assert_true(needs.walls && !needs.sea && !needs.stars && needs.climate);
    o.background_set = false, o.shade = &tc_shades[TC_SHADE_SLOPE];
    needs = tc_scene_needs_of(&o, &coast);
    assert_true(needs.walls && !needs.sea && !needs.stars && !needs.climate);
}

/* ---- Parts of globes --------------------------------------------------------------------------------------------- */

/* How far outside the frame the worst corner is, as a share of half of it. */
static double worst_corner(const tc_flight_box *box, const tc_pose *view, const tc_camera *lens)
{
    double t[2], worst = -INFINITY;
    tc_camera_tangents(lens, &t[0], &t[1]);
    const tc_basis basis = tc_camera_basis(&(tc_camera){.heading = view->heading, .pitch = view->pitch});
    const tc_body body = tc_body_of(box->radius);
    double eye[3], axes[3][3];
    const double at[3] = {view->x, view->y, view->z};
    body.class->position(&body, at, eye);
    body.class->axes(&body, at, axes);
    for (int i = 0; i < 4; i++) {
        const double place[3] = {i & 1 ? box->east : box->west, i & 2 ? box->north : box->south, box->z_max};
        double p[3], seen[3] = {0, 0, 0};
        body.class->position(&body, place, p);
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++) {
                const double along = axes[k][j] * (p[j] - eye[j]);
                seen[0] += basis.right[k] * along, seen[1] += basis.up[k] * along, seen[2] += basis.forward[k] * along;
            }
        if (seen[2] <= 0)
            return INFINITY;
        worst = fmax(worst, fmax(fabs(seen[0]) / (t[0] * seen[2]), fabs(seen[1]) / (t[1] * seen[2])) - 1);
    }
    return worst;
}

/* A cap around a pole is as wide as most of the frame is high, from above the pole. */
static void caps_fill_the_frame(void **state)
{
    (void)state;
    static const double talls[] = {0.1, 1, 3, 20, 50, 80}; /* degrees */
    for (int south = 0; south < 2; south++)
        for (size_t i = 0; i < sizeof talls / sizeof *talls; i++) {
            const double radius = 1737400, tall = talls[i] * DEGREE, pole = M_PI / 2;
            const tc_flight_box box = {.west = -M_PI,
                                       .east = M_PI,
                                       .south = south ? -pole : pole - tall,
                                       .north = south ? tall - pole : pole,
                                       .radius = radius};
            const tc_pose view = tc_sphere_navigation.whole(&box, 75 * DEGREE, 960, 540);
            const double rim = atan2(radius * sin(tall), view.z + radius * (1 - cos(tall)));
            const double half = atan(tan(37.5 * DEGREE) * 540 / 960), limb = asin(radius / (radius + view.z));
            assert_true(fabs(fabs(view.y) - pole) < 1e-6 && view.z > 0);
            assert_true(tall < 1 ? fabs(rim / half - 0.88) < 1e-3 : fabs(limb / half - 0.88) < 1e-3);
        }
}

static void parts_of_globes_fill_the_frame(void **state)
{
    (void)state;
    static const double radii[] = {6371000, 1737400};
    static const double boxes[][4] = {{8, 46, 9, 47},     {-180, -60, -175, -57}, {178, 60, 183, 64},
                                      {0, 88, 40, 89.9},  {0, -89.9, 30, -88},    {95, 9, 127, 41},
                                      {-1e-3, 0, 0, 1e-3}};
    for (size_t b = 0; b < sizeof boxes / sizeof *boxes; b++)
        for (int k = 0; k < 2; k++) {
            const double *d = boxes[b];
            const tc_flight_box box = {.west = d[0] * DEGREE,
                                       .south = d[1] * DEGREE,
                                       .east = d[2] * DEGREE,
                                       .north = d[3] * DEGREE,
                                       .z_min = 0,
                                       .z_max = b == 6 ? 10 : 4000,
                                       .radius = radii[k]};
            const tc_camera lens = {.fov = 75 * DEGREE, .width = 960, .height = 540};
            const tc_pose view = tc_sphere_navigation.whole(&box, lens.fov, lens.width, lens.height);
            assert_true(isfinite(view.x) && isfinite(view.y) && view.z > box.z_max);
            assert_true(fabs(view.x) <= M_PI + 1e-9 && fabs(view.y) <= M_PI / 2);
            const double worst = worst_corner(&box, &view, &lens);
            if (!(worst <= 0) || worst < -0.25)
                fail_msg("box %zu, radius %g: %g outside", b, radii[k], worst);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sea_is_at_the_edge_or_not),
        cmocka_unit_test(land_around_is_low),
        cmocka_unit_test(bodies_have_their_colours),
        cmocka_unit_test(noise_is_no_land),
        cmocka_unit_test(nothing_is_around_unless_asked_for),
        cmocka_unit_test(parts_of_globes_fill_the_frame),
        cmocka_unit_test(caps_fill_the_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

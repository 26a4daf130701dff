/* test_throttled_rings.c - rings drawn with every second or fourth vertex: the lists of indices close the mesh, heights
 * follow the throttle evenly, more of it is never more triangles, and what the driver draws is what the oracle says. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/measure/view_error.h"
#include "common/view/camera.h"
#include "common/view/throttle.h"
#include "spherical/rings_internal.h"
#include "tests/support/planet_scene.h"

/* ---- Lists of indices -------------------------------------------------------------------------------------------- */

/* An edge of a triangle, from a lower to a higher vertex or the other way. */
typedef struct edge {
    int a, b, way;
} edge;

static int by_vertices(const void *x, const void *y)
{
    const edge *p = x, *q = y;
    return p->a != q->a ? (p->a > q->a) - (p->a < q->a) : (p->b > q->b) - (p->b < q->b);
}

/* A vertex of a ring; columns 0 and n_phi are the same. */
static int vertex(const rings_geometry *g, const tc_geometry *geometry, uint32_t at)
{
    int index = (int)tc_index(geometry, at), row = index / g->stride, column = index % g->stride;
    return row * g->stride + column % g->n_phi;
}

/* Edges of the list's triangles; the count of triangles that have an area. */
static int list_edges(const rings_geometry *g, const tc_geometry *geometry, const rings_strips *list, edge *edges,
                      int *count_ret)
{
    int triangles = 0, count = 0;
    for (int sector = 0; sector < g->sectors; sector++) {
        uint32_t first = list->first + (uint32_t)sector * list->count;
        for (uint32_t at = first; at < first + list->count; at += 3) {
            int v[3] = {vertex(g, geometry, at), vertex(g, geometry, at + 1), vertex(g, geometry, at + 2)};
            if (v[0] == v[1] || v[1] == v[2] || v[0] == v[2])
                continue;
            triangles++;
            for (int k = 0; k < 3; k++) {
                int a = v[k], b = v[(k + 1) % 3];
                edges[count++] = a < b ? (edge){a, b, 1} : (edge){b, a, -1};
            }
        }
    }
    *count_ret = count;
    return triangles;
}

/* Whether a place of 0 .. last is drawn by a stage. */
static bool drawn(int at, int last, int stage)
{
    return tc_rings_stage_of(at, last) >= stage;
}

static int drawn_of(int last, int stage)
{
    int count = 0;
    for (int at = 0; at < last; at++)
        count += drawn(at, last, stage);
    return count;
}

static void check_list(const rings_geometry *g, const tc_geometry *geometry, const rings_strips *list, int stage,
                       int finer, bool disc, edge *edges)
{
    int count, rows = disc ? g->fill : g->m, columns = g->n_phi / g->sectors, outer = 0, inner = 0;
    int triangles = list_edges(g, geometry, list, edges, &count);
    assert_int_equal(triangles, list->triangles * g->sectors);
    qsort(edges, (size_t)count, sizeof *edges, by_vertices);
    for (int i = 0; i < count;) {
        const edge *e = &edges[i];
        if (i + 1 < count && by_vertices(e, e + 1) == 0) { /* between two triangles, and no more */
            assert_int_equal(e[0].way + e[1].way, 0);
            assert_true(i + 2 == count || by_vertices(e, e + 2) != 0);
            i += 2;
        } else { /* on a side, along it */
            int row = e->a / g->stride;
            assert_int_equal(e->b / g->stride, row);
            assert_true(row == 0 || (!disc && row == rows));
            outer += row == 0, inner += row != 0;
            i++;
        }
        for (int k = 0; k < 2; k++) {
            int v = k ? e->b : e->a, row = v / g->stride, column = v % g->stride % columns;
            assert_true(drawn(row, rows, stage));
            assert_true(drawn(column, columns, row == 0 ? stage - finer : stage));
        }
    }
    assert_int_equal(outer, g->sectors * drawn_of(columns, stage - finer));
    assert_int_equal(inner, disc ? 0 : g->sectors * drawn_of(columns, stage));
}

static void lists_close_the_mesh(void **state)
{
    (void)state;
    static const int sizes[][2] = {{64, 4}, {96, 6}, {128, 10}, {160, 8}, {512, 40}, {1024, 58}, {2048, 128}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        rings_geometry g = {
            .levels = 2, .n_phi = sizes[k][0], .m = sizes[k][1], .fill = sizes[k][1] / 2, .throttled = true};
        tc_geometry geometry = {0};
        assert_int_equal(tc_rings_geometry(&g, &geometry, NULL), TC_OK);
        edge *edges = malloc(sizeof *edges * 6 * (size_t)(g.n_phi + 1) * (size_t)(g.m + 1));
        assert_non_null(edges);
        for (int disc = 0; disc < 2; disc++)
            for (int stage = 0; stage <= RINGS_STAGES; stage++)
                for (int finer = 0; finer <= (stage > 0); finer++)
                    check_list(&g, &geometry, &(disc ? g.fill_strips : g.ring_strips)[stage][finer], stage, finer, disc,
                               edges);
        int all = g.ring_strips[0][0].triangles, half = g.ring_strips[1][1].triangles;
        assert_true(half <= 0.4 * all && g.ring_strips[2][1].triangles <= (g.m >= 8 ? 0.45 : 0.7) * half);
        free(edges);
        free(geometry.vertices);
        free(geometry.indices);
    }
}

/* ---- Views ------------------------------------------------------------------------------------------------------- */

enum { PLANETS = 3 };
static const struct {
    planet_kind kind;
    double radius;
    const char *name;
} made[PLANETS] = {{PLANET_CLIFF, 400e3, "cliffs of 8,000 m"},
                   {PLANET_SMOOTH, 1737400, "smooth"},
                   {PLANET_DEFAULT, 6371000, "the default"}};
static tc_context *context;
static tc_map *planet[PLANETS];

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    for (int k = 0; k < PLANETS; k++)
        planet[k] = planet_made(made[k].kind, 512, made[k].radius, 7);
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < PLANETS; k++)
        tc_map_destroy(planet[k]);
    tc_context_destroy(context);
    return 0;
}

static const tc_scene_options plain = {.unlit = true, .background_set = true, .budget = -1, .throttle = true};

/* A surface and one who looks at it, without OpenGL. */
typedef struct stage {
    tc_surface *surface;
    tc_windows windows;
    tc_view *view;
    tc_frame frame;
} stage;

static stage stage_of(const tc_map *map, const tc_rings_options *rings)
{
    stage s = {.surface = planet_rings(map, rings, &plain)};
    tc_error error;
    if (s.surface->make_windows(s.surface, &s.windows, &error) || !(s.view = tc_view_allocate(s.surface)) ||
        !tc_frame_allocate(s.surface, &s.frame))
        exit(99);
    return s;
}

static void stage_end(stage *s)
{
    tc_frame_free(&s->frame);
    free(s->view);
    tc_windows_destroy(&s->windows);
    s->surface->destroy(s->surface);
}

static const rings_view *look(stage *s, const tc_camera *camera, const tc_frame_options *options)
{
    tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    s->surface->look(s->surface, &s->windows, camera, options, true, s->view);
    s->surface->wanted(s->view, wanted);
    for (int chart = 0; chart < s->windows.charts; chart++)
        tc_clipmap_update(s->windows.clipmap[chart], wanted[chart], -1, true, 0);
    return (const rings_view *)s->view;
}

static tc_camera camera_at(const tc_map *map, double x, double y, double above)
{
    tc_camera c = {.x = x, .y = y, .heading = 0.6, .pitch = -0.4, .fov = 1.2, .width = 320, .height = 240};
    assert_int_equal(tc_map_height(map, x, y, &c.z), TC_OK);
    c.z += above;
    return c;
}

/* ---- Heights ----------------------------------------------------------------------------------------------------- */

enum { POINTS = 120, FINER = 8 };

/* What moves: the throttle from 0 to the most, or at that throttle the eye's height, over an octave. */
typedef struct motion {
    double above, throttle; /* metres; negative: this moves */
    bool no_morph;
} motion;

/* The largest change of drawn heights in steps of that many octaves, relative to their distance. */
static double largest_change(stage *s, const tc_map *map, motion m, double step)
{
    double x[POINTS], y[POINTS], away[POINTS], before[POINTS] = {0}, worst = 0;
    tc_camera c = camera_at(map, 0.3, 0.7, m.above);
    test_random r = {3};
    const double radius = map->body.radius, ground = c.z - m.above;
    double least = log(1e-2 * m.above / radius), most = log(fmin(4 * sqrt(m.above / radius), 1.2));
    for (int k = 0; k < POINTS; k++) {
        double angle = exp(test_random_range(&r, least, most)), way = test_random_range(&r, 0, 2 * M_PI);
        x[k] = c.x + angle * sin(way) / cos(c.y);
        y[k] = fmin(fmax(c.y + angle * cos(way), -1.5), 1.5);
        away[k] = hypot(angle * radius, m.above);
    }
    int count = (int)ceil((m.throttle < 0 ? s->surface->most_throttle : 1) / step);
    for (int i = 0; i <= count; i++) {
        const tc_frame_options options = {.throttle = m.throttle < 0 ? i * step : m.throttle, .no_morph = m.no_morph};
        c.z = ground + m.above * (m.throttle < 0 ? 1 : exp2(i * step));
        look(s, &c, &options);
        for (int k = 0; k < POINTS; k++) {
            double z;
            assert_true(s->surface->height(s->view, x[k], y[k], &z));
            worst = i ? fmax(worst, fabs(z - before[k]) / away[k]) : worst;
            before[k] = z;
        }
    }
    return worst;
}

/* What follows evenly changes by an eighth in an eighth of a step; what leaps by as much as ever. */
static void heights_follow_the_throttle(void **state)
{
    (void)state;
    for (int k = 0; k < PLANETS; k++)
        for (double above = 3; above < 4e6; above *= k ? 300 : 30) {
            stage s = stage_of(planet[k], &(tc_rings_options){.n_phi = 128, .m = 10});
            const motion moves = {above, -1, false};
            double whole = largest_change(&s, planet[k], moves, TC_THROTTLE_STEP);
            double fine = largest_change(&s, planet[k], moves, TC_THROTTLE_STEP / FINER);
            printf("throttled, %s, %.0f m above: largest change in a step %.5f of the distance, in an eighth %.6f\n",
                   made[k].name, above, whole, fine);
            assert_true(fine <= 2 * whole / FINER + 1e-9);
            stage_end(&s);
        }
    stage s = stage_of(planet[0], &(tc_rings_options){.n_phi = 128, .m = 10});
    const motion abrupt = {2700, -1, true};
    double whole = largest_change(&s, planet[0], abrupt, TC_THROTTLE_STEP);
    double fine = largest_change(&s, planet[0], abrupt, TC_THROTTLE_STEP / FINER);
    printf("throttled without morph: %.5f and %.5f\n", whole, fine);
    assert_true(fine > 0.5 * whole && fine > 0.01);
    stage_end(&s);
}

/* Rings come and go as the eye climbs, by bounds of the ground that leap, and what passes over must not go by these.
 * Where the finest one goes its steps are about a pixel, of a throttled frame four: it then leaves as much more behind.
 */
static void heights_do_not_leap_as_the_eye_climbs(void **state)
{
    (void)state;
    for (int k = 0; k < PLANETS; k++)
        for (double above = 90; above < 4e5; above *= 30) {
            stage s = stage_of(planet[k], &(tc_rings_options){.n_phi = 128, .m = 10});
            double whole = largest_change(&s, planet[k], (motion){above, 0, false}, TC_THROTTLE_STEP / FINER),
                   worst = 0;
            for (double throttle = 0.2; throttle < 2; throttle += 0.6)
                worst = fmax(worst,
                             largest_change(&s, planet[k], (motion){above, throttle, false}, TC_THROTTLE_STEP / FINER));
            printf("throttled, %s, climbing from %.0f m: largest change %.6f of the distance, unthrottled %.6f\n",
                   made[k].name, above, worst, whole);
            assert_true(worst <= 10 * whole + 2e-4);
            stage_end(&s);
        }
}

/* ---- Triangles --------------------------------------------------------------------------------------------------- */

static void more_is_never_more_triangles(void **state)
{
    (void)state;
    enum { STEPS = 100, VIEWS = 12 };
    double left = 0, cost[PLANETS][STEPS + 1] = {{0}};
    for (int k = 0; k < PLANETS; k++) {
        stage s = stage_of(planet[k], &(tc_rings_options){.n_phi = 256, .m = 20});
        test_random r = {9};
        for (int v = 0; v < VIEWS; v++) {
            tc_camera c = planet_view(&r, planet[k], 0.5, 5 * planet[k]->body.radius);
            int64_t seen = INT64_MAX, all = INT64_MAX, first = 0;
            for (int i = 0; i <= STEPS; i++) {
                const rings_view *view =
                    look(&s, &c, &(tc_frame_options){.throttle = s.surface->most_throttle * i / STEPS});
                tc_layers layers = {0};
                for (int chart = 0; chart < s.windows.charts; chart++)
                    layers.held[chart] = layers.ready[chart] = tc_clipmap_levels(s.windows.clipmap[chart]);
                s.surface->draws(&view->head, &layers, &s.frame);
                assert_true(s.frame.triangles <= seen && s.frame.triangles_unculled <= all);
                seen = s.frame.triangles, all = s.frame.triangles_unculled;
                first = i ? first : seen;
                cost[k][i] += (double)seen / (double)first / VIEWS;
            }
            left += (double)seen / (double)first / VIEWS / PLANETS;
        }
        printf("throttled, %s: triangles at 0.25, 0.5, 1, 1.5, 2: %.2f %.2f %.2f %.2f %.2f\n", made[k].name,
               cost[k][STEPS / 8], cost[k][STEPS / 4], cost[k][STEPS / 2], cost[k][3 * STEPS / 4], cost[k][STEPS]);
        stage_end(&s);
    }
    assert_true(left < 0.15);
}

/* ---- Pictures ---------------------------------------------------------------------------------------------------- */

/* The most pixels by which drawn depths are off the drawn heights, where the surface is not seen edge on. */
static double depths_off(scene *s, const tc_map *map, const tc_camera *c, const tc_frame_options *options, int *count)
{
    float *depth = planet_depth(s, c);
    const tc_view *view = scene_look(s, c, options);
    double worst = 0, scale = tc_camera_pixel_scale(c), radius = map->body.radius;
    for (int y = 3; y < c->height; y += 9)
        for (int x = 3; x < c->width; x += 9) {
            double p[3], lo = INFINITY, hi = -INFINITY, z;
            float d = depth[y * c->width + x];
            if (!(d > 0))
                continue;
            tc_view_unproject(c, s->surface->near_plane, &map->body, x + 0.5, y + 0.5, d, p);
            double ds = 2 * asin(fmin(1, sqrt(pow(sin((p[1] - c->y) / 2), 2) +
                                              cos(p[1]) * cos(c->y) * pow(sin((p[0] - c->x) / 2), 2))));
            double away = hypot(ds * radius, p[2] - c->z), pixel = away / scale;
            for (int k = 0; k < 9; k++) { /* within a tenth of a pixel of it */
                double out = k ? 0.1 * pixel / radius : 0, turn = M_PI / 4 * k;
                assert_true(s->surface->height(view, p[0] + out * sin(turn) / fmax(cos(p[1]), 1e-6),
                                               p[1] + out * cos(turn), &z));
                lo = fmin(lo, z), hi = fmax(hi, z);
            }
            worst = fmax(worst, fmax(lo - p[2], p[2] - hi) / pixel);
            ++*count;
        }
    free(depth);
    return worst;
}

static void what_is_drawn_is_what_the_oracle_says(void **state)
{
    (void)state;
    static const double throttles[] = {0.07, 0.35, 0.61, 1.27, 2};
    for (int k = 1; k < PLANETS; k++) {
        scene s = planet_scene(context, planet[k], &(tc_rings_options){.n_phi = 96, .m = 6}, &plain);
        double worst = 0, none = 0;
        int count = 0;
        for (double above = 5; above < 5e6; above *= 31.7)
            for (size_t i = 0; i < sizeof throttles / sizeof *throttles; i++) {
                tc_camera c = camera_at(planet[k], 1.3, -0.6, above);
                tc_scene_options options = plain;
                options.frame.throttle = throttles[i];
                tc_renderer_set_options(s.renderer, &options);
                scene_draw(&s, &c, true);
                worst = fmax(worst, depths_off(&s, planet[k], &c, &options.frame, &count));
                if (throttles[i] > 0.3) /* held against what is not throttled it is off */
                    none = fmax(none, depths_off(&s, planet[k], &c, &(tc_frame_options){0}, &count));
            }
        printf("throttled, %s: %d depths at most %.3f pixels off the oracle; %.1f off one that is not throttled\n",
               made[k].name, count, worst, none);
        assert_true(count > 3000 && worst < 0.15 && none > 1);
        scene_destroy(&s);
    }
}

/* Lit, with haze and sky. */
static uint8_t *picture(scene *s, const tc_camera *c, double throttle)
{
    tc_renderer_set_options(s->renderer,
                            &(tc_scene_options){.budget = -1, .throttle = true, .frame.throttle = throttle});
    scene_draw(s, c, true);
    return scene_pixels(s, c);
}

static void pictures_depend_on_view_and_throttle_alone(void **state)
{
    (void)state;
    const tc_rings_options rings = {.n_phi = 128, .m = 10};
    const tc_scene_options may = {.budget = -1, .throttle = true}, never = {.budget = -1};
    for (int k = 0; k < PLANETS; k++) {
        scene been = planet_scene(context, planet[k], &rings, &may), fresh;
        test_random r = {21};
        for (int v = 0; v < 6; v++) {
            tc_camera c = planet_view(&r, planet[k], 0.5, 2 * planet[k]->body.radius), other = c;
            other.z += 3e5, other.y *= 0.9;
            size_t bytes = 3 * (size_t)c.width * (size_t)c.height;
            free(picture(&been, &other, 1.9));
            uint8_t *throttled = picture(&been, &c, 0.8), *whole = picture(&been, &c, 0), *its;
            fresh = planet_scene(context, planet[k], &rings, &may);
            its = picture(&fresh, &c, 0.8);
            assert_memory_equal(throttled, its, bytes);
            free(its);
            scene_destroy(&fresh);
            fresh = planet_scene(context, planet[k], &rings, &never);
            scene_draw(&fresh, &c, true);
            its = scene_pixels(&fresh, &c);
            assert_memory_equal(whole, its, bytes);
            free(its);
            scene_destroy(&fresh);
            free(throttled), free(whole);
        }
        scene_destroy(&been);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_close_the_mesh),
        cmocka_unit_test(heights_follow_the_throttle),
        cmocka_unit_test(heights_do_not_leap_as_the_eye_climbs),
        cmocka_unit_test(more_is_never_more_triangles),
        cmocka_unit_test(what_is_drawn_is_what_the_oracle_says),
        cmocka_unit_test(pictures_depend_on_view_and_throttle_alone),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

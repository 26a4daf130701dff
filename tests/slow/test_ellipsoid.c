/* test_ellipsoid.c - what is drawn on an ellipsoid is where PROJ, which has no part in drawing it, says that it is.
 *
 * Vertices as the driver computes them against geodetic coordinates that PROJ brings to space; how far away and how
 * large the body is from above its equator and its poles; and a DEM beside the same one warped to a map and drawn on a
 * plane. */
#include "tests/support/test.h"

#include <cpl_conv.h>
#include <gdal.h>
#include <gdal_utils.h>
#include <ogr_srs_api.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/app/load.h"
#include "common/measure/view_error.h"
#include "common/view/camera.h"
#include "spherical/rings_internal.h"
#include "tests/support/feedback.h"
#include "tests/support/globe_scene.h"
#include "tests/support/made_files.h"
#include "tests/support/planet_scene.h"
#include "tests/support/rings_oracle.h"
#include "tests/support/rings_views.h"

#define DEGREE (M_PI / 180)
static const double semi_major = 6378137;

static tc_context *context;

static int set_up(void **state)
{
    (void)state;
    GDALAllRegister();
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    made_folder_remove();
    tc_context_destroy(context);
    return 0;
}

/* ---- PROJ -------------------------------------------------------------------------------------------------------- */

static OGRCoordinateTransformationH between(int from, int to)
{
    OGRSpatialReferenceH a = OSRNewSpatialReference(NULL), b = OSRNewSpatialReference(NULL);
    assert_true(OSRImportFromEPSG(a, from) == OGRERR_NONE && OSRImportFromEPSG(b, to) == OGRERR_NONE);
    OSRSetAxisMappingStrategy(a, OAMS_TRADITIONAL_GIS_ORDER);
    OSRSetAxisMappingStrategy(b, OAMS_TRADITIONAL_GIS_ORDER);
    OGRCoordinateTransformationH t = OCTNewCoordinateTransformation(a, b);
    assert_non_null(t);
    OSRDestroySpatialReference(a), OSRDestroySpatialReference(b);
    return t;
}

/* Longitude and latitude, radians, and height to space. */
static void to_space(OGRCoordinateTransformationH t, const double place[3], double p[3])
{
    p[0] = place[0] / DEGREE, p[1] = place[1] / DEGREE, p[2] = place[2];
    assert_true(OCTTransform(t, 1, &p[0], &p[1], &p[2]));
}

/* ---- Places ------------------------------------------------------------------------------------------------------ */

enum { GEODETIC = 4979, GEOCENTRIC = 4978 };

/* Geodetic place of a direction around the viewer, by spherical trigonometry: the directions are normals. */
static void place_around(const tc_camera *c, double theta, double phi, double *longitude, double *latitude)
{
    double south = sin(theta) * cos(phi), east = sin(theta) * sin(phi), up = cos(theta);
    double sp = sin(c->y), cp = cos(c->y), x = up * cp + south * sp;
    *longitude = c->x + atan2(east, x);
    *latitude = atan2(up * sp - south * cp, hypot(x, east));
}

static void places_are_where_proj_says(void **state)
{
    (void)state;
    enum { PLACES = 40, PER_VIEW = 40, ALTITUDES = 7 };
    static const double altitudes[ALTITUDES] = {10, 100, 1e3, 1e4, 1e5, 1e6, 1e7};
    OGRCoordinateTransformationH proj = between(GEODETIC, GEOCENTRIC);
    tc_map *atlas = planet_flattened(globe_atlas(globe_smooth, 1024, semi_major), WGS84_FLATTENING);
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.m = 20});
    GLuint program =
        feedback_program(globe.gl, globe.surface, "", "renderer.vert", "", (const char *[]){"gl_Position", NULL});
    const rings_geometry *g = &((const rings_surface *)globe.surface)->geometry;
    float(*clip)[4] = calloc((size_t)globe.surface->geometry.vertex_count, sizeof *clip);
    double worst[ALTITUDES] = {0};
    int places[ALTITUDES] = {0};
    assert_non_null(clip);
    for (int view = 0; view < PLACES * ALTITUDES; view++) {
        test_random r = {(uint64_t)view + 1};
        int a = view % ALTITUDES, taken = 0;
        double longitude, latitude, ground;
        rings_place_of(view / ALTITUDES, 1024, &longitude, &latitude);
        tc_camera c = rings_view_at(atlas, longitude, latitude, altitudes[a], &r);
        assert_int_equal(tc_map_height(atlas, c.x, c.y, &ground), TC_OK);
        globe_scene_frame(&globe, &c, false);
        scene s = {.surface = globe.surface, .renderer = globe.renderer};
        const rings_view *v = (const rings_view *)scene_look(&s, &c, NULL);
        int first = tc_rings_level_base(g, v->first), rows = (v->finest - v->first + 1) * g->m;
        feedback_run(globe.gl, program, first, rows * g->stride, 4, &clip[0][0]);
        double eye[3], axes[3][3];
        to_space(proj, (double[3]){c.x, c.y, c.z}, eye);
        const double sl = sin(c.x), cl = cos(c.x), sp = sin(c.y), cp = cos(c.y);
        const double own[3][3] = {{-sl, cl, 0}, {-sp * cl, -sp * sl, cp}, {cp * cl, cp * sl, sp}};
        memcpy(axes, own, sizeof axes);
        for (int tries = 0; tries < 100000 && taken < PER_VIEW; tries++) {
            int row = (int)test_random_int(&r, 0, rows - 1), k = (int)test_random_int(&r, 0, g->n_phi - 1);
            double w = v->first + (double)row / g->m, i = floor(w), theta = ldexp(M_PI, -(int)i) * (1 - (w - i) / 2);
            double phi = 2 * M_PI * k / g->n_phi, half = sin(theta / 2), place[3], p[3];
            long double position[3] = {0}, pixel[2];
            place_around(&c, theta, phi, &place[0], &place[1]);
            place[2] = tc_rings_height(v, sin(theta) * cos(phi), sin(theta) * sin(phi), 2 * half * half, w, 0);
            to_space(proj, place, p);
            for (int n = 0; n < 3; n++)
                for (int m = 0; m < 3; m++)
                    position[n] += (long double)axes[n][m] * ((long double)p[m] - eye[m]);
            if (!rings_oracle_pixel(&c, position, pixel))
                continue;
            const float *q = clip[row * g->stride + k];
            double x = (0.5 + 0.5 * (double)q[0] / (double)q[3]) * c.width - (double)pixel[0];
            double y = (0.5 + 0.5 * (double)q[1] / (double)q[3]) * c.height - (double)pixel[1];
            worst[a] = fmax(worst[a], hypot(x, y));
            taken++;
        }
        places[a] += taken;
        free(s.view);
    }
    int all = 0;
    for (int a = 0; a < ALTITUDES; a++) {
        printf("from %g m above ground: %d places are drawn within %.2e pixels of where PROJ has them\n", altitudes[a],
               places[a], worst[a]);
        assert_true(places[a] > 300);
        assert_true(worst[a] < 0.01);
        all += places[a];
    }
    assert_true(all > 1000);
    free(clip);
    globe.gl->DeleteProgram(program);
    globe_scene_destroy(&globe);
    tc_map_destroy(atlas);
    OCTDestroyCoordinateTransformation(proj);
}

/* ---- Distances --------------------------------------------------------------------------------------------------- */

static double flat_ground(double longitude, double latitude)
{
    (void)longitude, (void)latitude;
    return 0;
}

/* Pixels of terrain in the middle row and the middle column. */
static void extent(const float *depth, const tc_camera *c, int *across, int *down)
{
    *across = *down = 0;
    for (int i = 0; i < c->width; i++)
        *across += depth[c->height / 2 * c->width + i] > 0, *down += depth[i * c->width + c->width / 2] > 0;
}

/* The ground straight below is as far away as the eye is high, from wherever. The disc is an ellipse's from above the
 * equator and a circle from above a pole, and as large as tangents say. */
static void as_far_and_as_large_as_it_is(void **state)
{
    (void)state;
    enum { SIZE = 1001 };
    const double a = semi_major, f = WGS84_FLATTENING, b = a * (1 - f), h = 1e7;
    static const double latitudes[] = {0, 90, -90, 45, -30};
    tc_map *atlas = planet_flattened(globe_atlas(flat_ground, 512, a), f);
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.n_phi = 2048, .m = 64});
    scene s = {.surface = globe.surface, .renderer = globe.renderer};
    for (int k = 0; k < 5; k++) {
        static const double altitudes[] = {10, 1e4, 1e7};
        for (int i = 0; i < 3; i++) {
            tc_camera c = {.x = 0.3,
                           .y = latitudes[k] * DEGREE,
                           .z = altitudes[i],
                           .pitch = -M_PI / 2,
                           .fov = 0.5,
                           .width = 101,
                           .height = 101};
            globe_scene_frame(&globe, &c, true);
            float *depth = planet_depth(&s, &c);
            double away = globe.surface->near_plane / (double)depth[50 * 101 + 50];
            assert_float_equal(away / altitudes[i], 1, 2e-6);
            free(depth);
        }
        double half = 1.02 * asin(a / (a + h));
        tc_camera c = {.x = 0.3,
                       .y = latitudes[k] * DEGREE,
                       .z = h,
                       .pitch = -M_PI / 2,
                       .fov = 2 * half,
                       .width = SIZE,
                       .height = SIZE};
        globe_scene_frame(&globe, &c, true);
        float *depth = planet_depth(&s, &c);
        int across, down;
        extent(depth, &c, &across, &down);
        free(depth);
        /* The cone of tangents from P: planes through the axis of view cut it at these slopes. */
        double wide = 0, high = 0;
        if (latitudes[k] == 0)
            wide = a / sqrt((a + h) * (a + h) - a * a), high = b / sqrt((a + h) * (a + h) - a * a);
        else if (fabs(latitudes[k]) == 90)
            wide = high = a / sqrt((b + h) * (b + h) - b * b);
        else
            continue;
        double pixels = SIZE / tan(half);
        printf("disc from %g m above latitude %g: %d x %d pixels, tangents say %.2f x %.2f; of a sphere %.2f\n", h,
               latitudes[k], across, down, pixels * wide, pixels * high, pixels * a / sqrt((a + h) * (a + h) - a * a));
        assert_float_equal(across, pixels * wide, 1.2);
        assert_float_equal(down, pixels * high, 1.2);
    }
    globe_scene_destroy(&globe);
    tc_map_destroy(atlas);
}

/* ---- On the globe and on a map ----------------------------------------------------------------------------------- */

static void make_hills(const char *path)
{
    enum { SIDE = 301 };
    static float z[SIDE * SIDE];
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++)
            z[j * SIDE + i] = (float)(700 + 250 * sin(i * 0.06) * cos(j * 0.05) + 60 * sin(i * 0.12 + j * 0.1));
    const double d = 0.3 / (SIDE - 1), transform[6] = {10.2 - d / 2, d, 0, 46.65 + d / 2, 0, -d};
    make_tiff(path, &(made_tiff){.width = SIDE,
                                 .height = SIDE,
                                 .bits = 32,
                                 .format = MADE_FLOAT,
                                 .samples = z,
                                 .transform = transform,
                                 .epsg = 4326});
}

/* Warped to UTM 32, as fine. */
static void warp(const char *from, const char *to)
{
    const char *const words[] = {"-t_srs", "EPSG:32632", "-r",      "cubic", "-dstnodata",
                                 "-32768", "-ot",        "Float32", "-q",    NULL};
    GDALDatasetH source = GDALOpen(from, GA_ReadOnly);
    assert_non_null(source);
    GDALWarpAppOptions *options = GDALWarpAppOptionsNew((char **)words, NULL);
    GDALDatasetH made = GDALWarp(to, NULL, 1, &source, options, NULL);
    assert_non_null(made);
    GDALWarpAppOptionsFree(options);
    GDALClose(made);
    GDALClose(source);
}

static tc_map *load(const char *path, const tc_body_class *body, const tc_globe_choice *globe)
{
    tc_map *map = NULL;
    tc_error error = {0};
    if (tc_map_load(path, NULL, &(tc_load_options){.body = body, .globe = *globe, .threads = 2}, &map, &error) != TC_OK)
        fail_msg("%s", error.text);
    return map;
}

/* The map's coordinates of a place, metres from the flat terrain's first sample, and back. */
typedef struct utm {
    OGRCoordinateTransformationH there, back;
    const tc_map *map;
} utm;

static void to_map(const utm *u, double longitude, double latitude, double *x, double *y)
{
    const double *t = u->map->georef.transform;
    double e = longitude / DEGREE, n = latitude / DEGREE;
    assert_true(OCTTransform(u->there, 1, &e, &n, NULL));
    *x = ((e - t[0]) / t[1] - 0.5) * u->map->spacing_x;
    *y = ((double)u->map->height - 0.5 - (n - t[3]) / t[5]) * u->map->spacing_y;
}

static void from_map(const utm *u, double x, double y, double *longitude, double *latitude)
{
    const double *t = u->map->georef.transform;
    double e = t[0] + (x / u->map->spacing_x + 0.5) * t[1];
    double n = t[3] + ((double)u->map->height - 0.5 - y / u->map->spacing_y) * t[5];
    assert_true(OCTTransform(u->back, 1, &e, &n, NULL));
    *longitude = e * DEGREE, *latitude = n * DEGREE;
}

static int compare_doubles(const void *a, const void *b)
{
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

/* How far apart, over the distance, the places are that a globe and the flat map show in the same pixels of the same
 * view: the median and the 99th percentile of the pixels. */
static void compare_views(const tc_map *globe, const utm *flat, double longitude, double latitude, double pitch,
                          double *median, double *most)
{
    enum { SIZE = 160 };
    const tc_body body = tc_body_flattened(semi_major, WGS84_FLATTENING); /* that distances are measured on */
    const tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1};
    tc_camera c = {.x = longitude,
                   .y = latitude,
                   .heading = 0.6,
                   .pitch = pitch,
                   .fov = 60 * DEGREE,
                   .width = SIZE,
                   .height = SIZE};
    double ground, x, y, north_x, north_y;
    assert_int_equal(tc_map_height(globe, c.x, c.y, &ground), TC_OK);
    c.z = ground + 3000;
    tc_camera on_map = c;
    to_map(flat, c.x, c.y, &x, &y);
    to_map(flat, c.x, c.y + 1e-5, &north_x, &north_y);
    on_map.x = x, on_map.y = y, on_map.heading += atan2(north_x - x, north_y - y);
    scene round = planet_scene(context, globe, &(tc_rings_options){.n_phi = 1024}, &options);
    scene plane = scene_create(context, flat->map->chart[0].field, 511, &options);
    scene_draw(&round, &c, true);
    float *a = planet_depth(&round, &c);
    scene_draw(&plane, &on_map, true);
    float *b = planet_depth(&plane, &on_map);
    double *apart = calloc(SIZE * SIZE, sizeof *apart);
    int pixels = 0;
    assert_non_null(apart);
    for (int i = 0; i < SIZE * SIZE; i++) {
        if (!(a[i] > 0 && b[i] > 0))
            continue;
        double p[3], q[3], lon, lat, meridian, parallel, u = i % SIZE + 0.5, v = i / SIZE + 0.5;
        tc_view_unproject(&c, round.surface->near_plane, &globe->body, u, v, a[i], p);
        tc_view_unproject(&on_map, plane.surface->near_plane, &flat->map->body, u, v, b[i], q);
        from_map(flat, q[0], q[1], &lon, &lat);
        body.class->curvature(&body, lat, &meridian, &parallel);
        double away = round.surface->near_plane / (double)a[i];
        apart[pixels++] = hypot((lon - p[0]) * cos(lat) * parallel, (lat - p[1]) * meridian) / away;
    }
    assert_true(pixels > SIZE * SIZE / 2);
    qsort(apart, (size_t)pixels, sizeof *apart, compare_doubles);
    *median = apart[pixels / 2], *most = apart[pixels * 99 / 100];
    free(apart), free(a), free(b);
    scene_destroy(&round), scene_destroy(&plane);
}

/* The plane knows nothing of the Earth's curvature, by which a place d away lies d^2 / 2 R deeper: 3 m at 6 km, 5e-4 of
 * it. Its scale changes by less than 3e-4 over the map. A sphere is off by more than 1e-3 from the first metre on. */
static void globe_and_map_agree(const char *path, double longitude, double latitude, double half, double nearly_all)
{
    const char *warped = made_path("utm.tif");
    char copy[512];
    snprintf(copy, sizeof copy, "%s", warped);
    warp(path, copy);
    tc_map *ellipsoid = load(path, &tc_sphere_body, &(tc_globe_choice){0});
    tc_map *sphere = load(path, &tc_sphere_body, &(tc_globe_choice){.unflattened = true});
    tc_map *flat = load(copy, &tc_plane_body, &(tc_globe_choice){0});
    assert_true(ellipsoid->body.class == &tc_ellipsoid_body && sphere->body.class == &tc_sphere_body);
    const utm u = {between(4326, 32632), between(32632, 4326), flat};
    static const double pitch[] = {-M_PI / 2, -1.2, -1.0};
    for (int k = 0; k < 3; k++) {
        double median, most, round_median, round_most;
        compare_views(ellipsoid, &u, longitude * DEGREE, latitude * DEGREE, pitch[k], &median, &most);
        compare_views(sphere, &u, longitude * DEGREE, latitude * DEGREE, pitch[k], &round_median, &round_most);
        printf("globe beside UTM map, pitch %.2f: places %.1e of the distance apart (99 %%: %.1e); with a sphere %.1e "
               "(%.1e)\n",
               pitch[k], median, most, round_median, round_most);
        assert_true(median < half);
        assert_true(most < nearly_all);
        assert_true(round_median > 2 * median);
    }
    OCTDestroyCoordinateTransformation(u.there), OCTDestroyCoordinateTransformation(u.back);
    tc_map_destroy(ellipsoid), tc_map_destroy(sphere), tc_map_destroy(flat);
}

static void a_dem_and_the_same_one_warped_agree(void **state)
{
    (void)state;
    char path[512], real[512];
    snprintf(path, sizeof path, "%s", made_path("hills.tif"));
    make_hills(path);
    globe_and_map_agree(path, 10.35, 46.5, 2e-4, 1e-3);
    const char *data = getenv("TERRACLIP_DATA");
    if (!data)
        return;
    snprintf(real, sizeof real, "%s/N46E008.tif", data);
    globe_and_map_agree(real, 8.5, 46.5, 5e-4, 3e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_where_proj_says),
        cmocka_unit_test(as_far_and_as_large_as_it_is),
        cmocka_unit_test(a_dem_and_the_same_one_warped_agree),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

/* test_body.c - globes as bodies: places and back, offsets, radii of curvature, and what is refused. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>

#include "common/base/wkt.h"
#include "common/chart/body.h"
#include "tests/support/terrains.h"

static const double wgs84 = 1 / 298.257223563;

/* A place by the textbook, in long double. */
static void position_of(const tc_body *body, const long double place[3], long double p[3])
{
    long double f = body->flattening, e2 = f * (2 - f), s = sinl(place[1]), c = cosl(place[1]);
    long double n = body->radius / sqrtl(1 - e2 * s * s);
    p[0] = (n + place[2]) * c * cosl(place[0]);
    p[1] = (n + place[2]) * c * sinl(place[0]);
    p[2] = ((1 - e2) * n + place[2]) * s;
}

/* Latitudes on and beside the poles and the equator, longitudes on and beside the antimeridian. */
static void some_place(test_random *r, double place[3])
{
    double sign = test_random_bits(r) & 1 ? 1 : -1, where = test_random_unit(r);
    place[0] = test_random_range(r, -M_PI, M_PI), place[1] = asin(test_random_range(r, -1, 1)), place[2] = 0;
    if (where < 0.1)
        place[0] = sign * M_PI;
    else if (where < 0.2)
        place[0] = sign * (M_PI - pow(10, test_random_range(r, -12, -1)));
    where = test_random_unit(r);
    if (where < 0.1)
        place[1] = sign * M_PI / 2;
    else if (where < 0.2)
        place[1] = sign * (M_PI / 2 - pow(10, test_random_range(r, -12, -1)));
    else if (where < 0.3)
        place[1] = sign * (where < 0.22 ? 0 : pow(10, test_random_range(r, -12, -1)));
}

static double turns_apart(double a, double b)
{
    return fabs(remainder(a - b, 2 * M_PI));
}

/* Of how flat a body in units of its own size: degrees of freedom that rounding leaves, and no more. */
static void places_come_back(void **state)
{
    (void)state;
    static const struct {
        double radius, flattening;
    } bodies[] = {{6378137, 1 / 298.257223563}, {6378137, 0}, {1, 0.1}, {1e8, 0.3}, {3, 1e-9}, {60268000, 0.098}};
    for (size_t b = 0; b < sizeof bodies / sizeof *bodies; b++) {
        const tc_body body = tc_body_flattened(bodies[b].radius, bodies[b].flattening);
        double least, most, angle = 0, height = 0;
        body.class->curvatures(&body, &least, &most);
        test_random r = {b + 1};
        for (int k = 0; k < 100000; k++) {
            double place[3], p[3], back[3], z = pow(10, test_random_range(&r, -6.8, 7)) * body.radius / 6378137;
            some_place(&r, place);
            place[2] = k % 3 == 0 ? -fmin(z, 0.45 * least) : k % 3 == 1 ? z : 0;
            body.class->position(&body, place, p);
            assert_true(body.class->place(&body, p, back));
            double size = body.radius + fabs(place[2]);
            if (fabs(place[1]) < M_PI / 2) /* on a pole every longitude is right */
                angle = fmax(angle, turns_apart(back[0], place[0]) * cos(place[1]));
            angle = fmax(angle, fabs(back[1] - place[1]));
            height = fmax(height, fabs(back[2] - place[2]) / size);
        }
        printf("%s of %g m, flattening %g: places come back to %.2g radians, heights to %.2g of the distance\n",
               body.class->name, body.radius, body.flattening, angle, height);
        assert_true(angle < 2e-15);
        assert_true(height < 2e-15);
    }
}

/* Also by a formula that is not its own. */
static void positions_are_the_textbooks(void **state)
{
    (void)state;
    const tc_body body = tc_body_flattened(6378137, wgs84);
    test_random r = {7};
    double worst = 0;
    for (int k = 0; k < 10000; k++) {
        double place[3], p[3];
        long double exact[3];
        some_place(&r, place);
        place[2] = test_random_range(&r, -1e4, 1e6);
        body.class->position(&body, place, p);
        position_of(&body, (long double[3]){place[0], place[1], place[2]}, exact);
        for (int i = 0; i < 3; i++)
            worst = fmax(worst, fabs((double)(p[i] - exact[i])));
    }
    assert_true(worst < 4e-9);
    /* Known ones: a pole and the equator. */
    double p[3];
    body.class->position(&body, (double[3]){0, M_PI / 2, 0}, p);
    assert_true(fabs(p[2] - 6356752.314245) < 1e-6 && hypot(p[0], p[1]) < 1e-9);
    body.class->position(&body, (double[3]){M_PI / 2, 0, 100}, p);
    assert_true(fabs(p[1] - 6378237) < 1e-8 && fabs(p[2]) < 1e-9);
}

/* Deep inside normals meet: there is no one place. On the axis and in the plane of the equator there are places as long
 * as they are near the surface, and none in the middle. */
static void no_places_deep_inside(void **state)
{
    (void)state;
    static const double flattening[] = {0, 1 / 298.257223563, 0.1, 0.4};
    for (int k = 0; k < 4; k++) {
        const tc_body body = tc_body_flattened(1000, flattening[k]);
        double place[3], b = 1000 * (1 - flattening[k]);
        assert_false(body.class->place(&body, (double[3]){0, 0, 0}, place));
        assert_false(body.class->place(&body, (double[3]){1e-9, 0, 0}, place));
        assert_false(body.class->place(&body, (double[3]){0, 0, 1e-9}, place));
        assert_false(body.class->place(&body, (double[3]){10, -5, 3}, place));
        assert_true(body.class->place(&body, (double[3]){0, 0, b - 1}, place));
        assert_true(fabs(place[1] - M_PI / 2) < 1e-12 && fabs(place[2] + 1) < 1e-9);
        assert_true(body.class->place(&body, (double[3]){0, -999, 0}, place));
        assert_true(fabs(place[1]) < 1e-12 && fabs(place[2] + 1) < 1e-9 && fabs(place[0] + M_PI / 2) < 1e-12);
    }
}

/* East, north and up are unit vectors, up is the normal; ways along them lead where they should, and back. */
static void ways_beside_a_place(void **state)
{
    (void)state;
    const tc_body body = tc_body_flattened(6378137, wgs84);
    test_random r = {3};
    for (int k = 0; k < 20000; k++) {
        double place[3], axes[3][3], p[3], q[3], back[3], way[3], to[3], n[3];
        some_place(&r, place);
        place[2] = test_random_range(&r, -1000, 1e5);
        double length = pow(10, test_random_range(&r, -3, 6.5));
        for (int i = 0; i < 3; i++)
            way[i] = test_random_range(&r, -length, length);
        body.class->axes(&body, place, axes);
        body.class->normal(&body, place, n);
        body.class->position(&body, place, p);
        body.class->beside(&body, place, way, to);
        body.class->position(&body, to, q);
        for (int i = 0; i < 3; i++) {
            back[i] = 0;
            for (int j = 0; j < 3; j++)
                back[i] += axes[i][j] * (q[j] - p[j]);
            assert_true(fabs(back[i] - way[i]) < 1e-8 + 4e-15 * length);
            assert_true(fabs(axes[2][i] - n[i]) < 1e-15);
        }
    }
}

/* Long double of its own, from differences of places. */
static void offset_by_places(const tc_body *body, const double place[3], const double to[2], long double offset[3])
{
    long double a[3], b[3];
    long double sl = sinl(place[0]), cl = cosl(place[0]), sp = sinl(place[1]), cp = cosl(place[1]);
    position_of(body, (long double[3]){place[0], place[1], place[2]}, a);
    position_of(body, (long double[3]){to[0], to[1], place[2]}, b);
    long double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    offset[0] = -sl * x + cl * y;
    offset[1] = -sp * cl * x - sp * sl * y + cp * z;
    offset[2] = cp * cl * x + cp * sl * y + sp * z;
}

/* Differences of normals by half angles, so that they are exact. */
static void normal_beside(const double place[3], const double to[2], double d[3])
{
    double dlat = to[1] - place[1], sl = sin((to[0] - place[0]) / 2), sp = sin(dlat / 2);
    d[0] = cos(to[1]) * sin(to[0] - place[0]);
    d[1] = sin(dlat) + 2 * sin(place[1]) * cos(to[1]) * sl * sl;
    d[2] = -2 * (sp * sp + cos(to[1]) * cos(place[1]) * sl * sl);
}

static void offsets_are_differences_of_places(void **state)
{
    (void)state;
    static const double flattening[] = {0, 1 / 298.257223563, 0.1};
    for (int b = 0; b < 3; b++) {
        const tc_body body = tc_body_flattened(6378137, flattening[b]);
        test_random r = {11};
        double worst = 0;
        for (int k = 0; k < 20000; k++) {
            double place[3], to[2], d[3], offset[3], away = 0, off = 0;
            long double exact[3];
            some_place(&r, place);
            place[2] = k % 2 ? 0 : test_random_range(&r, -1e3, 1e5);
            double angle = pow(10, test_random_range(&r, -7, 0.49)), heading = test_random_range(&r, 0, 2 * M_PI);
            to[1] = fmin(fmax(place[1] + angle * cos(heading), -M_PI / 2), M_PI / 2);
            to[0] = place[0] + angle * sin(heading) / fmax(cos(place[1]), 0.1);
            normal_beside(place, to, d);
            body.class->offset(&body, place, d, offset);
            offset_by_places(&body, place, to, exact);
            for (int i = 0; i < 3; i++)
                away += (double)(exact[i] * exact[i]), off += pow((double)(offset[i] - exact[i]), 2);
            worst = fmax(worst, sqrt(off) / (sqrt(away) + 1e-3)); /* long double has rounded at a micrometre */
        }
        printf("flattening %g: offsets off by at most %.2g of the distance\n", flattening[b], worst);
        assert_true(worst < 1e-9);
    }
}

/* Against differences of positions; and within the least and the most anywhere. */
static void curvatures_are_metres_a_radian(void **state)
{
    (void)state;
    static const double flattening[] = {0, 1 / 298.257223563, 0.1, 0.5};
    const double step = 1e-6;
    for (int b = 0; b < 4; b++) {
        const tc_body body = tc_body_flattened(6378137, flattening[b]);
        double least, most, lo = INFINITY, hi = 0;
        body.class->curvatures(&body, &least, &most);
        for (int k = 0; k <= 900; k++) {
            double latitude = k * M_PI / 1800, meridian, parallel;
            long double p[3], q[3];
            body.class->curvature(&body, latitude, &meridian, &parallel);
            position_of(&body, (long double[3]){0, latitude - step, 0}, p);
            position_of(&body, (long double[3]){0, latitude + step, 0}, q);
            double along = (double)(hypotl(q[0] - p[0], q[2] - p[2]) / (2 * step));
            assert_true(fabs(along / meridian - 1) < 1e-9);
            if (k < 900) {
                position_of(&body, (long double[3]){-step, latitude, 0}, p);
                position_of(&body, (long double[3]){step, latitude, 0}, q);
                double across = (double)(hypotl(q[0] - p[0], q[1] - p[1]) / (2 * sin(step))) / cos(latitude);
                assert_true(fabs(across / parallel - 1) < 1e-9);
            }
            lo = fmin(lo, fmin(meridian, parallel)), hi = fmax(hi, fmax(meridian, parallel));
        }
        assert_true(fabs(lo / least - 1) < 1e-12 && fabs(hi / most - 1) < 1e-12);
    }
}

static void relief_that_leaves_no_surface(void **state)
{
    (void)state;
    const tc_body body = tc_body_flattened(1000, 0.5);
    tc_error error;
    assert_int_equal(body.class->check_relief(&body, "x", -200, 900, &error), TC_OK);
    assert_int_equal(body.class->check_relief(&body, "x", -260, 0, &error), TC_ERR_FORMAT);
    assert_int_equal(body.class->check_relief(&body, "x", 0, 1000, &error), TC_ERR_FORMAT);
    assert_int_equal(body.class->check_relief(&body, "x", NAN, 0, &error), TC_ERR_FORMAT);
}

static void bodies_by_numbers(void **state)
{
    (void)state;
    assert_ptr_equal(tc_body_flattened(0, 0.1).class, &tc_plane_body);
    assert_ptr_equal(tc_body_flattened(5, 0).class, &tc_sphere_body);
    assert_ptr_equal(tc_body_flattened(5, 0.1).class, &tc_ellipsoid_body);
    assert_true(tc_body_is(&tc_ellipsoid_body, &tc_sphere_body) && !tc_body_is(&tc_sphere_body, &tc_ellipsoid_body));
    assert_true(tc_body_is(&tc_plane_body, &tc_plane_body) && !tc_body_is(&tc_plane_body, &tc_sphere_body));
}

/* Names may say anything; words are those of WKT 1 and 2, brackets of both kinds. */
static void coordinate_systems_tell_their_ellipsoid(void **state)
{
    (void)state;
    static const struct {
        const char *wkt;
        double inverse;
    } systems[] = {
        {"GEOGCRS[\"WGS 84\",DATUM[\"World\",ELLIPSOID[\"WGS 84\",6378137,298.257223563,LENGTHUNIT[\"metre\",1]]]]",
         298.257223563},
        {"GEOGCS[\"ELLIPSOID[\"\"x\"\",1,2]\",DATUM[\"d\",SPHEROID[\"Clarke \"\"1866\"\"\", 6378206.4,\n "
         "294.978698213898]]]",
         294.978698213898},
        {"GEOGCS(\"m\",DATUM(\"d\",SPHEROID ( \"Moon\" , 1737400 , 0 )))", 0},
        {"LOCAL_CS[\"terrain\",UNIT[\"metre\",1]]", 0},
        {"ELLIPSOID[\"a\",6378137]", 0},
        {"ELLIPSOID[\"a\",6378137,x]", 0},
        {"ELLIPSOID[\"a\",6378137,-3]", 0},
        {"ELLIPSOID[\"a", 0},
        {"ELLIPSOID[", 0},
        {"ELLIPSOID", 0},
        {"", 0},
    };
    for (size_t k = 0; k < sizeof systems / sizeof *systems; k++)
        assert_true(tc_wkt_inverse_flattening(systems[k].wkt) == systems[k].inverse);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_come_back),
        cmocka_unit_test(positions_are_the_textbooks),
        cmocka_unit_test(no_places_deep_inside),
        cmocka_unit_test(ways_beside_a_place),
        cmocka_unit_test(offsets_are_differences_of_places),
        cmocka_unit_test(curvatures_are_metres_a_radian),
        cmocka_unit_test(relief_that_leaves_no_surface),
        cmocka_unit_test(bodies_by_numbers),
        cmocka_unit_test(coordinate_systems_tell_their_ellipsoid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

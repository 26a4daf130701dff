/* test_faces.c - charts of an octahedron and of a cube: there and back, what seams say, which way they turn, who
 * answers. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/hash.h"
#include "common/map/map.h"

typedef struct kind {
    const tc_chart_class *class;
    int faces;
} kind;
static const kind kinds[] = {{&tc_chart_hex, 4}, {&tc_chart_cube, 6}};
enum { KINDS = 2, CELLS = 24 };

static tc_chart face_of(const tc_chart_class *class, int face)
{
    tc_chart c = {.class = class, .face = face, .dx = 1.0 / CELLS, .dy = 1.0 / CELLS};
    for (int side = 0; side < TC_SIDES; side++)
        c.side[side] = class->seam(face, side, CELLS);
    return c;
}

static void direction(const tc_chart *c, double x, double y, double n[3])
{
    double lon, lat;
    c->class->to_place(c, x, y, &lon, &lat);
    n[0] = cos(lat) * cos(lon), n[1] = cos(lat) * sin(lon), n[2] = sin(lat);
}

static double apart(const double a[3], const double b[3])
{
    return fmax(fmax(fabs(a[0] - b[0]), fabs(a[1] - b[1])), fabs(a[2] - b[2]));
}

static double uniform(int n)
{
    return (double)(tc_hash64(11, (uint64_t)n) >> 11) / 9007199254740992.0;
}

static void there_and_back(void **state)
{
    (void)state;
    for (int t = 0; t < KINDS; t++)
        for (int face = 0; face < kinds[t].faces; face++) {
            const tc_chart c = face_of(kinds[t].class, face);
            for (int n = 0; n < 20000; n++) { /* a twentieth of it beyond the sides */
                double x = 1.1 * uniform(2 * n) - 0.05, y = 1.1 * uniform(2 * n + 1) - 0.05, lon, lat, u, v;
                if (n % 8 == 0) /* next to corners */
                    x = (n & 8 ? 1 : 0) + (x - 0.5) * 1e-6, y = (n & 16 ? 1 : 0) + (y - 0.5) * 1e-6;
                if (c.class == &tc_chart_hex && (x < 0 || y < 0 || x > 1 || y > 1)) {
                    /* Near a pole what is beyond a side is turns away, or on its other side: there is no way back. */
                    double rows = x + y <= 1 ? x + y : 2 - x - y;
                    if (rows < 0.2)
                        continue;
                }
                double n3[3], toward[3];
                direction(&c, x, y, n3);
                c.class->normal(&c, x, y, toward);
                assert_true(apart(n3, toward) < 1e-15);
                c.class->to_place(&c, x, y, &lon, &lat);
                c.class->from_place(&c, lon, lat, &u, &v);
                assert_true(fabs(u - x) < 4e-15 && fabs(v - y) < 4e-15);
            }
        }
}

/* Corners and middles are where they are said to be. */
static void faces_lie_where_they_should(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        const tc_chart hex = face_of(&tc_chart_hex, k), cube = face_of(&tc_chart_cube, k);
        double n[3], from = M_PI / 2 * k, to = from + M_PI / 2;
        const double north[] = {0, 0, 1}, south[] = {0, 0, -1}, first[] = {cos(from), sin(from), 0},
                     last[] = {cos(to), sin(to), 0};
        direction(&hex, 0, 0, n);
        assert_true(apart(n, north) < 1e-15);
        direction(&hex, 1, 1, n);
        assert_true(apart(n, south) < 1e-15);
        direction(&hex, 1, 0, n);
        assert_true(apart(n, first) < 1e-15);
        direction(&hex, 0, 1, n);
        assert_true(apart(n, last) < 1e-15);
        direction(&cube, 0.5, 0.5, n);
        assert_true(apart(n, first) < 1e-15);
        direction(&cube, 1, 0.5, n);
        assert_true(n[0] * last[0] + n[1] * last[1] > 0.7 && fabs(n[2]) < 1e-15); /* x to the east */
    }
    const tc_chart up = face_of(&tc_chart_cube, 4), down = face_of(&tc_chart_cube, 5);
    double n[3];
    direction(&up, 0.5, 0.5, n);
    assert_true(apart(n, (double[]){0, 0, 1}) < 1e-15);
    direction(&down, 0.5, 0.5, n);
    assert_true(apart(n, (double[]){0, 0, -1}) < 1e-15);
}

/* Past the pole of a sheared chart the meridian goes on on its other side. */
static void poles_are_passed(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        const tc_chart c = face_of(&tc_chart_hex, k);
        double a[3], b[3];
        for (int n = 1; n < 20; n++) {
            double s = n % 2 ? -0.01 * n : 0, out = 0.01 * n;
            direction(&c, s == 0 ? -out : s, s == 0 ? -out / 2 : s, a);
            direction(&c, s == 0 ? out : -s, s == 0 ? out / 2 : -s, b);
            assert_true(fabs(a[0] + b[0]) < 1e-15 && fabs(a[1] + b[1]) < 1e-15 && fabs(a[2] - b[2]) < 1e-15);
        }
    }
}

static int64_t moved(const tc_seam *s, int row, int64_t i, int64_t j)
{
    return s->m[2 * row] * i + s->m[2 * row + 1] * j + (row ? s->dy : s->dx);
}

static void seams_join(void **state)
{
    (void)state;
    for (int t = 0; t < KINDS; t++)
        for (int face = 0; face < kinds[t].faces; face++) {
            const tc_chart c = face_of(kinds[t].class, face);
            for (int side = 0; side < TC_SIDES; side++) {
                const tc_seam *s = &c.side[side];
                assert_true(s->chart >= 0 && s->chart < kinds[t].faces && s->chart != face);
                assert_int_equal(s->m[0] * s->m[3] - s->m[1] * s->m[2], 1);
                const tc_chart other = face_of(kinds[t].class, s->chart);
                int64_t at = side == TC_EAST || side == TC_NORTH ? CELLS : 0, in = at ? -1 : 1;
                bool along_x = side == TC_WEST || side == TC_EAST;
                for (int64_t along = 0; along <= CELLS; along++) {
                    int64_t i = along_x ? at : along, j = along_x ? along : at, u = moved(s, 0, i, j),
                            v = moved(s, 1, i, j);
                    double a[3], b[3];
                    direction(&c, (double)i / CELLS, (double)j / CELLS, a);
                    direction(&other, (double)u / CELLS, (double)v / CELLS, b);
                    assert_true(apart(a, b) < 1e-15);
                    /* One of the neighbour's seams leads back, and a step beyond is a step inwards there. */
                    bool back = false;
                    for (int k = 0; k < TC_SIDES; k++)
                        back |= other.side[k].chart == face && moved(&other.side[k], 0, u, v) == i &&
                                moved(&other.side[k], 1, u, v) == j;
                    assert_true(back);
                    i -= along_x ? in : 0, j -= along_x ? 0 : in;
                    int64_t p = moved(s, 0, i, j), q = moved(s, 1, i, j);
                    bool corner = along < 2 || along > CELLS - 2;
                    assert_true(corner || (p >= 0 && p <= CELLS && q >= 0 && q <= CELLS));
                    if (c.class == &tc_chart_hex && !corner) { /* and the chart's own formulas are there as well */
                        direction(&c, (double)i / CELLS, (double)j / CELLS, a);
                        direction(&other, (double)p / CELLS, (double)q / CELLS, b);
                        assert_true(apart(a, b) < 1e-14);
                    }
                }
            }
        }
}

/* Lengths and areas are those of small steps. */
static void they_spread(void **state)
{
    (void)state;
    for (int t = 0; t < KINDS; t++)
        for (int face = 0; face < kinds[t].faces; face++) {
            const tc_chart c = face_of(kinds[t].class, face);
            for (int n = 0; n < 200; n++) {
                double x = 0.02 + 0.96 * uniform(2 * n), y = 0.02 + 0.96 * uniform(2 * n + 1), e = 1e-6;
                double a[3], b[3], p[3], q[3], along[2], area;
                direction(&c, x - e, y, a), direction(&c, x + e, y, b);
                direction(&c, x, y - e, p), direction(&c, x, y + e, q);
                if (c.class == &tc_chart_hex && fabs(x + y - 1) < 1e-4)
                    continue; /* where rows turn */
                for (int i = 0; i < 3; i++)
                    b[i] = (b[i] - a[i]) / (2 * e), q[i] = (q[i] - p[i]) / (2 * e);
                double cross[3] = {b[1] * q[2] - b[2] * q[1], b[2] * q[0] - b[0] * q[2], b[0] * q[1] - b[1] * q[0]};
                c.class->spread(&c, x, y, &along[0], &along[1], &area);
                assert_true(fabs(sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]) / along[0] - 1) < 1e-6);
                assert_true(fabs(sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) / along[1] - 1) < 1e-6);
                assert_true(fabs(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / area - 1) <
                            1e-6);
            }
        }
}

/* x, y and outwards are right-handed everywhere. */
static void they_turn_left(void **state)
{
    (void)state;
    for (int t = 0; t < KINDS; t++)
        for (int face = 0; face < kinds[t].faces; face++) {
            const tc_chart c = face_of(kinds[t].class, face);
            for (int n = 0; n < 500; n++) {
                double x = 0.02 + 0.96 * uniform(2 * n), y = 0.02 + 0.96 * uniform(2 * n + 1), p[3], a[3], b[3];
                direction(&c, x, y, p), direction(&c, x + 1e-5, y, a), direction(&c, x, y + 1e-5, b);
                for (int i = 0; i < 3; i++)
                    a[i] -= p[i], b[i] -= p[i];
                double turn = p[0] * (a[1] * b[2] - a[2] * b[1]) + p[1] * (a[2] * b[0] - a[0] * b[2]) +
                              p[2] * (a[0] * b[1] - a[1] * b[0]);
                assert_true(turn > 1e-10);
            }
        }
}

static void one_answers(void **state)
{
    (void)state;
    for (int t = 0; t < KINDS; t++)
        for (int n = 0; n < 3000; n++) {
            double p[3];
            for (int i = 0; i < 3; i++)
                p[i] = n < 27 ? (n / (i == 0 ? 1 : i == 1 ? 3 : 9)) % 3 - 1 : 2 * uniform(3 * n + i) - 1;
            double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), sum = 0;
            if (r == 0)
                continue;
            for (int face = 0, first = -1; face < kinds[t].faces; face++) {
                const tc_chart c = face_of(kinds[t].class, face);
                double x, y, share = c.class->share(&c, p);
                c.class->from_place(&c, atan2(p[1], p[0]), atan2(p[2], hypot(p[0], p[1])), &x, &y);
                bool inside = x >= -1e-12 && x <= 1 + 1e-12 && y >= -1e-12 && y <= 1 + 1e-12;
                assert_true(share == 0 || share == 1);
                assert_true(share == 0 || inside);
                if (inside && first < 0) /* of those that have the place the first */
                    first = face, assert_true(share == 1);
                sum += share;
            }
            assert_true(sum == 1);
        }
}

static void cells_halve(void **state)
{
    (void)state;
    for (int64_t least = 1; least < 5000; least += 7) {
        int64_t cells = tc_chart_cells(least), q = cells;
        while (q % 2 == 0 && q > TC_MOST_CELLS)
            q /= 2;
        assert_true(cells >= least && cells % 2 == 0 && q <= TC_MOST_CELLS);
        assert_true((double)cells <= fmax((double)least + 1, (double)least * (1 + 1.0 / 15)));
    }
    assert_int_equal(tc_chart_cells(1024), 1024);
    assert_int_equal(tc_chart_cells(5400), 5632);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(there_and_back),   cmocka_unit_test(faces_lie_where_they_should),
        cmocka_unit_test(poles_are_passed), cmocka_unit_test(seams_join),
        cmocka_unit_test(they_spread),      cmocka_unit_test(they_turn_left),
        cmocka_unit_test(one_answers),      cmocka_unit_test(cells_halve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

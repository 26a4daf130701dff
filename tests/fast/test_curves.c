/* test_curves.c - a codec's bits at an error that none of its points has. */
#include "tests/support/test.h"

#include <math.h>

#include "tests/support/curves.h"

/* bits = 3 / rms^0.7, which is straight in logarithms. */
static curve_point law(double rms)
{
    return (curve_point){3 * pow(rms, -0.7), rms};
}

static void straight_curves_are_met(void **state)
{
    (void)state;
    const curve_point points[] = {law(8), law(0.5), law(2), law(1), law(32)}; /* in no order */
    for (double rms = 0.5; rms <= 32; rms *= 1.17)
        assert_float_equal(curve_bits(points, 5, rms), law(rms).bits, 1e-12);
    assert_float_equal(curve_bits(points, 5, 32), law(32).bits, 0);
    assert_float_equal(curve_between(points[0], points[1], 3), law(3).bits, 1e-12);
}

static void nothing_is_known_beyond_the_points(void **state)
{
    (void)state;
    const curve_point points[] = {law(1), law(4)};
    assert_true(isnan(curve_bits(points, 2, 0.999)) && isnan(curve_bits(points, 2, 4.001)));
    assert_true(isnan(curve_bits(points, 1, 2)) && isnan(curve_bits(points, 0, 2)));
}

/* Of a bent curve: the two points around, not the first and the last. */
static void the_nearest_points_count(void **state)
{
    (void)state;
    const curve_point points[] = {{8, 1}, {4, 2}, {3.9, 16}, {1, 4}};
    assert_float_equal(curve_bits(points, 4, 2 * sqrt(2)), 2, 1e-12);
    assert_float_equal(curve_bits(points, 4, sqrt(2)), sqrt(32), 1e-12);
}

static void no_error_has_no_logarithm(void **state)
{
    (void)state;
    const curve_point points[] = {{9, 0}, law(1), law(4)};
    assert_true(isnan(curve_bits(points, 3, 0.5)));
    assert_float_equal(curve_bits(points, 3, 2), law(2).bits, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_curves_are_met),
        cmocka_unit_test(nothing_is_known_beyond_the_points),
        cmocka_unit_test(the_nearest_points_count),
        cmocka_unit_test(no_error_has_no_logarithm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

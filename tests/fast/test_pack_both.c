/* test_pack_both.c - an rms and a bound of every height's error kept at once: whichever of the two has more to say, at
 * the bytes of that one where the other has nothing to. That such files come back like all others: test_pack.c. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/made_files.h"
#include "tests/support/packing.h"

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

typedef struct outcome {
    double rms, most; /* of what was read back */
    int64_t bytes;
} outcome;

static outcome pack(const packing *p)
{
    const char *path = made_path("a.tclip");
    tc_pack_result result;
    tc_error error = {TC_OK, ""};
    tc_field *file;
    uint8_t *voids;
    outcome o = {0};
    if (packing_write(p, path, &result, &error) || tc_field_open(path, NULL, &file, &error))
        fail_msg("rms %g, at most %g: %s", p->error, p->max_error, error.text);
    float *given = packing_heights(p, &voids), *z = packing_read(file, tc_field_info(file)->levels, NULL);
    assert_non_null(z);
    packing_error(z, given, voids, p->width * p->height, &o.rms, &o.most);
    o.bytes = result.bytes;
    assert_true(result.rms >= o.rms * (1 - 1e-6) && result.max_error >= o.most * (1 - 1e-6));
    free(given), free(z), free(voids);
    tc_field_destroy(file);
    return o;
}

static const packing spikes = {.width = 400, .height = 300, .kind = PACKING_SPIKES, .type = TC_SAMPLE_FLOAT32};

/* What the rms alone lets go is caught, at the same rms and not many more bytes. */
static void spikes_are_kept(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        packing p = spikes;
        p.voids = k % 2 ? PACKING_LAKES : PACKING_WHOLE;
        p.kind = k < 2 ? PACKING_SPIKES : PACKING_NEEDLE;
        p.error = k < 2 ? 3 : 1;
        const outcome alone = pack(&p);
        p.max_error = 4 * p.error;
        const outcome both = pack(&p);
        assert_true(alone.most > p.max_error && both.most <= p.max_error);
        assert_true(alone.rms <= p.error && both.rms <= p.error);
        if (k < 2) /* a needle is all the error that there is */
            assert_true(both.rms >= 0.97 * p.error && (double)both.bytes < 1.2 * (double)alone.bytes);
    }
}

/* From bounds that leave the rms nothing to say to those that say nothing themselves. */
static void every_ratio_is_kept(void **state)
{
    (void)state;
    static const double ratios[] = {0.05, 0.3, 0.9, 1, 1.3, 1.69, 1.71, 2, 3, 8, 1e3, 1e7};
    static const packing_kind kinds[] = {PACKING_SPIKES, PACKING_INTEGERS, PACKING_SLOPE, PACKING_NOISE};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (size_t n = 0; n < sizeof ratios / sizeof *ratios; n++)
            for (int fine = 0; fine < 2; fine++) {
                packing p = {.width = 190, .height = 140, .kind = kinds[k], .error = fine ? 0.25 : 4};
                p.type = kinds[k] == PACKING_INTEGERS ? TC_SAMPLE_INT16 : TC_SAMPLE_FLOAT32;
                p.voids = n % 2 ? PACKING_LAKES : PACKING_WHOLE;
                p.max_error = ratios[n] * p.error;
                const outcome o = pack(&p);
                if (!(o.rms <= p.error * (1 + 1e-6) && o.most <= p.max_error * (1 + 1e-6)))
                    fail_msg("kind %d, rms %g of %g, at most %g of %g", (int)p.kind, o.rms, p.error, o.most,
                             p.max_error);
            }
}

/* Where one of them decides alone, the other costs nothing to speak of. */
static void the_other_costs_nothing(void **state)
{
    (void)state;
    packing tight = spikes, loose = spikes;
    tight.error = 5, tight.max_error = 3, loose.error = 3, loose.max_error = 1000;
    const outcome bounded = pack(&tight), free_of_it = pack(&loose);
    tight.mode = TC_PACK_MAX_ERROR, tight.error = tight.max_error, tight.max_error = 0;
    loose.max_error = 0;
    const outcome bound = pack(&tight), rms = pack(&loose);
    assert_true(bounded.bytes == bound.bytes && bounded.most == bound.most);
    assert_true((double)free_of_it.bytes < 1.01 * (double)rms.bytes && free_of_it.most == rms.most);
}

/* What lossless is told to take is about what it takes, whatever type the heights come in; of heights on no lattice
 * nothing is told. */
static void lossless_is_told(void **state)
{
    (void)state;
    const char *path = made_path("a.tclip");
    for (int k = 0; k < 4; k++) {
        bool lattice = k != 2;
        packing p = {.width = 700, .height = 500, .kind = lattice ? PACKING_INTEGERS : PACKING_SPIKES, .error = 2};
        p.type = k < 2 ? TC_SAMPLE_INT16 : TC_SAMPLE_FLOAT32;
        p.voids = k == 1 ? PACKING_LAKES : PACKING_WHOLE;
        p.price_lossless = true;
        tc_pack_result told, result;
        tc_error error;
        assert_int_equal(packing_write(&p, path, &told, &error), TC_OK);
        assert_true((told.lossless_bytes > 0) == lattice);
        p.mode = TC_PACK_LOSSLESS;
        if (lattice && packing_write(&p, path, &result, &error))
            fail_msg("%s", error.text);
        if (lattice && fabs((double)told.lossless_bytes / (double)result.bytes - 1) > 0.1)
            fail_msg("told about %lld bytes, found %lld", (long long)told.lossless_bytes, (long long)result.bytes);
    }
}

/* Floats a million metres up are 0.06 m apart: a bound that they cannot hold is refused, or dropped where it may. */
static void bound_that_may_yield_is_dropped(void **state)
{
    (void)state;
    packing p = {
        .width = 190, .height = 140, .kind = PACKING_DUST, .type = TC_SAMPLE_FLOAT32, .error = 0.01, .offset = 1e6};
    p.max_error = 4 * p.error;
    tc_pack_result result;
    tc_error error;
    assert_int_equal(packing_write(&p, made_path("a.tclip"), &result, &error), TC_ERR_UNSUPPORTED);
    p.max_error_may_yield = true;
    if (packing_write(&p, made_path("a.tclip"), &result, &error))
        fail_msg("%s", error.text);
    assert_true(result.rms <= p.error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spikes_are_kept),
        cmocka_unit_test(every_ratio_is_kept),
        cmocka_unit_test(the_other_costs_nothing),
        cmocka_unit_test(lossless_is_told),
        cmocka_unit_test(bound_that_may_yield_is_dropped),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}

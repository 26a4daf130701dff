/* test_lifting.c - the integer transform: invertible for any input, by any rectangle, however it is cut. */
#include "tests/support/test.h"

#include "common/codec/lifting/lifting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "tests/support/terrains.h"

/* A level and its bands, whole. With a wrapping level the bands' planes hold `margin` more columns on either side. */
typedef struct whole {
    tc_lifting_level level;
    int64_t cw, ch, margin;
    tc_plane fine, ll, band[TC_BANDS];
} whole;

static tc_plane new_plane(tc_rect rect)
{
    tc_plane p = {calloc((size_t)tc_rect_area(rect) + 1, sizeof *p.z), rect.x1 - rect.x0, rect};
    assert_non_null(p.z);
    return p;
}

static whole whole_new(tc_lifting_level level)
{
    whole w = {.level = level, .cw = tc_coarse_size(level.width), .ch = tc_coarse_size(level.height)};
    w.margin = level.wrap_x ? 2 * TC_LIFTING_REACH : 0;
    w.fine = new_plane((tc_rect){0, 0, level.width, level.height});
    w.ll = new_plane((tc_rect){-w.margin, 0, w.cw + w.margin, w.ch});
    for (int b = 0; b < TC_BANDS; b++)
        w.band[b] = new_plane((tc_rect){-w.margin, 0, w.cw + w.margin, w.ch});
    return w;
}

static void whole_free(whole *w)
{
    free(w->fine.z), free(w->ll.z);
    for (int b = 0; b < TC_BANDS; b++)
        free(w->band[b].z);
}

static void wrap_plane(const whole *w, const tc_plane *p)
{
    for (int64_t j = 0; j < w->ch; j++)
        for (int64_t i = -w->margin; i < w->cw + w->margin; i++)
            *tc_plane_at(p, i, j) = *tc_plane_at(p, ((i % w->cw) + w->cw) % w->cw, j);
}

/* Analyses in bands of `rows` rows. */
static void analyse(whole *w, int64_t rows)
{
    int32_t *scratch = malloc(tc_lifting_analyse_scratch(&w->level, rows) * sizeof *scratch);
    assert_non_null(scratch);
    for (int64_t j = 0; j < w->ch; j += rows)
        tc_lifting_analyse(&w->level, &w->fine, j, tc_min64(j + rows, w->ch), &w->ll, w->band, scratch);
    free(scratch);
    wrap_plane(w, &w->ll);
    for (int b = 0; b < TC_BANDS; b++)
        wrap_plane(w, &w->band[b]);
}

static tc_plane synthesise(const whole *w, tc_rect rect)
{
    tc_plane p = new_plane(rect);
    int32_t *scratch = malloc(tc_lifting_synthesise_scratch(&w->level, rect) * sizeof *scratch);
    assert_non_null(scratch);
    tc_lifting_synthesise(&w->level, &w->ll, w->band, &p, scratch, rect.x0 % 2 ? TC_SIMD_NONE : TC_SIMD_AUTO);
    free(scratch);
    return p;
}

static void every_level_comes_back(void **state)
{
    (void)state;
    test_random r = {3};
    for (int k = 0; k < 400; k++) {
        tc_lifting_level level = {test_random_int(&r, 1, k % 4 ? 20 : 150), test_random_int(&r, 1, k % 4 ? 20 : 150),
                                  k % 3 == 0};
        level.width += level.wrap_x && level.width % 2;
        whole w = whole_new(level);
        for (int64_t i = 0; i < level.width * level.height; i++)
            switch (k % 5) {
            case 0: w.fine.z[i] = (int32_t)(uint32_t)test_random_bits(&r); break; /* wraps everywhere */
            case 1: w.fine.z[i] = test_random_bits(&r) & 1 ? INT32_MAX : INT32_MIN; break;
            case 2: w.fine.z[i] = (int32_t)test_random_int(&r, -TC_LIFTING_LIMIT, TC_LIFTING_LIMIT); break;
            case 3: w.fine.z[i] = (int32_t)(i % level.width * 1000); break;
            default: w.fine.z[i] = 77; break;
            }
        analyse(&w, test_random_int(&r, 1, w.ch));
        tc_plane back = synthesise(&w, w.fine.rect);
        assert_memory_equal(back.z, w.fine.z, (size_t)(level.width * level.height) * sizeof *back.z);
        free(back.z);
        for (int n = 0; n < 10; n++) {
            tc_rect q = {test_random_int(&r, 0, level.width - 1), test_random_int(&r, 0, level.height - 1), 0, 0};
            q.x1 = test_random_int(&r, q.x0 + 1, level.width), q.y1 = test_random_int(&r, q.y0 + 1, level.height);
            tc_plane part = synthesise(&w, q);
            for (int64_t y = q.y0; y < q.y1; y++)
                assert_memory_equal(tc_plane_at(&part, q.x0, y), tc_plane_at(&w.fine, q.x0, y),
                                    (size_t)(q.x1 - q.x0) * sizeof *part.z);
            free(part.z);
        }
        /* Constants have no details, neither have ramps where nothing wraps. */
        if (k % 5 == 4 || (k % 5 == 3 && !level.wrap_x))
            for (int b = 0; b < TC_BANDS; b++)
                for (int64_t i = 0; i < w.cw * w.ch; i++)
                    assert_int_equal(w.band[b].z[i], 0);
        whole_free(&w);
    }
}

static void within_the_limit_nothing_wraps(void **state)
{
    (void)state;
    /* The worst input for a detail, then for the low band, alternates between the limits. */
    whole w = whole_new((tc_lifting_level){64, 64, false});
    for (int64_t i = 0; i < 64 * 64; i++)
        w.fine.z[i] = (i + i / 64) % 2 ? TC_LIFTING_LIMIT : -TC_LIFTING_LIMIT;
    analyse(&w, 64);
    for (int64_t j = 8; j < 24; j++)
        for (int64_t i = 8; i < 24; i++) {
            assert_int_equal(*tc_plane_at(&w.ll, i, j), 0);
            assert_int_equal(*tc_plane_at(&w.band[TC_HL], i, j), 0);
            assert_int_equal(*tc_plane_at(&w.band[TC_LH], i, j), 0);
            assert_int_equal(*tc_plane_at(&w.band[TC_HH], i, j), -4 * TC_LIFTING_LIMIT);
        }
    whole_free(&w);
}

static void norms_are_those_of_the_synthesis(void **state)
{
    (void)state;
    enum { AMPLITUDE = 1 << 20, DEPTHS = 5, COARSE = 24 };
    for (int band = 0; band < TC_BANDS; band++)
        for (int depth = 0; depth < DEPTHS; depth++) {
            tc_plane z = {0};
            int64_t size = COARSE;
            for (int d = depth; d >= 0; d--) {
                size *= 2;
                whole w = whole_new((tc_lifting_level){size, size, false});
                if (d == depth)
                    *tc_plane_at(&w.band[band], COARSE / 2, COARSE / 2) = AMPLITUDE;
                else
                    memcpy(w.ll.z, z.z, (size_t)(w.cw * w.ch) * sizeof *z.z);
                free(z.z);
                z = synthesise(&w, w.fine.rect);
                whole_free(&w);
            }
            double sum = 0;
            for (int64_t i = 0; i < size * size; i++)
                sum += (double)z.z[i] * z.z[i];
            free(z.z);
            double norm = sqrt(sum) / AMPLITUDE;
            if (fabs(tc_lifting_norm(band, depth) / norm - 1) > 0.005)
                fail_msg("band %d depth %d: norm %.6f, table %.6f", band, depth, norm, tc_lifting_norm(band, depth));
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_level_comes_back),
                                       cmocka_unit_test(within_the_limit_nothing_wraps),
                                       cmocka_unit_test(norms_are_those_of_the_synthesis)};
    return cmocka_run_group_tests_name("lifting", tests, NULL, NULL);
}

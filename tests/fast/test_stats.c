/* test_stats.c - the figures of frames and the JSON that they become. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/app/stats.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void quantiles_of_all_frames(void **state)
{
    (void)state;
    tc_stats *stats;
    assert_int_equal(tc_stats_create(100, &stats, NULL), TC_OK);
    tc_stats_summary s;
    tc_stats_summarise(stats, &s);
    assert_true(s.frames == 0 && s.frame_median == 0 && s.frame_max == 0);
    tc_stats_load(stats, &(tc_frame_stats){.samples_updated = 1000, .bytes_uploaded = 8000});
    for (int i = 1; i <= 100; i++) /* in a shuffled order */
        tc_stats_frame(stats, 37 * i % 101,
                       &(tc_frame_stats){.update_ms = 1,
                                         .draw_ms = 2,
                                         .triangles = 1000 + 37 * i % 101,
                                         .draws = 10,
                                         .throttle = 0.01 * i,
                                         .levels_active = 5,
                                         .samples_updated = 1,
                                         .bytes_uploaded = 8});
    tc_stats_summarise(stats, &s);
    assert_true(s.frames == 100 && s.frame_median == 50 && s.frame_p95 == 95 && s.frame_max == 100);
    assert_true(s.update_ms == 1 && s.draw_ms == 2 && s.triangles == 1050 && s.draws == 10 && s.levels_active == 5);
    assert_true(s.throttle_median == 0.5 && s.throttle_max == 1);
    assert_true(s.samples_updated == 1100 && s.bytes_uploaded == 8800);
    /* Older times are forgotten, counts and the maximum are not. */
    for (int i = 0; i < 100; i++)
        tc_stats_frame(stats, 3, &(tc_frame_stats){.samples_updated = 1});
    tc_stats_summarise(stats, &s);
    assert_true(s.frames == 200 && s.frame_median == 3 && s.frame_p95 == 3 && s.frame_max == 100);
    assert_true(s.samples_updated == 1200);
    tc_stats_destroy(stats);
    tc_stats_destroy(NULL);
}

static const char *const left_out[] = {"normal map: \"unlit\"", "back\\slash\tand tab", NULL};
static const tc_stats_summary summary = {.frames = 2,
                                         .frame_median = 1.5,
                                         .triangles = 1234567890123,
                                         .throttle_median = 0.25,
                                         .throttle_max = 1.5,
                                         .tolerance = 2,
                                         .error_bound = 1.75,
                                         .blocks = {1, 0, 12},
                                         .levels = 3};
static const tc_stats_context context = {
    .renderer = "llvmpipe",
    .backend = "osmesa",
    .sun = {.kind = TC_SUN_LOCAL, .azimuth = M_PI / 2, .elevation = -M_PI / 18},
    .sea = {.kind = TC_SEA_GIVEN, .level = -12.5},
    .exaggeration = 1.5,
    .memory = {.geometry = 1, .heights = 2, .normals = 3, .imagery = 4, .field = 5},
    .left_out = left_out};

static void json_has_the_keys(void **state)
{
    (void)state;
    char text[4096];
    FILE *file = fmemopen(text, sizeof text, "w");
    assert_non_null(file);
    tc_stats_print(&summary, &context, file);
    fclose(file);
    static const char *const parts[] = {"\"frames\": 2,",
                                        "\"frame_ms\": {\"median\": 1.500, \"p95\": 0.000, \"max\": 0.000}",
                                        "\"update_ms\": 0.000",
                                        "\"draw_ms\": 0.000",
                                        "\"triangles\": 1234567890123",
                                        "\"draws\": 0",
                                        "\"levels_active\": 0",
                                        "\"samples_updated\": 0",
                                        "\"bytes_uploaded\": 0",
                                        "\"bytes_decoded\": 0",
                                        "\"synthesised_levels\": 0",
                                        "\"memory\": {\"geometry\": 1, \"heights\": 2, \"normals\": 3, \"imagery\": 4, "
                                        "\"pyramid\": 5}",
                                        "\"renderer\": \"llvmpipe\"",
                                        "\"backend\": \"osmesa\"",
                                        "\"left_out\": [\n    \"normal map: \\\"unlit\\\"\",\n    "
                                        "\"back\\\\slash\\u0009and tab\"\n  ],\n",
                                        "  \"throttle\": {\"median\": 0.250, \"max\": 1.500},\n",
                                        "  \"tolerance_px\": 2.000,\n  \"error_bound_px\": 1.750,\n",
                                        "  \"blocks_by_level\": [1, 0, 12],\n",
                                        "  \"sun\": {\"azimuth\": 90.000, \"elevation\": -10.000},\n",
                                        "  \"sea\": -12.5,\n  \"exaggeration\": 1.5\n}\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (!strstr(text, parts[i]))
            fail_msg("no %s in %s", parts[i], text);
}

static void files_are_replaced_and_others_kept(void **state)
{
    (void)state;
    char directory[] = "/tmp/tc-stats-XXXXXX", name[64], link_name[64];
    assert_non_null(mkdtemp(directory));
    snprintf(name, sizeof name, "%s/s.json", directory);
    snprintf(link_name, sizeof link_name, "%s/link", directory);
    tc_error error;
    assert_int_equal(tc_stats_write(name, &summary, &context, &error), TC_OK);
    assert_int_equal(tc_stats_write(name, &summary, &context, &error), TC_OK);
    assert_int_equal(symlink(name, link_name), 0);
    assert_int_equal(tc_stats_write(link_name, &summary, &context, &error), TC_OK);
    struct stat status;
    assert_int_equal(lstat(link_name, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(tc_stats_write("/dev/null", &summary, &context, &error), TC_OK);
    assert_int_equal(lstat("/dev/null", &status), 0);
    assert_true(S_ISCHR(status.st_mode));
    assert_int_equal(tc_stats_write("/nonexistent/s.json", &summary, &context, &error), TC_ERR_IO);
    assert_non_null(strstr(error.text, "/nonexistent/s.json: cannot be written"));
    assert_int_equal(tc_stats_write("/dev/full", &summary, &context, &error), TC_ERR_IO);
    assert_int_equal(tc_stats_write(directory, &summary, &context, &error), TC_ERR_IO);
    unlink(name);
    unlink(link_name);
    assert_int_equal(rmdir(directory), 0); /* nothing was left behind */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_of_all_frames),
        cmocka_unit_test(json_has_the_keys),
        cmocka_unit_test(files_are_replaced_and_others_kept),
    };
    return cmocka_run_group_tests_name("stats", tests, NULL, NULL);
}

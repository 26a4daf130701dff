/* test_display.c - what a viewer's window tells: words, lines that pass, and a panel whose rows read and write what
 * they say. How it is drawn: tests/cli/test_display.sh. */
#include "tests/support/test.h"

#include "common/app/display.h"
#include "common/app/panel.h"
#include "common/app/viewer_internal.h"
#include "common/app/viewer_place.h"
#include "common/gl/context.h"
#include "planar/square.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static tc_context *context;

/* ---- Words ------------------------------------------------------------------------------------------------------- */

static void a_scale_is_round_and_fits(void **state)
{
    (void)state;
    char text[TC_WORDS / 2];
    for (double metres = 1e-5; metres < 1e6; metres *= 1.0173) {
        const double pixels = tc_words_scale(metres, 160, text);
        char unit[4];
        double number;
        assert_int_equal(sscanf(text, "%lf %3s", &number, unit), 2);
        const double length = number * (strcmp(unit, "km") == 0   ? 1e3
                                        : strcmp(unit, "m") == 0  ? 1
                                        : strcmp(unit, "cm") == 0 ? 0.01
                                                                  : 0.001);
        assert_true(pixels <= 160 * (1 + 1e-9) && pixels > 160 / 2.5 * (1 - 1e-9)); /* no longer one would fit */
        assert_true(fabs(length / metres / pixels - 1) < 1e-9);                     /* as long as it says */
        const double power = pow(10, floor(log10(number) + 1e-9)), lead = number / power;
        assert_true(fabs(lead - 1) < 1e-9 || fabs(lead - 2) < 1e-9 || fabs(lead - 5) < 1e-9);
        assert_true(number >= 0.001 && (number < 1000 || strcmp(unit, "km") == 0));
    }
    const double none[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        assert_true(tc_words_scale(none[i], 160, text) == 0);
        assert_string_equal(text, "");
    }
    assert_true(fabs(tc_words_scale(100, 160, text) - 100) < 1e-9);
    assert_string_equal(text, "10 km");
    tc_words_scale(0.01, 100, text);
    assert_string_equal(text, "1 m");
}

static void places_are_told_in_both_hemispheres(void **state)
{
    (void)state;
    static const struct {
        double longitude, latitude;
        int digits;
        const char *text;
    } cases[] = {
        {8.5, 46.25, 2, "46.25° N, 8.50° E"}, {-68.3, -54.8, 1, "54.8° S, 68.3° W"},
        {190, 0, 3, "0.000° N, 170.000° W"},  {-190, -0.5, 1, "0.5° S, 170.0° E"},
        {180, 90, 0, "90° N, 180° W"},        {378.1, -1.23456, 4, "1.2346° S, 18.1000° E"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[TC_WORDS];
        tc_words_degrees(cases[i].longitude, cases[i].latitude, cases[i].digits, text);
        assert_string_equal(text, cases[i].text);
    }
}

static void lengths_are_told_by_their_size(void **state)
{
    (void)state;
    static const struct {
        double metres;
        const char *text;
    } cases[] = {{1.234, "1.23 m"},    {-12.34, "-12.3 m"},  {1234.4, "1234 m"},   {9999.6, "10.00 km"},
                 {123456, "123.5 km"}, {6371000, "6371 km"}, {-10994, "-10.99 km"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[TC_WORDS];
        tc_words_metres(cases[i].metres, text);
        assert_string_equal(text, cases[i].text);
    }
}

/* ---- Lines ------------------------------------------------------------------------------------------------------- */

static tc_display display;

static int shown_at(tc_display_lines *lines, double now)
{
    display.texts = 0;
    tc_display_lines_show(lines, now, &display);
    return display.texts;
}

static void lines_pass(void **state)
{
    (void)state;
    static tc_display_lines lines;
    tc_display_lines_add(&lines, false, 0, "done");
    tc_display_lines_add(&lines, true, 0, "beware");
    assert_int_equal(shown_at(&lines, 100), 2);
    assert_true(display.text[0].opacity == 1 && display.text[1].warning);
    shown_at(&lines, 4500);
    assert_true(display.text[0].opacity > 0 && display.text[0].opacity < 1); /* on its way */
    assert_int_equal(shown_at(&lines, 6000), 1);                             /* warnings stay longer */
    assert_string_equal(display.text[0].text, "beware");
    assert_int_equal(shown_at(&lines, 60000), 0);
    /* The last ones are kept; the same again is one. */
    for (int i = 0; i < 20; i++) {
        char text[32];
        snprintf(text, sizeof text, "line %d", i);
        tc_display_lines_add(&lines, false, 0, text);
        tc_display_lines_add(&lines, false, 1, text);
    }
    assert_int_equal(shown_at(&lines, 10), TC_DISPLAY_LINES);
    assert_string_equal(display.text[TC_DISPLAY_LINES - 1].text, "line 19");
    tc_display_lines_drop(&lines, "line 18");
    assert_int_equal(shown_at(&lines, 10), TC_DISPLAY_LINES - 1);
}

/* What is too long is cut between characters, and what there is no room for is left out. */
static void texts_are_cut(void **state)
{
    (void)state;
    char text[2 * TC_DISPLAY_LENGTH];
    for (int before = 0; before < 3; before++) {
        memset(text, 'x', sizeof text);
        for (size_t i = (size_t)before; i + 2 < sizeof text; i += 3)
            memcpy(text + i, "\u2026", 3);
        text[sizeof text - 1] = '\0';
        display.texts = 0;
        tc_display_say(&display, TC_SIDE_TOP, false, 1, "%s", text);
        const size_t length = strlen(display.text[0].text);
        assert_true(length < TC_DISPLAY_LENGTH && length > TC_DISPLAY_LENGTH - 4);
        assert_int_equal((length - (size_t)before) % 3, 0);
    }
    for (int i = 0; i < 2 * TC_DISPLAY_TEXTS; i++)
        tc_display_say(&display, TC_SIDE_TOP, false, 1, "x");
    assert_int_equal(display.texts, TC_DISPLAY_TEXTS);
}

/* ---- The panel --------------------------------------------------------------------------------------------------- */

static double ground(void *unused, double x, double y)
{
    (void)unused, (void)x, (void)y;
    return 0;
}

static tc_viewer viewer(void)
{
    static const tc_scheme *const lists[] = {tc_square_schemes, NULL};
    static const tc_viewer_program program = {
        .name = "test", .body = &tc_plane_body, .navigation = &tc_plane_navigation, .schemes = lists};
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 500, 400, 30, 1);
    tc_viewer v = {.program = &program,
                   .gl = tc_context_gl(context),
                   .options.output = "picture.png",
                   .options.terrain = "/nowhere/terrain.tif",
                   .options.exaggeration = 1,
                   .options.quiet = true,
                   .scene = {.budget = -1, .samples = 1, .exaggeration = 1}};
    tc_error error;
    if (tc_map_build(&grid, 0, 2, &v.map, &error) != TC_OK)
        fail_msg("%s", error.text);
    v.options.scheme = &tc_square_schemes[0];
    v.spacing = 30;
    v.ground = (tc_ground){ground, NULL, 2, v.map->body};
    v.camera = (tc_camera){.x = 7e3, .y = 2e3, .z = 5000, .pitch = -0.6, .fov = 1.2, .width = 160, .height = 120};
    if (tc_viewer_make_surface(&v, &error) != TC_OK)
        fail_msg("%s", error.text);
    return v;
}

static void leave(tc_viewer *v)
{
    tc_renderer_destroy(v->renderer);
    if (v->surface)
        v->surface->destroy(v->surface);
    tc_map_destroy(v->map);
    tc_viewer_forget_kept(v);
}

static void draw(tc_viewer *v)
{
    tc_frame_stats stats;
    tc_error error;
    if (tc_viewer_frame(v, true, &stats, &error) != TC_OK)
        fail_msg("%s", error.text);
}

static tc_panel panel;
static tc_display_row rows[TC_DISPLAY_ROWS];

static const tc_display_row *row_of(const tc_viewer *v, const char *label)
{
    const int count = tc_panel_rows(&panel, v, rows);
    for (int i = 0; i < count; i++)
        if (rows[i].kind != TC_ROW_HEADING && strcmp(rows[i].label, label) == 0)
            return &rows[i];
    return NULL;
}

static double value_of(const tc_viewer *v, const char *label)
{
    const tc_display_row *row = row_of(v, label);
    if (!row)
        fail_msg("no row %s", label);
    return row->value;
}

static tc_status set(tc_viewer *v, const char *label, double value, tc_error *error)
{
    return tc_panel_set(&panel, v, row_of(v, label)->id, value, error);
}

/* Each row has the value afterwards that it was set to, also through a frame; the rest is as before. */
static void rows_read_and_write(void **state)
{
    (void)state;
    static const struct {
        const char *label;
        double before, value;
    } cases[] = {{"Morph", 1, 0}, {"Wireframe", 0, 1},    {"Level colours", 0, 1},  {"Sea", 0, 1},
                 {"Sea", 1, 2},   {"Sea level", 0, 40},   {"Sun azimuth", 310, 90}, {"Sun elevation", 38, -10},
                 {"Light", 1, 0}, {"Contours", 0, 250},   {"Shade", 0, 1},          {"Error", 0, 4},
                 {"Error", 4, 6}, {"Exaggeration", 1, 3}, {"Levels", 10, 4},        {"Levels", 4, 10}};
    tc_viewer v = viewer();
    draw(&v);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static tc_display_row before[TC_DISPLAY_ROWS];
        tc_error error = {.text = ""};
        if (value_of(&v, cases[i].label) != cases[i].before)
            fail_msg("%s: %g", cases[i].label, value_of(&v, cases[i].label));
        const int count = tc_panel_rows(&panel, &v, before);
        if (set(&v, cases[i].label, cases[i].value, &error) != TC_OK)
            fail_msg("%s: %s", cases[i].label, error.text);
        draw(&v);
        assert_true(value_of(&v, cases[i].label) == cases[i].value);
        for (int k = 0; k < count && strcmp(cases[i].label, "Shade") != 0; k++) { /* which has no light of its own */
            const tc_display_row *now = row_of(&v, before[k].label);
            if (strcmp(cases[i].label, "Light") == 0 && strncmp(before[k].label, "Sun ", 4) == 0) {
                assert_null(now);
                continue;
            }
            assert_true(before[k].kind == TC_ROW_HEADING || strcmp(before[k].label, cases[i].label) == 0 ||
                        (now && now->value == before[k].value));
        }
    }
    assert_null(row_of(&v, "Scheme")); /* there is one alone */
    assert_null(row_of(&v, "Light"));  /* of natural colours */
    leave(&v);
}

/* What is only switched keeps its windows; what is drawn anew does not. */
static void switches_keep_what_is_loaded(void **state)
{
    (void)state;
    tc_viewer v = viewer();
    tc_error error;
    draw(&v);
    const tc_renderer *renderer = v.renderer;
    const char *const quick[] = {"Morph", "Wireframe", "Level colours", "Sun azimuth", "Sun elevation"};
    for (int i = 0; i < 5; i++)
        assert_int_equal(set(&v, quick[i], i != 0, &error), TC_OK);
    assert_ptr_equal(v.renderer, renderer);
    assert_true(v.scene.frame.no_morph && v.scene.wireframe && v.scene.level_colours);
    assert_int_equal(v.scene.sun.kind, TC_SUN_LOCAL);
    leave(&v);
}

/* What cannot be read leaves all as it was. */
static void failures_change_nothing(void **state)
{
    (void)state;
    tc_viewer v = viewer();
    const tc_map *map = v.map;
    tc_error error = {.text = ""};
    bool opened = true;
    tc_pose view;
    draw(&v);
    assert_int_not_equal(set(&v, "Synthesis", 2, &error), TC_OK);
    assert_non_null(strstr(error.text, "/nowhere/terrain.tif"));
    assert_true(value_of(&v, "Synthesis") == 0);
    for (int picture = 0; picture < 2; picture++) {
        assert_int_not_equal(tc_viewer_drop(&v, "/nowhere/else.tif", picture, &opened, &view, &error), TC_OK);
        assert_non_null(strstr(error.text, "/nowhere/else.tif"));
        assert_false(opened);
    }
    assert_int_not_equal(tc_viewer_drop(&v, "tests/fast/test_display.c", false, &opened, &view, &error), TC_OK);
    assert_ptr_equal(v.map, map);
    assert_int_equal(v.options.imagery_count, 0);
    draw(&v);
    leave(&v);
}

/* Straight down, the middle of the frame shows the ground below the eye; above the horizon there is none, nor is there
 * beside the terrain. */
static void ground_is_seen_where_it_is(void **state)
{
    (void)state;
    tc_viewer v = viewer();
    double place[3], distance;
    v.camera.pitch = -3.14159265358979 / 2;
    assert_true(tc_viewer_point(&v, 80, 60, place, &distance));
    assert_true(fabs(place[0] - 7e3) < 1 && fabs(place[1] - 2e3) < 1 && fabs(place[2]) < 1);
    assert_true(fabs(distance - 5000) < 1);
    v.camera.pitch = 0.7;
    assert_false(tc_viewer_point(&v, 80, 60, place, &distance));
    v.camera.pitch = -0.2, v.camera.heading = 3.1416; /* to the south, where it ends */
    assert_false(tc_viewer_point(&v, 80, 60, place, &distance));
    leave(&v);
}

/* ---- Texts of a frame -------------------------------------------------------------------------------------------- */

static tc_display shown;

/* The pointer is in the middle of the frame. */
static bool show(tc_window *window, const tc_display *told, tc_display_result *result)
{
    (void)window;
    shown = *told;
    result->pointed = true;
    result->x = 80, result->y = 60;
    return true;
}

static const char *text_that_begins(const char *begin)
{
    for (int i = 0; i < shown.texts; i++)
        if (strncmp(shown.text[i].text, begin, strlen(begin)) == 0)
            return shown.text[i].text;
    return "";
}

static double hill(void *unused, double x, double y)
{
    (void)unused, (void)x, (void)y;
    return 1000;
}

/* Those of eye and pointer alike, however high they are drawn. */
static void heights_are_the_true_ones(void **state)
{
    (void)state;
    static const struct tc_window_plugin window = {.show = show};
    tc_viewer v = viewer();
    tc_error error;
    tc_frame_stats stats;
    assert_int_equal(set(&v, "Exaggeration", 4, &error), TC_OK);
    v.camera.pitch = -3.14159265358979 / 2;
    assert_int_equal(tc_viewer_frame(&v, true, &stats, &error), TC_OK);
    v.ground.height = hill;
    v.options.output = NULL;
    v.window_plugin = &window;
    assert_int_equal(tc_viewer_display_open(&v, &error), TC_OK);
    for (int i = 0; i < 4; i++) { /* it looks now and then */
        tc_viewer_display_show(&v, &stats);
        usleep(35000);
    }
    assert_string_equal(text_that_begins("height "), "height 1250 m, 1000 m above ground");
    assert_non_null(strstr(text_that_begins("pointer "), " m, 250 m"));
    tc_viewer_display_close(&v);
    leave(&v);
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scale_is_round_and_fits),
        cmocka_unit_test(places_are_told_in_both_hemispheres),
        cmocka_unit_test(lengths_are_told_by_their_size),
        cmocka_unit_test(lines_pass),
        cmocka_unit_test(texts_are_cut),
        cmocka_unit_test(rows_read_and_write),
        cmocka_unit_test(switches_keep_what_is_loaded),
        cmocka_unit_test(failures_change_nothing),
        cmocka_unit_test(ground_is_seen_where_it_is),
        cmocka_unit_test(heights_are_the_true_ones),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}

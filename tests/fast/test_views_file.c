/* test_views_file.c - files of views: lines and names, found and added. */
#include "tests/support/test.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/view/flight_path.h"
#include "common/view/views_file.h"
#include "tests/support/made_files.h"

static const tc_navigation *const plane = &tc_plane_navigation, *const globe = &tc_sphere_navigation;

static void views_have_names(void **state)
{
    (void)state;
    static const char text[] = "# a comment: no view\n"
                               "\n"
                               "1,2,3,4,5\n"
                               "  2,2,3,4,5  \t#  over  the lake \r\n"
                               "3,2,3,4,5#a # b\r\n"
                               "4,2,3,4,5 #\n"
                               "5,2,3,4,5 # over  the lake";
    static const char *const names[] = {"", "over  the lake", "a # b", "", "over  the lake"};
    tc_views views = tc_views_of(plane, "file", text);
    bool found;
    for (int n = 0; n < 5; n++) {
        assert_int_equal(tc_views_next(&views, &found, NULL), TC_OK);
        assert_true(found && views.view.x == n + 1 && views.number == n + 3);
        assert_int_equal(views.name_length, strlen(names[n]));
        assert_memory_equal(views.name, names[n], views.name_length);
    }
    assert_int_equal(tc_views_next(&views, &found, NULL), TC_OK);
    assert_false(found);
    tc_pose view;
    assert_int_equal(tc_views_find(plane, "file", text, "over  the lake", &view, NULL), TC_OK);
    assert_true(view.x == 2); /* the first one */
    assert_int_equal(tc_views_find(plane, "file", text, "a # b", &view, NULL), TC_OK);
    assert_true(view.x == 3);
    static const char *const none[] = {"", "over the lake", "Over  the lake", "over", "a comment: no view", " a # b"};
    tc_error error;
    for (size_t n = 0; n < sizeof none / sizeof *none; n++)
        assert_int_equal(tc_views_find(plane, "file", text, none[n], &view, &error), TC_ERR_USAGE);
    assert_string_equal(error.text, "file: expected a view named ' a # b', found none");
}

/* A path reads the same lines. */
static void paths_pass_over_names(void **state)
{
    (void)state;
    tc_flight_path path;
    assert_int_equal(tc_flight_path_parse(plane, "file", "# lake\n1,2,3,4,5 # there\n\n2,3,4,5,6# back\n", &path, NULL),
                     TC_OK);
    assert_int_equal(path.count, 2);
    assert_true(path.keys[0].x == 1 && path.keys[1].x == 2);
    tc_flight_path_free(&path);
}

static void bad_lines_are_named(void **state)
{
    (void)state;
    static const struct {
        const tc_navigation *navigation;
        const char *text, *error;
    } cases[] = {
        {plane, "1,2,3,4,5\n1,2,3,4 # x\n", "file: line 2: expected X,Y,Z,HEADING,PITCH, found '1,2,3,4'"},
        {plane, "1,2,3,4,5 lake\n", "file: line 1: expected X,Y,Z,HEADING,PITCH, found '1,2,3,4,5 lake'"},
        {plane, "\n\nlake # 1,2,3,4,5\n", "file: line 3: "},
        {plane, "1,2,3,4,nan\n", "file: line 1: "},
        {globe, "1,91,3,4,5 # x\n", "file: line 1: expected LON,LAT,ALT,HEADING,PITCH in degrees and metres"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        tc_pose view;
        tc_error error;
        tc_flight_path path;
        assert_int_equal(tc_views_find(cases[n].navigation, "file", cases[n].text, "x", &view, &error), TC_ERR_FORMAT);
        if (strncmp(error.text, cases[n].error, strlen(cases[n].error)) != 0)
            fail_msg("'%s' is not '%s'", error.text, cases[n].error);
        assert_int_equal(tc_flight_path_parse(cases[n].navigation, "file", cases[n].text, &path, &error),
                         TC_ERR_FORMAT);
        assert_int_equal(strncmp(error.text, cases[n].error, strlen(cases[n].error)), 0);
    }
    char text[600];
    memset(text, '1', sizeof text - 1);
    text[sizeof text - 1] = 0;
    tc_pose view;
    assert_int_equal(tc_views_find(plane, "file", text, "x", &view, NULL), TC_ERR_FORMAT);
}

static void names_are_new(void **state)
{
    (void)state;
    char name[TC_VIEW_NAME];
    tc_views_new_name(plane, "", name);
    assert_string_equal(name, "view 1");
    tc_views_new_name(plane, "1,2,3,4,5 # view 1\n1,2,3,4,5 # view 3\nnonsense # view 2\n1,2,3,4,5 # view 22\n", name);
    assert_string_equal(name, "view 2");
    tc_views_new_name(plane, "nonsense\n1,2,3,4,5 # view 1\n1,2,3,4,5 # view 2\n", name);
    assert_string_equal(name, "view 3");
    static const char *const others[] = {"view 01", "view  1", "view 1 ", "view +1", "View 1", "view 1a", "view 1.0"};
    char text[64];
    for (size_t n = 0; n < sizeof others / sizeof *others; n++) {
        snprintf(text, sizeof text, "1,2,3,4,5 # %s\n", others[n]);
        tc_views_new_name(plane, text, name);
        assert_string_equal(name, n == 2 ? "view 2" : "view 1"); /* blanks around are none of the name */
    }
}

/* The number of a new name costs no pass over the file for each name that there is. */
static void names_are_new_in_long_files(void **state)
{
    (void)state;
    enum { VIEWS = 40000, LINE = 32 };
    char *text = malloc(VIEWS * LINE), *end = text, name[TC_VIEW_NAME];
    for (int n = VIEWS; n > 0; n--)
        end += snprintf(end, LINE, "1,2,3,4,5 # view %d\n", n);
    tc_views_new_name(plane, text, name);
    assert_string_equal(name, "view 40001");
    free(text);
}

/* As some editors begin a text. */
static void a_byte_order_mark_is_no_part(void **state)
{
    (void)state;
    static const char text[] = "\xef\xbb\xbf"
                               "1,2,3,4,5 # view 1\n2,2,3,4,5\n";
    char name[TC_VIEW_NAME];
    tc_pose view;
    tc_flight_path path;
    assert_int_equal(tc_views_find(plane, "file", text, "view 1", &view, NULL), TC_OK);
    assert_true(view.x == 1);
    tc_views_new_name(plane, text, name);
    assert_string_equal(name, "view 2");
    make_bytes(made_path("path.txt"), text, sizeof text - 1);
    assert_int_equal(tc_flight_path_load(plane, made_path("path.txt"), &path, NULL), TC_OK);
    assert_int_equal(path.count, 2);
    tc_flight_path_free(&path);
}

static void assert_holds(const char *path, const char *text)
{
    char *found;
    assert_int_equal(tc_views_read(path, "a file", &found, NULL), TC_OK);
    assert_string_equal(found, text);
    free(found);
}

static void lines_are_added(void **state)
{
    (void)state;
    const char *path = made_path("views.txt");
    assert_int_equal(tc_views_append(path, "1,2,3,4,5", "view 1", NULL), TC_OK);
    assert_int_equal(tc_views_append(path, "2,2,3,4,5", "view 2", NULL), TC_OK);
    assert_holds(path, "1,2,3,4,5 # view 1\n2,2,3,4,5 # view 2\n");
    make_bytes(path, "# mine\n1,2,3,4,5 # a", 20); /* a last line that is not ended */
    assert_int_equal(tc_views_append(path, "2,2,3,4,5", "view 1", NULL), TC_OK);
    assert_holds(path, "# mine\n1,2,3,4,5 # a\n2,2,3,4,5 # view 1\n");
}

static void what_cannot_be_written_stays(void **state)
{
    (void)state;
    tc_error error;
    assert_int_equal(tc_views_append(made_path("nowhere/views.txt"), "1,2,3,4,5", "a", &error), TC_ERR_IO);
    assert_int_equal(tc_views_append(made_folder(), "1,2,3,4,5", "a", &error), TC_ERR_IO);
    assert_int_equal(tc_views_append("/dev/full", "1,2,3,4,5", "a", &error), TC_ERR_IO);
    const char *pipe = made_path("pipe");
    assert_int_equal(mkfifo(pipe, 0600), 0);
    assert_int_equal(tc_views_append(pipe, "1,2,3,4,5", "a", &error), TC_ERR_IO);
    assert_non_null(strstr(error.text, "expected a regular file"));
    assert_int_equal(unlink(pipe), 0);
    /* No room for all of a line: nothing of it is left. */
    const char *path = made_path("full.txt");
    make_bytes(path, "1,2,3,4,5 # a\n", 14);
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = before, small.rlim_cur = 20;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    tc_status status = tc_views_append(path, "2,2,3,4,5", "b", &error);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(status, TC_ERR_IO);
    assert_holds(path, "1,2,3,4,5 # a\n");
}

static void what_is_no_text_is_refused(void **state)
{
    (void)state;
    char *text;
    tc_error error;
    const char *path = made_path("binary");
    make_bytes(path, "1,2,3,4,5\n\0\n", 12);
    assert_int_equal(tc_views_read(path, "a file of views", &text, &error), TC_ERR_FORMAT);
    assert_non_null(strstr(error.text, "expected text, found zero bytes"));
    assert_int_equal(tc_views_read(made_path("missing"), "a file of views", &text, &error), TC_ERR_IO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_have_names),
        cmocka_unit_test(paths_pass_over_names),
        cmocka_unit_test(bad_lines_are_named),
        cmocka_unit_test(names_are_new),
        cmocka_unit_test(names_are_new_in_long_files),
        cmocka_unit_test(a_byte_order_mark_is_no_part),
        cmocka_unit_test(lines_are_added),
        cmocka_unit_test(what_cannot_be_written_stays),
        cmocka_unit_test(what_is_no_text_is_refused),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    made_folder_remove();
    return failed;
}

/* test_options.c - the viewers' command line and the names of frames. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/app/options.h"
#include "common/base/numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_ARGUMENTS = 32 };

/* A program with options and schemes of its own. */
static bool read_n(void *n, const char *value)
{
    int *samples = n;
    return tc_read_int(value, 15, 2047, samples) && (*samples & (*samples + 1)) == 0;
}

static const tc_scheme schemes[] = {{.name = "plain"}, {.name = "fancy", .help = "with frills"}, {0}};
static const tc_scheme *const lists[] = {schemes, NULL};
static const tc_option own[] = {
    {.help = "Geometry clipmap"},
    {0, "n", "N", "2^k - 1 of 15..2047", "samples", read_n, offsetof(tc_options, n)},
    TC_LEVELS_OPTION,
    TC_BUDGET_OPTION,
    TC_SCHEME_OPTION,
};
static const tc_viewer_program program = {.name = "viewer",
                                          .summary = "Shows.",
                                          .navigation = &tc_plane_navigation,
                                          .schemes = lists,
                                          .options = own,
                                          .option_count = sizeof own / sizeof *own};

/* Parses a command line given as words with single spaces between. */
static tc_status parse(const char *line, tc_options *options, tc_error *error)
{
    static char words[1024]; /* options point into it */
    char *argv[MAX_ARGUMENTS + 1] = {(char *)"viewer"};
    int argc = 1;
    snprintf(words, sizeof words, "%s", line);
    for (char *rest = words, *word; (word = strsep(&rest, " ")) && argc < MAX_ARGUMENTS;)
        if (*word)
            argv[argc++] = strcmp(word, "''") == 0 ? (char *)"" : word;
    return tc_options_parse(&program, argc, argv, options, error);
}

static tc_options good(const char *line)
{
    tc_options options;
    tc_error error = {.text = ""};
    if (parse(line, &options, &error) != TC_OK)
        fail_msg("'%s': %s", line, error.text);
    return options;
}

static void defaults(void **state)
{
    (void)state;
    tc_options o = good("a.tif");
    assert_string_equal(o.terrain, "a.tif");
    assert_int_equal(o.action, TC_RUN);
    assert_null(o.output);
    assert_int_equal(o.width, 1280);
    assert_int_equal(o.height, 720);
    assert_float_equal(o.fov, 75 * acos(-1) / 180, 1e-15);
    assert_false(o.has_view);
    assert_int_equal(o.backend, TC_BACKEND_AUTO);
    assert_int_equal(o.n, 0);
    assert_true(o.target_ms == 0);
    assert_true(o.scene.budget == 0);
    assert_false(o.scene.unlit || o.scene.background_set || o.scene.wireframe || o.scene.frame.no_morph);
}

static void values_arrive(void **state)
{
    (void)state;
    tc_options o = good("--view -1.5,2e3,+300,-90,-45.5 -o out.png --size 640x480 --fov=90 --n 127 --levels 5 t.hgt");
    assert_true(o.has_view);
    assert_true(o.view.x == -1.5 && o.view.y == 2000 && o.view.z == 300);
    assert_float_equal(o.view.heading, -acos(-1) / 2, 1e-15);
    assert_float_equal(o.view.pitch, -45.5 * acos(-1) / 180, 1e-15);
    assert_string_equal(o.output, "out.png");
    assert_int_equal(o.width, 640);
    assert_int_equal(o.height, 480);
    assert_float_equal(o.fov, acos(-1) / 2, 1e-15);
    assert_int_equal(o.n, 127);
    assert_int_equal(o.levels, 5);

    o = good(
        "t -oout.png --backend osmesa --stats s.json --explain --budget 5000000000 --background ff0080 --unlit -q");
    assert_string_equal(o.output, "out.png");
    assert_int_equal(o.backend, TC_BACKEND_OSMESA);
    assert_string_equal(o.stats, "s.json");
    assert_true(o.explain && o.scene.unlit && o.scene.background_set && o.quiet && !o.verbose);
    assert_true(o.scene.budget == 5000000000);
    assert_int_equal(o.scene.background[0], 255);
    assert_int_equal(o.scene.background[1], 0);
    assert_int_equal(o.scene.background[2], 128);

    o = good("t --wireframe --level-colours --no-morph --spacing 30 --unit 0.5 --nodata -9999 --voids constant=-3 "
             "--threads 3 --json -v");
    assert_ptr_equal(o.scene.shade, NULL);
    assert_true(o.scene.wireframe && o.scene.level_colours && o.scene.frame.no_morph && o.json && o.verbose);
    assert_true(o.source.spacing == 30 && o.source.unit == 0.5);
    assert_true(o.source.has_nodata && o.source.nodata == -9999);
    assert_int_equal(o.source.voids, TC_VOIDS_CONSTANT);
    assert_true(o.source.void_constant == -3);
    assert_int_equal(o.threads, 3);
    assert_int_equal(good("--voids hole t").source.voids, TC_VOIDS_HOLE);
    assert_int_equal(good("--voids hole --voids fill t").source.voids, TC_VOIDS_FILL);

    o = good("t --shade aspect --contours 2.5 --unlit");
    assert_ptr_equal(o.scene.shade, &tc_shades[TC_SHADE_ASPECT]);
    assert_true(o.scene.contours == 2.5 && o.scene.unlit);

    o = good("t --lookat -118.5,37.25 --exaggeration 2.5");
    assert_true(o.look.given && o.look.longitude == -118.5 && o.look.latitude == 37.25 && !o.look.has_height);
    assert_true(o.look.distance == 0 && o.look.heading == 0 && o.exaggeration == 2.5 && !o.has_view);
    assert_float_equal(o.look.pitch, -acos(-1) / 6, 1e-15);
    o = good("t --lookat 1,2,-300 --distance 5e3 --heading 90 --pitch -90");
    assert_true(o.look.has_height && o.look.height == -300 && o.look.distance == 5000 && o.exaggeration == 1);
    assert_float_equal(o.look.heading, acos(-1) / 2, 1e-15);
    assert_float_equal(o.look.pitch, -acos(-1) / 2, 1e-15);

    o = good("t --sea=-12.5");
    assert_true(o.sea.kind == TC_SEA_GIVEN && o.sea.level == -12.5);
    assert_true(good("t --sea 1e9").sea.level == 1e9 && good("t --sea none").sea.kind == TC_SEA_NONE);
    assert_int_equal(good("t").sea.kind, TC_SEA_FOUND);

    o = good("t --sun=-90,-12.5");
    assert_int_equal(o.scene.sun.kind, TC_SUN_LOCAL);
    assert_float_equal(o.scene.sun.azimuth, 1.5 * acos(-1), 1e-15);
    assert_float_equal(o.scene.sun.elevation, -12.5 * acos(-1) / 180, 1e-15);
    o = good("t --sun 360,90 --shade natural");
    assert_float_equal(o.scene.sun.azimuth, 2 * acos(-1), 1e-15);
    o = good("t --date 2000-01-01T12:00Z");
    assert_true(o.julian == 2451545 && o.scene.sun.kind == TC_SUN_USUAL);
    assert_string_equal(o.date, "2000-01-01T12:00Z");
    assert_true(!good("t").date && good("t").scene.sun.kind == TC_SUN_USUAL);

    o = good("t --target-ms 16.7");
    assert_true(o.target_ms == 16.7 && o.scene.frame.throttle == 0);
    assert_true(good("t --target-ms 1e-3 --path p --frames 3 -o f-%d.png").target_ms == 1e-3);

    o = good("--path p.txt --frames 10 -o f-%05d.png t");
    assert_string_equal(o.path, "p.txt");
    assert_int_equal(o.frames, 10);
    assert_string_equal(good("-- -t").terrain, "-t");
    assert_string_equal(good("-").terrain, "-");
    assert_int_equal(good("--frames 10 t").frames, 10);
    assert_string_equal(good("-o a%b.png t").output, "a%b.png");
}

static void help_and_version(void **state)
{
    (void)state;
    assert_int_equal(good("--size 3x3 -h").action, TC_SHOW_HELP);
    assert_int_equal(good("--help --nonsense").action, TC_SHOW_HELP);
    assert_int_equal(good("--version").action, TC_SHOW_VERSION);

    char text[16384];
    FILE *file = fmemopen(text, sizeof text, "w");
    assert_non_null(file);
    tc_options_print_help(&program, file);
    fclose(file);
    assert_non_null(strstr(text, "usage: viewer [OPTION]... [TERRAIN]"));
    static const char *const names[] = {"--view X,Y,Z,HEADING,PITCH",
                                        "-o, --output FILE.png",
                                        "--lookat LON,LAT[,HEIGHT]",
                                        "--distance M",
                                        "--exaggeration FACTOR",
                                        "--sea Z",
                                        "--sun AZIMUTH,ELEVATION",
                                        "--date YYYY-MM-DDTHH:MMZ",
                                        "--size WxH",
                                        "--fov DEG",
                                        "--n N",
                                        "--levels M",
                                        "--path FILE",
                                        "--frames N",
                                        "--backend NAME",
                                        "--stats FILE.json",
                                        "--explain",
                                        "--budget SAMPLES",
                                        "--wireframe",
                                        "--level-colours",
                                        "--no-morph",
                                        "--unlit",
                                        "--background RRGGBB",
                                        "--voids POLICY",
                                        "--nodata V",
                                        "--spacing M",
                                        "--unit M",
                                        "--json",
                                        "--threads N",
                                        "-h, --help",
                                        "--version",
                                        "-q, --quiet",
                                        "-v, --verbose"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strstr(text, names[i]))
            fail_msg("help lacks %s", names[i]);
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next)
            *next++ = '\0';
        assert_true(strlen(line) <= 120);
    }
}

/* Without a file there is a default one, where there is a display for a window, and a window is wanted. */
static void no_file_is_a_window(void **state)
{
    (void)state;
    static const struct {
        const char *line;
        bool window;
    } cases[] = {{"", true},          {"--no-display --frames 5", true},  {"--backend window", true},
                 {"-o p.png", false}, {"--path p.txt --frames 5", false}, {"--backend egl", false}};
    static const char *const displays[][2] = {{"DISPLAY", ":7"}, {"WAYLAND_DISPLAY", "wayland-0"}};
    for (int d = 0; d < 2; d++) {
        setenv(displays[d][0], displays[d][1], 1);
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            tc_options o;
            tc_error error;
            const tc_status status = parse(cases[i].line, &o, &error);
            assert_int_equal(status, cases[i].window ? TC_OK : TC_ERR_USAGE);
            if (status == TC_OK)
                assert_null(o.terrain);
            else
                assert_non_null(strstr(error.text, "TERRAIN: expected a file, found none"));
        }
        setenv(displays[d][0], "", 1); /* is none */
    }
}

/* Each is refused, with this in the message. */
static void nonsense_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *line, *text;
    } cases[] = {
        {"", "TERRAIN: expected a file, found none"},
        {"a b", "TERRAIN: expected one file, found also 'b'"},
        {"t --size 0x5", "--size: expected WxH of 1..16384, found '0x5'"},
        {"t --size 5x", "--size: "},
        {"t --size x5", "--size: "},
        {"t --size 5", "--size: "},
        {"t --size 16385x1", "--size: "},
        {"t --size 5x5x5", "--size: "},
        {"t --size 5X5", "--size: "},
        {"t --size +5x5", "--size: "},
        {"t --size -5x5", "--size: "},
        {"t --size 99999999999999999999x5", "--size: "},
        {"t --size", "--size: expected WxH of 1..16384, found nothing"},
        {"t --view 1,2,3,4", "--view: "},
        {"t --view 1,2,3,4,5,6", "--view: "},
        {"t --view 1,2,3,4,5,", "--view: "},
        {"t --view 1,2,,4,5", "--view: "},
        {"t --view nan,2,3,4,5", "--view: "},
        {"t --view 1,2,inf,4,5", "--view: "},
        {"t --view 1,2,1e999,4,5", "--view: "},
        {"t --view 1,2,1e13,4,5", "--view: "},
        {"t --view 1,2,3,4,91", "--view: "},
        {"t --view 1,2,3,400,5", "--view: "},
        {"t --view 0x10,2,3,4,5", "--view: "},
        {"t --view 1;2;3;4;5", "--view: "},
        {"t --view ''", "--view: "},
        {"t --lookat 1", "--lookat: expected LON,LAT[,HEIGHT] in degrees and metres"},
        {"t --lookat 1,", "--lookat: "},
        {"t --lookat 1,2,3,", "--lookat: "},
        {"t --lookat 1,91", "--lookat: "},
        {"t --lookat 1,2 --distance 0", "--distance: expected metres above 0, up to 1e12, found '0'"},
        {"t --lookat 1,2 --distance nan", "--distance: "},
        {"t --lookat 1,2 --view 1,2,3,4,5", "--lookat: expected either it or --view, found both"},
        {"t --distance 5", "--distance: expected --lookat LON,LAT with it, found none"},
        {"t --sea x", "--sea: expected metres of -1e9..1e9, or none, found 'x'"},
        {"t --sea nan", "--sea: "},
        {"t --sea inf", "--sea: "},
        {"t --sea 1.1e9", "--sea: "},
        {"t --sea 5m", "--sea: "},
        {"t --sea None", "--sea: "},
        {"t --sun 90",
         "--sun: expected AZIMUTH,ELEVATION in degrees, |AZIMUTH| up to 360, |ELEVATION| up to 90, found '90'"},
        {"t --sun 90,", "--sun: "},
        {"t --sun 90,91", "--sun: "},
        {"t --sun 361,0", "--sun: "},
        {"t --sun 90;30", "--sun: "},
        {"t --sun 90,30,1", "--sun: "},
        {"t --sun nan,30", "--sun: "},
        {"t --sun 90,inf", "--sun: "},
        {"t --date 2024-06-21", "--date: expected YYYY-MM-DDTHH:MMZ, a minute of UTC of the years 1901 to 2099, found "
                                "'2024-06-21'"},
        {"t --date 2024-02-30T00:00Z", "--date: expected YYYY-MM-DDTHH:MMZ"},
        {"t --sun 90,30 --date 2024-06-21T12:00Z", "--date: expected either it or --sun, found both"},
        {"t --sun 90,30 --unlit", "--sun: expected no --unlit with it, which has no light, found both"},
        {"t --date 2024-06-21T12:00Z --unlit", "--date: expected no --unlit with it"},
        {"t --sun 90,30 --shade height", "--sun: expected natural colours, whose light it is, found --shade height"},
        {"t --date 2024-06-21T12:00Z --shade none", "--date: expected natural colours"},
        {"t --exaggeration 0", "--exaggeration: expected a factor of 0.01..1000, found '0'"},
        {"t --exaggeration inf", "--exaggeration: "},
        {"t --fov 0.5", "--fov: expected 1..170 degrees, found '0.5'"},
        {"t --fov 171", "--fov: "},
        {"t --fov nan", "--fov: "},
        {"t --fov 90deg", "--fov: "},
        {"t --n 128", "--n: expected 2^k - 1 of 15..2047, found '128'"},
        {"t --n 7", "--n: "},
        {"t --n 4095", "--n: "},
        {"t --levels 0", "--levels: "},
        {"t --levels 33", "--levels: "},
        {"t --budget 0", "--budget: "},
        {"t --budget -1", "--budget: "},
        {"t --frames 0 --path p", "--frames: "},
        {"t --frames 5 -o x.png", "--frames: expected --path FILE with it"},
        {"t --path p", "--path: expected --frames N with it"},
        {"t --path p --frames 3 -o x.png", "--output: "},
        {"t --path p --frames 3 -o %s.png", "--output: "},
        {"t --path p --frames 3 -o %05d%d.png", "--output: "},
        {"t --path p --frames 3 --view 1,2,3,4,5", "--view: "},
        {"t --target-ms 0", "--target-ms: expected more than 0 ms, found '0'"},
        {"t --target-ms -16", "--target-ms: expected more than 0 ms, found '-16'"},
        {"t --target-ms 16ms", "--target-ms: "},
        {"t --target-ms inf", "--target-ms: "},
        {"t --target-ms 16 -o x.png", "--target-ms: expected a window or --path FILE with it, found one picture"},
        {"t --backend egl", "--backend: expected -o FILE or --path FILE"},
        {"t --backend vulkan", "--backend: expected auto, window, egl or osmesa, found 'vulkan'"},
        {"t --background fff", "--background: "},
        {"t --shade foo", "--shade: expected natural, slope, aspect, height or none, found 'foo'"},
        {"t --shade ''", "--shade: "},
        {"t --shade Slope", "--shade: "},
        {"t --unlit --shade height", "--unlit: "},
        {"t --shade natural --unlit --shade height", "--unlit: "},
        {"t --contours 0", "--contours: expected metres of 0.001..1e6, found '0'"},
        {"t --contours -1", "--contours: "},
        {"t --contours nan", "--contours: "},
        {"t --contours inf", "--contours: "},
        {"t --contours 1e-9", "--contours: "},
        {"t --contours 2e6", "--contours: "},
        {"t --contours 10m", "--contours: "},
        {"t --background 0x1234", "--background: "},
        {"t --background -12345", "--background: "},
        {"t --voids pit", "--voids: "},
        {"t --voids constant", "--voids: "},
        {"t --voids constant=", "--voids: "},
        {"t --voids constant=x", "--voids: "},
        {"t --nodata nan", "--nodata: "},
        {"t --nodata 1e999", "--nodata: "},
        {"t --spacing 0", "--spacing: "},
        {"t --spacing -3", "--spacing: "},
        {"t --spacing inf", "--spacing: "},
        {"t --unit 0", "--unit: "},
        {"t --threads 0", "--threads: "},
        {"t --threads 1.5", "--threads: "},
        {"t -o ''", "--output: "},
        {"t --json=1", "--json: expected no value, found '1'"},
        {"t --imagery ''", "--imagery: "},
        {"t --imagry x.png", "--imagry: no such option"},
        {"t --synthesised 3", "--synthesised: no such option"},
        {"t --scheme rings", "--scheme: expected plain or fancy, found 'rings'"},
        {"t --siz 3x3", "--siz: no such option"},
        {"t -z", "-z: no such option"},
        {"t -vv", "-vv: no such option"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tc_options options = {.frames = 4711};
        tc_error error = {.text = ""};
        tc_status status = parse(cases[i].line, &options, &error);
        if (status != TC_ERR_USAGE || strncmp(error.text, cases[i].text, strlen(cases[i].text)) != 0)
            fail_msg("'%s': status %d, '%s'", cases[i].line, status, error.text);
        assert_int_equal(options.frames, 4711);
    }
}

static void patterns_of_frames(void **state)
{
    (void)state;
    char name[32];
    assert_true(tc_frame_pattern_name("frame-%05d.png", 7, name, sizeof name));
    assert_string_equal(name, "frame-00007.png");
    assert_true(tc_frame_pattern_name("a/%d", 123456, name, sizeof name));
    assert_string_equal(name, "a/123456");
    assert_true(tc_frame_pattern_name("%03dx", 123456, name, sizeof name));
    assert_string_equal(name, "123456x");
    assert_false(tc_frame_pattern_name("frame-%05d.png", 7, name, 15));
    static const char *const bad[] = {"",     "frame.png", "%",    "%%d",   "%5d",     "%00d", "%-5d",
                                      "%05i", "%05x",      "%05s", "%n",    "%*d",     "%0d",  "%05d%%",
                                      "%ld",  "% d",       "%+d",  "%010d", "%05dd%d", "%.3d"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (tc_frame_pattern_valid(bad[i]))
            fail_msg("'%s' was taken", bad[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults),           cmocka_unit_test(values_arrive),
        cmocka_unit_test(help_and_version),   cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(patterns_of_frames), cmocka_unit_test(no_file_is_a_window),
    };
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    return cmocka_run_group_tests_name("options", tests, NULL, NULL);
}

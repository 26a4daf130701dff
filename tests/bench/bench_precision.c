/* bench_precision.c - the rings' vertices as the driver computes them against long double, level by level, with the
 * exact map transform and with CH06's: bench_precision [FILE]; a table as CSV.
 *
 * The planet is as large as the Earth and rough; places and altitudes are those of test_rings_precision.c. A level is
 * the ring's number, the disc inside the finest one counting as one more. Pixels are of a frame 1280 wide. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/rings_capture.h"
#include "tests/support/rings_views.h"

static void measure(const tc_context *context, const tc_atlas *atlas, tc_rings_scheme scheme, int64_t width,
                    rings_error level[RINGS_MAX_LEVELS])
{
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.scheme = scheme});
    rings_capture capture = rings_capture_create(&globe);
    test_random r = {1};
    for (int place = 0; place < RINGS_PLACES; place++)
        for (int k = place % 4; k < RINGS_ALTITUDES; k += 4) {
            tc_camera c = rings_view_of(atlas, place, width, rings_altitude(k, atlas->radius), &r);
            rings_capture_compare(&capture, &c, 16, level);
        }
    rings_capture_destroy(&capture);
    globe_scene_destroy(&globe);
}

int main(int argc, char **argv)
{
    enum { WIDTH = 1024 };
    FILE *out = argc > 1 ? fopen(argv[1], "w") : stdout;
    tc_context *context = scene_context();
    if (!out || !context) {
        fprintf(stderr, "bench_precision: %s\n", out ? "no context" : "cannot write the table");
        return 1;
    }
    tc_atlas atlas = globe_atlas(globe_rough, WIDTH, 6371000);
    fprintf(out, "level,variant,err_over_radius,err_px\n");
    for (int scheme = TC_RINGS_EXACT; scheme <= TC_RINGS_CH06; scheme++) {
        rings_error level[RINGS_MAX_LEVELS] = {{0}};
        measure(context, &atlas, (tc_rings_scheme)scheme, WIDTH, level);
        for (int i = 0; i < RINGS_MAX_LEVELS; i++)
            if (level[i].vertices)
                fprintf(out, "%d,%s,%.3e,%.3e\n", i, scheme == TC_RINGS_CH06 ? "ch06" : "exact", level[i].over_radius,
                        level[i].pixels);
    }
    tc_atlas_free(&atlas);
    tc_context_destroy(context);
    return out != stdout && fclose(out) != 0;
}

/* bench_precision.c - the rings' vertices as the driver computes them against long double, level by level, with the
 * exact map transform and with CH06's: precision.csv.
 *
 * The planet is as large as the Earth and rough; places and altitudes are those of test_rings_precision.c, or, quick,
 * every twentieth place. A level is the ring's number, the disc inside the finest one counting as one more. Pixels are
 * of a frame 1280 wide. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/measure.h"
#include "tests/support/rings_capture.h"
#include "tests/support/rings_views.h"

static void measure(const tc_context *context, const tc_map *atlas, tc_rings_scheme scheme, int64_t width, int step,
                    rings_error level[RINGS_MAX_LEVELS])
{
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.scheme = scheme});
    rings_capture capture = rings_capture_create(&globe);
    test_random r = {1};
    for (int place = 0; place < RINGS_PLACES; place += step)
        for (int k = place / step % 4; k < RINGS_ALTITUDES; k += 4) {
            tc_camera c = rings_view_of(atlas, place, width, rings_altitude(k, atlas->body.radius), &r);
            rings_capture_compare(&capture, &c, 16, level);
        }
    rings_capture_destroy(&capture);
    globe_scene_destroy(&globe);
}

int main(int argc, char **argv)
{
    enum { WIDTH = 1024 };
    measure_options o = measure_begin(argc, argv, "level,variant,err_over_radius,err_px");
    tc_context *context = scene_context();
    if (!context)
        return 1;
    tc_map *atlas = globe_atlas(globe_rough, WIDTH, 6371000);
    printf("%5s %8s %16s %12s\n", "level", "variant", "error / radius", "error px");
    for (int scheme = TC_RINGS_EXACT; scheme <= TC_RINGS_CH06; scheme++) {
        const char *name = scheme == TC_RINGS_CH06 ? "ch06" : "exact";
        rings_error level[RINGS_MAX_LEVELS] = {{0}};
        measure(context, atlas, (tc_rings_scheme)scheme, WIDTH, o.quick ? 20 : 1, level);
        for (int i = 0; i < RINGS_MAX_LEVELS; i++)
            if (level[i].vertices) {
                printf("%5d %8s %16.3e %12.3e\n", i, name, level[i].over_radius, level[i].pixels);
                if (o.csv)
                    fprintf(o.csv, "%d,%s,%.3e,%.3e\n", i, name, level[i].over_radius, level[i].pixels);
            }
    }
    tc_map_destroy(atlas);
    tc_context_destroy(context);
    return measure_end(&o);
}

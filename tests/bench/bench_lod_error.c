/* bench_lod_error.c - LH04's table 2 for our terrains: the columns of lod_error.csv.
 *
 * n = 255, W = 640, 90 degrees. Marks levels whose rms reaches 0.2 pixels or whose 99.9th percentile reaches 1 pixel.
 */
#include <math.h>
#include <stdio.h>

#include "common/core/clipmap/clipmap.h"
#include "common/core/clipmap/lod_error.h"
#include "tests/support/datasets.h"

static void measure(const dataset *d)
{
    tc_grid grid;
    tc_pyramid *p;
    tc_clipmap *c;
    if (!dataset_load(d, &grid))
        return;
    if (tc_pyramid_build(&grid, 0, &p, NULL) || tc_clipmap_create(p, &(tc_clipmap_options){.n = 255}, &c, NULL))
        return;
    for (int l = 1; l <= tc_clipmap_levels(c); l++) {
        tc_lod_error e;
        if (tc_lod_error_measure(p, tc_clipmap_pyramid_level(c, l), 255, 640, M_PI / 2, 0, &e))
            break;
        bool within = e.rms_px < 0.2 && e.p999_px < 1;
        printf("%s,%d,%g,%.3f,%.3f,%.2f,%.4f,%.3f,%.2f%s\n", d->name, l, e.spacing_m, e.rms_m, e.p999_m, e.max_m,
               e.rms_px, e.p999_px, e.max_px, within ? "" : "   <- above the bar");
    }
    tc_clipmap_destroy(c);
    tc_pyramid_destroy(p);
}

int main(void)
{
    const dataset sets[] = {{"default", 0, 0},
                            {"moon_gld100_256ppd_ne_4097.png", 118.45, 0},
                            {"srtm3_tatra_poland_4801.tif", 0, 0},
                            {"ps_height_1k.png", 160, 0.1}};
    printf("terrain,level,spacing_m,rms_m,p999_m,max_m,rms_px,p999_px,max_px\n");
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++)
        measure(&sets[i]);
    return 0;
}

/* bench_lod_error.c - LH04's table 2 for our terrains: lod_error.csv.
 *
 * n = 255, W = 640, 90 degrees; all flat terrains that there are, or, quick, those of at most 4 million samples and the
 * default one. The table on the terminal marks levels whose rms reaches 0.2 pixels or whose 99.9th percentile 1. */
#include <math.h>
#include <stdio.h>

#include "common/content/ground.h"
#include "common/measure/lod_error.h"
#include "tests/support/flat_data.h"
#include "tests/support/measure.h"

enum { WINDOW = 255, FRAME = 640, QUICK = 4000000 };

static bool measure(const measure_options *o, const dataset *d)
{
    tc_grid grid;
    tc_field *p;
    tc_clipmap *c;
    tc_error error;
    if (!flat_data_load(d, o->quick ? QUICK : 0, &grid))
        return true;
    if (tc_field_build(&grid, 0, &p, &error) || tc_ground_create(p, &(tc_ground_options){.n = WINDOW}, &c, &error)) {
        fprintf(stderr, "%s: %s\n", d->name, error.text);
        return false;
    }
    bool measured = true;
    for (int l = 1; l < tc_clipmap_levels(c) && measured; l++) { /* the finest has no error */
        tc_lod_error e;
        measured = tc_lod_error_measure(p, tc_clipmap_field_level(c, l), WINDOW, FRAME, M_PI / 2, 0, &e) == TC_OK;
        if (!measured)
            break;
        bool within = e.rms_px < 0.2 && e.p999_px < 1;
        printf("%-40s %5d %9g %9.3f %9.3f %9.2f %9.4f %9.3f %8.2f%s\n", d->name, l, e.spacing_m, e.rms_m, e.p999_m,
               e.max_m, e.rms_px, e.p999_px, e.max_px, within ? "" : "   <- above the bar");
        fflush(stdout);
        if (!o->csv)
            continue;
        measure_put_text(o->csv, d->name);
        fprintf(o->csv, ",%d,%g,%.3f,%.3f,%.2f,%.4f,%.3f,%.2f\n", l, e.spacing_m, e.rms_m, e.p999_m, e.max_m, e.rms_px,
                e.p999_px, e.max_px);
    }
    tc_clipmap_destroy(c);
    tc_field_destroy(p);
    return measured;
}

int main(int argc, char **argv)
{
    measure_options o = measure_begin(argc, argv, "terrain,level,spacing_m,rms_m,p999_m,max_m,rms_px,p999_px,max_px");
    printf("%-40s %5s %9s %9s %9s %9s %9s %9s %8s\n", "terrain", "level", "spacing m", "rms m", "99.9 % m", "max m",
           "rms px", "99.9 % px", "max px");
    dataset sets[DATASETS_MAX];
    int count = dataset_list(sets, DATASETS_MAX);
    bool measured = true;
    for (int i = 0; i < count; i++)
        measured &= measure(&o, &sets[i]);
    return measure_end(&o) || !measured;
}

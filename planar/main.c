/* main.c - planar-viewer: a terrain as a flat map of square nested grids. */
#include "square.h"

#include "common/app/options.h"
#include "common/app/viewer.h"
#include "common/base/numbers.h"

static bool read_n(void *n, const char *value)
{
    int *samples = n;
    return tc_read_int(value, 15, 2047, samples) && (*samples & (*samples + 1)) == 0;
}

int main(int argc, char **argv)
{
    static const tc_option options[] = {
        {.help = "Geometry clipmap"},
        {0, "n", "N", "2^k - 1 of 15..2047", "samples a side of each level's window (by the frame's width)", read_n,
         offsetof(tc_options, n)},
        TC_LEVELS_OPTION,
        TC_BUDGET_OPTION,
        TC_BUDGET_US_OPTION,
    };
    static const tc_scheme *const schemes[] = {tc_square_schemes, NULL};
    /* As wide as `make demo` has it, with half as many samples. */
    static const char *const synth[] = {"--size", "2049", "--spacing", "60", "--seed", "4", NULL};
    static const char *const pack[] = {"--rms", "1", NULL};
    static const tc_viewer_program program = {
        .name = "planar-viewer",
        .summary =
            "Shows any elevation file (.hgt, GeoTIFF, VRT, PNG, EXR, ...) as a watertight terrain, in a window or "
            "as a picture.",
        .body = &tc_plane_body,
        .navigation = &tc_plane_navigation,
        .schemes = schemes,
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .by_default = {"terrain", synth, pack},
    };
    return tc_viewer_main(&program, argc, argv);
}

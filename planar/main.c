/* main.c - planar-viewer: a terrain as a flat map of square nested grids. */
#include "square.h"

#include "common/shell/viewer.h"

int main(int argc, char **argv)
{
    static const tc_viewer_program program = {
        .name = "planar-viewer",
        .summary =
            "Shows any elevation file (.hgt, GeoTIFF, VRT, PNG, EXR, ...) as a watertight terrain, in a window or "
            "as a picture.",
        .make_surface = tc_square_create,
    };
    return tc_viewer_main(&program, argc, argv);
}

/* main.c - planet-viewer: a planet, or a part of one, on a globe. */
#include "faces.h"
#include "rings.h"

#include "common/app/options.h"
#include "common/app/viewer.h"
#include "common/base/numbers.h"

/* Steps of rings, or samples of the other schemes' windows: those say which numbers they take. */
static bool read_n(void *n, const char *value)
{
    return tc_read_int(value, TC_RINGS_LEAST_N_PHI, TC_RINGS_MOST_N_PHI, n);
}

static bool read_steps(void *steps, const char *value)
{
    return tc_read_int(value, TC_RINGS_LEAST_STEPS, TC_RINGS_MOST_STEPS, steps) && *(int *)steps % 2 == 0;
}

static bool read_radius(void *radius, const char *value)
{
    return tc_read_number(value, 1e-3, 1e12, radius);
}

int main(int argc, char **argv)
{
    static const tc_option options[] = {
        {.help = "Geometry clipmap"},
        TC_LEVELS_OPTION,
        TC_BUDGET_OPTION,
        TC_BUDGET_US_OPTION,
        {.help = "Planet"},
        TC_SCHEME_OPTION,
        {0, "n", "N", "a number of 64..4096",
         "steps of a ring around the viewer, a multiple of 32 (by the frame's width, 512 to 4096); of hex and cube "
         "samples a side of the windows, 2^k - 1 of 127 to 2047",
         read_n, offsetof(tc_options, n)},
        {0, "steps", "M", "an even number of 4..128",
         "steps outwards in a level of rings (as long as those around, N / 12.6, at most 128)", read_steps,
         offsetof(tc_options, steps)},
        {0, "ellipsoid", "NAME", TC_EXPECTED_ELLIPSOID,
         "that heights are above: wgs84, A,1/F (metres, inverse flattening) or sphere (by the file's coordinate "
         "system, "
         "else a sphere)",
         tc_read_ellipsoid, offsetof(tc_options, globe)},
        {0, "radius", "M", "metres of 0.001..1e12",
         "of a sphere instead (by the file's coordinate system, else the Earth's mean radius)", read_radius,
         offsetof(tc_options, globe.radius)},
    };
    static const tc_scheme *const schemes[] = {tc_rings_schemes, tc_faces_schemes, NULL};
    static const char *const synth[] = {"--kind", "planet", "--size", "2048", NULL};
    static const char *const pack[] = {"--planet", NULL};
    static const tc_viewer_program program = {
        .name = "planet-viewer",
        .summary =
            "Shows a map of a planet in longitude and latitude, or of a part of one, as a globe: from space to the "
            "ground, in a window or as a picture.",
        .body = &tc_sphere_body,
        .navigation = &tc_sphere_navigation,
        .schemes = schemes,
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .by_default = {"planet", synth, pack},
    };
    return tc_viewer_main(&program, argc, argv);
}

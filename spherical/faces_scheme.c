/* faces_scheme.c - what surfaces over faces differ by: charts, the distance that settles levels, and the passage
 * between them. A further one is a line here, its chart (common/chart) and two files in shaders/. */
#include <math.h>

#include "common/chart/atlas.h"
#include "faces_internal.h"

/* ---- Hexagons --------------------------------------------------------------------------------------------------- */

/* BN08's: a hexagon around the viewer, two of its sides along the parallel, as rows of samples are. What is a straight
 * way from the viewer is as far as it is in space, so that there is no end before the other side of the globe. */
static double hexagonal(const double d[3], double height)
{
    double flat = hypot(d[0], d[1]), away = flat > 0 ? sqrt(flat * flat + d[2] * d[2]) / flat : 1;
    double x = fabs(d[0]) * away, y = fabs(d[1]) * away;
    return fmax(fmax(y, 0.5 * sqrt(3) * x + 0.5 * y), height);
}

/* What chart_hex.glsl reads: the viewer by the formulas of both halves (common/chart/hex.c). */
static void place_hex(const faces_view *v, int chart, float (*vectors)[4], int32_t (*integers)[4])
{
    const double cells = (double)tc_faces_of(v)->cells;
    double t = M_SQRT2 * sin((M_PI / 2 - fabs(v->place[1])) / 2);
    double north = v->axes[2][2] / (1 + t); /* 1 - t, as |sine| = (1 - t) (1 + t) has it */
    double turn = v->place[0] / (M_PI / 2) - chart;
    turn -= 4 * floor((turn + 1.5) / 4);
    double rows = cells * (1 - north), from_south = cells * (1 + north);
    const faces_spot by_north = tc_faces_spot(rows * (1 - turn), rows * turn),
                     by_south = tc_faces_spot(cells - from_south * turn, rows - (cells - from_south * turn));
    tc_set4(vectors[0], by_north.rest[0], by_north.rest[1], by_south.rest[0], by_south.rest[1]);
    tc_set4(vectors[1], turn, north, t, 0);
    for (int k = 0; k < 2; k++)
        integers[0][k] = (int32_t)by_north.at[k], integers[0][2 + k] = (int32_t)by_south.at[k];
}

/* ---- Cube ------------------------------------------------------------------------------------------------------- */

/* PT's: in space. */
static double straight(const double d[3], double height)
{
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + height * height);
}

/* What chart_cube.glsl reads. */
static void place_cube(const faces_view *v, int chart, float (*vectors)[4], int32_t (*integers)[4])
{
    enum { X, Y, MIDDLE };
    const faces_surface *s = tc_faces_of(v);
    const tc_chart *c = &s->map->chart[chart];
    static const double at[3][2] = {[X] = {1, 0.5}, [Y] = {0.5, 1}, [MIDDLE] = {0.5, 0.5}};
    double axis[3][3], seen[3][3];
    for (int k = 0; k < 3; k++) {
        double place[3] = {0};
        c->class->to_place(c, at[k][0], at[k][1], &place[0], &place[1]);
        s->map->body.class->normal(&s->map->body, place, axis[k]);
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) { /* the middles of sides lie between the axes */
            if (k != MIDDLE)
                axis[k][i] = M_SQRT2 * axis[k][i] - axis[MIDDLE][i];
            axis[k][i] = rint(axis[k][i]);
        }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            seen[k][i] = v->axes[i][0] * axis[k][0] + v->axes[i][1] * axis[k][1] + v->axes[i][2] * axis[k][2];
    const faces_spot here = tc_faces_spot(v->chart[chart][0], v->chart[chart][1]);
    const double a = M_PI / 4 * (2 * v->chart[chart][0] / (double)s->cells - 1),
                 b = M_PI / 4 * (2 * v->chart[chart][1] / (double)s->cells - 1);
    const bool near = seen[MIDDLE][2] > 0 && fabs(tan(a)) < 1.5 && fabs(tan(b)) < 1.5;
    if (near)
        tc_set4(vectors[0], here.rest[0], here.rest[1], tan(a), tan(b));
    tc_set4(vectors[1], seen[MIDDLE][0], seen[MIDDLE][1], seen[MIDDLE][2], near);
    tc_set4(vectors[2], seen[X][0], seen[X][1], seen[X][2], cos(a));
    tc_set4(vectors[3], seen[Y][0], seen[Y][1], seen[Y][2], cos(b));
    for (int k = 0; k < 2 && near; k++)
        integers[0][k] = (int32_t)here.at[k];
}

/* ---- Tables ----------------------------------------------------------------------------------------------------- */

const faces_kind tc_faces_hex = {.name = "hex",
                                 .chart = &tc_chart_hex,
                                 .charts = 4,
                                 .metric = "distance_hex.glsl",
                                 .distance = hexagonal,
                                 .reach = 1.52,
                                 .bends = 0.1,
                                 .morphs = true,
                                 .place = place_hex};
const faces_kind tc_faces_cube = {.name = "cube",
                                  .chart = &tc_chart_cube,
                                  .charts = 6,
                                  .metric = "distance_cube.glsl",
                                  .distance = straight,
                                  .reach = 1.41,
                                  .morphs = true,
                                  .place = place_cube};
const faces_kind tc_faces_cube_pt = {.name = "cube-pt",
                                     .chart = &tc_chart_cube,
                                     .charts = 6,
                                     .metric = "distance_cube.glsl",
                                     .distance = straight,
                                     .reach = 1.41,
                                     .place = place_cube};

/* ---- Schemes ---------------------------------------------------------------------------------------------------- */

/* Samples a side of the windows that the frame alone calls for: a range is some half of what squares have of a window
 * of that size; and of those that there are. With a tolerance they may have to reach further. */
static int shaded_size(const tc_surface_request *request)
{
    if (request->n)
        return request->n;
    int n = 2 * tc_clipmap_n_for(request->camera) + 1;
    for (int i = 0; i < request->halvings && n > TC_FACES_LEAST_N; i++)
        n /= 2;
    return n < TC_FACES_LEAST_N ? TC_FACES_LEAST_N : n > TC_CLIPMAP_MAX_N ? TC_CLIPMAP_MAX_N : n;
}

static int size(const tc_surface_request *request)
{
    const int n = shaded_size(request);
    enum { MOST_WITHIN = 1023 }; /* in blocks of 8 x 8 cells */
    return request->n || !(request->error > 0) || n >= MOST_WITHIN || request->halvings ? n : 2 * n + 1;
}

static tc_status create(const tc_scheme *scheme, const tc_map *map, const tc_surface_request *request,
                        tc_surface **surface_ret, tc_error *error)
{
    const tc_faces_options options = {.kind = scheme->kind,
                                      .n = size(request),
                                      .shaded_n = request->error > 0 ? shaded_size(request) : 0,
                                      .max_levels = request->levels,
                                      .normals = request->needs->normals,
                                      .fine_normals = request->needs->fine_normals,
                                      .holes = request->needs->holes};
    return tc_faces_create(map, &options, surface_ret, error);
}

const tc_scheme tc_faces_schemes[] = {
    {"hex", "hexagonal geometry clipmaps", &tc_sphere_body, size, create, &tc_atlas_hex, &tc_faces_hex, true},
    {"cube", "chunks of a cube's faces, passing over into each other", &tc_sphere_body, size, create, &tc_atlas_cube,
     &tc_faces_cube, true},
    {"cube-pt", "the same without a passage", &tc_sphere_body, size, create, &tc_atlas_cube, &tc_faces_cube_pt, false},
    {0}};

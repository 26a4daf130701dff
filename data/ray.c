/* ray.c - where a ray meets a terrain: of a flat one's mesh, or of a packed planet's surface, as the viewers stand on
 * them; holes let it through. A flat one has sides, straight down; beside a part of a planet there is the planet. The
 * walk goes an eighth of the data's samples at a time: what is met for less may be missed. */
#include "ray.h"

#include "common/base/status.h"
#include "common/field/field.h"
#include "common/view/flight.h"
#include "common/view/pick.h"

#include <math.h>
#include <stdio.h>

typedef struct target {
    const tc_map *map;
    tc_status status; /* of reading it */
} target;

static double ground_height(void *context, double x, double y)
{
    target *t = context;
    double z = 0;
    bool hole = false;
    tc_status status = tc_map_height(t->map, x, y, &z);
    if (status == TC_OK)
        status = tc_map_hole(t->map, x, y, &hole);
    if (status != TC_OK)
        t->status = status;
    return hole ? -INFINITY : z;
}

/* Bounds of the ground, synthesised or not, metres absolute. */
static void bounds(const tc_map *map, double *lowest_ret, double *highest_ret)
{
    const tc_range range = tc_map_range(map);
    const double z_base = tc_field_info(tc_map_field(map, 0))->z_base;
    *lowest_ret = z_base + (double)range.lo, *highest_ret = z_base + (double)range.hi;
    if (tc_map_radius(map) > 0) /* what is no map's is at 0 */
        *lowest_ret = fmin(*lowest_ret, 0), *highest_ret = fmax(*highest_ret, 0);
}

/* The part of a ray that is over a flat map, which ends with its outermost samples, and below which there is nothing;
 * false: none. */
static bool cut_to_map(const tc_map *map, double spacing, double lowest, const double eye[3], const double way[3],
                       double *from, double *to)
{
    double low[2], high[2];
    tc_map_extent(map, low, high);
    *from = 0, *to = INFINITY;
    for (int k = 0; k < 2; k++) {
        const double beside = 1e-9 * spacing; /* what rounding puts a point on the edge off it by */
        const double a = low[k] - beside - eye[k], b = high[k] + beside - eye[k];
        if (way[k] == 0 && !(a <= 0 && b >= 0))
            return false;
        if (way[k] != 0) {
            *from = fmax(*from, fmin(a / way[k], b / way[k]));
            *to = fmin(*to, fmax(a / way[k], b / way[k]));
        }
    }
    if (way[2] < 0)
        *to = fmin(*to, fmax((lowest - spacing - eye[2]) / way[2], *from));
    return *from <= *to;
}

/* Without what arithmetic leaves behind a number's last digit that means something. */
static double rounded(double v, double places)
{
    return rint(v * places) / places + 0.0; /* no -0 */
}

tc_status tc_ray_tell(const tc_map *map, const char *name, const char *text, tc_error *error)
{
    const bool flat = tc_map_radius(map) == 0;
    const tc_navigation *navigation = flat ? &tc_plane_navigation : &tc_sphere_navigation;
    const tc_field *field = tc_map_field(map, 0);
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    tc_pose eye;
    if (!tc_pose_parse(navigation, text, &eye))
        return tc_fail(error, TC_ERR_USAGE, "--ray: expected %s, found '%s'", navigation->bounds, text);
    target t = {.map = map};
    const double spacing = fmin(finest.spacing_x, finest.spacing_y);
    double lowest, highest;
    bounds(map, &lowest, &highest);
    const tc_ground ground = {ground_height, &t, spacing, map->body};
    const tc_scenery straight = {.navigation = navigation, .ground = &ground, .fov = 1, .width = 1, .height = 1};
    /* What is made up is no steeper than that, or thinner. */
    const tc_ray_steps steps = {.by_height = 0.1,
                                .shortest = 0.125 * spacing,
                                .longest = ldexp(0.125 * spacing, map->synthesised),
                                .most = INT64_MAX};
    const double place[3] = {eye.x, eye.y, eye.z};
    double way[3], p[3], met[3], from = 0, to = 4 * (tc_map_radius(map) + fabs(eye.z) + fabs(highest)), distance = 0;
    tc_pixel_ray(&straight, &eye, 0.5, 0.5, way);
    bool meets = !flat || cut_to_map(map, spacing, lowest, place, way, &from, &to);
    for (int i = 0; i < 3; i++)
        p[i] = place[i] + from * way[i];
    const double below = meets ? ground_height(&t, p[0], p[1]) - p[2] : 0;
    if (below > 0 && from == 0)
        return tc_fail(error, TC_ERR_IO, "--ray: expected an eye above the ground of %s, found one %.3f m below it",
                       name, below);
    if (below > 0) /* the side of a flat one */
        distance = from;
    else
        meets = meets && tc_meet_ground(&ground, place, way, highest, from, to, &steps, &distance, p);
    if (t.status != TC_OK)
        return tc_fail(error, t.status, "%s: cannot be read: %s", name, tc_status_text(t.status));
    if (!meets || !map->body.class->place(&map->body, p, met))
        return tc_fail(error, TC_ERR_IO, "--ray: expected a ray that meets the ground of %s, found one that does not",
                       name);
    const double places = flat ? 1e6 : 1e9;
    printf("%.10g %.10g %.10g %.10g\n", rounded(met[0] / navigation->unit, places),
           rounded(met[1] / navigation->unit, places), rounded(met[2], 1e6), rounded(distance, 1e6));
    return TC_OK;
}

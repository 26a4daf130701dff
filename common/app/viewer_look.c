/* viewer_look.c - where a viewer's eye starts: by a path, a view, a place to look at, or with all of the terrain in
 * sight. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "common/view/look_at.h"
#include "find_place.h"

#include <math.h>

void tc_viewer_say_lifted(tc_viewer *v, double below)
{
    if (!v->lifted && below > 0)
        tc_viewer_tell(v, TC_TOLD_WARNING, "the eye was %.6g m under the ground: lifted above it", below);
    v->lifted |= below > 0;
}

/* ---- Views that were meant otherwise ----------------------------------------------------------------------------- */

static void warn(tc_viewer *v, const char *meant, const char *instead)
{
    tc_viewer_tell(
        v, TC_TOLD_WARNING,
        "--view: %.9g,%.9g are metres from the south-west sample, and look like %s, which are on the terrain: %s",
        v->options.view.x, v->options.view.y, meant, instead);
}

/* Of a flat map: longitude and latitude, or coordinates of its own system, that are taken for metres from its
 * south-west sample. Such a place is beside the terrain; or degrees name a corner of it so small that no view is from
 * there. */
static void check_view(tc_viewer *v)
{
    const double corner = 100; /* times as wide as that is all of it */
    const tc_map *map = v->map;
    const double x = v->options.view.x, y = v->options.view.y;
    char instead[2 * TC_POSE_TEXT];
    double lo[2], hi[2], place[2];
    tc_map_extent(map, lo, hi);
    const bool beside = x < lo[0] || x > hi[0] || y < lo[1] || y > hi[1];
    const bool tiny = hi[0] - lo[0] > corner * 360 && hi[1] - lo[1] > corner * 90;
    if (map->body.radius > 0 || !map->georef.known)
        return;
    if (fabs(x) <= 360 && fabs(y) <= 90 && (beside || tiny) &&
        tc_find_place(map, v->options.terrain, "--view", x, y, place, NULL) == TC_OK) {
        snprintf(instead, sizeof instead, "--lookat %.9g,%.9g looks at that place", x, y);
        warn(v, "longitude and latitude", instead);
    } else if (beside && !map->georef.geographic && tc_find_georeferenced(map, x, y, place)) {
        snprintf(instead, sizeof instead, "there it is --view %.9g,%.9g,...", place[0], place[1]);
        warn(v, "coordinates of its own system", instead);
    }
}

/* ---- A place to look at ------------------------------------------------------------------------------------------ */

/* From where some kilometres around a place are seen, of a coarse map as many as a hundred samples, of a small one a
 * quarter of it. */
static double default_distance(const tc_viewer *v)
{
    double lo[2], hi[2];
    tc_map_extent(v->map, lo, hi);
    const double unit = v->map->body.radius > 0 ? v->map->body.radius : 1;
    const double extent = unit * hypot(hi[0] - lo[0], hi[1] - lo[1]);
    const double data = ldexp(v->spacing, v->map->synthesised), distance = fmin(extent / 4, fmax(5000, 100 * data));
    return distance > 0 ? distance : 1; /* a map of one sample has no extent */
}

static tc_status look_at(tc_viewer *v, tc_pose *view_ret, tc_error *error)
{
    const tc_look *look = &v->options.look;
    double place[3] = {0, 0, look->height * v->map->exaggeration}, z;
    tc_status status =
        tc_find_place(v->map, v->options.terrain, "--lookat", look->longitude, look->latitude, place, error);
    if (status == TC_OK && !look->has_height &&
        (status = tc_map_height(v->map, place[0], place[1], &place[2])) != TC_OK)
        return tc_fail(error, status, "%s: cannot be read: %s", v->options.terrain, tc_status_text(status));
    if (status != TC_OK)
        return status;
    if (v->map->body.radius > 0 && place[2] <= -0.999 * v->map->body.radius)
        return tc_fail(error, TC_ERR_USAGE, "--lookat: expected a height above the middle of %s, found %.9g m",
                       v->options.terrain, look->height);
    const double distance = look->distance > 0 ? look->distance : default_distance(v);
    *view_ret = tc_look_at(&v->map->body, place, look->heading, look->pitch, distance);
    v->program->navigation->settle(view_ret);
    /* Over what stands in the way of the eye it still looks there. */
    if (tc_map_has_ground(v->map, view_ret->x, view_ret->y) &&
        tc_map_height(v->map, view_ret->x, view_ret->y, &z) == TC_OK && view_ret->z < z) {
        tc_viewer_say_lifted(v, z - view_ret->z);
        view_ret->z = z + v->least_height;
        tc_look_towards(&v->map->body, place, view_ret);
    }
    return TC_OK;
}

/* ---- The first view ---------------------------------------------------------------------------------------------- */

/* Pictures find the ground below their eye themselves; in a window what flies is kept above the ground without a word,
 * so that views that were asked for are looked at here. */
static void lift_asked(tc_viewer *v, tc_pose *view)
{
    double z;
    if (!tc_viewer_at_sea(v, view->x, view->y, &z) &&
        (!tc_map_has_ground(v->map, view->x, view->y) || tc_map_height(v->map, view->x, view->y, &z) != TC_OK))
        return;
    tc_viewer_say_lifted(v, z - view->z);
    view->z = fmax(view->z, z + v->least_height);
}

tc_status tc_viewer_first_view(tc_viewer *v, tc_pose *view_ret, tc_error *error)
{
    const tc_navigation *navigation = v->program->navigation;
    tc_status status = TC_OK;
    if (v->options.path) {
        status = tc_flight_path_load(navigation, v->options.path, &v->path, error);
        if (status == TC_OK)
            *view_ret = v->path.keys[0];
    } else if (v->options.look.given) {
        status = look_at(v, view_ret, error);
    } else if (v->options.has_view) {
        *view_ret = v->options.view;
        check_view(v);
    } else {
        *view_ret = tc_viewer_whole(v);
    }
    if (status != TC_OK || !tc_viewer_interactive(&v->options))
        return status;
    lift_asked(v, view_ret);
    for (int k = 0; k < v->path.count; k++)
        lift_asked(v, &v->path.keys[k]);
    return TC_OK;
}

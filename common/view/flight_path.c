/* flight_path.c - Catmull-Rom curves through the keys of a path file.
 *
 * The curve is the uniform one: each stretch between two keys takes the same time and the velocity is continuous, so
 * that whoever writes the keys sets the pace by their distances. At its ends the path goes on straight
 * (p_-1 = 2 p_0 - p_1), which makes evenly spaced keys on a line an even flight. On a globe longitudes, latitudes and
 * headings are those of flight_sphere.c. */
#include "flight_path.h"
#include "common/base/status.h"
#include "flight_sphere.h"
#include "views_file.h"

#include <math.h>
#include <stdlib.h>

#define HALF_TURN 3.14159265358979323846

/* Appends a key. */
static bool add_key(tc_flight_path *path, int *capacity, tc_pose key)
{
    if (path->count == *capacity) {
        int more = *capacity ? 2 * *capacity : 64;
        tc_pose *keys = realloc(path->keys, (size_t)more * sizeof *keys);
        if (!keys)
            return false;
        path->keys = keys;
        *capacity = more;
    }
    if (path->count > 0) /* the short way round */
        key.heading += 2 * HALF_TURN * round((path->keys[path->count - 1].heading - key.heading) / (2 * HALF_TURN));
    double period = path->navigation->x_period;
    if (path->count > 0 && period > 0)
        key.x += period * round((path->keys[path->count - 1].x - key.x) / period);
    path->keys[path->count++] = key;
    return true;
}

tc_status tc_flight_path_parse(const tc_navigation *navigation, const char *name, const char *text,
                               tc_flight_path *path_ret, tc_error *error)
{
    tc_flight_path path = {.navigation = navigation};
    tc_views views = tc_views_of(navigation, name, text);
    int capacity = 0;
    bool more = true;
    tc_status status = TC_OK;
    while (status == TC_OK && more) {
        status = tc_views_next(&views, &more, error);
        if (status == TC_OK && more && !add_key(&path, &capacity, views.view))
            status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for the path", name);
    }
    if (status == TC_OK && path.count == 0)
        status = tc_fail(error, TC_ERR_FORMAT, "%s: expected lines of %s, found none", name,
                         navigation->x_period > 0 ? navigation->bounds : navigation->form);
    if (status == TC_OK)
        *path_ret = path;
    else
        tc_flight_path_free(&path);
    return status;
}

tc_status tc_flight_path_load(const tc_navigation *navigation, const char *path, tc_flight_path *path_ret,
                              tc_error *error)
{
    char *text;
    tc_status status = tc_views_read(path, "a path file", &text, error);
    if (status != TC_OK)
        return status;
    status = tc_flight_path_parse(navigation, path, text, path_ret, error);
    free(text);
    return status;
}

void tc_flight_path_free(tc_flight_path *path)
{
    free(path->keys);
    *path = (tc_flight_path){0};
}

/* Number of a view's components, and one of them. */
enum { COMPONENTS = 5 };
static double *component(tc_pose *view, int i)
{
    double *const all[COMPONENTS] = {&view->x, &view->y, &view->z, &view->heading, &view->pitch};
    return all[i];
}

tc_pose tc_flight_path_view(const tc_flight_path *path, int frame, int frames)
{
    int last = path->count - 1;
    double at = frames > 1 ? (double)frame / (frames - 1) * last : 0;
    int i = (int)fmax(0, fmin(floor(at), last - 1));
    if (last == 0 || at <= 0)
        return path->keys[0];
    double t = at - i;
    bool globe = path->navigation->x_period > 0;
    if (globe && t <= 0)
        return path->keys[i];
    if (t >= 1)
        return path->keys[i + 1];
    tc_pose p[4] = {path->keys[i > 0 ? i - 1 : 0], path->keys[i], path->keys[i + 1],
                    path->keys[i + 2 <= last ? i + 2 : last]};
    tc_pose view;
    for (int c = 0; c < COMPONENTS; c++) {
        double q[4];
        for (int k = 0; k < 4; k++)
            q[k] = *component(&p[k], c);
        if (i == 0)
            q[0] = 2 * q[1] - q[2];
        if (i + 2 > last)
            q[3] = 2 * q[2] - q[1];
        *component(&view, c) = tc_catmull_rom(q[0], q[1], q[2], q[3], t);
    }
    if (globe)
        tc_flight_on_sphere(p, i == 0, i + 2 > last, t, &view);
    /* The curve swings beyond its keys. */
    view.pitch = fmax(-HALF_TURN / 2, fmin(HALF_TURN / 2, view.pitch));
    path->navigation->settle(&view);
    return view;
}

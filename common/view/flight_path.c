/* flight_path.c - Catmull-Rom curves through the keys of a path file.
 *
 * The curve is the uniform one: each stretch between two keys takes the same time and the velocity is continuous, so
 * that whoever writes the keys sets the pace by their distances. At its ends the path goes on straight
 * (p_-1 = 2 p_0 - p_1), which makes evenly spaced keys on a line an even flight. On a globe longitudes, latitudes and
 * headings are those of flight_sphere.c. */
#include "flight_path.h"
#include "common/base/status.h"
#include "flight_sphere.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HALF_TURN 3.14159265358979323846

enum { MAX_FILE = 16 << 20 }; /* bytes; more is no path file */

/* What a line must be. */
static const char *form_of(const tc_navigation *navigation)
{
    return navigation->x_period > 0 ? navigation->bounds : navigation->form;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

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
    int capacity = 0, number = 0;
    for (const char *line = text; *line;) {
        const char *next = line + strcspn(line, "\n");
        const char *begin = line, *end = line + strcspn(line, "#\n");
        number++;
        while (begin < end && is_blank(*begin))
            begin++;
        while (begin < end && is_blank(end[-1]))
            end--;
        if (begin < end) {
            char content[256];
            size_t length = (size_t)(end - begin);
            tc_pose key;
            bool fits = length < sizeof content;
            snprintf(content, sizeof content, "%.*s", (int)(fits ? length : sizeof content - 1), begin);
            if (!fits || !tc_pose_parse(navigation, content, &key)) {
                tc_flight_path_free(&path);
                return tc_fail(error, TC_ERR_FORMAT, "%s: line %d: expected %s, found '%.60s%s'", name, number,
                               form_of(navigation), content, strlen(content) > 60 ? "..." : "");
            }
            if (!add_key(&path, &capacity, key)) {
                tc_flight_path_free(&path);
                return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for the path", name);
            }
        }
        line = *next ? next + 1 : next;
    }
    if (path.count == 0)
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected lines of %s, found none", name, form_of(navigation));
    *path_ret = path;
    return TC_OK;
}

tc_status tc_flight_path_load(const tc_navigation *navigation, const char *path, tc_flight_path *path_ret,
                              tc_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    /* In pieces: a pipe has no size to ask for. */
    char *text = NULL;
    size_t length = 0, capacity = 0;
    tc_status status = TC_OK;
    while (status == TC_OK && !feof(file)) {
        if (length + 4096 > capacity) {
            capacity = capacity ? 2 * capacity : 1 << 14;
            char *more = capacity <= MAX_FILE ? realloc(text, capacity) : NULL;
            if (!more) {
                status = tc_fail(error, TC_ERR_FORMAT, "%s: too long for a path file", path);
                break;
            }
            text = more;
        }
        length += fread(text + length, 1, capacity - length - 1, file);
        if (ferror(file))
            status = tc_fail(error, TC_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
    }
    fclose(file);
    if (status == TC_OK) {
        text[length] = '\0';
        if (strlen(text) != length)
            status = tc_fail(error, TC_ERR_FORMAT, "%s: expected text, found zero bytes", path);
    }
    if (status == TC_OK)
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

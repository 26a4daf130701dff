/* viewer_display.c - what a viewer's window tells: fills a display (display.h) for each frame from what is shown and
 * how, and does what the user did in it. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "interrupt.h"
#include "panel.h"
#include "viewer_place.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static const double HINT_SECONDS = 10, HINT_FADING = 1.5;
static const double LOADING_MS = 250; /* that it must have lasted to be told */
static const double SCALE_PIXELS = 160;
static const double LOOK_MS = 30; /* between looks at what is seen */

struct tc_viewer_display {
    tc_display display;
    tc_display_result result;
    pthread_mutex_t telling; /* lines, by any thread */
    tc_display_lines lines;
    tc_panel panel;
    tc_places *places; /* of this map; NULL: none yet */
    const tc_map *places_of;
    bool off, help, panel_shown;
    bool unable;           /* the window has none */
    double begun;          /* milliseconds of tc_clock_ms(): of the first frame; 0: none yet */
    double loading;        /* since when; 0: all is there */
    double looked;         /* when, */
    bool turn;             /* at which of two things: */
    bool pointed;          /* the ground is under the pointer, */
    double point[3];       /* here; */
    double metres_a_pixel; /* of the ground in the middle of the picture; 0: there is none */
    double ms;             /* that the last frame's display took */
};

void tc_viewer_display_line(tc_viewer *v, bool warning, const char *text)
{
    if (!v->display)
        return;
    pthread_mutex_lock(&v->display->telling);
    tc_display_lines_add(&v->display->lines, warning, tc_clock_ms(), text);
    pthread_mutex_unlock(&v->display->telling);
}

static void show_lines(struct tc_viewer_display *d, double now)
{
    pthread_mutex_lock(&d->telling);
    tc_display_lines_show(&d->lines, now, &d->display);
    pthread_mutex_unlock(&d->telling);
}

/* ---- What is told ------------------------------------------------------------------------------------------------ */

static void tell_hint(struct tc_viewer_display *d, double now)
{
    const double left = HINT_SECONDS - (now - d->begun) / 1e3;
    if (left > 0 && !d->help)
        tc_display_say(&d->display, TC_SIDE_TOP, false, fmin(1, left / HINT_FADING),
                       "H: help   Tab: settings   O: display off");
}

/* The share of the levels that the view asks for which are up to date. */
static void tell_loading(const tc_viewer *v, const tc_frame_stats *frame, double now)
{
    struct tc_viewer_display *d = v->display;
    const tc_renderer_use use = tc_renderer_used(v->renderer);
    int held = 0, ready = 0;
    d->loading = frame->resident ? 0 : d->loading > 0 ? d->loading : now;
    if (d->loading == 0 || now - d->loading < LOADING_MS)
        return;
    for (int chart = 0; chart < use.windows->charts; chart++)
        held += use.textures->layers.held[chart], ready += use.textures->layers.ready[chart];
    if (ready < held)
        tc_display_say(&d->display, TC_SIDE_CORNER, false, 1, "loading: %d of %d levels", ready, held);
    else
        tc_display_say(&d->display, TC_SIDE_CORNER, false, 1, "loading ...");
}

static void tell_state(const tc_viewer *v, const tc_frame_stats *frame)
{
    tc_display *display = &v->display->display;
    tc_display_say(display, TC_SIDE_CORNER, false, 1, "%.1f ms", v->recent_ms);
    if (frame->throttle > 0.05)
        tc_display_say(display, TC_SIDE_CORNER, true, 1, "coarser while it moves: too slow");
    if (v->quality.samples < v->quality.full)
        tc_display_say(display, TC_SIDE_CORNER, true, 1, "%d of %d samples a pixel while it moves: too slow",
                       v->quality.samples, v->quality.full);
    if (v->map->exaggeration != 1)
        tc_display_say(display, TC_SIDE_CORNER, false, 1, "heights x %.4g", v->map->exaggeration);
    if (v->scene.frame.cull_camera)
        tc_display_say(display, TC_SIDE_CORNER, false, 1, "culling frozen");
    if (v->failing || frame->imagery_failed)
        tc_display_say(display, TC_SIDE_CORNER, true, 1, "a part cannot be read");
}

static void tell_credits(tc_display *display, const tc_credits *credits)
{
    for (int i = 0; i < credits->count; i++)
        tc_display_say(display, TC_SIDE_LEFT, false, 1, "%s", credits->line[i]);
}

static void tell_files(const tc_viewer *v)
{
    tc_display *display = &v->display->display;
    const tc_options *o = &v->options;
    if (o->imagery_count > 0)
        tc_display_say(display, TC_SIDE_LEFT, false, 1, "%s%s", tc_viewer_file_name(o->imagery[o->imagery_count - 1]),
                       o->imagery_count > 1 ? " and others" : "");
    if (o->imagery_count > 0)
        tell_credits(display, &v->imagery_credits);
    tc_display_say(display, TC_SIDE_LEFT, false, 1, "%s", tc_viewer_file_name(o->terrain));
    tell_credits(display, &v->terrain_credits);
}

/* Digits of a place that are as fine as what is seen from this height. */
static int digits_from(double above)
{
    return (int)fmax(2, fmin(6, round(8 - log10(fmax(above, 1)))));
}

/* What is seen under the pointer and in the middle of the picture: one of them now and then, since a ray that grazes
 * the ground takes its time. */
static void look_around(tc_viewer *v, double now)
{
    struct tc_viewer_display *d = v->display;
    double point[3], distance;
    if (now - d->looked < LOOK_MS)
        return;
    d->looked = now;
    d->turn = !d->turn;
    if (d->turn)
        d->pointed = d->result.pointed && tc_viewer_point(v, d->result.x, d->result.y, d->point, &distance);
    else
        d->metres_a_pixel = tc_viewer_point(v, v->camera.width / 2.0, v->camera.height / 2.0, point, &distance)
                                ? distance / tc_camera_pixel_scale(&v->camera)
                                : 0;
}

static void tell_places(const tc_viewer *v)
{
    struct tc_viewer_display *d = v->display;
    const tc_camera *eye = &v->camera;
    char place[TC_WORDS], height[TC_WORDS], above[TC_WORDS];
    const double ground = v->ground.height(v->ground.context, eye->x, eye->y);
    const double exaggeration = v->map->exaggeration; /* all heights are told as they are without it */
    const int digits = digits_from(eye->z - ground);
    if (d->pointed && d->result.pointed) {
        tc_places_words(d->places, v->map, d->point[0], d->point[1], digits, place);
        tc_words_metres(d->point[2] / exaggeration, height);
        tc_display_say(&d->display, TC_SIDE_RIGHT, false, 1, "pointer %s, %s", place, height);
    }
    tc_places_words(d->places, v->map, eye->x, eye->y, digits, place);
    tc_display_say(&d->display, TC_SIDE_RIGHT, false, 1, "eye %s", place);
    tc_words_metres(eye->z / exaggeration, height);
    tc_words_metres((eye->z - ground) / exaggeration, above);
    if (tc_map_has_ground(v->map, eye->x, eye->y))
        tc_display_say(&d->display, TC_SIDE_RIGHT, false, 1, "height %s, %s above ground", height, above);
    else
        tc_display_say(&d->display, TC_SIDE_RIGHT, false, 1, "height %s", height);
    /* The scale is that across the view. */
    d->display.scale_pixels =
        tc_words_scale(d->metres_a_pixel, fmin(SCALE_PIXELS, v->camera.width / 3.0), d->display.scale);
}

static void fill(tc_viewer *v, const tc_frame_stats *frame)
{
    struct tc_viewer_display *d = v->display;
    const double now = tc_clock_ms();
    if (d->begun == 0)
        d->begun = now;
    if (d->places_of != v->map) {
        tc_places_close(d->places);
        d->places = tc_places_open(v->map);
        d->places_of = v->map;
    }
    d->display.texts = d->display.rows = 0;
    d->display.heading = v->camera.heading;
    d->display.help = d->help, d->display.panel = d->panel_shown;
    show_lines(d, now);
    tell_hint(d, now);
    tell_files(v);
    if (frame && v->renderer) {
        tell_loading(v, frame, now);
        tell_state(v, frame);
        look_around(v, now);
        tell_places(v);
    }
    if (d->panel_shown && v->renderer)
        d->display.rows = tc_panel_rows(&d->panel, v, d->display.row);
}

static bool shown(const tc_viewer *v)
{
    return v->display && !v->display->off && !v->display->unable;
}

void tc_viewer_display_show(tc_viewer *v, const tc_frame_stats *frame)
{
    struct tc_viewer_display *d = v->display;
    const double start = tc_clock_ms();
    if (!d)
        return;
    d->ms = 0;
    if (!shown(v))
        return;
    fill(v, frame);
    d->unable = !v->window_plugin->show(v->window, &d->display, &d->result);
    d->ms = tc_clock_ms() - start;
}

/* What else is shown stays as it was; what the user does in it is not heard. */
void tc_viewer_display_work(tc_viewer *v, const tc_display_work *work)
{
    struct tc_viewer_display *d = v->display;
    tc_display_result unused;
    if (!shown(v))
        return;
    d->display.texts = 0;
    show_lines(d, tc_clock_ms());
    d->display.work = *work;
    d->unable = !v->window_plugin->show(v->window, &d->display, &unused);
    d->display.work = (tc_display_work){.name = ""};
}

double tc_viewer_display_ms(const tc_viewer *v)
{
    return v->display ? v->display->ms : 0;
}

/* ---- What is done ------------------------------------------------------------------------------------------------ */

/* Shows a file; whether it is another terrain, seen by *view_ret. */
static bool show_file(tc_viewer *v, const char *path, bool picture, tc_pose *view_ret)
{
    tc_error error;
    bool opened = false;
    if (!v->renderer || tc_interrupted())
        return false;
    const tc_status status = tc_viewer_drop(v, path, picture, &opened, view_ret, &error);
    if (status != TC_OK)
        tc_viewer_tell(v, TC_TOLD_FAILURE, "%s", error.text);
    else
        tc_viewer_tell(v, TC_TOLD_DONE, "%s: %s", tc_viewer_file_name(path),
                       opened ? "opened" : "laid over the terrain");
    return opened;
}

static bool change_row(tc_viewer *v, tc_pose *view_ret, int *key_ret)
{
    const tc_display_result *r = &v->display->result;
    bool picture, opened = false;
    tc_error error;
    const int row = r->changed, key = tc_panel_key(row, r->value);
    if (key) {
        *key_ret = key;
    } else if (tc_panel_is_file(row, &picture)) {
        char path[TC_DISPLAY_ENTRY];
        memcpy(path, r->entry, sizeof path);
        opened = show_file(v, path, picture, view_ret);
    } else if (tc_panel_set(&v->display->panel, v, row, r->value, &error) != TC_OK) {
        tc_viewer_tell(v, TC_TOLD_FAILURE, "%s", error.text);
    }
    return opened;
}

bool tc_viewer_display_act(tc_viewer *v, const tc_window_input *input, tc_pose *view_ret, int *key_ret)
{
    struct tc_viewer_display *d = v->display;
    bool opened = false;
    *key_ret = 0;
    if (shown(v)) {
        *key_ret = d->result.north ? 'N' : 0;
        d->help &= !d->result.help_closed;
        d->panel_shown &= !d->result.panel_closed;
        if (d->result.changed >= 0)
            opened = change_row(v, view_ret, key_ret);
        d->result.changed = -1, d->result.north = d->result.help_closed = d->result.panel_closed = false;
    }
    /* While a file is loaded the next events come, and with them other names. */
    const char *dropped[TC_WINDOW_MAX_DROPPED];
    for (int i = 0; i < input->dropped_count; i++)
        dropped[i] = tc_viewer_keep(v, input->dropped[i]);
    for (int i = 0; i < input->dropped_count; i++)
        opened |= dropped[i] && show_file(v, dropped[i], false, view_ret);
    tc_viewer_tell_left_out(v, input);
    if (d && opened) /* another map may lie where one lay before */
        d->places_of = NULL;
    return opened;
}

/* ---- Keys -------------------------------------------------------------------------------------------------------- */

bool tc_viewer_display_help(tc_viewer *v)
{
    if (!shown(v))
        return false;
    v->display->help = !v->display->help;
    return true;
}

void tc_viewer_display_panel(tc_viewer *v)
{
    if (v->display) {
        v->display->panel_shown = v->display->off || !v->display->panel_shown;
        v->display->off = false;
    }
}

void tc_viewer_display_toggle(tc_viewer *v)
{
    if (v->display)
        v->display->off = !v->display->off;
}

bool tc_viewer_display_dismiss(tc_viewer *v)
{
    bool *open = !shown(v) ? NULL : v->display->help ? &v->display->help : &v->display->panel_shown;
    const bool was = open && *open;
    if (was)
        *open = false;
    return was;
}

/* ---- Beginning and end ------------------------------------------------------------------------------------------- */

tc_status tc_viewer_display_open(tc_viewer *v, tc_error *error)
{
    if (v->options.no_display || v->options.path || !tc_viewer_interactive(&v->options))
        return TC_OK;
    struct tc_viewer_display *d = v->display = calloc(1, sizeof *d);
    if (!d)
        return tc_fail(error, TC_ERR_MEMORY, "display: not enough memory");
    pthread_mutex_init(&d->telling, NULL);
    d->result.changed = -1;
    tc_display_key *key = d->display.key;
    for (int k = 0; k < TC_DISPLAY_KEYS && tc_viewer_key(k, &key[k].label, &key[k].help); k++)
        d->display.keys = k + 1;
    return TC_OK;
}

void tc_viewer_display_close(tc_viewer *v)
{
    if (!v->display)
        return;
    tc_places_close(v->display->places);
    pthread_mutex_destroy(&v->display->telling);
    free(v->display);
    v->display = NULL;
}

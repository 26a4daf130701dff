/* viewer_window.c - the viewer's window: keys and flight.
 *
 * What a key does is one line of the table; the help text comes from it. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "common/gl/frame_timer.h"
#include "common/view/gestures.h"
#include "interrupt.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What is true while the window is open. */
typedef struct session {
    tc_viewer *viewer;
    tc_flight flight, start;
    tc_gestures gestures;
    tc_scenery scenery;  /* of the present frame */
    bool captured;       /* the mouse turns the view, after the keys handled so far */
    tc_camera frozen;    /* culled for, while culling is frozen */
    bool picture_wanted; /* once the frame is drawn */
    bool quit;
    int picture_number; /* to try next */
    int key;            /* that is handled */
    tc_telling telling;
} session;

/* ---- Keys --------------------------------------------------------------------------------------------------- */

/* Hands the renderer the changed scene and tells the user. */
static void changed(session *s, const char *name, bool on)
{
    tc_renderer_set_options(s->viewer->renderer, &s->viewer->scene);
    tc_viewer_tell(s->viewer, TC_TOLD_DONE, "%s %s", name, on ? "on" : "off");
}

static void do_help(session *s)
{
    if (!tc_viewer_display_help(s->viewer))
        tc_viewer_print_keys(stderr);
}

static void do_panel(session *s)
{
    tc_viewer_display_panel(s->viewer);
}

static void do_display(session *s)
{
    tc_viewer_display_toggle(s->viewer);
}

static void do_wireframe(session *s)
{
    bool *on = &s->viewer->scene.wireframe;
    *on = !*on;
    changed(s, "wireframe", *on);
}

static void do_level_colours(session *s)
{
    bool *on = &s->viewer->scene.level_colours;
    *on = !*on;
    changed(s, "level colours", *on);
}

static void do_morph(session *s)
{
    bool *off = &s->viewer->scene.frame.no_morph;
    *off = !*off;
    changed(s, "morph", !*off);
}

static void do_freeze(session *s)
{
    tc_frame_options *frame = &s->viewer->scene.frame;
    s->frozen = s->viewer->camera;
    frame->cull_camera = frame->cull_camera ? NULL : &s->frozen;
    changed(s, "frozen culling", frame->cull_camera != NULL);
}

/* On to the next one that draws the file; why others do not is told. */
static void do_scheme(session *s)
{
    tc_viewer *v = s->viewer;
    const tc_scheme *now = tc_viewer_scheme(v), *next = now;
    const tc_camera *frozen = v->scene.frame.cull_camera;
    tc_status status = TC_ERR_UNSUPPORTED;
    v->scene.frame.cull_camera = NULL; /* of the scheme that it was frozen in */
    while (status != TC_OK && v->renderer && (next = tc_viewer_scheme_after(v, next)) != now) {
        tc_error error;
        status = tc_viewer_change_scheme(v, next, &error);
        if (status != TC_OK)
            tc_viewer_tell(v, TC_TOLD_FAILURE, "%s: %s", next->name, error.text);
    }
    if (status == TC_OK)
        tc_viewer_tell(v, TC_TOLD_DONE, "%s", next->name);
    if (status != TC_OK)
        v->scene.frame.cull_camera = frozen;
    if (v->renderer)
        tc_renderer_set_options(v->renderer, &v->scene);
    s->quit |= v->renderer == NULL;
}

static void do_tell(session *s)
{
    tc_viewer_tell_figures(&s->telling, !s->telling.figures);
}

static void do_picture(session *s)
{
    s->picture_wanted = true;
}

static void do_full_screen(session *s)
{
    s->viewer->window_plugin->toggle_full_screen(s->viewer->window);
}

/* What moves, moves from where the eye is seen: above ground that has risen since. */
static void rise(session *s)
{
    s->flight.view.z = fmax(s->flight.view.z, s->viewer->camera.z);
}

static void do_reset(session *s)
{
    rise(s);
    s->flight.speed = s->start.speed;
    tc_gestures_fly(&s->gestures, &s->scenery, &s->flight.view, &s->start.view);
}

static void do_listed(session *s)
{
    tc_pose view;
    if (tc_viewer_listed_view(s->viewer, s->key - '0', &view))
        tc_gestures_fly(&s->gestures, &s->scenery, &s->flight.view, &view);
}

static void capture(session *s, bool on)
{
    s->captured = on;
    s->viewer->window_plugin->capture(s->viewer->window, on);
}

/* Each press counts: a slow frame may bring several. */
static void do_look(session *s)
{
    tc_gestures_rest(&s->gestures);
    capture(s, !s->captured);
    tc_viewer_tell(s->viewer, TC_TOLD_DONE, "the mouse %s", s->captured ? "turns the view" : "moves the ground");
}

static void do_view(session *s)
{
    rise(s);
    tc_viewer_keep_view(s->viewer, &s->flight.view);
}

static void do_north(session *s)
{
    rise(s);
    tc_gestures_north(&s->gestures, &s->scenery, &s->flight.view);
}

static void do_quit(session *s)
{
    if (s->captured)
        capture(s, false);
    else
        s->quit = !tc_viewer_display_dismiss(s->viewer);
}

static const struct key {
    int keys[TC_VIEWER_LISTED]; /* 0 none */
    const char *label, *help;
    void (*action)(session *s);
} keys[] = {
    {.label = "W A S D, Q E", .help = "fly forward, left, back, right; down, up; the higher, the faster"},
    {.label = "arrows, shift", .help = "turn and tilt; eight times as fast"},
    {.label = "left button", .help = "pull the ground: it stays under the pointer; twice: fly there"},
    {.label = "wheel", .help = "nearer to the ground under the pointer, or farther from it"},
    {.label = "right button", .help = "turn about the point in the middle, tilt"},
    {{'F'}, "F", "let the mouse turn the view, and the wheel set the speed; again, or Esc: no more", do_look},
    {{'V'}, "V", "print the view as a --view option, or add it to the file of --views", do_view},
    {{'P'}, "P", "write a picture: terraclip-0001.png and on", do_picture},
    {{'1', '2', '3', '4', '5', '6', '7', '8', '9'}, "1 to 9", "fly to the first nine views of --views", do_listed},
    {{'R', '0'}, "R, 0", "fly back to the first view", do_reset},
    {{'N'}, "N", "north up", do_north},
    {{'G'}, "G", "wireframe", do_wireframe},
    {{'L'}, "L", "level colours", do_level_colours},
    {{'M'}, "M", "morph on or off", do_morph},
    {{'C'}, "C", "freeze culling: fly on and see what is left out", do_freeze},
    {{'X'}, "X", "the next scheme, at the same view", do_scheme},
    {{'T'}, "T", "statistics on the terminal, every second", do_tell},
    {{TC_KEY_F11}, "F11", "full screen", do_full_screen},
    {{TC_KEY_TAB}, "Tab", "settings", do_panel},
    {{'O'}, "O", "texts, compass and settings in the window, or none", do_display},
    {{'H', TC_KEY_F1}, "H, F1", "this help", do_help},
    {{TC_KEY_ESCAPE}, "Esc", "let the mouse go; close help or settings; quit", do_quit},
};

void tc_viewer_print_keys(FILE *file)
{
    fprintf(file, "\nKeys of the window:\n");
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        fprintf(file, "  %-14s%s\n", keys[i].label, keys[i].help);
}

bool tc_viewer_key(int k, const char **label_ret, const char **help_ret)
{
    if (k >= (int)(sizeof keys / sizeof *keys))
        return false;
    *label_ret = keys[k].label, *help_ret = keys[k].help;
    return true;
}

static bool has_key(const struct key *row, int key)
{
    bool has = false;
    for (int k = 0; k < TC_VIEWER_LISTED; k++)
        has |= row->keys[k] == key;
    return has;
}

static void handle_key(session *s, int key)
{
    s->key = key;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (keys[k].action && has_key(&keys[k], key))
            keys[k].action(s);
}

/* What the display was used for, and files that fell on the window. */
static void use_display(session *s, const tc_window_input *input)
{
    int key;
    tc_pose view;
    if (tc_viewer_display_act(s->viewer, input, &view, &key)) {
        tc_gestures_rest(&s->gestures);
        s->start.view = s->flight.view = view;
    }
    if (key)
        handle_key(s, key);
    s->quit |= s->viewer->renderer == NULL;
}

/* ---- A frame ------------------------------------------------------------------------------------------------ */

/* Writes what is shown, at its best, under the first free number. */
static void write_picture(session *s)
{
    tc_viewer *v = s->viewer;
    char name[32];
    do
        snprintf(name, sizeof name, "terraclip-%04d.png", ++s->picture_number);
    while (access(name, F_OK) == 0 && s->picture_number < INT_MAX);
    tc_error error = {.text = "not enough memory"};
    uint8_t *rgb = malloc((size_t)v->camera.width * (size_t)v->camera.height * 3);
    tc_status status = rgb ? tc_viewer_best_frame(v, &error) : TC_ERR_MEMORY;
    if (status == TC_OK)
        status = tc_viewer_write_frame(v, name, rgb, &error);
    free(rgb);
    if (status != TC_OK)
        tc_viewer_tell(v, TC_TOLD_FAILURE, "%s", error.text);
    else
        tc_viewer_tell(v, TC_TOLD_DONE, "%s", name);
}

/* Flies by keys, and by a captured mouse. */
static void fly(session *s, const tc_window_input *input, double dt)
{
    /* A pixel of the mouse is a pixel of the picture, on the whole. */
    double radians_per_pixel = s->viewer->camera.fov / fmax(640, input->width), key_turn = 1.2 * fmin(dt, 0.1);
    const tc_flight_input flight_input = {.right = input->right,
                                          .forward = input->forward,
                                          .up = input->up,
                                          .turn = input->look_x * radians_per_pixel + input->turn * key_turn,
                                          .tilt = -input->look_y * radians_per_pixel + input->tilt * key_turn,
                                          .fast = input->fast,
                                          .dt = dt};
    const double moves[] = {input->right, input->forward, input->up,    input->turn,
                            input->tilt,  input->look_x,  input->look_y};
    bool moved = false;
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++)
        moved |= moves[i] != 0;
    if (!moved)
        return;
    rise(s);
    tc_gestures_rest(&s->gestures);
    s->viewer->program->navigation->step(&s->flight, &flight_input, &s->viewer->ground);
}

/* Moves the view by what the user did in dt seconds. */
static void move(session *s, const tc_window_input *input, double dt)
{
    if (input->event_count > 0)
        rise(s);
    for (int i = 0; i < input->event_count; i++) {
        const tc_pointer_event *event = &input->events[i];
        if (!input->captured)
            tc_gestures_event(&s->gestures, &s->scenery, event, &s->flight.view);
        else if (event->kind == TC_POINTER_WHEEL)
            tc_flight_faster(&s->flight, event->wheel);
    }
    tc_gestures_step(&s->gestures, &s->scenery, dt, &s->flight.view);
    fly(s, input, dt);
}

static const double STANDING = 0.03; /* seconds to wait for an event while nothing changes */

tc_status tc_viewer_window(tc_viewer *v, tc_error *error)
{
    const tc_camera *camera = &v->camera;
    const tc_pose start = {camera->x, camera->y, camera->z, camera->heading, camera->pitch};
    double now = tc_clock_ms();
    session s = {
        .viewer = v, .flight = {start, tc_flight_speed}, .start = {start, tc_flight_speed}, .telling.title_since = now};
    if (!v->display && !v->options.quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "%s: H prints the keys\n", v->program->name);

    tc_status status = TC_OK;
    double last = now, took;
    tc_frame_stats frame = {0};
    tc_viewer_quality_begin(v);
    tc_frame_timer timer = tc_frame_timer_create(v->gl);
    for (int frames = 0; status == TC_OK && !s.quit && !tc_interrupted();) {
        tc_window_input input;
        v->window_plugin->poll(v->window, v->quality.stands ? STANDING : 0, &input);
        while ((input.width <= 0 || input.height <= 0) && !input.close && !tc_interrupted()) {
            v->window_plugin->poll(v->window, 0.2, &input); /* iconified: buttons are let go meanwhile */
            tc_gestures_rest(&s.gestures);
            last = tc_clock_ms();
        }
        if (input.close || input.width <= 0 || input.height <= 0 || (v->options.frames && frames == v->options.frames))
            break;
        v->camera.width = input.width;
        v->camera.height = input.height;
        s.scenery = tc_viewer_scenery(v);
        s.captured = input.was_captured;
        for (int i = 0; i < input.pressed_count && !s.quit; i++)
            handle_key(&s, input.pressed[i]);
        if (s.quit)
            break;
        now = tc_clock_ms();
        if (v->path.count > 0)
            s.flight.view = tc_flight_path_view(&v->path, frames, v->options.frames);
        else
            move(&s, &input, (now - last) / 1e3);
        tc_viewer_place(v, &s.flight.view);
        const bool draws = tc_viewer_quality_before(v, (now - last) / 1e3);
        last = now;
        if (draws)
            tc_frame_timer_begin(v->gl, &timer);
        if (draws)
            status = tc_viewer_frame(v, false, &frame, error);
        if (draws)
            tc_frame_timer_end(v->gl, &timer);
        if (status != TC_OK)
            break;
        tc_renderer_present(v->renderer, input.width, input.height);
        tc_viewer_display_show(v, &frame);
        v->window_plugin->swap(v->window);
        if (draws) {
            const double frame_ms = tc_clock_ms() - now;
            v->recent_ms += 0.2 * (frame_ms - v->recent_ms);
            tc_stats_frame(v->stats, frame_ms - tc_viewer_display_ms(v), &frame);
            tc_viewer_quality_drawn(v, &frame);
        }
        while (tc_frame_timer_read(v->gl, &timer, &took))
            tc_quality_took(&v->quality, took, v->surface->most_throttle);
        tc_viewer_tell_frame(v, &s.telling, &frame);
        if (s.picture_wanted) {
            write_picture(&s);
            s.picture_wanted = false;
        }
        use_display(&s, &input);
        if (v->waited) { /* buttons may have been let go meanwhile */
            tc_gestures_rest(&s.gestures);
            v->waited = false;
            last = tc_clock_ms();
        }
        frames++;
    }
    tc_frame_timer_destroy(v->gl, &timer);
    if (status == TC_OK && !v->renderer)
        status = tc_fail(error, TC_ERR_CONTEXT, "%s: cannot be drawn any more", v->options.terrain);
    return status;
}

/* viewer_work.c - what takes long: done on a thread of its own, while this one, which has the window, hears its events
 * and tells in it how far the work is. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "interrupt.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Milliseconds: between two looks at events, which are two pictures, too; that work takes without a word of it; that a
 * file may take until it is refused, and then no window was opened for it; that work may go on once it is to end. */
static const double TURN = 50, UNTOLD = 150, REFUSING = 600, ENDING = 700, ENDING_CHILD = 5000;

struct tc_viewer_work {
    tc_viewer *viewer;
    tc_status (*work)(tc_viewer *viewer, tc_error *error);
    const tc_viewer *behind;
    double begun, ending; /* milliseconds of tc_clock_ms(); ending: since when it is to, 0: it is not */
    tc_status unopened;   /* the window, and why; TC_OK: it is there, or was not due yet */
    tc_error why;
    bool told; /* in the window */

    pthread_mutex_t lock; /* of what follows */
    pthread_cond_t changed;
    bool ended;
    char what[TC_DISPLAY_LENGTH]; /* "": no word yet */
    double share, since;          /* of what is done now */
    tc_status status;
    tc_error error;
};

bool tc_viewer_progress(void *context, const char *what, double share)
{
    struct tc_viewer_work *w = ((tc_viewer *)context)->work;
    if (w) {
        pthread_mutex_lock(&w->lock);
        if (strcmp(w->what, what) != 0)
            w->since = tc_clock_ms();
        snprintf(w->what, sizeof w->what, "%s", what);
        w->share = share;
        pthread_mutex_unlock(&w->lock);
    }
    return !tc_interrupted();
}

static void *do_work(void *context)
{
    struct tc_viewer_work *w = context;
    tc_error error = {.text = ""};
    const tc_status status = w->work(w->viewer, &error);
    pthread_mutex_lock(&w->lock);
    w->ended = true, w->status = status, w->error = error;
    pthread_cond_signal(&w->changed);
    pthread_mutex_unlock(&w->lock);
    return NULL;
}

/* Whether it has ended, within a turn. */
static bool await_end(struct tc_viewer_work *w)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += (long)(TURN * 1e6);
    until.tv_sec += until.tv_nsec / 1000000000, until.tv_nsec %= 1000000000;
    int how = 0;
    pthread_mutex_lock(&w->lock);
    while (!w->ended && how != ETIMEDOUT)
        how = pthread_cond_timedwait(&w->changed, &w->lock, &until);
    const bool ended = w->ended;
    pthread_mutex_unlock(&w->lock);
    return ended;
}

/* What is done now. */
static tc_display_work telling(struct tc_viewer_work *w, double now)
{
    tc_display_work told = {.share = -1, .alone = !w->behind};
    pthread_mutex_lock(&w->lock);
    snprintf(told.what, sizeof told.what, "%s", *w->what ? w->what : "opening");
    told.share = w->share;
    told.seconds = (now - (*w->what ? w->since : w->begun)) / 1e3;
    pthread_mutex_unlock(&w->lock);
    snprintf(told.name, sizeof told.name, "%s", tc_viewer_file_name(w->viewer->options.terrain));
    return told;
}

/* Draws what is told. */
static void tell(struct tc_viewer_work *w, const tc_display_work *told, int width, int height)
{
    tc_viewer *v = w->viewer;
    char title[2 * TC_DISPLAY_LENGTH + 64], share[16] = "";
    if (told->share >= 0)
        snprintf(share, sizeof share, " %.0f %%", floor(100 * told->share));
    snprintf(title, sizeof title, "%.100s - %.100s%s - %s", told->name, told->what, share, v->program->name);
    v->window_plugin->set_title(v->window, title);
    if (w->behind) {
        tc_renderer_present(w->behind->renderer, width, height);
    } else {
        v->gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
        v->gl->ClearColor(0.1f, 0.1f, 0.12f, 1);
        v->gl->Clear(GL_COLOR_BUFFER_BIT);
    }
    tc_viewer_display_work(v, told);
    v->window_plugin->swap(v->window);
    w->told = true;
}

/* It does not end although it is to: what is being read, or computed, cannot be stopped. No file is being written. */
static void leave(const struct tc_viewer_work *w)
{
    tc_error error = w->why;
    tc_status status = w->unopened;
    if (status == TC_OK && (w->behind || w->viewer->closed))
        status = tc_viewer_report(w->behind ? w->behind : w->viewer, &error);
    else if (status == TC_OK)
        status = tc_fail(&error, TC_ERR_IO, "interrupted");
    _exit(tc_viewer_end(w->viewer->program, status, &error));
}

static void leave_in_time(struct tc_viewer_work *w)
{
    const double now = tc_clock_ms();
    if (tc_interrupted() && w->ending == 0)
        w->ending = now;
    if (w->ending > 0 && now - w->ending > (w->viewer->writing ? ENDING_CHILD : ENDING))
        leave(w);
}

static void refuse_files(tc_viewer *v, const tc_window_input *input)
{
    for (int i = 0; i < input->dropped_count; i++)
        tc_viewer_tell(v, TC_TOLD_FAILURE,
                       "%s: cannot be opened while another file is loaded; drop it again after that",
                       tc_viewer_file_name(input->dropped[i]));
    tc_viewer_tell_left_out(v, input);
}

/* A look at the window's events. */
static void attend(struct tc_viewer_work *w)
{
    tc_viewer *v = w->viewer;
    const double now = tc_clock_ms();
    tc_window_input input;
    v->window_plugin->poll(v->window, 0, &input);
    v->waited = true;
    bool closed = input.close;
    for (int i = 0; i < input.pressed_count && !w->behind; i++)
        closed |= input.pressed[i] == TC_KEY_ESCAPE;
    v->closed |= closed;
    if (closed)
        tc_interrupt();
    refuse_files(v, &input);
    if (now - w->begun > UNTOLD && input.width > 0 && input.height > 0) {
        const tc_display_work told = telling(w, now);
        tell(w, &told, input.width, input.height);
    }
}

/* Whether a window is to be opened: for what was not refused, or would have been. */
static bool due(struct tc_viewer_work *w)
{
    const double passed = tc_clock_ms() - w->begun;
    pthread_mutex_lock(&w->lock);
    const bool under_way = *w->what && passed > UNTOLD;
    pthread_mutex_unlock(&w->lock);
    return !tc_interrupted() && (under_way || passed > REFUSING);
}

static void wait_for(struct tc_viewer_work *w)
{
    while (!await_end(w)) {
        if (w->viewer->window && w->unopened == TC_OK)
            attend(w);
        else if (due(w))
            w->unopened = tc_viewer_open_window(w->viewer, &w->why);
        if (w->unopened != TC_OK)
            tc_interrupt();
        leave_in_time(w);
    }
}

/* What comes then has no share that is known, and is on this thread. */
static void tell_end(struct tc_viewer_work *w)
{
    tc_window_input input;
    if (!w->told || w->status != TC_OK || w->viewer->closed)
        return;
    tc_display_work told = {.what = "drawing", .share = -1, .alone = !w->behind};
    snprintf(told.name, sizeof told.name, "%s", tc_viewer_file_name(w->viewer->options.terrain));
    w->viewer->window_plugin->poll(w->viewer->window, 0, &input);
    refuse_files(w->viewer, &input);
    if (input.width > 0 && input.height > 0)
        tell(w, &told, input.width, input.height);
}

tc_status tc_viewer_wait(tc_viewer *v, tc_status (*work)(tc_viewer *, tc_error *), const tc_viewer *behind,
                         tc_error *error)
{
    pthread_t thread;
    pthread_condattr_t clock;
    if (!tc_viewer_interactive(&v->options))
        return work(v, error);
    struct tc_viewer_work w = {.viewer = v,
                               .work = work,
                               .behind = behind,
                               .begun = tc_clock_ms(),
                               .share = -1,
                               .unopened = TC_OK,
                               .status = TC_OK};
    pthread_mutex_init(&w.lock, NULL);
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_cond_init(&w.changed, &clock);
    pthread_condattr_destroy(&clock);
    v->work = &w;
    if (pthread_create(&thread, NULL, do_work, &w) == 0) {
        wait_for(&w);
        pthread_join(thread, NULL);
        tell_end(&w);
    } else {
        w.status = work(v, &w.error);
    }
    v->work = NULL;
    pthread_cond_destroy(&w.changed);
    pthread_mutex_destroy(&w.lock);
    if (w.unopened != TC_OK)
        w.status = w.unopened, w.error = w.why;
    if (w.status != TC_OK)
        *error = w.error;
    return w.status;
}

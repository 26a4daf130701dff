/* viewer_tell.c - what a viewer tells in lines: on the terminal, in the window's title, and for some seconds in its
 * display. */
#include "viewer_internal.h"
#include "display.h"

#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

void tc_viewer_tell(tc_viewer *v, tc_told how, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    if (how == TC_TOLD_FAILURE && v->closed) /* of what ended because the window was closed */
        return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (how == TC_TOLD_DONE && !v->options.quiet)
        fprintf(stderr, "%s\n", text);
    else if (how == TC_TOLD_FAILURE || !v->options.quiet)
        fprintf(stderr, "%s: %s%s\n", v->program->name, how == TC_TOLD_WARNING ? "warning: " : "", text);
    tc_viewer_display_line(v, how != TC_TOLD_DONE, text);
}

void tc_viewer_tell_left_out(tc_viewer *v, const tc_window_input *input)
{
    if (input->dropped_left_out > 0)
        tc_viewer_tell(v, TC_TOLD_FAILURE,
                       "expected at most %d files dropped at once, found %d: drop the last %d again",
                       TC_WINDOW_MAX_DROPPED, input->dropped_count + input->dropped_left_out, input->dropped_left_out);
}

const char *tc_viewer_file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

/* ---- A frame ----------------------------------------------------------------------------------------------------- */

/* Says once that a part of the terrain cannot be read, and again where it comes back. */
static void tell_failure(tc_viewer *v, const tc_frame_stats *frame)
{
    int64_t tiles = tc_map_unreadable(v->map);
    bool failing = frame->failed || tiles > 0;
    if (failing == v->failing)
        return;
    v->failing = failing;
    const char *name = v->options.terrain;
    if (!failing)
        tc_viewer_tell(v, TC_TOLD_WARNING, "%s: all of it can be read again", name);
    else if (tiles > 0)
        tc_viewer_tell(v, TC_TOLD_WARNING,
                       "%s: %" PRId64 " tiles cannot be read and are shown coarser; they will be tried again", name,
                       tiles);
    else
        tc_viewer_tell(v, TC_TOLD_WARNING,
                       "%s: a part of it cannot be read and is shown coarser; it will be tried again", name);
}

/* Says what was found to be damaged, and again where there is more of it; now and then, since charts are asked. */
static void tell_damage(tc_viewer *v, tc_telling *t, double now)
{
    if (now - t->damage_since < 2000)
        return;
    const int64_t damaged = tc_map_damaged(v->map);
    if (damaged > t->damaged)
        tc_viewer_tell(v, TC_TOLD_WARNING, "%s: damaged: %" PRId64 " tiles are shown from the next coarser level",
                       v->options.terrain, damaged);
    t->damaged = damaged, t->damage_since = now;
}

static void tell_title(const tc_viewer *v, tc_telling *t, const tc_frame_stats *frame, double now)
{
    char title[256];
    if (now - t->title_since < 250)
        return;
    snprintf(title, sizeof title, "%.100s - %.1f ms, %" PRId64 " triangles, %d levels - %s",
             tc_viewer_file_name(v->options.terrain), v->recent_ms, frame->triangles, frame->levels_active,
             v->program->name);
    v->window_plugin->set_title(v->window, title);
    t->title_since = now;
}

static void tell_figures(const tc_viewer *v, tc_telling *t, const tc_frame_stats *frame, double now)
{
    if (!t->figures || now - t->figures_since < 1000)
        return;
    fprintf(stderr,
            "%.2f ms a frame (update %.2f, draw %.2f); %" PRId64 " of %" PRId64
            " triangles, %d draws, %d levels; %" PRId64 " samples updated, %" PRId64 " bytes uploaded%s",
            v->recent_ms, frame->update_ms, frame->draw_ms, frame->triangles, frame->triangles_unculled, frame->draws,
            frame->levels_active, frame->samples_updated, frame->bytes_uploaded, frame->resident ? "" : "; loading");
    if (v->options.target_ms > 0)
        fprintf(stderr, "; %.2f octaves coarser", frame->throttle);
    if (v->display)
        fprintf(stderr, "; display %.2f ms", tc_viewer_display_ms(v));
    fputc('\n', stderr);
    t->figures_since = now;
}

void tc_viewer_tell_figures(tc_telling *telling, bool on)
{
    telling->figures = on;
    telling->figures_since = tc_clock_ms();
}

void tc_viewer_tell_frame(tc_viewer *v, tc_telling *telling, const tc_frame_stats *frame)
{
    const double now = tc_clock_ms();
    tell_title(v, telling, frame, now);
    tell_figures(v, telling, frame, now);
    tell_failure(v, frame);
    tell_damage(v, telling, now);
}

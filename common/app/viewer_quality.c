/* viewer_quality.c - how well a window's frames are drawn: as pictures are, but for a while of motion that would be too
 * slow (common/view/quality.h). */
#include "viewer_internal.h"

#include <string.h>

static const double TARGET_MS = 50; /* that a frame may take while the view moves, unless --target-ms says so */

bool tc_viewer_coarsens(const tc_viewer *v)
{
    const tc_options *o = &v->options;
    if (o->target_ms > 0)
        return true;
    return tc_viewer_interactive(o) && !o->frames && tc_gl_software((const char *)v->gl->GetString(GL_RENDERER));
}

void tc_viewer_quality_begin(tc_viewer *v)
{
    const tc_options *o = &v->options;
    const bool slow = tc_gl_software((const char *)v->gl->GetString(GL_RENDERER));
    v->quality = tc_quality_of(v->scene.samples, !o->frames && v->path.count == 0, v->scene.throttle,
                               o->target_ms > 0 ? o->target_ms : TARGET_MS, slow);
}

/* What a frame is drawn of, without its quality. */
static struct tc_shown to_show(const tc_viewer *v)
{
    struct tc_shown shown;
    memset(&shown, 0, sizeof shown); /* what lies between the members, too */
    shown.camera = v->camera, shown.scene = v->scene, shown.renderer = v->renderer;
    shown.scene.frame.throttle = 0;
    return shown;
}

static void draw_with(tc_viewer *v, int samples, double octaves)
{
    tc_renderer_set_samples(v->renderer, samples);
    if (v->scene.frame.throttle == octaves) /* or each frame would settle anew what its scene needs */
        return;
    v->scene.frame.throttle = octaves;
    tc_renderer_set_options(v->renderer, &v->scene);
}

bool tc_viewer_quality_before(tc_viewer *v, double dt)
{
    const struct tc_shown now = to_show(v);
    const bool changed = memcmp(&now, &v->shown, sizeof now) != 0;
    v->shown = now;
    v->quality.full = v->scene.samples;
    tc_quality_before(&v->quality, changed, dt);
    draw_with(v, v->quality.samples, v->quality.octaves);
    return v->quality.draws;
}

/* What is wanted follows from the ground that was there before: only a frame that brings nothing new has it all. */
void tc_viewer_quality_drawn(tc_viewer *v, const tc_frame_stats *frame)
{
    const bool still = frame->samples_updated == 0 && frame->texels_updated == 0;
    tc_quality_drawn(&v->quality, still && frame->resident && !frame->failed && !frame->imagery_failed);
}

/* What cannot be read is shown as it is without it. */
tc_status tc_viewer_best_frame(tc_viewer *v, tc_error *error)
{
    enum { MOST = 1000 };
    tc_frame_stats frame = {0};
    draw_with(v, v->scene.samples, 0);
    tc_status status = TC_OK;
    for (int i = 0; i < MOST && status == TC_OK && !(frame.resident && frame.samples_updated == 0); i++)
        status = tc_viewer_frame(v, true, &frame, error);
    return status == TC_ERR_IO && v->renderer ? tc_viewer_frame(v, false, &frame, error) : status;
}

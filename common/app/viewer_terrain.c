/* viewer_terrain.c - what a viewer shows: the terrain in the charts that its scheme draws, with its pictures. What of
 * it changes while it is shown: viewer_change.c. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "interrupt.h"
#include "load_imagery.h"

#include <inttypes.h>
#include <math.h>
#include <unistd.h>

static const double LEAST_HEIGHT = 0.01; /* metres above the ground; less where samples are a few of them apart */

/* What the source has to say. */
static void say(void *context, bool warning, const char *line)
{
    tc_viewer *viewer = context;
    if (warning)
        tc_viewer_tell(viewer, TC_TOLD_WARNING, "%s", line);
    else if (viewer->options.verbose)
        fprintf(stderr, "%s: %s\n", viewer->program->name, line);
}

static tc_status open_file(tc_viewer *v, tc_error *error)
{
    tc_source_options source = v->options.source;
    source.say = say;
    source.progress = tc_viewer_progress;
    source.say_context = source.progress_context = v;
    source.credit = tc_credits_take;
    source.credit_context = &v->terrain_credits;
    v->terrain_credits.count = 0;
    source.outputs = &v->outputs;
    tc_load_options load = {.body = v->program->body,
                            .globe = v->options.globe,
                            .atlas = v->options.scheme ? v->options.scheme->atlas : NULL,
                            .synthesises = v->options.synthesis != 0,
                            .threads = v->options.threads};
    tc_status status = tc_map_load(v->options.terrain, &source, &load, &v->map, error);
    if (status == TC_ERR_UNSUPPORTED && v->options.scheme_implied) { /* the file may be in the charts of another one */
        tc_error other;
        load.atlas = NULL;
        if (tc_map_load(v->options.terrain, &source, &load, &v->map, &other) == TC_OK) {
            const tc_scheme *own = tc_scheme_for(v->program->schemes, v->map);
            if (own && own->by_error)
                v->options.scheme = own, status = TC_OK;
            else
                tc_map_destroy(v->map), v->map = NULL;
        }
    }
    if (status == TC_OK && !v->options.scheme) /* as the file has its charts */
        v->options.scheme = tc_scheme_for(v->program->schemes, v->map);
    if (status == TC_OK && v->options.synthesis)
        tc_viewer_progress(v, "fitting what is synthesised", -1);
    if (status == TC_OK)
        status = tc_map_synthesise(v->map, v->options.synthesis, error);
    return status;
}

/* The ground under the eye. Where a person waits for the next frame, nothing is read or decoded for it: it is what is
 * drawn, which the eye must be above, or else a rough one; pictures and measured flights have the true one, or that of
 * a coarser level which is drawn in its place and may be higher. */
static double ground_height(void *context, double x, double y)
{
    const tc_viewer *v = context;
    double z = 0, drawn;
    if (tc_viewer_at_sea(v, x, y, &z))
        return z;
    const tc_view *view = v->renderer ? tc_renderer_view(v->renderer) : NULL;
    bool shown = view && view->surface->height(view, x, y, &drawn);
    if (shown && tc_viewer_interactive(&v->options))
        return drawn;
    if (tc_viewer_interactive(&v->options))
        tc_map_rough_height(v->map, x, y, &z);
    else
        tc_map_height(v->map, x, y, &z);
    return shown ? fmax(z, drawn) : z;
}

tc_status tc_viewer_load_terrain(tc_viewer *v, tc_error *error)
{
    tc_status status = open_file(v, error);
    if (status != TC_OK)
        return status;
    const tc_field *field = tc_map_field(v->map, 0);
    const tc_terrain_info *info = tc_field_info(field);
    const tc_level finest = tc_field_level(field, info->levels);
    v->spacing = fmin(finest.spacing_x, finest.spacing_y);
    v->least_height = fmin(LEAST_HEIGHT, 0.25 * v->spacing);
    v->ground = (tc_ground){ground_height, v, tc_flight_clearance(v->spacing), v->map->body};
    if (v->options.verbose)
        fprintf(stderr,
                "%s: %s: %" PRId64 " x %" PRId64 " samples every %g x %g m, heights %.2f to %.2f m, %" PRId64
                " voids; %s in %.0f ms, %d levels in %.0f ms\n",
                v->program->name, v->options.terrain, finest.width, finest.height, finest.spacing_x, finest.spacing_y,
                info->z_base + info->z_min, info->z_base + info->z_max, info->void_count,
                tc_field_packed_info(field) ? "opened" : "read", v->map->read_ms, info->levels, v->map->build_ms);
    status = tc_map_flood(v->map, v->options.sea, error);
    v->scene.sea = v->map->sea;
    if (status == TC_OK)
        status = tc_map_exaggerate(v->map, v->options.exaggeration, error);
    v->scene.exaggeration = v->map->exaggeration;
    const tc_body *body = &v->map->body;
    char about[64];
    if (v->options.verbose && body->class->describe) {
        body->class->describe(body, about, sizeof about);
        fprintf(stderr, "%s: %s, %d charts\n", v->program->name, about, v->map->charts);
    }
    return status;
}

/* A line that tells a person how far making a picture's levels is. */
typedef struct levels_line {
    tc_viewer *viewer;
    bool shown, begun; /* to a person; and not ended yet */
} levels_line;

static void end_line(levels_line *line)
{
    if (line->begun)
        fputc('\n', stderr);
    line->begun = false;
}

/* False: that is to end. */
static bool show_levels(void *context, double done)
{
    levels_line *line = context;
    if (line->shown)
        line->begun = fprintf(stderr, "\rimagery: %3.0f %%", floor(100 * done)) > 0;
    if (done >= 1)
        end_line(line);
    return tc_viewer_progress(line->viewer, "making levels of imagery", done);
}

tc_status tc_viewer_load_imagery(tc_viewer *v, tc_error *error)
{
    const tc_source_options source = {.say = say,
                                      .say_context = v,
                                      .credit = tc_credits_take,
                                      .credit_context = &v->imagery_credits,
                                      .outputs = &v->outputs};
    v->imagery_credits.count = 0;
    levels_line line = {.viewer = v, .shown = !v->options.quiet && isatty(STDERR_FILENO)};
    const tc_image_options options = {.source = &source, .progress = show_levels, .progress_context = &line};
    tc_viewer_progress(v, "opening imagery", -1);
    tc_status status = tc_imagery_load(v->map, v->options.imagery, v->options.imagery_count, v->options.threads,
                                       &options, &v->imagery, error);
    end_line(&line); /* what is said of a failure has its own */
    return status;
}

tc_status tc_viewer_look_around(tc_viewer *v, tc_error *error)
{
    v->around = (tc_surroundings){0};
    return v->options.alone ? TC_OK : tc_surroundings_of(v->map, &v->around, error);
}

tc_status tc_viewer_load(tc_viewer *v, tc_error *error)
{
    tc_status status = tc_viewer_load_terrain(v, error);
    tc_watch_interrupts();
    if (status == TC_OK)
        status = tc_viewer_look_around(v, error);
    if (status == TC_OK && v->options.imagery_count > 0)
        status = tc_viewer_load_imagery(v, error);
    return status;
}

void tc_viewer_unload(tc_viewer *v)
{
    tc_imagery_destroy(v->imagery);
    tc_map_destroy(v->map);
    v->imagery = NULL, v->map = NULL;
}

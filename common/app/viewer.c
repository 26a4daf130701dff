/* viewer.c - a viewer from its command line to its exit code: options, terrain, context, renderer, then one of picture,
 * flight and window, then the figures. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "common/base/outfile.h"
#include "colour_file.h"
#include "explain.h"
#include "interrupt.h"
#include "load_imagery.h"
#include "common/gl/debug.h"
#include "common/input/plugin.h"
#include "common/render/canvas.h"
#include "common/render/drape.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

enum { WINDOW_FRAMES = 65536 }; /* that a window's statistics look back */

/* ---- Starting ----------------------------------------------------------------------------------------------- */

bool tc_viewer_interactive(const tc_options *options)
{
    return !options->output && (!options->path || options->backend == TC_BACKEND_WINDOW);
}

bool tc_viewer_keeps(const tc_options *options)
{
    return options->output || options->video;
}

tc_flight_box tc_viewer_box(const tc_viewer *v)
{
    double lo[2], hi[2], lowest = INFINITY, highest = -INFINITY;
    tc_map_extent(v->map, lo, hi);
    for (int c = 0; c < v->map->charts; c++) {
        const tc_terrain_info *info = tc_field_info(tc_map_field(v->map, c));
        lowest = fmin(lowest, info->z_base + info->z_min), highest = fmax(highest, info->z_base + info->z_max);
    }
    /* A sea that is far below the ground is not in the view of it all. */
    const double RELIEFS = 3,
                 sea = fmax(v->map->sea.level * v->map->exaggeration, lowest - RELIEFS * (highest - lowest));
    return (tc_flight_box){.west = lo[0],
                           .south = lo[1],
                           .east = hi[0],
                           .north = hi[1],
                           .z_min = v->around.walls && !v->around.sea  ? v->around.foot
                                    : v->map->sea.kind == TC_SEA_GIVEN ? fmin(sea, highest)
                                                                       : lowest,
                           .z_max = highest,
                           .radius = v->map->body.radius};
}

tc_pose tc_viewer_whole(const tc_viewer *v)
{
    const tc_flight_box box = tc_viewer_box(v);
    return v->program->navigation->whole(&box, v->camera.fov, v->camera.width, v->camera.height);
}

bool tc_viewer_at_sea(const tc_viewer *v, double x, double y, double *z_ret)
{
    const bool around = v->map->sea.kind == TC_SEA_GIVEN && v->around.sea && !v->options.scene.background_set;
    *z_ret = v->around.level;
    return around && !tc_map_has_ground(v->map, x, y);
}

void tc_viewer_place(tc_viewer *v, const tc_pose *view)
{
    double z = 0; /* an eye under the ground sees nothing, or the terrain's underside */
    const bool ground = tc_map_has_ground(v->map, view->x, view->y);
    tc_pose_to_camera(view, &v->camera);
    if (!ground && !tc_viewer_at_sea(v, view->x, view->y, &z))
        return;
    if (ground && tc_viewer_interactive(&v->options))
        z = v->ground.height(v->ground.context, view->x, view->y);
    else if (ground)
        tc_map_height(v->map, view->x, view->y, &z);
    if (!tc_viewer_interactive(&v->options)) /* who flies is kept above it */
        tc_viewer_say_lifted(v, z - v->camera.z);
    v->camera.z = fmax(v->camera.z, z + v->least_height);
}

/* Lifts the eye out of the terrain as it is drawn; whether it had to be. */
static bool lift(tc_viewer *v)
{
    double z;
    const tc_camera *c = &v->camera;
    const tc_view *view = tc_renderer_view(v->renderer);
    if (!view || !view->surface->height(view, c->x, c->y, &z) || c->z >= z + v->least_height)
        return false;
    tc_viewer_say_lifted(v, z - c->z);
    v->camera.z = z + 2 * v->least_height;
    return true;
}

/* Where the camera starts. */
static tc_status place_camera(tc_viewer *v, tc_error *error)
{
    v->camera.fov = v->options.fov;
    v->camera.width = v->options.width;
    v->camera.height = v->options.height;
    tc_pose view;
    tc_status status = tc_viewer_first_view(v, &view, error);
    if (status == TC_OK)
        tc_viewer_place(v, &view);
    return status;
}

tc_status tc_viewer_open_window(tc_viewer *v, tc_error *error)
{
    const void *table;
    tc_error reason;
    if (v->window)
        return TC_OK;
    tc_status status = tc_plugin_load("window", &table, &reason);
    if (status == TC_OK) {
        v->window_plugin = table;
        const tc_window_options options = {.title = v->program->name,
                                           .program = v->program->name,
                                           .width = v->options.width,
                                           .height = v->options.height,
                                           .hidden = !tc_viewer_interactive(&v->options)};
        status = v->window_plugin->open(&options, &v->window, &reason);
    }
    if (status == TC_OK)
        status = tc_gl_load(&v->window_gl, v->window_plugin->get_proc, &reason);
    if (status != TC_OK)
        return tc_fail(error, status, "%s%s", reason.text,
                       v->options.output ? "" : "; -o FILE.png writes a picture without a display");
    tc_gl_watch(&v->window_gl);
    v->gl = &v->window_gl;
    return TC_OK;
}

static tc_status open_context(tc_viewer *v, tc_error *error)
{
    tc_status status;
    if (tc_viewer_interactive(&v->options) || v->options.backend == TC_BACKEND_WINDOW) {
        status = tc_viewer_open_window(v, error);
    } else {
        status = tc_context_create(v->options.backend, &v->context, error);
        if (status == TC_OK)
            v->gl = tc_context_gl(v->context);
    }
    if (status == TC_OK && v->options.verbose)
        fprintf(stderr, "%s: OpenGL %s on %s by %s\n", v->program->name, v->gl->GetString(GL_VERSION),
                v->gl->GetString(GL_RENDERER), v->context ? tc_context_backend(v->context) : "window");
    return status;
}

/* The surface and what draws it, as large as frame and machine call for. */
static tc_status make_scene(tc_viewer *v, tc_error *error)
{
    v->scene = v->options.scene;
    v->scene.throttle = tc_viewer_coarsens(v);
    v->throttle = tc_throttle_of(v->options.target_ms);
    v->scene.exaggeration = v->map->exaggeration;
    v->scene.sea = v->map->sea;
    v->scene.holes = v->map->voids == TC_VOIDS_HOLE;
    v->scene.colours = v->colours.count > 0 ? &v->colours : NULL;
    v->scene.imagery = v->imagery;
    v->scene.around = v->around;
    /* A picture waits for all that it needs; in one go unless told otherwise. */
    if (tc_viewer_keeps(&v->options) && !v->scene.budget)
        v->scene.budget = -1;
    if (!v->scene.samples)
        v->scene.samples = tc_viewer_keeps(&v->options) || !v->options.path ? 4 : 1;
    if (tc_viewer_settle_sun(v, error) != TC_OK)
        return TC_ERR_USAGE;
    int most = tc_canvas_samples(v->gl, v->scene.samples);
    if (v->options.scene.samples > most && !v->options.quiet)
        fprintf(stderr, "%s: warning: --samples: expected at most %d with this driver, found %d; %d are drawn\n",
                v->program->name, most, v->options.scene.samples, most);
    return tc_viewer_make_surface(v, error);
}

/* ---- Frames ------------------------------------------------------------------------------------------------- */

/* Counts a frame that was waited for. */
static void finished(tc_viewer *v, double frame_ms, const tc_frame_stats *frame)
{
    tc_stats_frame(v->stats, frame_ms, frame);
    tc_viewer_throttle(v, frame_ms);
}

tc_status tc_viewer_measured_frame(tc_viewer *v, tc_frame_stats *frame_ret, tc_error *error)
{
    double start = tc_clock_ms();
    tc_status status = tc_viewer_frame(v, true, frame_ret, error);
    if (status == TC_OK)
        finished(v, tc_clock_ms() - start, frame_ret);
    return status;
}

tc_status tc_viewer_resident_frame(tc_viewer *v, tc_error *error)
{
    /* Every frame brings something, or nothing more will come. */
    for (int idle = 0, tries = 0; idle < 3 && tries < 100000 && !tc_interrupted(); tries++) {
        tc_frame_stats frame;
        double start = tc_clock_ms();
        tc_status status = tc_viewer_frame(v, true, &frame, error);
        if (status != TC_OK)
            return status;
        if (frame.resident && lift(v)) { /* which may call for other levels */
            tc_stats_load(v->stats, &frame);
            continue;
        }
        if (frame.resident) {
            finished(v, tc_clock_ms() - start, &frame);
            return TC_OK;
        }
        tc_stats_load(v->stats, &frame);
        idle = frame.samples_updated > 0 ? 0 : idle + 1;
    }
    if (tc_interrupted())
        return tc_fail(error, TC_ERR_IO, "interrupted");
    return tc_fail(error, TC_ERR_UNSUPPORTED,
                   "%s: what the view needs could not be loaded, at %" PRId64 " samples a frame", v->options.terrain,
                   v->scene.budget);
}

tc_status tc_viewer_write_frame(tc_viewer *v, const char *path, uint8_t *rgb, tc_error *error)
{
    tc_renderer_read(v->renderer, rgb, NULL);
    return tc_write_picture(path, v->camera.width, v->camera.height, rgb, error);
}

/* ---- Telling ------------------------------------------------------------------------------------------------ */

static void explain(const tc_viewer *v, const tc_left_out *left_out)
{
    tc_explain_uses(v->renderer, stdout);
    if (v->map->exaggeration != 1)
        printf("uses: exaggeration: heights are drawn %g times as high\n", v->map->exaggeration);
    if (v->map->sea.kind == TC_SEA_GIVEN)
        printf("uses: sea: at %g m, over all ground below it\n", v->map->sea.level);
    const tc_sun sun = tc_viewer_sun(v);
    if (v->scene.sun.kind != TC_SUN_USUAL && tc_renderer_used(v->renderer).needs->light)
        printf("uses: sun: azimuth %.4g, elevation %.4g degrees%s%s\n", sun.azimuth * 180 / M_PI,
               sun.elevation * 180 / M_PI, v->options.date ? ", at " : "", v->options.date ? v->options.date : "");
    if (v->options.target_ms > 0)
        printf("uses: throttling: for frames of %g ms the last one was drawn %.2f of at most %.2f octaves coarser\n",
               v->options.target_ms, tc_renderer_used(v->renderer).frame->throttle, v->surface->most_throttle);
    for (int i = 0; i < v->terrain_credits.count; i++)
        printf("credit: terrain: %s\n", v->terrain_credits.line[i]);
    for (int i = 0; i < v->imagery_credits.count; i++)
        printf("credit: imagery: %s\n", v->imagery_credits.line[i]);
    for (int i = 0; i < left_out->count; i++)
        printf("left out: %s\n", left_out->lines[i]);
}

/* Writes --stats, prints --json and --explain, and a line about a measured flight. */
static tc_status report_figures(const tc_viewer *v, tc_error *error)
{
    tc_stats_summary summary;
    tc_stats_summarise(v->stats, &summary);
    tc_left_out left_out;
    tc_explain_left_out(v->renderer, &left_out);
    const tc_drape *drape = tc_renderer_used(v->renderer).drape;
    tc_stats_context context = {.renderer = (const char *)v->gl->GetString(GL_RENDERER),
                                .backend = v->context ? tc_context_backend(v->context) : "window",
                                .bytes_decoded = tc_map_bytes_decoded(v->map),
                                .synthesised = v->map->synthesised,
                                .exaggeration = v->map->exaggeration,
                                .sun = tc_renderer_used(v->renderer).needs->light ? tc_viewer_sun(v) : (tc_sun){0},
                                .sea = v->map->sea,
                                .imagery = drape ? tc_drape_levels(drape) : 0,
                                .left_out = left_out.lines};
    tc_renderer_memory(v->renderer, &context.memory);
    if (v->options.explain && !v->options.json) /* which says it, too */
        explain(v, &left_out);
    if (v->options.json)
        tc_stats_print(&summary, &context, stdout);
    else if (v->options.path && !tc_viewer_keeps(&v->options) && !v->options.quiet)
        printf("%" PRId64 " frames: %.2f ms median, %.2f ms p95, %.2f ms max; %" PRId64 " triangles, %" PRId64
               " draws, %" PRId64 " levels\n",
               summary.frames, summary.frame_median, summary.frame_p95, summary.frame_max, summary.triangles,
               summary.draws, summary.levels_active);
    return v->options.stats ? tc_stats_write(v->options.stats, &summary, &context, error) : TC_OK;
}

/* What could not be shown as it should be. */
static void report_damage(const tc_viewer *v)
{
    int64_t damaged = tc_map_damaged(v->map), unreadable = tc_map_unreadable(v->map);
    if (damaged > 0 && !v->options.quiet)
        fprintf(stderr, "%s: warning: %s: damaged: %" PRId64 " tiles were shown from the next coarser level\n",
                v->program->name, v->options.terrain, damaged);
    if (unreadable > 0 && !v->failing && !v->options.quiet) /* a window has said so */
        fprintf(stderr, "%s: warning: %s: %" PRId64 " tiles could not be read\n", v->program->name, v->options.terrain,
                unreadable);
}

tc_status tc_viewer_report(const tc_viewer *v, tc_error *error)
{
    tc_status status = TC_OK;
    if (v->renderer) {
        status = report_figures(v, error);
        report_damage(v);
    } else if ((v->options.stats || v->options.json) && !v->options.quiet) {
        fprintf(stderr, "%s: warning: closed before anything was drawn: there are no figures\n", v->program->name);
    }
    return status;
}

int tc_viewer_end(const tc_viewer_program *program, tc_status status, tc_error *error)
{
    if (status == TC_OK && fflush(stdout) != 0)
        status = tc_fail(error, TC_ERR_IO, "standard output: cannot be written");
    if (status != TC_OK && error->text[0])
        fprintf(stderr, "%s: %s\n", program->name, error->text);
    return tc_exit_code(status);
}

/* What will be written is not what is read: neither file of the command line, nor what they are made of (source.h). */
static tc_status list_outputs(tc_viewer *v, tc_error *error)
{
    const tc_options *o = &v->options;
    char name[PATH_MAX];
    tc_status status = TC_OK;
    if (o->output && !o->path)
        status = tc_outputs_add(&v->outputs, o->output, error);
    for (int i = 0; o->output && o->path && i < o->frames && status == TC_OK; i++)
        if (tc_frame_pattern_name(o->output, i, name, sizeof name)) {
            status = tc_outputs_add_frame(&v->outputs, name, error);
            if (status == TC_OK && o->stats && tc_same_place(name, o->stats))
                status = tc_fail(error, TC_ERR_USAGE, "%s: expected another file than the output %s, found the same",
                                 o->stats, name);
        }
    if (status == TC_OK && o->video)
        status = tc_outputs_add(&v->outputs, o->video, error);
    if (status == TC_OK && o->stats)
        status = tc_outputs_add(&v->outputs, o->stats, error);
    const bool keeps = o->views && tc_viewer_interactive(o);
    if (status == TC_OK && keeps)
        status = tc_outputs_add(&v->outputs, o->views, error);
    if (status == TC_OK)
        status = tc_outputs_spare(&v->outputs, o->terrain, error);
    if (status == TC_OK && o->views && !keeps)
        status = tc_outputs_spare(&v->outputs, o->views, error);
    if (status == TC_OK && o->path && !(keeps && tc_same_place(o->path, o->views))) /* which is read before */
        status = tc_outputs_spare(&v->outputs, o->path, error);
    if (status == TC_OK && o->colours)
        status = tc_outputs_spare(&v->outputs, o->colours, error);
    for (int i = 0; i < o->imagery_count && status == TC_OK; i++)
        status = tc_outputs_spare(&v->outputs, o->imagery[i], error);
    return status;
}

/* Fails now where a file could not be written later, after all the work. */
static tc_status check_writable(const char *path, tc_error *error)
{
    struct stat old;
    if (!path || (stat(path, &old) == 0 && !S_ISREG(old.st_mode) && !S_ISDIR(old.st_mode)))
        return TC_OK; /* a device, a pipe: will be seen */
    return tc_outfile_probe(path, error);
}

/* ---- No file ------------------------------------------------------------------------------------------------ */

static tc_status name_default(tc_viewer *v, tc_error *error)
{
    char path[TC_DEFAULT_PATH];
    tc_status status = tc_default_terrain_path(&v->program->by_default, tc_viewer_scheme(v)->atlas, path, error);
    v->options.terrain = status == TC_OK ? tc_viewer_keep(v, path) : NULL;
    if (status == TC_OK && !v->options.terrain)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    return status;
}

static tc_status make_default(tc_viewer *v, tc_error *error)
{
    tc_viewer_progress(v, "making the default terrain, once", -1);
    return tc_default_terrain_make(&v->program->by_default, tc_viewer_scheme(v)->atlas, v->options.terrain,
                                   v->options.quiet, error);
}

static tc_status load_default(tc_viewer *v, tc_error *error)
{
    tc_watch_interrupts();
    v->writing = true;
    tc_status status = tc_viewer_wait(v, make_default, NULL, error);
    v->writing = false;
    return status == TC_OK && !v->closed ? tc_viewer_wait(v, tc_viewer_load, NULL, error) : status;
}

/* ---- The whole ---------------------------------------------------------------------------------------------- */

static tc_status run(tc_viewer *v, tc_error *error)
{
    tc_status status = tc_viewer_display_open(v, error); /* which hears what is said from here on */
    const bool by_default = status == TC_OK && !v->options.terrain;
    if (by_default)
        status = name_default(v, error);
    if (status == TC_OK)
        status = list_outputs(v, error);
    if (status == TC_OK)
        status = check_writable(v->options.stats, error);
    if (status == TC_OK) /* of a flight, the pattern itself stands for the frames */
        status = check_writable(v->options.output, error);
    if (status == TC_OK)
        status = check_writable(v->options.video, error);
    if (status == TC_OK && v->options.output)
        status = tc_check_picture_name(v->options.output, error);
    if (status == TC_OK && v->options.colours)
        status = tc_colour_file_read(v->options.colours, &v->colours, error);
    if (status == TC_OK)
        status = tc_viewer_begin_views(v, error);
    if (status == TC_OK && by_default)
        status = load_default(v, error);
    else if (status == TC_OK)
        status = tc_viewer_wait(v, tc_viewer_load, NULL, error);
    if (v->closed)
        return tc_viewer_report(v, error);
    if (status == TC_OK)
        status = place_camera(v, error);
    if (status == TC_OK)
        status = tc_stats_create(v->options.path     ? v->options.frames
                                 : v->options.output ? 1
                                                     : WINDOW_FRAMES,
                                 &v->stats, error);
    if (status == TC_OK)
        status = open_context(v, error);
    if (status == TC_OK)
        status = make_scene(v, error);
    if (status != TC_OK)
        return status;

    if (by_default)
        tc_viewer_tell(v, TC_TOLD_DONE, "the default %s; your own: %s FILE, or let a file fall on the window",
                       v->program->by_default.name, v->program->name);
    if (tc_viewer_interactive(&v->options))
        status = tc_viewer_window(v, error);
    else if (v->options.path)
        status = tc_viewer_flight(v, error);
    else
        status = tc_viewer_picture(v, error);
    if (!v->renderer)
        return status;
    /* A flight that was cut short still tells what it measured. */
    tc_error unused;
    tc_status reported = tc_viewer_report(v, status == TC_OK ? error : &unused);
    return status == TC_OK ? reported : status;
}

int tc_viewer_main(const tc_viewer_program *program, int argc, char **argv)
{
    /* Without it the software renderer gives its memory back and fetches it anew each frame: a third of its time. */
#ifdef __GLIBC__
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif

    tc_viewer viewer = {.program = program};
    tc_error error = {.text = ""};
    tc_status status = tc_options_parse(program, argc, argv, &viewer.options, &error);
    if (status == TC_OK && viewer.options.action == TC_SHOW_HELP) {
        tc_options_print_help(program, stdout);
        tc_viewer_print_keys(stdout);
    } else if (status == TC_OK && viewer.options.action == TC_SHOW_VERSION) {
        printf("%s %s\n", program->name, tc_version());
    } else if (status == TC_OK) {
        status = run(&viewer, &error);
    }
    const int code = tc_viewer_end(program, status, &error);

    tc_viewer_destroy_scene(&viewer);
    tc_context_destroy(viewer.context);
    if (viewer.window)
        viewer.window_plugin->close(viewer.window);
    tc_viewer_unload(&viewer);
    tc_flight_path_free(&viewer.path);
    tc_outputs_free(&viewer.outputs);
    tc_stats_destroy(viewer.stats);
    tc_viewer_display_close(&viewer);
    tc_viewer_forget_kept(&viewer);
    free(viewer.colours.stop);
    return code;
}

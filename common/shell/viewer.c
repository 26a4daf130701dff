/* viewer.c - a viewer from its command line to its exit code: options, terrain, context, renderer, then one of picture,
 * flight and window, then the figures. */
#include "viewer_internal.h"
#include "common/core/base/status.h"
#include "common/core/base/outfile.h"
#include "interrupt.h"
#include "plugin.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

enum { WINDOW_FRAMES = 65536 }; /* that a window's statistics look back */

/* ---- Starting ----------------------------------------------------------------------------------------------- */

/* What the source has to say. */
static void say(void *context, bool warning, const char *line)
{
    const tc_viewer *viewer = context;
    if (warning ? !viewer->options.quiet : viewer->options.verbose)
        fprintf(stderr, "%s: %s%s\n", viewer->program->name, warning ? "warning: " : "", line);
}

static tc_status load_terrain(tc_viewer *v, tc_error *error)
{
    tc_source_options source = v->options.source;
    source.say = say;
    source.say_context = v;
    tc_status status = tc_terrain_open(v->options.terrain, &source, v->options.threads, &v->terrain, error);
    if (status != TC_OK)
        return status;
    v->pyramid = v->terrain.pyramid;
    const tc_terrain_info *info = tc_pyramid_info(v->pyramid);
    const tc_level finest = tc_pyramid_level(v->pyramid, info->levels);
    v->spacing = fmin(finest.spacing_x, finest.spacing_y);
    if (v->options.verbose)
        fprintf(stderr,
                "%s: %s: %" PRId64 " x %" PRId64 " samples every %g x %g m, heights %.2f to %.2f m, %" PRId64
                " voids; %s in %.0f ms, %d levels in %.0f ms\n",
                v->program->name, v->options.terrain, finest.width, finest.height, finest.spacing_x, finest.spacing_y,
                info->z_base + info->z_min, info->z_base + info->z_max, info->void_count,
                tc_pyramid_packed_info(v->pyramid) ? "opened" : "read", v->terrain.read_ms, info->levels,
                v->terrain.build_ms);
    return TC_OK;
}

/* Where the camera starts. */
static tc_status place_camera(tc_viewer *v, tc_error *error)
{
    v->camera.fov = v->options.fov;
    v->camera.width = v->options.width;
    v->camera.height = v->options.height;
    tc_view view = v->options.view;
    if (v->options.path) {
        tc_status status = tc_flight_path_load(v->options.path, &v->path, error);
        if (status != TC_OK)
            return status;
        view = v->path.keys[0];
    } else if (!v->options.has_view) {
        const tc_terrain_info *info = tc_pyramid_info(v->pyramid);
        const tc_level finest = tc_pyramid_level(v->pyramid, info->levels);
        const tc_flight_box box = {.x_max = (double)(finest.width - 1) * finest.spacing_x,
                                   .y_max = (double)(finest.height - 1) * finest.spacing_y,
                                   .z_min = info->z_base + info->z_min,
                                   .z_max = info->z_base + info->z_max};
        view = tc_view_whole(&box, v->camera.fov, v->camera.width, v->camera.height);
    }
    tc_view_to_camera(&view, &v->camera);
    return TC_OK;
}

/* Whether there is to be a window that a person sees. */
static bool interactive(const tc_options *options)
{
    return !options->output && (!options->path || options->backend == TC_BACKEND_WINDOW);
}

static tc_status open_window(tc_viewer *v, tc_error *error)
{
    const void *table;
    tc_error reason;
    tc_status status = tc_plugin_load("window", &table, &reason);
    if (status == TC_OK) {
        v->window_plugin = table;
        const tc_window_options options = {.title = v->program->name,
                                           .width = v->options.width,
                                           .height = v->options.height,
                                           .hidden = !interactive(&v->options)};
        status = v->window_plugin->open(&options, &v->window, &reason);
    }
    if (status == TC_OK)
        status = tc_gl_load(&v->window_gl, v->window_plugin->get_proc, &reason);
    if (status != TC_OK)
        return tc_fail(error, status, "%s%s", reason.text,
                       v->options.output ? "" : "; -o FILE.png writes a picture without a display");
    v->gl = &v->window_gl;
    return TC_OK;
}

static tc_status open_context(tc_viewer *v, tc_error *error)
{
    tc_status status;
    if (interactive(&v->options) || v->options.backend == TC_BACKEND_WINDOW) {
        status = open_window(v, error);
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

/* The clipmap and what draws it, as large as frame and machine call for. */
static tc_status make_scene(tc_viewer *v, tc_error *error)
{
    v->scene = v->options.scene;
    v->scene.holes = v->terrain.voids == TC_VOIDS_HOLE && tc_pyramid_info(v->pyramid)->void_count > 0;
    /* A picture waits for all that it needs; in one go unless told otherwise. */
    if (v->options.output && !v->scene.budget)
        v->scene.budget = -1;
    if (!v->scene.samples)
        v->scene.samples = v->options.output ? 4 : 1;
    tc_clipmap_options clipmap = v->options.clipmap;
    clipmap.normals = !v->scene.unlit;
    clipmap.holes = v->scene.holes;
    if (!clipmap.n) {
        clipmap.n = tc_clipmap_n_for(&v->camera);
        if (interactive(&v->options) && tc_gl_software((const char *)v->gl->GetString(GL_RENDERER)))
            clipmap.n = clipmap.n > 255 ? 255 : clipmap.n;
    }
    tc_status status = tc_clipmap_create(v->pyramid, &clipmap, &v->clipmap, error);
    if (status == TC_OK)
        status = v->program->make_surface(v->clipmap, &v->surface, error);
    if (status == TC_OK)
        status = tc_renderer_create(v->gl, v->surface, &v->scene, &v->renderer, error);
    return status;
}

/* ---- Frames ------------------------------------------------------------------------------------------------- */

tc_status tc_viewer_measured_frame(tc_viewer *v, tc_frame_stats *frame_ret, tc_error *error)
{
    double start = tc_clock_ms();
    tc_status status = tc_renderer_frame(v->renderer, &v->camera, true, frame_ret, error);
    if (status == TC_OK)
        tc_stats_frame(v->stats, tc_clock_ms() - start, frame_ret);
    return status;
}

tc_status tc_viewer_resident_frame(tc_viewer *v, tc_error *error)
{
    /* Every frame brings something, or nothing more will come. */
    for (int idle = 0; idle < 3 && !tc_interrupted();) {
        tc_frame_stats frame;
        double start = tc_clock_ms();
        tc_status status = tc_renderer_frame(v->renderer, &v->camera, true, &frame, error);
        if (status != TC_OK)
            return status;
        if (frame.resident) {
            tc_stats_frame(v->stats, tc_clock_ms() - start, &frame);
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

/* What the scene as a whole did not need, and what its last frame did not. */
static void explain(const tc_viewer *v, const tc_stats_summary *summary, const char *const *left_out)
{
    static const char *const libraries[][2] = {{"gdal", "GDAL"}, {"oiio", "OpenImageIO"}, {"window", "GLFW"}};
    for (int i = 0; left_out[i]; i++)
        printf("left out: %s\n", left_out[i]);
    printf("left out: %" PRId64 " of %d levels: too fine for the height above ground, or not where the terrain is\n",
           tc_clipmap_levels(v->clipmap) - summary->levels_active, tc_clipmap_levels(v->clipmap));
    printf("left out: %" PRId64 " of %" PRId64 " triangles: outside the view\n",
           summary->triangles_unculled - summary->triangles, summary->triangles_unculled);
    for (size_t i = 0; i < sizeof libraries / sizeof *libraries; i++)
        if (!tc_plugin_loaded(libraries[i][0]))
            printf("left out: %s: not loaded\n", libraries[i][1]);
}

/* Writes --stats, prints --json and --explain, and a line about a measured flight. */
static tc_status report(tc_viewer *v, tc_error *error)
{
    tc_stats_summary summary;
    tc_stats_summarise(v->stats, &summary);
    tc_stats_context context = {.renderer = (const char *)v->gl->GetString(GL_RENDERER),
                                .backend = v->context ? tc_context_backend(v->context) : "window",
                                .bytes_decoded = tc_terrain_bytes_decoded(v->pyramid),
                                .left_out = tc_renderer_left_out(v->renderer)};
    tc_renderer_memory(v->renderer, &context.memory);
    if (v->options.explain && !v->options.json) /* which says it, too */
        explain(v, &summary, context.left_out);
    if (v->options.json)
        tc_stats_print(&summary, &context, stdout);
    else if (v->options.path && !v->options.output && !v->options.quiet)
        printf("%" PRId64 " frames: %.2f ms median, %.2f ms p95, %.2f ms max; %" PRId64 " triangles, %" PRId64
               " draws, %" PRId64 " levels\n",
               summary.frames, summary.frame_median, summary.frame_p95, summary.frame_max, summary.triangles,
               summary.draws, summary.levels_active);
    return v->options.stats ? tc_stats_write(v->options.stats, &summary, &context, error) : TC_OK;
}

/* What could not be shown as it should be. */
static void report_damage(const tc_viewer *v)
{
    int64_t tiles = tc_terrain_damaged(v->pyramid);
    if (tiles > 0 && !v->options.quiet)
        fprintf(stderr, "%s: warning: %s: damaged: %" PRId64 " tiles were shown from the next coarser level\n",
                v->program->name, v->options.terrain, tiles);
}

/* Fails now where a file could not be written later, after all the work. */
static tc_status check_writable(const char *path, tc_error *error)
{
    struct stat old;
    if (!path || (stat(path, &old) == 0 && !S_ISREG(old.st_mode) && !S_ISDIR(old.st_mode)))
        return TC_OK; /* a device, a pipe: will be seen */
    return tc_outfile_probe(path, error);
}

/* ---- The whole ---------------------------------------------------------------------------------------------- */

static tc_status run(tc_viewer *v, tc_error *error)
{
    tc_status status = check_writable(v->options.stats, error);
    if (status == TC_OK) /* of a flight, the pattern itself stands for the frames */
        status = check_writable(v->options.output, error);
    if (status == TC_OK && v->options.output)
        status = tc_check_picture_name(v->options.output, error);
    if (status == TC_OK)
        status = load_terrain(v, error);
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

    tc_watch_interrupts();
    if (interactive(&v->options))
        status = tc_viewer_window(v, error);
    else if (v->options.path)
        status = tc_viewer_flight(v, error);
    else
        status = tc_viewer_picture(v, error);
    /* A flight that was cut short still tells what it measured. */
    tc_error unused;
    tc_status reported = report(v, status == TC_OK ? error : &unused);
    report_damage(v);
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
    tc_status status = tc_options_parse(argc, argv, &viewer.options, &error);
    if (status == TC_OK && viewer.options.action == TC_SHOW_HELP) {
        tc_options_print_help(&(tc_options_program){.name = program->name, .summary = program->summary}, stdout);
        tc_viewer_print_keys(stdout);
    } else if (status == TC_OK && viewer.options.action == TC_SHOW_VERSION) {
        printf("%s %s\n", program->name, tc_version());
    } else if (status == TC_OK) {
        status = run(&viewer, &error);
    }
    if (status == TC_OK && fflush(stdout) != 0)
        status = tc_fail(&error, TC_ERR_IO, "standard output: cannot be written");
    if (status != TC_OK)
        fprintf(stderr, "%s: %s\n", program->name, error.text);

    tc_renderer_destroy(viewer.renderer);
    tc_context_destroy(viewer.context);
    if (viewer.window)
        viewer.window_plugin->close(viewer.window);
    if (viewer.surface)
        viewer.surface->destroy(viewer.surface);
    tc_clipmap_destroy(viewer.clipmap);
    tc_terrain_close(&viewer.terrain);
    tc_flight_path_free(&viewer.path);
    tc_stats_destroy(viewer.stats);
    return tc_exit_code(status);
}

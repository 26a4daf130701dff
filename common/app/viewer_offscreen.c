/* viewer_offscreen.c - pictures and flights without a window. */
#include "viewer_internal.h"
#include "common/base/outfile.h"
#include "common/base/status.h"
#include "common/input/plugin.h"
#include "interrupt.h"
#include "video.h"

#include <limits.h>
#include <stdlib.h>
#include <unistd.h>

/* Room for one frame's pixels. */
static tc_status allocate_frame(const tc_viewer *v, uint8_t **rgb_ret, tc_error *error)
{
    uint8_t *rgb = malloc((size_t)v->camera.width * (size_t)v->camera.height * 3);
    if (!rgb)
        return tc_fail(error, TC_ERR_MEMORY, "picture: not enough memory for %d x %d pixels", v->camera.width,
                       v->camera.height);
    *rgb_ret = rgb;
    return TC_OK;
}

tc_status tc_viewer_picture(tc_viewer *v, tc_error *error)
{
    uint8_t *rgb = NULL;
    tc_status status = allocate_frame(v, &rgb, error);
    if (status == TC_OK)
        status = tc_viewer_resident_frame(v, error);
    if (status == TC_OK)
        status = tc_viewer_write_frame(v, v->options.output, rgb, error);
    free(rgb);
    return status;
}

/* Tells a person how far the flight is; `done` of all frames. */
static void show_progress(const tc_viewer *v, int done)
{
    if (!v->options.quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\rframe %d of %d%s", done, v->options.frames, done == v->options.frames ? "\n" : "");
}

/* Draws what the first frame of a measured flight needs, without measuring it. */
static tc_status warm_up(tc_viewer *v, tc_error *error)
{
    tc_frame_stats frame = {0};
    for (int idle = 0; idle < 3 && !frame.resident && !tc_interrupted();) {
        tc_status status = tc_viewer_frame(v, true, &frame, error);
        if (status != TC_OK)
            return status;
        tc_stats_load(v->stats, &frame);
        idle = frame.samples_updated > 0 ? 0 : idle + 1;
    }
    return TC_OK;
}

/* Where the frames of a flight go that are kept. */
typedef struct kept_frames {
    uint8_t *rgb;
    const struct tc_video_plugin *plugin;
    tc_video *video; /* NULL: no film */
    tc_outfile file; /* of it */
} kept_frames;

static tc_status begin_video(const tc_viewer *v, kept_frames *kept, tc_error *error)
{
    const void *table;
    tc_status status = tc_plugin_load("video", &table, error);
    if (status != TC_OK)
        return status;
    kept->plugin = table;
    status = tc_outfile_begin(v->options.video, &kept->file, error);
    if (status != TC_OK)
        return status;
    int width = v->camera.width, height = v->camera.height;
    if ((width | height) & 1 && !v->options.quiet)
        fprintf(stderr, "%s: warning: --video: films have even sizes: the last %s is left out\n", v->program->name,
                width & 1 ? height & 1 ? "row and column" : "column" : "row");
    status = kept->plugin->begin(kept->file.temporary, v->options.video, width, height,
                                 v->options.rate ? v->options.rate : TC_VIDEO_RATE, &kept->video, error);
    return status == TC_OK ? TC_OK : tc_outfile_end(&kept->file, status, error);
}

static tc_status begin_kept(const tc_viewer *v, kept_frames *kept, tc_error *error)
{
    tc_status status = allocate_frame(v, &kept->rgb, error);
    return status == TC_OK && v->options.video ? begin_video(v, kept, error) : status;
}

static tc_status keep_frame(tc_viewer *v, kept_frames *kept, int i, tc_error *error)
{
    const char *pattern = v->options.output;
    char name[PATH_MAX];
    tc_status status = tc_viewer_resident_frame(v, error);
    if (status == TC_OK && pattern && !tc_frame_pattern_name(pattern, i, name, sizeof name))
        status = tc_fail(error, TC_ERR_USAGE, "--output: expected a shorter name");
    if (status == TC_OK && pattern)
        status = tc_viewer_write_frame(v, name, kept->rgb, error);
    else if (status == TC_OK)
        tc_renderer_read(v->renderer, kept->rgb, NULL);
    if (status == TC_OK && kept->video)
        status = kept->plugin->add(kept->video, kept->rgb, error);
    return status;
}

static tc_status end_kept(kept_frames *kept, tc_status status, tc_error *error)
{
    if (kept->video) {
        status = kept->plugin->end(kept->video, status, error);
        status = tc_outfile_end(&kept->file, status, error);
    }
    free(kept->rgb);
    return status;
}

tc_status tc_viewer_flight(tc_viewer *v, tc_error *error)
{
    const bool keeps = tc_viewer_keeps(&v->options);
    kept_frames kept = {0};
    tc_status status = keeps ? begin_kept(v, &kept, error) : warm_up(v, error);
    for (int i = 0; status == TC_OK && i < v->options.frames; i++) {
        if (tc_interrupted()) {
            status = tc_fail(error, TC_ERR_IO, "interrupted after %d of %d frames", i, v->options.frames);
            break;
        }
        const tc_pose view = tc_flight_path_view(&v->path, i, v->options.frames);
        tc_viewer_place(v, &view);
        tc_frame_stats frame;
        status = keeps ? keep_frame(v, &kept, i, error) : tc_viewer_measured_frame(v, &frame, error);
        if (status == TC_OK)
            show_progress(v, i + 1);
    }
    return end_kept(&kept, status, error);
}

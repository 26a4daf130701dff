/* viewer_offscreen.c - pictures and flights without a window. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "interrupt.h"

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

tc_status tc_viewer_flight(tc_viewer *v, tc_error *error)
{
    const char *pattern = v->options.output;
    uint8_t *rgb = NULL;
    tc_status status = pattern ? allocate_frame(v, &rgb, error) : warm_up(v, error);
    for (int i = 0; status == TC_OK && i < v->options.frames; i++) {
        if (tc_interrupted()) {
            status = tc_fail(error, TC_ERR_IO, "interrupted after %d of %d frames", i, v->options.frames);
            break;
        }
        const tc_pose view = tc_flight_path_view(&v->path, i, v->options.frames);
        tc_viewer_place(v, &view);
        if (pattern) {
            char name[PATH_MAX];
            status = tc_viewer_resident_frame(v, error);
            if (status == TC_OK && !tc_frame_pattern_name(pattern, i, name, sizeof name))
                status = tc_fail(error, TC_ERR_USAGE, "--output: expected a shorter name");
            if (status == TC_OK)
                status = tc_viewer_write_frame(v, name, rgb, error);
        } else {
            tc_frame_stats frame;
            status = tc_viewer_measured_frame(v, &frame, error);
        }
        if (status == TC_OK)
            show_progress(v, i + 1);
    }
    free(rgb);
    return status;
}

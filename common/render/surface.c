/* surface.c - what is the same for every surface: memory of views and frames. */
#include "surface.h"

#include <stdlib.h>

void tc_windows_destroy(tc_windows *windows)
{
    for (int chart = 0; chart < TC_MAX_CHARTS; chart++)
        tc_clipmap_destroy(windows->clipmap[chart]);
    *windows = (tc_windows){0};
}

tc_view tc_view_of(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                   const tc_frame_options *options)
{
    tc_view view = {.surface = surface,
                    .windows = windows,
                    .camera = *camera,
                    .culled = options->cull_camera ? *options->cull_camera : *camera,
                    .options = *options};
    view.frozen = options->cull_camera != NULL;
    view.options.cull_camera = NULL; /* which may not live as long as the view */
    return view;
}

tc_view *tc_view_allocate(const tc_surface *surface)
{
    return calloc(1, surface->view_bytes);
}

bool tc_frame_allocate(const tc_surface *surface, tc_frame *frame)
{
    size_t most = (size_t)(surface->draw_capacity + surface->wall_capacity);
    *frame = (tc_frame){.draws = calloc(most, sizeof *frame->draws),
                        .instances = surface->instances ? calloc(most, sizeof *frame->instances) : NULL};
    if (frame->draws && (frame->instances || !surface->instances))
        return true;
    tc_frame_free(frame);
    return false;
}

void tc_frame_free(tc_frame *frame)
{
    free(frame->draws);
    free(frame->instances);
    frame->draws = NULL;
    frame->instances = NULL;
}

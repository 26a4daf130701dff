/* renderer.h - draws a surface over a clipmap: vertex textures, programs, frames. */
#ifndef TC_RENDERER_H
#define TC_RENDERER_H

#include "common/terraclip.h"
#include "surface.h"
#include "common/gl/gl.h"
#include "level_textures.h"
#include "scene_needs.h"
#include "scene_objects.h"
#include "scene_programs.h"
#include "sight.h"
#include "target.h"

typedef struct tc_frame_stats {
    double update_ms, draw_ms; /* CPU time of filling windows and uploading; of drawing (until finished, offscreen) */
    int64_t triangles, triangles_unculled;
    int draws; /* of the terrain */
    int wall_draws;
    int64_t wall_triangles;                        /* below a flat terrain's edge */
    int blocks, blocks_unculled;                   /* of the draws those that cover area; with those outside the view */
    int levels_active, levels_fine, levels_beyond; /* drawn; too fine for the view; beyond the horizon */
    int64_t samples_updated, bytes_uploaded;
    bool resident;          /* the clipmap held all that this view needs */
    bool failed;            /* a part of that could not be read, and will be tried again */
    int64_t texels_updated; /* of imagery */
    bool imagery_failed;
    int blocks_of[TC_DRAWN_LEVELS]; /* drawn of each level, coarse to fine */
    double tolerance, error_bound;  /* pixels; 0: none was asked for; INFINITY: not known */
    double throttle;                /* octaves by which it is drawn coarser */
} tc_frame_stats;

/* Bytes by item, on both sides of the driver. */
typedef struct tc_memory_stats {
    size_t geometry, heights, normals, imagery, field;
} tc_memory_stats;

typedef struct tc_renderer tc_renderer;

/* A viewer of a surface, which must outlive it, with windows of its own. gl must be current. */
tc_status tc_renderer_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_options *options,
                             tc_renderer **renderer_ret, tc_error *error);
/* Another viewer of the surface of these objects: it shares geometry, colours and programs with all others of them,
 * which may be destroyed before it. */
tc_status tc_renderer_create_with(const tc_gl *gl, tc_scene_objects *objects, const tc_scene_options *options,
                                  tc_renderer **renderer_ret, tc_error *error);
tc_scene_objects *tc_renderer_objects(const tc_renderer *renderer);
void tc_renderer_destroy(tc_renderer *renderer);

/* Changes what may change while running: level_colours, wireframe, sun, frame, budget. */
void tc_renderer_set_options(tc_renderer *renderer, const tc_scene_options *options);

/* How many samples a pixel the renderer's own pictures have from the next one on; at most what the driver has. */
void tc_renderer_set_samples(tc_renderer *renderer, int samples);

/* Updates the clipmap for the camera within the budget, uploads, and draws a frame of camera->width x height into the
 * renderer's own framebuffer. finish: waits until it is done, so that draw_ms is the whole cost, and for what must be
 * decoded first. Over a flat background the terrain's vertices, uniforms and textures stay bound, for tests that run
 * its vertex stage once more. */
tc_status tc_renderer_frame(tc_renderer *renderer, const tc_camera *camera, bool finish, tc_frame_stats *stats_ret,
                            tc_error *error);

/* The same into a target of the caller's, as it is seen. What does not fit the target is an error before anything is
 * drawn. Where the target keeps state, all of OpenGL's is as before, also on failure; else it is anything. */
tc_status tc_renderer_draw(tc_renderer *renderer, tc_target *target, const tc_sight *sight, bool finish,
                           tc_frame_stats *stats_ret, tc_error *error);

/* Copies the last frame to the bound window framebuffer (id 0). */
void tc_renderer_present(tc_renderer *renderer, int window_width, int window_height);

/* Reads the last frame: rgb 3 bytes a pixel, rows top to bottom, width x height of its camera. depth, where not NULL:
 * reversed depth (0 at
 * infinity; see tc_view_unproject); only where a pixel is one sample, rows top to bottom. */
void tc_renderer_read(tc_renderer *renderer, uint8_t *rgb, float *depth);

void tc_renderer_memory(const tc_renderer *renderer, tc_memory_stats *stats_ret);

/* What there is for the scene, and its last frame: for explain.c and tests. Valid until the next call. */
typedef struct tc_renderer_use {
    const tc_surface *surface;
    const tc_scene_needs *needs;
    const tc_scene_programs *programs;
    const tc_level_textures *textures;
    const tc_windows *windows;
    const struct tc_drape *drape; /* NULL: no imagery */
    const tc_frame_stats *frame;
} tc_renderer_use;
tc_renderer_use tc_renderer_used(const tc_renderer *renderer);

/* The view of the last frame: heights in it are those drawn, and nothing is read for them. NULL: there was none yet. */
const tc_view *tc_renderer_view(const tc_renderer *renderer);

#endif

/* scene.h - a planar scene over a pyramid, for picture tests: context, clipmap, surface, renderer. */
#ifndef SCENE_H
#define SCENE_H

#include "common/gl/context.h"
#include "common/render/renderer.h"

typedef struct scene {
    const tc_field *field; /* not owned */
    tc_clipmap *clipmap;
    tc_surface *surface;
    tc_renderer *renderer;
    tc_view *view; /* of scene_look() */
} scene;

/* An offscreen context: what TERRACLIP_BACKEND names (auto, egl or osmesa), else OSMesa where there is one, the
 * reference; NULL, with the reason printed, where none can be had. The first one is named on stdout. */
tc_context *scene_context(void);

/* The same for measurements: on a GPU where there is one. */
tc_context *scene_context_fastest(void);

/* Ends the program with the error on failure. n: 0 for the default. */
scene scene_create(const tc_context *context, const tc_field *field, int n, const tc_scene_options *options);
void scene_destroy(scene *s);

/* What a camera sees of the scene's windows as they stand; valid until the next call. And the height drawn in it. */
const tc_view *scene_look(scene *s, const tc_camera *camera, const tc_frame_options *options);
bool scene_height(scene *s, const tc_camera *camera, const tc_frame_options *options, double x, double y,
                  double *z_ret);

/* Draws the view; resident: frames until everything it needs is there, else one frame. */
tc_frame_stats scene_draw(scene *s, const tc_camera *camera, bool resident);

/* Frames of a surface whose draws are left out have windows, uniforms and what stays bound for tests that run its
 * vertex stage once more, but no triangles. */
void scene_leave_draws_out(tc_surface *surface);
void scene_put_draws_back(tc_surface *surface);

/* The drawn frame, rows top to bottom; caller frees. */
uint8_t *scene_pixels(scene *s, const tc_camera *camera);

/* Writes a binary PPM: for a person to look at. */
void write_ppm(const char *path, const uint8_t *rgb, int width, int height);

#endif

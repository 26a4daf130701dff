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
} scene;

/* An offscreen context (OSMesa where there is one: the reference); NULL, with the reason printed, where none can be
 * had. The first one is named on stdout. */
tc_context *scene_context(void);

/* The same for measurements: on a GPU where there is one. */
tc_context *scene_context_fastest(void);

/* Ends the program with the error on failure. n: 0 for the default. */
scene scene_create(const tc_context *context, const tc_field *field, int n, const tc_scene_options *options);
void scene_destroy(scene *s);

/* Draws the view; resident: frames until everything it needs is there, else one frame. */
tc_frame_stats scene_draw(scene *s, const tc_camera *camera, bool resident);

/* The drawn frame, rows top to bottom; caller frees. */
uint8_t *scene_pixels(scene *s, const tc_camera *camera);

/* Writes a binary PPM: for a person to look at. */
void write_ppm(const char *path, const uint8_t *rgb, int width, int height);

#endif

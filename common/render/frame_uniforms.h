/* frame_uniforms.h - what every stage of a frame knows: the uniform block of shaders/frame.glsl. */
#ifndef TC_FRAME_UNIFORMS_H
#define TC_FRAME_UNIFORMS_H

#include "level_textures.h"
#include "palette.h"
#include "scene_needs.h"
#include "sight.h"
#include "surface.h"
#include "target.h"

typedef struct tc_frame_uniforms {
    float view_projection[16];
    float surface[TC_SURFACE_VECTORS][4];
    float layer[TC_MAX_LAYERS][TC_LAYER_VECTORS][4];
    float image[TC_MAX_LAYERS][TC_LAYER_VECTORS][4]; /* of imagery (drape.h), as layer */
    float window[TC_MAX_LAYERS][4];
    float eye[4];
    float ray[3][4];
    float sun[4];
    float dusk[4]; /* what there is where the sun is low */
    float heights[4];
    float haze[4];
    float zenith[4];
    float lens[4];
    float pixel[3][4];
    float beyond[4];
    float contours[4];
    float around[5][4]; /* of what a map that ends is shown with */
    float space[3][4];  /* axes of the eye that stars are seen by */
    float body[TC_BODY_VECTORS][4];
    int32_t whole[TC_SURFACE_INTEGERS][4];
    int32_t image_stack[TC_MAX_CHARTS][4];
    float image_scale[TC_MAX_CHARTS][4];
} tc_frame_uniforms;

/* Light, air and camera of a frame; nothing in it depends on anything but the view. contours: metres between lines of
 * equal height, of the true ones; 0: none. exaggeration: heights over those. sun: where light comes from. */
void tc_frame_uniforms_set(tc_frame_uniforms *uniforms, const tc_view *view, const tc_palette *palette,
                           const tc_sight *sight, const tc_target_place *place, const tc_frame *frame,
                           const tc_layers *layers, const tc_scene_needs *needs, double contours, double exaggeration,
                           const tc_sun *sun);

#endif

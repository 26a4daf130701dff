/* drawn.h - a planar scene as the driver draws it, held against the same in double: cracks, depths, vertices, and
 * numbers that are none. */
#ifndef DRAWN_H
#define DRAWN_H

#include "scene.h"

typedef struct drawn_figures {
    int views;
    int64_t terrain, cracks;    /* pixels (watertight.h) */
    int64_t depths, vertices;   /* that were compared */
    double depth_px, vertex_px; /* worst distance of a pixel's depth from the surface; of a vertex within the frame */
    int64_t numbers;            /* handed to OpenGL or put out by the vertex stage, */
    int64_t not_finite;         /* and of them not finite */
} drawn_figures;

/* What is compared; a planar scene with watertight_options() and one sample a pixel. */
typedef struct drawn {
    const tc_gl *gl;
    scene *scene;
    unsigned program; /* of the vertex stage alone */
} drawn;

drawn drawn_create(const tc_context *context, scene *s);
void drawn_destroy(drawn *d);

/* Draws the view once all of it is there, and adds what it finds. */
void drawn_look(drawn *d, const tc_camera *camera, const tc_scene_options *options, drawn_figures *figures);

/* The parts of it. Depths: every `step`th pixel's unprojected depth against height(): how many pixels away from
 * the pixel's middle the surface is as near as that at last, in steps of half as much again from 0.01 on. */
void drawn_depths(scene *s, const tc_camera *camera, const tc_frame_options *options, int step, drawn_figures *figures);
/* Vertices of the last frame's strips, by transform feedback, and all uniforms and heights that it was drawn with. */
void drawn_vertices(drawn *d, const tc_camera *camera, const tc_frame_options *options, drawn_figures *figures);

#endif

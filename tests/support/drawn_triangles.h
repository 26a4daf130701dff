/* drawn_triangles.h - the triangles of a frame as the driver puts them together, of whatever surface. */
#ifndef DRAWN_TRIANGLES_H
#define DRAWN_TRIANGLES_H

#include "scene.h"

typedef struct drawn_triangles {
    int64_t count;       /* of strips, those without area too */
    float (*clip)[3][4]; /* clip coordinates; owned */
} drawn_triangles;

typedef struct triangle_catcher {
    const tc_gl *gl;
    scene *scene;
    unsigned program, query;
} triangle_catcher;

/* For an unlit scene before a flat background. */
triangle_catcher triangle_catcher_create(const tc_gl *gl, scene *s);
void triangle_catcher_destroy(triangle_catcher *c);

/* Draws the view, without pixels, once all of it is there. Freed with free(clip). */
drawn_triangles triangle_catcher_draw(triangle_catcher *c, const tc_camera *camera);

/* Pixels that a triangle covers; 0: not all of it lies in the frame. */
double drawn_triangle_area(const float clip[3][4], const tc_camera *camera);

#endif

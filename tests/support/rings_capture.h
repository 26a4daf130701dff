/* rings_capture.h - the rings' vertices as the driver computes them, against the oracle. */
#ifndef RINGS_CAPTURE_H
#define RINGS_CAPTURE_H

#include "globe_scene.h"
#include "rings_oracle.h"

enum { RINGS_MAX_LEVELS = 48, RINGS_CHARTS = 3 }; /* longitude and latitude, caps */

/* One captured vertex: what rings.vert puts out, and what it looked up. */
typedef struct captured_vertex {
    float clip[4];              /* gl_Position */
    float position[3];          /* from the eye, metres */
    float map[RINGS_CHARTS][4]; /* of a chart: samples from the viewer's cell, layer (-1: none), coarser share */
} captured_vertex;

typedef struct rings_capture {
    globe_scene *globe;
    GLuint program, plain; /* the latter without additions: gl_Position alone */
    captured_vertex *vertices;
    uint32_t *elements; /* which vertices are captured */
    float (*positions)[4];
    double place[TC_MAX_CHARTS][2]; /* of the viewer looked at last, finest samples */
} rings_capture;

rings_capture rings_capture_create(globe_scene *globe);
void rings_capture_destroy(rings_capture *c);

/* Worst errors of the vertices of a level; the disc inside the finest one counts as one more level. */
typedef struct rings_error {
    double over_radius; /* of the position, share of the radius */
    double pixels;      /* on the screen, of vertices within the frame */
    double texels;      /* of the place, samples of the level that the driver read */
    int64_t vertices, seen;
    int64_t
        differ; /* where rings_map.c has another height: on the very edge of a window, where either level is right */
} rings_error;

/* Draws the view (without pixels) and compares every `step`-th column of the drawn levels; adds to error[level]. */
void rings_capture_compare(rings_capture *c, const tc_camera *camera, int step, rings_error error[RINGS_MAX_LEVELS]);

/* How many pixels every `step`-th column of the five finest levels is off, right and up; NAN outside the frame. Returns
 * how many there are, at most `capacity`. */
int rings_capture_offsets(rings_capture *c, const tc_camera *camera, int step, int capacity, double (*offset)[2]);

/* Numbers of all drawn vertices (gl_Position and position) that are not finite. */
int64_t rings_capture_not_finite(rings_capture *c, const tc_camera *camera);

/* Vertices whose gl_Position is another in the program without additions, after the same frame. */
int64_t rings_capture_additions(rings_capture *c, const tc_camera *camera);

#endif

/* faces_capture.h - vertices of surfaces over faces as the driver computes them, against the plainest of long double
 * arithmetic: longitudes, latitudes, absolute places, nothing relative to the viewer but the last subtraction. */
#ifndef FACES_CAPTURE_H
#define FACES_CAPTURE_H

#include "scene.h"
#include "spherical/faces_internal.h"

typedef struct faces_capture {
    const tc_gl *gl;
    scene *scene; /* not owned */
    GLuint program;
} faces_capture;

/* defines: of the scene, "" for none. */
faces_capture faces_capture_create(const tc_gl *gl, scene *s, const char *defines);
void faces_capture_destroy(faces_capture *c);

typedef struct faces_error {
    double pixels;  /* worst, of vertices within the frame */
    double samples; /* worst: of the place told to the fragment stage, in samples of the level */
    int64_t vertices, seen, not_finite;
    int64_t between; /* of those seen that were on their way to a coarser edge */
} faces_error;

/* Draws the view and compares all vertices of what is drawn of it; adds to *error. options: those that the scene draws
 * with, NULL for none. */
void faces_capture_compare(faces_capture *c, const tc_camera *camera, const tc_frame_options *options,
                           faces_error *error);

/* Vertices of a view that several blocks draw, and how many of them not all to the same bits. */
typedef struct faces_shared {
    int64_t shared, across; /* across: by blocks of several charts */
    int64_t different;
} faces_shared;
void faces_capture_shared(faces_capture *c, const tc_camera *camera, const tc_frame_options *options,
                          faces_shared *shared);

#endif

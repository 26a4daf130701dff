/* plain_mesh.h - meshes of ready-made positions, drawn with a position-only shader: what frames are held against.
 *
 * Brute force is the full-resolution mesh: all samples of the finest level. On a planet these are chart 0's, at the
 * heights of tc_map_height(), with a vertex on each pole and flat triangles between. */
#ifndef PLAIN_MESH_H
#define PLAIN_MESH_H

#include "common/map/map.h"
#include "common/render/surface.h"
#include "common/gl/gl.h"

typedef struct plain_mesh {
    GLuint program, vao, vertices, indices, draws, framebuffer, renderbuffers[2];
    int width, height; /* of the frame */
    int strip_draws, list_draws;
    int64_t triangles; /* of brute force */
    GLint matrix;
} plain_mesh;

/* Positions are relative to the eye; draws are strips first, then triangle lists. */
void plain_create(const tc_gl *gl, int width, int height, plain_mesh *m, const float (*positions)[3], size_t count,
                  const uint16_t *indices, int index_count, const tc_draw *draws, int strips, int lists);
void plain_destroy(const tc_gl *gl, plain_mesh *m);

/* near_plane: metres. one_sided: backs of triangles are left out. Not waited for. */
void plain_draw(const tc_gl *gl, const plain_mesh *m, const tc_camera *camera, double near_plane, bool one_sided);

/* Reversed depths of the frame, rows top to bottom, to be freed; for tc_view_error_add(). */
float *plain_depth(const tc_gl *gl, const plain_mesh *m);

/* More samples than this are not put into one mesh: with the driver's copy they take some 30 bytes each. */
#define PLAIN_MOST_SAMPLES ((int64_t)48 << 20)

/* For this camera. False, saying so on stdout, where there are more. */
bool plain_brute_flat(const tc_gl *gl, const tc_field *field, const tc_camera *camera, plain_mesh *m);
bool plain_brute_globe(const tc_gl *gl, const tc_map *atlas, const tc_camera *camera, plain_mesh *m);

#endif

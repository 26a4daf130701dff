/* scene_objects.h - what all views of one map and scheme share on the GPU: support geometry, colours, programs. */
#ifndef TC_SCENE_OBJECTS_H
#define TC_SCENE_OBJECTS_H

#include "palette.h"
#include "scene_programs.h"

typedef struct tc_scene_objects {
    int users;
    GLuint vertices, indices; /* of the support geometry; draws select parts of them */
    size_t vertex_bytes, index_bytes;
    int n; /* of the windows that the programs are made for */
    const char *scheme;
    GLuint ramp;
    tc_palette palette;
    tc_scene_programs programs;
} tc_scene_objects;

/* For one user, with the programs that the needs call for; NULL: none so far. */
tc_status tc_scene_objects_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_needs *needs,
                                  tc_scene_objects **objects_ret, tc_error *error);

/* Takes one more user in, whose surface must be of the same scheme, geometry and windows. */
tc_status tc_scene_objects_share(tc_scene_objects *objects, const tc_surface *surface, tc_error *error);

/* Of one of its users; the last one destroys it. */
void tc_scene_objects_release(const tc_gl *gl, tc_scene_objects *objects);

/* Bytes of a vertex. */
size_t tc_vertex_bytes(const tc_geometry *geometry);

#endif

/* scene_objects.h - what all views of one map and scheme share on the GPU: support geometry, colours, programs. */
#ifndef TC_SCENE_OBJECTS_H
#define TC_SCENE_OBJECTS_H

#include "palette.h"
#include "scene_programs.h"

typedef struct tc_scene_objects {
    int users;
    const tc_surface *surface;
    GLuint vertices, indices; /* of the support geometry; draws select parts of them */
    GLenum index_type;
    size_t bytes; /* of both */
    GLuint ramp;
    tc_palette palette;
    tc_scene_programs programs;
} tc_scene_objects;

/* For one user, without programs so far. The surface outlives them. Of the options only colours and shade count. */
tc_status tc_scene_objects_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_options *options,
                                  tc_scene_objects **objects_ret, tc_error *error);

/* The same for one more user. */
tc_scene_objects *tc_scene_objects_share(tc_scene_objects *objects);

/* Of one of its users; the last one destroys it. */
void tc_scene_objects_release(const tc_gl *gl, tc_scene_objects *objects);

/* Bytes of a vertex. */
size_t tc_vertex_bytes(const tc_geometry *geometry);

#endif

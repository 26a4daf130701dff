/* scene_objects.c - geometry and colours of a scene, counted by their users. */
#include "scene_objects.h"

#include <stdlib.h>
#include <string.h>

#include "common/base/status.h"

size_t tc_vertex_bytes(const tc_geometry *g)
{
    return g->format == TC_VERTEX_FLOAT_4 ? 4 * sizeof(float) : 2 * sizeof(uint16_t);
}

static size_t geometry_bytes(const tc_geometry *g, size_t *index_bytes_ret)
{
    *index_bytes_ret = (size_t)g->index_count * sizeof *g->indices;
    return (size_t)g->vertex_count * tc_vertex_bytes(g);
}

static void create_geometry(const tc_gl *gl, const tc_geometry *g, tc_scene_objects *o)
{
    o->vertex_bytes = geometry_bytes(g, &o->index_bytes);
    gl->CreateBuffers(1, &o->vertices);
    gl->NamedBufferStorage(o->vertices, (GLsizeiptr)o->vertex_bytes, g->vertices, 0);
    gl->CreateBuffers(1, &o->indices);
    gl->NamedBufferStorage(o->indices, (GLsizeiptr)o->index_bytes, g->indices, 0);
}

static void create_ramp(const tc_gl *gl, tc_scene_objects *o)
{
    gl->CreateTextures(GL_TEXTURE_1D, 1, &o->ramp);
    gl->TextureStorage1D(o->ramp, 1, GL_RGBA8, TC_RAMP_SIZE);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
}

tc_status tc_scene_objects_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_needs *needs,
                                  tc_scene_objects **objects_ret, tc_error *error)
{
    tc_scene_objects *o = calloc(1, sizeof *o);
    if (!o)
        return tc_fail(error, TC_ERR_MEMORY, "renderer: not enough memory");
    *o = (tc_scene_objects){.users = 1, .n = tc_clipmap_n(surface->clipmap[0]), .scheme = surface->name};
    o->palette = tc_palette_make(tc_field_info(tc_clipmap_field(surface->clipmap[0])));
    tc_status status = needs ? tc_scene_programs_build(gl, surface, needs, &o->programs, error) : TC_OK;
    if (status == TC_OK) {
        tc_gl_forget_errors(gl); /* what went wrong before is none of ours */
        create_geometry(gl, &surface->geometry, o);
        create_ramp(gl, o);
        status = tc_gl_allocated(gl, "geometry", error);
    }
    if (status == TC_OK) {
        gl->TextureSubImage1D(o->ramp, 0, 0, TC_RAMP_SIZE, GL_RGBA, GL_UNSIGNED_BYTE, o->palette.ramp);
        *objects_ret = o;
    } else {
        tc_scene_objects_release(gl, o);
    }
    return status;
}

tc_status tc_scene_objects_share(tc_scene_objects *o, const tc_surface *surface, tc_error *error)
{
    size_t index_bytes, vertex_bytes = geometry_bytes(&surface->geometry, &index_bytes);
    if (strcmp(surface->name, o->scheme) != 0 || tc_clipmap_n(surface->clipmap[0]) != o->n ||
        vertex_bytes != o->vertex_bytes || index_bytes != o->index_bytes)
        return tc_fail(error, TC_ERR_USAGE,
                       "view: expected %s with windows of %d samples as of the others, found %s with %d", o->scheme,
                       o->n, surface->name, tc_clipmap_n(surface->clipmap[0]));
    o->users++;
    return TC_OK;
}

void tc_scene_objects_release(const tc_gl *gl, tc_scene_objects *o)
{
    if (!o || --o->users > 0)
        return;
    tc_scene_programs_destroy(gl, &o->programs);
    gl->DeleteTextures(1, &o->ramp);
    gl->DeleteBuffers(2, (GLuint[]){o->vertices, o->indices});
    free(o);
}

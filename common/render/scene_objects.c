/* scene_objects.c - geometry and colours of a scene, counted by their users. */
#include "scene_objects.h"

#include <stdlib.h>

#include "common/base/status.h"

size_t tc_vertex_bytes(const tc_geometry *g)
{
    return g->format == TC_VERTEX_FLOAT_4 ? 4 * sizeof(float) : 2 * sizeof(uint16_t);
}

static void create_geometry(const tc_gl *gl, tc_scene_objects *o)
{
    const tc_geometry *g = &o->surface->geometry;
    const size_t vertices = (size_t)g->vertex_count * tc_vertex_bytes(g);
    const size_t indices = (size_t)g->index_count * (size_t)g->index_bytes;
    o->index_type = g->index_bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    o->bytes = vertices + indices;
    gl->CreateBuffers(1, &o->vertices);
    gl->NamedBufferStorage(o->vertices, (GLsizeiptr)vertices, g->vertices, 0);
    gl->CreateBuffers(1, &o->indices);
    gl->NamedBufferStorage(o->indices, (GLsizeiptr)indices, g->indices, 0);
}

static void create_ramp(const tc_gl *gl, tc_scene_objects *o)
{
    gl->CreateTextures(GL_TEXTURE_1D, 1, &o->ramp);
    gl->TextureStorage1D(o->ramp, 1, GL_RGBA8, TC_RAMP_SIZE);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
}

tc_status tc_scene_objects_create(const tc_gl *gl, const tc_surface *surface, tc_scene_objects **objects_ret,
                                  tc_error *error)
{
    tc_scene_objects *o = calloc(1, sizeof *o);
    if (!o)
        return tc_fail(error, TC_ERR_MEMORY, "renderer: not enough memory");
    *o = (tc_scene_objects){.users = 1, .surface = surface, .palette = tc_palette_make(tc_field_info(surface->field))};
    tc_gl_forget_errors(gl); /* what went wrong before is none of ours */
    create_geometry(gl, o);
    create_ramp(gl, o);
    tc_status status = tc_gl_allocated(gl, "geometry", error);
    if (status == TC_OK) {
        gl->TextureSubImage1D(o->ramp, 0, 0, TC_RAMP_SIZE, GL_RGBA, GL_UNSIGNED_BYTE, o->palette.ramp);
        *objects_ret = o;
    } else {
        tc_scene_objects_release(gl, o);
    }
    return status;
}

tc_scene_objects *tc_scene_objects_share(tc_scene_objects *o)
{
    o->users++;
    return o;
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

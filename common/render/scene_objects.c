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

static void create_ramp(const tc_gl *gl, tc_scene_objects *o, bool given)
{
    gl->CreateTextures(GL_TEXTURE_1D, 1, &o->ramp);
    gl->TextureStorage1D(o->ramp, 1, given ? GL_RGBA16 : GL_RGBA8, given ? TC_GIVEN_SIZE : TC_RAMP_SIZE);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(o->ramp, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
}

static void fill_ramp(const tc_gl *gl, tc_scene_objects *o, uint16_t (*given)[4])
{
    if (given)
        gl->TextureSubImage1D(o->ramp, 0, 0, TC_GIVEN_SIZE, GL_RGBA, GL_UNSIGNED_SHORT, given);
    else
        gl->TextureSubImage1D(o->ramp, 0, 0, TC_RAMP_SIZE, GL_RGBA, GL_UNSIGNED_BYTE, o->palette.ramp);
}

tc_status tc_scene_objects_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_options *options,
                                  tc_scene_objects **objects_ret, tc_error *error)
{
    const double exaggeration = tc_scene_exaggeration(options);
    const tc_terrain_info *info = tc_field_info(surface->field), told = tc_palette_heights(info, exaggeration);
    tc_scene_objects *o = calloc(1, sizeof *o);
    const tc_scene_needs needs = tc_scene_needs_of(options, info);
    uint16_t(*given)[4] = needs.given ? malloc(TC_GIVEN_SIZE * sizeof *given) : NULL;
    if (!o || (needs.given && !given)) {
        free(o), free(given);
        return tc_fail(error, TC_ERR_MEMORY, "renderer: not enough memory");
    }
    *o = (tc_scene_objects){.users = 1, .surface = surface, .palette = tc_palette_make(&told)};
    if (needs.shade->degrees > 0)
        tc_palette_give_degrees(&o->palette, needs.shade, given);
    else if (given)
        tc_palette_give(&o->palette, &told, options->colours, given);
    tc_palette_exaggerate(&o->palette, exaggeration, needs.shade->degrees > 0);
    tc_gl_forget_errors(gl); /* what went wrong before is none of ours */
    create_geometry(gl, o);
    create_ramp(gl, o, given);
    tc_status status = tc_gl_allocated(gl, "geometry", error);
    if (status == TC_OK) {
        fill_ramp(gl, o, given);
        *objects_ret = o;
    } else {
        tc_scene_objects_release(gl, o);
    }
    free(given);
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

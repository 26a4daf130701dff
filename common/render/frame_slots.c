/* frame_slots.c - a ring of buffers with fences. */
#include "frame_slots.h"

#include "common/base/status.h"

static size_t draw_bytes(const tc_frame_slots *slots)
{
    return sizeof(tc_draw) + (slots->instances ? sizeof(tc_instance) : 0);
}

static GLuint vertex_array(const tc_gl *gl, const tc_geometry *g, const tc_scene_objects *objects, bool instances)
{
    GLuint vao;
    gl->CreateVertexArrays(1, &vao);
    gl->VertexArrayElementBuffer(vao, objects->indices);
    gl->VertexArrayVertexBuffer(vao, 0, objects->vertices, 0, (GLsizei)tc_vertex_bytes(g));
    gl->EnableVertexArrayAttrib(vao, 0);
    if (g->format == TC_VERTEX_FLOAT_4)
        gl->VertexArrayAttribFormat(vao, 0, 4, GL_FLOAT, GL_FALSE, 0);
    else
        gl->VertexArrayAttribIFormat(vao, 0, 2, GL_UNSIGNED_SHORT, 0);
    gl->VertexArrayAttribBinding(vao, 0, 0);
    if (instances) {
        gl->EnableVertexArrayAttrib(vao, 1);
        gl->VertexArrayAttribIFormat(vao, 1, 4, GL_INT, 0);
        gl->VertexArrayAttribBinding(vao, 1, 1);
        gl->EnableVertexArrayAttrib(vao, 2);
        gl->VertexArrayAttribFormat(vao, 2, 4, GL_FLOAT, GL_FALSE, offsetof(tc_instance, corner));
        gl->VertexArrayAttribBinding(vao, 2, 1);
        gl->VertexArrayBindingDivisor(vao, 1, 1);
    }
    return vao;
}

tc_status tc_frame_slots_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_objects *objects,
                                tc_frame_slots *slots, tc_error *error)
{
    *slots = (tc_frame_slots){.instances = surface->instances};
    tc_gl_forget_errors(gl);
    gl->CreateVertexArrays(1, &slots->sky_vertex_array);
    for (int i = 0; i < TC_FRAME_SLOTS; i++) {
        tc_frame_slot *s = &slots->slot[i];
        s->vertex_array = vertex_array(gl, &surface->geometry, objects, slots->instances);
        gl->CreateBuffers(1, &s->uniforms);
        gl->CreateBuffers(1, &s->draws);
        gl->NamedBufferStorage(s->uniforms, sizeof(tc_frame_uniforms), NULL, GL_DYNAMIC_STORAGE_BIT);
    }
    tc_status status = tc_gl_allocated(gl, "frames", error);
    if (status != TC_OK)
        tc_frame_slots_destroy(gl, slots);
    return status;
}

void tc_frame_slots_destroy(const tc_gl *gl, tc_frame_slots *slots)
{
    for (int i = 0; i < TC_FRAME_SLOTS; i++) {
        tc_frame_slot *s = &slots->slot[i];
        gl->DeleteVertexArrays(1, &s->vertex_array);
        gl->DeleteBuffers(2, (GLuint[]){s->uniforms, s->draws});
        gl->DeleteSync(s->done); /* NULL is silently ignored */
    }
    gl->DeleteVertexArrays(1, &slots->sky_vertex_array);
    *slots = (tc_frame_slots){0};
}

static tc_status wait_for(const tc_gl *gl, tc_frame_slot *slot, tc_error *error)
{
    enum { TRIES = 10 };
    const GLuint64 second = 1000000000;
    if (!slot->done)
        return TC_OK;
    GLenum result = GL_TIMEOUT_EXPIRED;
    for (int i = 0; i < TRIES && result == GL_TIMEOUT_EXPIRED; i++)
        result = gl->ClientWaitSync(slot->done, GL_SYNC_FLUSH_COMMANDS_BIT, second);
    gl->DeleteSync(slot->done);
    slot->done = NULL;
    if (result != GL_ALREADY_SIGNALED && result != GL_CONDITION_SATISFIED)
        return tc_fail(error, TC_ERR_CONTEXT, "frame: the driver does not come to an end with an earlier one");
    return TC_OK;
}

static tc_status reserve(const tc_gl *gl, const tc_frame_slots *slots, tc_frame_slot *s, size_t count, tc_error *error)
{
    if (count <= s->capacity)
        return TC_OK;
    size_t capacity = count + count / 2;
    tc_gl_forget_errors(gl);
    gl->NamedBufferData(s->draws, (GLsizeiptr)(capacity * draw_bytes(slots)), NULL, GL_DYNAMIC_DRAW);
    tc_status status = tc_gl_allocated(gl, "draws of a frame", error);
    s->capacity = status == TC_OK ? capacity : 0;
    return status;
}

tc_status tc_frame_slots_fill(const tc_gl *gl, tc_frame_slots *slots, const tc_frame_uniforms *uniforms,
                              const tc_frame *frame, const tc_frame_slot **slot_ret, tc_error *error)
{
    slots->now = (slots->now + 1) % TC_FRAME_SLOTS;
    tc_frame_slot *s = &slots->slot[slots->now];
    size_t count = (size_t)(frame->strip_draws + frame->list_draws + frame->wall_draws);
    tc_status status = wait_for(gl, s, error);
    if (status == TC_OK)
        status = reserve(gl, slots, s, count, error);
    if (status != TC_OK)
        return status;
    gl->NamedBufferSubData(s->uniforms, 0, sizeof *uniforms, uniforms);
    if (count) {
        gl->NamedBufferSubData(s->draws, 0, (GLsizeiptr)(count * sizeof(tc_draw)), frame->draws);
        if (slots->instances) {
            GLintptr instances = (GLintptr)(s->capacity * sizeof(tc_draw));
            gl->NamedBufferSubData(s->draws, instances, (GLsizeiptr)(count * sizeof(tc_instance)), frame->instances);
            gl->VertexArrayVertexBuffer(s->vertex_array, 1, s->draws, instances, sizeof(tc_instance));
        }
    }
    *slot_ret = s;
    return TC_OK;
}

void tc_frame_slots_drawn(const tc_gl *gl, tc_frame_slots *slots)
{
    slots->slot[slots->now].done = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

size_t tc_frame_slots_bytes(const tc_frame_slots *slots)
{
    size_t bytes = 0;
    for (int i = 0; i < TC_FRAME_SLOTS; i++)
        bytes += slots->slot[i].capacity * draw_bytes(slots) + sizeof(tc_frame_uniforms);
    return bytes;
}

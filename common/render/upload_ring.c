/* upload_ring.c - parts of a mapped buffer, used in turn. */
#include "upload_ring.h"

enum { ALIGNMENT = 64, ALL_BYTES = TC_UPLOAD_PARTS * TC_UPLOAD_PART_BYTES };

bool tc_upload_ring_pays(const tc_gl *gl)
{
    return !tc_gl_software((const char *)gl->GetString(GL_RENDERER));
}

tc_status tc_upload_ring_create(const tc_gl *gl, tc_upload_ring *ring, tc_error *error)
{
    const GLbitfield how = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    *ring = (tc_upload_ring){0};
    tc_gl_forget_errors(gl);
    gl->CreateBuffers(1, &ring->buffer);
    gl->NamedBufferStorage(ring->buffer, ALL_BYTES, NULL, how);
    tc_status status = tc_gl_allocated(gl, "uploads", error);
    if (status == TC_OK)
        ring->map = gl->MapNamedBufferRange(ring->buffer, 0, ALL_BYTES, how);
    if (!ring->map) {
        tc_gl_forget_errors(gl);
        tc_upload_ring_destroy(gl, ring);
    }
    return status;
}

void tc_upload_ring_destroy(const tc_gl *gl, tc_upload_ring *ring)
{
    for (int i = 0; i < TC_UPLOAD_PARTS; i++)
        gl->DeleteSync(ring->done[i]);   /* NULL is silently ignored */
    gl->DeleteBuffers(1, &ring->buffer); /* which ends the mapping; 0 is ignored */
    *ring = (tc_upload_ring){0};
}

void tc_upload_ring_begin(const tc_gl *gl, tc_upload_ring *ring)
{
    if (!ring->buffer)
        return;
    const int next = (ring->now + 1) % TC_UPLOAD_PARTS;
    ring->used = 0;
    ring->open = true;
    if (ring->done[next]) {
        const GLenum result = gl->ClientWaitSync(ring->done[next], 0, 0);
        ring->open = result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED;
    }
    if (!ring->open)
        return; /* the same part is asked about again */
    gl->DeleteSync(ring->done[next]);
    ring->done[next] = NULL;
    ring->now = next;
}

void tc_upload_ring_end(const tc_gl *gl, tc_upload_ring *ring)
{
    if (ring->open && ring->used > 0)
        ring->done[ring->now] = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    ring->open = false;
}

void *tc_upload_ring_take(tc_upload_ring *ring, size_t bytes, size_t *offset_ret)
{
    bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (!ring->open || bytes > TC_UPLOAD_PART_BYTES - ring->used)
        return NULL;
    *offset_ret = (size_t)ring->now * TC_UPLOAD_PART_BYTES + ring->used;
    ring->used += bytes;
    return ring->map + *offset_ret;
}

size_t tc_upload_ring_bytes(const tc_upload_ring *ring)
{
    return ring->buffer ? ALL_BYTES : 0;
}

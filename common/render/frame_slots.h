/* frame_slots.h - buffers of frames that the GPU may still be drawing: each is used again only when its frame is done.
 */
#ifndef TC_FRAME_SLOTS_H
#define TC_FRAME_SLOTS_H

#include "frame_uniforms.h"
#include "scene_objects.h"

enum { TC_FRAME_SLOTS = 3 };

typedef struct tc_frame_slot {
    GLuint vertex_array;
    GLuint uniforms;
    GLuint draws;    /* [draws][instances] */
    size_t capacity; /* draws that there is room for */
    GLsync done;     /* of the frame drawn from it last; NULL: none, or the driver has none to give */
} tc_frame_slot;

typedef struct tc_frame_slots {
    tc_frame_slot slot[TC_FRAME_SLOTS];
    int now;
    GLuint sky_vertex_array; /* of no vertex data at all */
    bool instances;          /* draws have them */
} tc_frame_slots;

tc_status tc_frame_slots_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_objects *objects,
                                tc_frame_slots *slots, tc_error *error);
void tc_frame_slots_destroy(const tc_gl *gl, tc_frame_slots *slots);

/* The next slot, with the frame's numbers, draws and instances in it. Waits for the frame that was drawn from it; where
 * that takes longer than ten seconds, or the context is lost, TC_ERR_CONTEXT. Allocates only where a frame has more
 * draws than any before. */
tc_status tc_frame_slots_fill(const tc_gl *gl, tc_frame_slots *slots, const tc_frame_uniforms *uniforms,
                              const tc_frame *frame, const tc_frame_slot **slot_ret, tc_error *error);

/* The slot's frame is all asked for. */
void tc_frame_slots_drawn(const tc_gl *gl, tc_frame_slots *slots);

size_t tc_frame_slots_bytes(const tc_frame_slots *slots);

#endif

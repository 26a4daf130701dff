/* target.h - what a frame is drawn into: a picture's own framebuffer (picture.h), a host's, or any other.
 *
 * A target is its head and, where it is more than that, what its class does before and after a frame. A new kind is a
 * struct that begins with a tc_target and a class beside it; nobody else changes. */
#ifndef TC_TARGET_H
#define TC_TARGET_H

#include "common/gl/gl.h"
#include "common/terraclip_draw.h"

typedef struct tc_target tc_target;

typedef struct tc_target_class {
    const char *name;
    /* Makes ready for a frame of width x height pixels and fills in the head. NULL: it is as it stands. */
    tc_status (*begin)(tc_target *target, const tc_gl *gl, int width, int height, tc_error *error);
    /* The frame is drawn: resolves, hands on. NULL: nothing. */
    tc_status (*end)(tc_target *target, const tc_gl *gl, tc_error *error);
} tc_target_class;

struct tc_target {
    const tc_target_class *class;
    tc_target_place place;
    bool whole; /* nothing else lies in its framebuffer */
};

/* How depth lies in a target, by tc_depth. */
typedef struct tc_depth_convention {
    const char *name;
    GLenum clip;       /* of glClipControl */
    GLenum nearer;     /* passes where a surface is nearer than what is there, */
    GLenum not_beyond; /* and where it is as near */
    float farthest;    /* depth where nothing is */
    float sky;         /* the same in clip coordinates over w */
} tc_depth_convention;
const tc_depth_convention *tc_depth_convention_of(tc_depth depth);

/* Whether a place is as it says: a framebuffer that is complete, with colour and depth, of that many samples and that
 * encoding, which holds the rectangle. What cannot be asked for (a window's size) is believed. */
tc_status tc_target_check(const tc_gl *gl, const tc_target_place *place, tc_error *error);

#endif

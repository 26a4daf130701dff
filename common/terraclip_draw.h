/* terraclip_draw.h - the public interface of libterraclip-draw: terrains and planets inside frames of other programs.
 *
 * A drawer holds what all views of a map share in an OpenGL context; a view holds the windows of one viewer. A view is
 * drawn into a target: a framebuffer of the host's, by the host's matrices or by a camera.
 *
 * OpenGL 4.5 core. Every function here is called with the context current (or one that shares its objects, and then
 * only views made in it are drawn) that the drawer was made in. A drawer and its views belong to one thread at a time;
 * different drawers may be used by different threads, also of one map. Conventions are those of terraclip.h. */
#ifndef TERRACLIP_DRAW_H
#define TERRACLIP_DRAW_H

#include "terraclip.h"

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/* ---- Targets ------------------------------------------------------------------------------------------------- */

/* How depth lies in a target's depth buffer. */
typedef enum tc_depth {
    TC_DEPTH_REVERSED,     /* 1 near .. 0 infinitely far, clip space 0 .. 1: what floats are best at. Clear to 0 */
    TC_DEPTH_CONVENTIONAL, /* 0 near .. 1 far, clip space -1 .. 1: OpenGL as it begins. Clear to 1 */
    TC_DEPTH_ZERO_TO_ONE,  /* 0 near .. 1 far, clip space 0 .. 1: as Vulkan's and Direct3D's matrices. Clear to 1 */
    TC_DEPTHS
} tc_depth;

/* What numbers stand for in a target's colours. */
typedef enum tc_encoding {
    TC_ENCODING_SHOWN, /* what is shown, as in a picture file: plain RGBA8 and the like */
    TC_ENCODING_SRGB, /* the same in an sRGB format, to which OpenGL converts: blending and resolving in linear light */
    TC_ENCODING_LINEAR, /* linear light, in a float format */
    TC_ENCODINGS
} tc_encoding;

/* Where to draw. Zero is the default of all that may be left out. */
typedef struct tc_target_place {
    unsigned framebuffer;    /* 0: the window's; only the first colour attachment is written, and depth */
    int x, y, width, height; /* pixels from the lower left */
    int samples;             /* a pixel; 0: 1 */
    tc_encoding encoding;
    tc_depth depth;
    bool clear;      /* first clears rectangle and depth in it; else draws where it is nearer than what is there */
    bool keep_state; /* gives all OpenGL state back as it was, at the price of asking for it. Else promises nothing */
} tc_target_place;

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif

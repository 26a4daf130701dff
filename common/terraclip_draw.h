/* terraclip_draw.h - the public interface of libterraclip-draw: terrains and planets inside frames of other programs.
 *
 * A drawer holds what all eyes on a map share in an OpenGL context; an eye holds the windows around one viewer. What it
 * sees is drawn into a target: a framebuffer of the host's, by the host's matrices or by a camera.
 *
 * OpenGL 4.5 core. Every function here is called with the context current (or one that shares its objects, and then
 * only eyes made in it draw) that the drawer was made in. A drawer and its eyes belong to one thread at a time;
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

/* ---- Drawers ------------------------------------------------------------------------------------------------- */

typedef struct tc_drawer tc_drawer;

/* How a map is drawn; zero is the default. */
typedef struct tc_draw_options {
    const char *scheme;    /* "square", "rings", ...; NULL: the first one for the map's body */
    int width;             /* pixels across that frames will have, by which the mesh is made; 0: 1920 */
    int n, levels;         /* instead: samples a side of the windows (rings: steps around); levels at most */
    bool unlit;            /* colours without light */
    bool no_sky;           /* nothing where the map is not: no sky, no haze */
    uint8_t background[3]; /* shown there instead, where the target is cleared */
    bool holes;            /* voids are holes */
    int64_t budget;        /* height samples updated a frame; 0: n * n, negative: no limit */
    int64_t budget_us;     /* microseconds that updating takes in a frame that does not wait, to within a small piece a
                            * chart; 0: 4000 or, where a budget is given, no limit; negative: no limit */
} tc_draw_options;

/* A drawer of the map in the current context. get_proc: finds an OpenGL function by name, as
 * glfwGetProcAddress and eglGetProcAddress do. The map may be destroyed while it is drawn: it then goes with its last
 * drawer. OpenGL state is as before, but for errors that nobody had asked for. TC_ERR_USAGE: no map, no get_proc, or
 * sizes that the scheme does not take; TC_ERR_CONTEXT: not OpenGL 4.5, or a driver that refuses what is asked of it;
 * TC_ERR_UNSUPPORTED: no such scheme for the map's body; TC_ERR_MEMORY: the machine or the driver has none. */
tc_status tc_drawer_create(tc_map *map, const tc_draw_options *options, void *(*get_proc)(const char *name),
                           tc_drawer **drawer_ret, tc_error *error);

/* What eyes still need goes with the last of them. */
void tc_drawer_destroy(tc_drawer *drawer);

/* ---- Eyes ---------------------------------------------------------------------------------------------------- */

/* A viewer of the map with the windows around it. Several draw in one frame, each into its target. */
typedef struct tc_eye tc_eye;

/* Reads the coarsest level, waiting for it: TC_ERR_IO where it cannot be read. Else as tc_drawer_create(). */
tc_status tc_eye_create(tc_drawer *drawer, tc_eye **eye_ret, tc_error *error);
void tc_eye_destroy(tc_eye *eye);

/* What a frame was. */
typedef struct tc_draw_stats {
    int64_t triangles; /* drawn */
    int draws, levels;
    int64_t samples_updated, bytes_uploaded;
    double update_ms, draw_ms; /* of this thread, not of the GPU */
    bool resident;             /* the windows hold all that the view needs; else parts of it are drawn coarser */
    bool failed;               /* a part could not be read, and will be tried again */
} tc_draw_stats;

/* Draws a frame by the host's matrices, column-major as OpenGL has them, in double since planets are large. view turns
 * and moves from the map's frame to the eye's, which looks along -z: of a flat map its metres, of a planet metres from
 * its centre, x towards longitude and latitude 0, z north. projection is a perspective with the target's depth.
 * wait: waits for what must be read and decoded first. The first frame of its kind (samples, encoding, depth) compiles
 * programs. TC_ERR_USAGE, and nothing drawn: matrices that are not finite, singular or not as above; a target that is
 * not as it says. TC_ERR_MEMORY, and with wait TC_ERR_IO where a part cannot be read: likewise; the next frame tries
 * again. *stats_ret may be NULL. */
tc_status tc_eye_draw(tc_eye *eye, const tc_target_place *target, const double view[16], const double projection[16],
                      bool wait, tc_draw_stats *stats_ret, tc_error *error);

/* The same through a camera, whose width and height are those of the target, without a far plane. */
tc_status tc_eye_draw_through(tc_eye *eye, const tc_target_place *target, const tc_camera *camera, bool wait,
                              tc_draw_stats *stats_ret, tc_error *error);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif

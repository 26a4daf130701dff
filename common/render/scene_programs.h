/* scene_programs.h - the programs of a scene, assembled from the parts that it needs. */
#ifndef TC_SCENE_PROGRAMS_H
#define TC_SCENE_PROGRAMS_H

#include <stdio.h>

#include "surface.h"
#include "common/gl/gl.h"
#include "scene_needs.h"

/* By what may differ from frame to frame: level colours, the target's samples, encoding and depth, and throttling. */
enum { TC_PROGRAM_VARIANTS = 32 };

/* What is drawn with the scene's light and colours. */
typedef enum tc_program_kind {
    TC_DRAWS_BLOCKS,
    TC_DRAWS_CLOSERS,
    TC_DRAWS_WALLS,
    TC_DRAWS_SEA,
    TC_PROGRAM_KINDS
} tc_program_kind;

/* 0: not built, since not needed so far. */
typedef struct tc_scene_programs {
    GLuint terrain[TC_PROGRAM_VARIANTS][TC_PROGRAM_KINDS];
    GLuint sky[2]; /* [linear] */
} tc_scene_programs;

static inline int tc_program_variant(const tc_scene_needs *needs)
{
    return (needs->level_colours ? 1 : 0) | (needs->multisampled ? 2 : 0) | (needs->linear ? 4 : 0) |
           (needs->by_w ? 8 : 0) | (needs->throttled ? 16 : 0);
}

/* Builds what the needs as they are call for and is not there yet. closers: also of triangles between levels. */
tc_status tc_scene_programs_build(const tc_gl *gl, const tc_surface *surface, bool closers, const tc_scene_needs *needs,
                                  tc_scene_programs *programs, tc_error *error);
void tc_scene_programs_destroy(const tc_gl *gl, tc_scene_programs *programs);

/* Whether triangles between levels are ever drawn. */
bool tc_scene_closers(const tc_surface *surface, const tc_windows *windows);

/* Lines that the text of every stage begins with: sizes of what frame.glsl has. */
enum { TC_FRAME_DEFINES = 192 };
void tc_scene_frame_defines(char text[TC_FRAME_DEFINES]);

/* Prints what was compiled, as --explain tells it: lines "uses: ...". */
void tc_scene_programs_explain(const tc_surface *surface, const tc_scene_needs *needs,
                               const tc_scene_programs *programs, FILE *file);

#endif

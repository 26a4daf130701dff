/* scene_programs.h - the programs of a scene, assembled from the parts that it needs. */
#ifndef TC_SCENE_PROGRAMS_H
#define TC_SCENE_PROGRAMS_H

#include <stdio.h>

#include "surface.h"
#include "common/gl/gl.h"
#include "scene_needs.h"

/* 0: not built, since not needed so far. */
typedef struct tc_scene_programs {
    GLuint terrain[2][2]; /* [level colours][closers] */
    GLuint sky;
} tc_scene_programs;

/* Builds what the needs as they are call for and is not there yet. */
tc_status tc_scene_programs_build(const tc_gl *gl, const tc_surface *surface, const tc_scene_needs *needs,
                                  tc_scene_programs *programs, tc_error *error);
void tc_scene_programs_destroy(const tc_gl *gl, tc_scene_programs *programs);

/* Whether triangles between levels are ever drawn. */
bool tc_scene_closers(const tc_surface *surface);

/* Prints what was compiled, as --explain tells it: lines "uses: ...". */
void tc_scene_programs_explain(const tc_surface *surface, const tc_scene_needs *needs,
                               const tc_scene_programs *programs, FILE *file);

#endif

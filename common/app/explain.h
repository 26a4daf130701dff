/* explain.h - what a scene uses, and what was left out of it and why: --explain, and left_out of --stats. */
#ifndef TC_EXPLAIN_H
#define TC_EXPLAIN_H

#include "common/render/renderer.h"

#include <stdio.h>

enum { TC_LEFT_OUT_LINES = 24, TC_LEFT_OUT_TEXT = 120 };
typedef struct tc_left_out {
    int count;
    char text[TC_LEFT_OUT_LINES][TC_LEFT_OUT_TEXT]; /* "void mask: no holes to show" */
    const char *lines[TC_LEFT_OUT_LINES + 1];       /* those, NULL-terminated; of where the list was made */
} tc_left_out;

/* What the scene as a whole did not need, what its last frame did not, and libraries that were not loaded. */
void tc_explain_left_out(const tc_renderer *renderer, tc_left_out *list);

/* Prints lines "uses: ...": shaders by their parts and defines, textures, levels, draws, libraries, threads. */
void tc_explain_uses(const tc_renderer *renderer, FILE *file);

#endif

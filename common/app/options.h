/* options.h - the command line shared by the viewers. No GL, no window. */
#ifndef TC_OPTIONS_H
#define TC_OPTIONS_H

#include "common/terraclip.h"
#include "common/window/clipmap.h"
#include "arguments.h"
#include "common/gl/context.h"
#include "common/view/flight.h"
#include "common/render/renderer.h"
#include "common/input/source.h"

#include <stdio.h>

/* What the command line asks for. Strings point into argv. */
typedef struct tc_options {
    tc_action action;
    const char *terrain;
    const char *output; /* picture, or pattern of pictures where path is given; NULL: a window */
    int width, height;  /* pixels */
    bool has_view;
    tc_pose view;
    double fov;       /* horizontal, radians */
    const char *path; /* of a flight; NULL none */
    int frames;       /* of the flight; in a window without a path: how many until it closes. 0: not given */
    tc_backend backend;
    const char *stats; /* JSON file; NULL none */
    int threads;       /* 0: as many as there are processors */
    bool explain, json, quiet, verbose;
    tc_source_options source; /* without say */
    int n, levels;            /* of the clipmap; 0: not given */
    const char *scheme;       /* NULL: not given; the rest of globes only */
    int steps;                /* of theta~ in a level of rings; 0: not given */
    double radius;            /* metres; 0: not given */
    const tc_navigation *navigation;
    tc_scene_options scene; /* without holes */
} tc_options;

/* What differs between the programs. */
typedef struct tc_options_program {
    const char *name;    /* "planar-viewer" */
    const char *summary; /* one sentence for the help */
    const tc_navigation *navigation;
    bool sphere; /* has the options of planets */
} tc_options_program;

/* Reads the command line. On failure *error names the option, what it expects and what was found; status
 * TC_ERR_USAGE. With -h or --version the rest is not looked at. */
tc_status tc_options_parse(const tc_options_program *program, int argc, char **argv, tc_options *options_ret,
                           tc_error *error);

/* Prints usage and options; the caller goes on with the keys of the window. */
void tc_options_print_help(const tc_options_program *program, FILE *file);

/* Whether pattern has exactly one number, %d or %0Nd with N of 1 .. 9, and no other percent sign. */
bool tc_frame_pattern_valid(const char *pattern);

/* The name of frame number `frame` by a valid pattern; false where it does not fit. */
bool tc_frame_pattern_name(const char *pattern, int frame, char *name, size_t capacity);

#endif

/* options.h - the command line shared by the viewers. No GL, no window. */
#ifndef TC_OPTIONS_H
#define TC_OPTIONS_H

#include "common/terraclip.h"
#include "common/window/clipmap.h"
#include "arguments.h"
#include "globe_choice.h"
#include "common/gl/context.h"
#include "common/view/flight.h"
#include "common/render/renderer.h"
#include "common/input/source.h"
#include "viewer.h"

#include <stdio.h>

enum { TC_MOST_IMAGERY = 64 };

/* A place to look at. */
typedef struct tc_look {
    bool given, has_height, has_heading, has_pitch;
    double longitude, latitude, height; /* degrees; metres above the sea, else on the ground */
    double distance;                    /* metres; 0: not given */
    double heading, pitch;              /* radians; north and 30 degrees down unless given */
} tc_look;

/* What the command line asks for. Strings point into argv. */
typedef struct tc_options {
    tc_action action;
    const char *terrain; /* NULL: there is to be a window, with the default one */
    const char *output;  /* picture, or pattern of pictures where path is given; NULL: a window */
    int width, height;   /* pixels */
    bool has_view;
    tc_pose view;
    const char *views;     /* file of views; NULL none */
    const char *view_name; /* of the view, which is in that file; NULL: the view itself was given */
    tc_look look;          /* at a place, instead of a view */
    double fov;            /* horizontal, radians */
    const char *colours;   /* file of a height ramp; NULL none */
    const char *imagery[TC_MOST_IMAGERY];
    int imagery_count;
    const char *path;  /* of a flight; NULL none */
    const char *video; /* film of the flight; NULL none */
    int rate;          /* its frames a second; 0: not given */
    int frames;        /* of the flight; in a window without a path: how many until it closes. 0: not given */
    tc_backend backend;
    const char *stats; /* JSON file; NULL none */
    int threads;       /* 0: as many as there are processors */
    double target_ms;  /* that a frame may take; 0: as long as it takes */
    bool explain, json, quiet, verbose, no_display;
    bool alone;               /* nothing is shown around the map */
    tc_source_options source; /* without say */
    int synthesis;            /* levels finer than the data, or TC_SYNTHESIS_AUTO; 0: none */
    double exaggeration;      /* of heights */
    tc_sea sea;               /* where it is */
    const char *date;         /* at which the sun is shown where it stands; NULL: not given */
    double julian;            /* that date */
    int n, levels;            /* of the clipmap; 0: not given */
    const tc_scheme *scheme;  /* NULL: not given */
    bool scheme_implied;      /* not given, but by a tolerance */
    int steps;                /* outwards in a level; 0: not given */
    tc_globe_choice globe;
    const tc_viewer_program *program;
    tc_scene_options scene; /* without holes */
} tc_options;

/* Rows that programs put into their own tables (viewer.h), at most TC_PROGRAM_OPTIONS in all. Texts of TC_SCHEME_OPTION
 * come from the program's schemes. */
enum { TC_PROGRAM_OPTIONS = 12 };
#define TC_SCHEME_OPTION                                                                                               \
    {                                                                                                                  \
        0, "scheme", "NAME", NULL, NULL, tc_read_scheme, 0                                                             \
    }
#define TC_LEVELS_OPTION                                                                                               \
    {                                                                                                                  \
        0, "levels", "M", "1..32", "of detail at most (all)", tc_read_levels, offsetof(tc_options, levels)             \
    }
#define TC_BUDGET_OPTION                                                                                               \
    {                                                                                                                  \
        0, "budget", "SAMPLES", "1 or more samples", "updated a frame (N * N; all that is missing with -o)",           \
            tc_read_budget, offsetof(tc_options, scene.budget)                                                         \
    }
#define TC_BUDGET_US_OPTION                                                                                            \
    {                                                                                                                  \
        0, "budget-us", "US", "1 or more microseconds", "for updating a frame in a window (4000; none with --budget)", \
            tc_read_budget, offsetof(tc_options, scene.budget_us)                                                      \
    }
bool tc_read_scheme(void *options, const char *value); /* tc_options */
bool tc_read_levels(void *levels, const char *value);  /* int */
bool tc_read_budget(void *budget, const char *value);  /* int64_t */

/* Reads the command line. On failure *error names the option, what it expects and what was found; status
 * TC_ERR_USAGE. With -h or --version the rest is not looked at. */
tc_status tc_options_parse(const tc_viewer_program *program, int argc, char **argv, tc_options *options_ret,
                           tc_error *error);

/* Prints usage and options; the caller goes on with the keys of the window. */
void tc_options_print_help(const tc_viewer_program *program, FILE *file);

/* Whether pattern has exactly one number, %d or %0Nd with N of 1 .. 9, and no other percent sign. */
bool tc_frame_pattern_valid(const char *pattern);

/* The name of frame number `frame` by a valid pattern; false where it does not fit. */
bool tc_frame_pattern_name(const char *pattern, int frame, char *name, size_t capacity);

#endif

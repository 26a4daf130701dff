/* viewer.h - the viewer program: everything of planar-viewer and planet-viewer that does not depend on the scheme. */
#ifndef TC_VIEWER_H
#define TC_VIEWER_H

#include "common/map/map.h"
#include "common/render/scene_needs.h"
#include "common/render/surface.h"
#include "common/view/navigation.h"
#include "arguments.h"

/* What the command line and the machine ask of a surface; zero is the default. */
typedef struct tc_surface_request {
    int n, levels, steps;
    const tc_scene_needs *needs;
    bool interactive; /* a window on a software renderer: no more detail than it can draw */
    const tc_camera *camera;
} tc_surface_request;

/* A way of drawing a map. */
typedef struct tc_scheme {
    const char *name; /* as in figures and on the command line */
    const char *help; /* what it is, beside the first one; of that NULL */
    /* A surface over the map, which outlives it. */
    tc_status (*create)(const tc_map *map, const tc_surface_request *request, tc_surface **surface_ret,
                        tc_error *error);
} tc_scheme;

/* What differs between the programs. */
typedef struct tc_viewer_program {
    const char *name;          /* "planar-viewer" */
    const char *summary;       /* one sentence for the help */
    const tc_body_class *body; /* that files are shown on */
    const tc_navigation *navigation;
    const tc_scheme *schemes; /* the first one unless --scheme names another */
    int scheme_count;
    const tc_option *options; /* of its schemes and its body (options.h); they follow those of how a file is read */
    int option_count;
} tc_viewer_program;

/* The whole of main(): reads the command line, loads, shows or writes. Returns the exit code. */
int tc_viewer_main(const tc_viewer_program *program, int argc, char **argv);

#endif

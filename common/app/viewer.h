/* viewer.h - the viewer program: everything of planar-viewer and planet-viewer that does not depend on the scheme. */
#ifndef TC_VIEWER_H
#define TC_VIEWER_H

#include "common/render/surface.h"
#include "common/terraclip.h"
#include "common/view/navigation.h"
#include "common/render/scene_needs.h"

/* What the command line and the machine ask of a surface; zero is the default. */
typedef struct tc_surface_request {
    const char *scheme;
    int n, levels, steps;
    const tc_scene_needs *needs;
    bool interactive; /* a window on a software renderer: no more detail than it can draw */
    const tc_camera *camera;
} tc_surface_request;

typedef struct tc_viewer_program {
    const char *name;    /* "planar-viewer" */
    const char *summary; /* one sentence for the help */
    const tc_navigation *navigation;
    bool sphere; /* files are opened as planets */
    /* A surface over the atlas, which outlives it; of a flat terrain chart 0 is all. */
    tc_status (*make_surface)(const tc_atlas *atlas, const tc_surface_request *request, tc_surface **surface_ret,
                              tc_error *error);
} tc_viewer_program;

/* The whole of main(): reads the command line, loads, shows or writes. Returns the exit code. */
int tc_viewer_main(const tc_viewer_program *program, int argc, char **argv);

#endif

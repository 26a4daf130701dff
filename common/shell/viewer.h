/* viewer.h - the viewer program: everything of planar-viewer and planet-viewer that does not depend on the scheme. */
#ifndef TC_VIEWER_H
#define TC_VIEWER_H

#include "common/terraclip.h"
#include "common/core/clipmap/surface.h"

typedef struct tc_viewer_program {
    const char *name;    /* "planar-viewer" */
    const char *summary; /* one sentence for the help */
    tc_status (*make_surface)(tc_clipmap *clipmap, tc_surface **surface_ret, tc_error *error);
} tc_viewer_program;

/* The whole of main(): reads the command line, loads, shows or writes. Returns the exit code. */
int tc_viewer_main(const tc_viewer_program *program, int argc, char **argv);

#endif

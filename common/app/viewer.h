/* viewer.h - the viewer program: everything of planar-viewer and planet-viewer that does not depend on the scheme. */
#ifndef TC_VIEWER_H
#define TC_VIEWER_H

#include "common/map/map.h"
#include "common/render/scheme.h"
#include "common/view/navigation.h"
#include "arguments.h"
#include "default_terrain.h"

/* What differs between the programs. */
typedef struct tc_viewer_program {
    const char *name;          /* "planar-viewer" */
    const char *summary;       /* one sentence for the help */
    const tc_body_class *body; /* that files are shown on */
    const tc_navigation *navigation;
    const tc_scheme *const *schemes; /* lists, ended by NULL: the first one unless --scheme names another */
    const tc_option *options; /* of its schemes and its body (options.h); they follow those of how a file is read */
    int option_count;
    tc_default_terrain by_default; /* that a window shows where no file is named */
} tc_viewer_program;

/* The whole of main(): reads the command line, loads, shows or writes. Returns the exit code. */
int tc_viewer_main(const tc_viewer_program *program, int argc, char **argv);

#endif

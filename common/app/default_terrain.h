/* default_terrain.h - what a viewer's window shows where no file is named: a terrain that the program `terraclip`
 * beside the viewer makes once, into the user's cache. */
#ifndef TC_DEFAULT_TERRAIN_H
#define TC_DEFAULT_TERRAIN_H

#include "common/terraclip.h"
#include "common/chart/atlas.h"

/* Which one; arguments of `terraclip` are ended by NULL. */
typedef struct tc_default_terrain {
    const char *name;         /* "planet" */
    const char *const *synth; /* how it is made, */
    const char *const *pack;  /* and packed */
} tc_default_terrain;

/* Whether there is a display for a window. */
bool tc_display_there(void);

enum { TC_DEFAULT_PATH = 4096 };

/* Where it lies, or will, in the charts of the atlas (NULL: of no other than its own). TC_ERR_IO where there is no
 * place for a cache. */
tc_status tc_default_terrain_path(const tc_default_terrain *which, const tc_atlas *atlas,
                                  char path_ret[TC_DEFAULT_PATH], tc_error *error);

/* Makes it where it is not there yet; it appears whole or not at all. Waits for another viewer that is just making it.
 * On a terminal progress is shown, unless quiet. Where `terraclip` has said why it failed, *error is empty. */
tc_status tc_default_terrain_make(const tc_default_terrain *which, const tc_atlas *atlas,
                                  const char path[TC_DEFAULT_PATH], bool quiet, tc_error *error);

#endif

/* cache_folder.h - the folder of a user's cache, whose files may be deleted at any time: $XDG_CACHE_HOME/terraclip,
 * else
 * ~/.cache/terraclip. */
#ifndef TC_CACHE_FOLDER_H
#define TC_CACHE_FOLDER_H

#include "common/terraclip.h"

#include <stddef.h>

/* Where a file of that name is in it; "" where the system tells neither of the two, or the path is longer than that. */
void tc_cache_path(const char *name, char *path_ret, size_t size);

/* Makes the folders that such a path lies in. On failure *error is "FOLDER: REASON". */
tc_status tc_cache_make_folder(const char *path, tc_error *error);

#endif

/* plugin.h - libraries that are loaded only when a scene needs them.
 *
 * GDAL, OpenImageIO, GLFW and ffmpeg's libraries each sit behind a small shared object (terraclip-gdal.so and so on)
 * that lies beside the program, or under ../lib/terraclip when installed. */
#ifndef TC_PLUGIN_H
#define TC_PLUGIN_H

#include "common/terraclip.h"

#include <limits.h>

/* The table of functions that plugin NAME ("gdal", "oiio", "window", "video") exports as the symbol `tc_plugin`.
 * Loaded once per process and never unloaded; thread-safe. */
tc_status tc_plugin_load(const char *name, const void **table_ret, tc_error *error);

/* Whether that plugin has been loaded. */
bool tc_plugin_loaded(const char *name);

/* Folder of the running program, without a slash at the end; empty where the system does not say. */
void tc_program_folder(char folder_ret[PATH_MAX]);

#endif

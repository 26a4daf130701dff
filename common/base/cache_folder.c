/* cache_folder.c - see cache_folder.h. */
#include "cache_folder.h"

#include "status.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void tc_cache_path(const char *name, char *path, size_t size)
{
    const char *home = getenv("XDG_CACHE_HOME"), *user = getenv("HOME");
    int length = -1;
    if (home && *home == '/')
        length = snprintf(path, size, "%s/terraclip/%s", home, name);
    else if (user && *user == '/')
        length = snprintf(path, size, "%s/.cache/terraclip/%s", user, name);
    if (length < 0 || (size_t)length >= size)
        *path = '\0';
}

tc_status tc_cache_make_folder(const char *path, tc_error *error)
{
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", path);
    for (char *slash = strchr(folder + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(folder, 0700) != 0 && errno != EEXIST)
            return tc_fail(error, TC_ERR_IO, "%s: %s", folder, strerror(errno));
        *slash = '/';
    }
    return TC_OK;
}

/* video.c - names of films; see video.h. */
#include "video.h"
#include "common/base/status.h"

#include <string.h>
#include <strings.h>

tc_status tc_video_check_name(const char *path, tc_error *error)
{
    const char *dot = strrchr(path, '.');
    if (dot && (strcasecmp(dot, ".mp4") == 0 || strcasecmp(dot, ".webm") == 0))
        return TC_OK;
    return tc_fail(error, TC_ERR_USAGE, "--video: expected a name that ends in .mp4 or .webm, found '%s'", path);
}

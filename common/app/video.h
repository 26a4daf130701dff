/* video.h - films: the table that the plugin terraclip-video.so (ffmpeg's libraries) exports. It knows nothing of
 * terrains; frames come in as pictures. */
#ifndef TC_VIDEO_H
#define TC_VIDEO_H

#include "common/terraclip.h"

typedef struct tc_video tc_video;

enum { TC_VIDEO_RATE = 30 }; /* frames a second, unless told otherwise */

/* Whether the name's ending is that of a film that can be made: .mp4 or .webm, in any case. TC_ERR_USAGE names them. */
tc_status tc_video_check_name(const char *path, tc_error *error);

struct tc_video_plugin {
    /* A film, of whose failures is told as `name`, of frames of width x height pixels, rate of them a second, in a file
     * whose name ends in what it is. Odd sizes lose their last row or column, since colours are told for two by two
     * pixels. TC_ERR_UNSUPPORTED where the installed libraries have no encoder for it. */
    tc_status (*begin)(const char *path, const char *name, int width, int height, int rate, tc_video **video_ret,
                       tc_error *error);
    /* The next frame: rgb 3 bytes a pixel, rows top to bottom. */
    tc_status (*add)(tc_video *video, const uint8_t *rgb, tc_error *error);
    /* Writes what is left, unless status is a failure, and frees the film. Returns status, or why writing failed. */
    tc_status (*end)(tc_video *video, tc_status status, tc_error *error);
};

#endif

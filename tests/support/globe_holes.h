/* globe_holes.h - background that shows through a planet of rings, drawn in flat colours on magenta. */
#ifndef GLOBE_HOLES_H
#define GLOBE_HOLES_H

#include "scene.h"

/* Pixels of a frame. */
typedef struct globe_holes {
    int64_t terrain, sure;    /* that are not background; that surely are terrain */
    int64_t holes;            /* sure ones that are background */
    int64_t suspects, cracks; /* background below terrain; of these, where the surface drawn is crossed */
} globe_holes;

/* Of the frame that has just been drawn with these options (NULL: zero); at most so many suspects are looked into. */
globe_holes globe_holes_of(scene *s, const tc_camera *camera, const tc_frame_options *options, int64_t most_suspects);

#endif

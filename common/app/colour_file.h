/* colour_file.h - a height ramp from a text file, in the form that `gdaldem color-relief` reads. */
#ifndef TC_COLOUR_FILE_H
#define TC_COLOUR_FILE_H

#include "common/render/colour_ramp.h"
#include "common/terraclip.h"

/* A line a stop: a height in metres or a percentage of the terrain's heights (30%), then red, green, blue and perhaps
 * alpha, 0 to 255 each, or a colour's name; blanks, commas, tabs or colons between them. Lines that begin with # are
 * left out, and so are those of "nv" (no value) and "default", for voids are not coloured. ramp_ret->stop is the
 * caller's to free. TC_ERR_IO, TC_ERR_FORMAT: names the line. */
tc_status tc_colour_file_read(const char *path, tc_colour_ramp *ramp_ret, tc_error *error);

#endif

/* image_memory.h - a picture that is held in memory with all its levels. */
#ifndef TC_IMAGE_MEMORY_H
#define TC_IMAGE_MEMORY_H

#include "image.h"

/* Pixels of a picture that is held so: about 43 MiB with its levels. */
enum { TC_IMAGE_SMALL = 1 << 23 };

/* Reads all rows, which stay the caller's. */
tc_status tc_image_in_memory(tc_image_rows *rows, tc_image **image_ret, tc_error *error);

#endif

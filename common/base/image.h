/* image.h - a picture as rectangles of pixels on several levels, wherever they are kept: what imagery is made of.
 *
 * Pixels are RGBA8, as shown (sRGB), alpha not multiplied in. Pixel (i, j) of level k, counted from the top left,
 * stands for the area from (i, j) to (i + 1, j + 1) times 2^k of level 0; the last ones of a row and of a column may
 * reach beyond the picture, and stand for what of it there is. */
#ifndef TC_IMAGE_H
#define TC_IMAGE_H

#include "common/terraclip.h"

enum { TC_IMAGE_LEVELS = 32 };

typedef struct tc_image_size {
    int64_t width, height;
} tc_image_size;

typedef struct tc_image tc_image;
struct tc_image {
    const char *name; /* for messages; lives as long as the image */
    int levels;       /* from the picture itself, 0, on */
    tc_image_size level[TC_IMAGE_LEVELS];
    /* Pixels rect of a level, which lie on it, rows stride pixels apart. By one thread at a time. */
    tc_status (*read)(tc_image *image, int level, tc_rect rect, uint8_t (*rgba)[4], ptrdiff_t stride, tc_error *error);
    /* Pixels (x, y), level 0, of count places (x, y) of the map that the image was opened for (image places,
     * common/input/image.h), in place; NAN where there is none. By one thread at a time. NULL: it has no places. */
    void (*find)(tc_image *image, int count, double *x, double *y);
    void (*locate)(tc_image *image, int count, double *x, double *y); /* the way back */
    char **parts;  /* all files that it is made of, NULL at the end; NULL: its own alone */
    double period; /* pixels after which columns come round again; 0: never */
    void (*close)(tc_image *image);
};

/* A picture from the top down, once: where levels are made from. */
typedef struct tc_image_rows tc_image_rows;
struct tc_image_rows {
    const char *name;
    int64_t width, height;
    tc_status (*read)(tc_image_rows *rows, int64_t row, int64_t count, uint8_t (*rgba)[4], tc_error *error);
    /* Pixels rect, without gaps, of a picture that is kept in parts of that size: those of one row of parts after the
     * other each cost what they have, where its rows would cost all of them. NULL: it is kept in rows. */
    tc_status (*read_part)(tc_image_rows *rows, tc_rect rect, uint8_t (*rgba)[4], tc_error *error);
    int64_t part_width, part_height;
    void (*close)(tc_image_rows *rows);
};

#endif

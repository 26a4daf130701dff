/* mosaic_internal.h - what the files mosaic*.c share. */
#ifndef TC_MOSAIC_INTERNAL_H
#define TC_MOSAIC_INTERNAL_H

#include "mosaic.h"

/* One file. */
typedef struct tc_mosaic_part {
    const char *path;
    int64_t width, height;
    int64_t column, row; /* of its north-west sample, counted from that of the first file */
    int64_t x0, y0;      /* of its south-west sample, counted from that of the terrain */
} tc_mosaic_part;

struct tc_mosaic {
    tc_source_options options;
    tc_pack_terrain terrain;
    tc_source_info first; /* of the first file, without its coordinate system */
    bool placed;          /* the first file is known, so its z_base is */
    bool mixed;           /* the files differ in how they store */
    int64_t samples, shared;
    bool silent;         /* what is said on opening has been said */
    int said_of;         /* the part that speaks */
    char last_line[512]; /* that was said */
    int count;
    tc_mosaic_part parts[];
};

/* Opens a part; its heights are above the terrain's z_base. */
tc_status tc_mosaic_open_part(tc_mosaic *mosaic, int part, tc_source **source_ret, tc_error *error);

/* ---- mosaic_place.c ---------------------------------------------------------------------------------------------- */

/* Finds where a file begins in columns and rows of the first one. */
tc_status tc_mosaic_place(const tc_mosaic *mosaic, const char *path, const tc_source_info *info, int64_t *column_ret,
                          int64_t *row_ret, tc_error *error);

/* All files are placed: sets where they lie in the rectangle around them, which becomes the terrain, and counts their
 * samples. */
tc_status tc_mosaic_lay_out(tc_mosaic *mosaic, tc_error *error);

#endif

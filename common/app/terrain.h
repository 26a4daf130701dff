/* terrain.h - a terrain from any file: a packed one, or a DEM or picture that is read into memory as a whole. */
#ifndef TC_TERRAIN_H
#define TC_TERRAIN_H

#include "common/terraclip.h"
#include "common/input/source.h"

typedef struct tc_terrain {
    tc_field *field;
    tc_void_policy voids;        /* that of the options, or the file's own */
    tc_georef georef;            /* of the finest level, which may be missing; without crs_wkt */
    int64_t width, height;       /* likewise */
    double spacing_x, spacing_y; /* likewise */
    double read_ms, build_ms;
} tc_terrain;

/* Whether a file is a packed terrain, by its first bytes. */
bool tc_is_packed(const char *path);

/* Opens. A packed terrain has its scale and its nodata from when it was packed: options for them are refused with
 * TC_ERR_USAGE. threads: that build the pyramid, 0 all. */
tc_status tc_terrain_open(const char *path, const tc_source_options *options, int threads, tc_terrain *terrain_ret,
                          tc_error *error);
/* The same for packed terrains only. */
tc_status tc_terrain_open_packed(const char *path, const tc_source_options *options, tc_terrain *terrain_ret,
                                 tc_error *error);
void tc_terrain_close(tc_terrain *terrain);

/* Bytes of a packed terrain's tiles decoded so far, and tiles found damaged; 0 for others. */
int64_t tc_terrain_bytes_decoded(const tc_field *field);
int64_t tc_terrain_damaged(const tc_field *field);

#endif

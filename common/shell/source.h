/* source.h - elevation input: any DEM or picture as rows of heights.
 *
 * A source is an open file. Tiles of SRTM (.hgt) are read here; other formats by two plugins, loaded only when a file
 * needs them: GDAL for elevation formats (GeoTIFF, VRT, PGM, PNG, JPEG 2000, ...), OpenImageIO for float EXR and what
 * GDAL does not know.
 * Everything that depends on the file is settled here, once: row order, registration, units, voids. */
#ifndef TC_SOURCE_H
#define TC_SOURCE_H

#include "common/terraclip.h"

/* Zero is the default everywhere. */
typedef struct tc_source_options {
    double spacing; /* metres between samples; 0: as the file says, else 1 */
    double unit;    /* metres per stored unit; 0: as the file says, else 1 */
    bool has_nodata;
    double nodata;  /* stored value that means void, beside the file's own */
    bool has_voids; /* the policy was asked for */
    tc_void_policy voids;
    double void_constant; /* metres, for TC_VOIDS_CONSTANT */
    /* Called with one line without newline for what a user should know (a warning: 8-bit steps, ...) or may want to
     * (said with -v: how degrees became metres, ...). NULL: not said. */
    void (*say)(void *context, bool warning, const char *line);
    void *say_context;
} tc_source_options;

typedef struct tc_source_info {
    int64_t width, height;       /* samples */
    double spacing_x, spacing_y; /* metres */
    double z_base;               /* metres; subtracted from the heights that tc_source_read gives */
    const char *sample_type;     /* "int16", "float32", ... */
    bool integer;                /* stored as integers */
    double unit;                 /* metres per stored unit */
    tc_georef georef;            /* crs_wkt owned by the source */
} tc_source_info;

typedef struct tc_source tc_source;

/* Opens a file. Refuses what cannot be a height field: three-channel pictures (the message names the encodings that
 * could be meant), directories, empty and unknown files. */
tc_status tc_source_open(const char *path, const tc_source_options *options, tc_source **source_ret, tc_error *error);
void tc_source_close(tc_source *source);
const tc_source_info *tc_source_get_info(const tc_source *source);

/* Reads rows y0 .. y0 + rows - 1, counted from the south, into z[(j - y0) * width + i], metres above z_base, and
 * voids (same layout, 1 = void: nodata, NaN, infinite; z is 0 there). Any order; north to south is the file's own. */
tc_status tc_source_read(tc_source *source, int64_t y0, int64_t rows, float *z, uint8_t *voids, tc_error *error);

/* Opens, reads, fills voids by the policy: the whole file as a grid that the caller frees with tc_grid_free. Refuses
 * grids that would not fit the machine's memory together with their pyramid, and grids without one valid sample. */
tc_status tc_grid_load(const char *path, const tc_source_options *options, tc_grid *grid_ret, tc_error *error);

/* Writes a float32 GeoTIFF from rows that are asked for as they are needed: row(context, y, z) gives row y counted
 * from the south. Written beside the target and renamed, so that a failure leaves an old file as it was. */
typedef tc_status (*tc_row_function)(void *context, int64_t y, float *z);
typedef struct tc_tiff_options {
    int64_t width, height;
    double spacing; /* metres */
    bool int16;     /* rounded to int16 instead of float32 */
} tc_tiff_options;
tc_status tc_write_tiff(const char *path, const tc_tiff_options *options, tc_row_function row, void *context,
                        tc_error *error);

/* Writes 8-bit RGB pixels, rows top to bottom, as a picture whose format the extension names (OpenImageIO), beside
 * the target and renamed. */
tc_status tc_write_picture(const char *path, int width, int height, const uint8_t *rgb, tc_error *error);

/* TC_ERR_USAGE where path has no extension that tc_write_picture knows. */
tc_status tc_check_picture_name(const char *path, tc_error *error);

#endif

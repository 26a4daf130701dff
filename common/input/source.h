/* source.h - elevation input: any DEM or picture as rows of heights.
 *
 * A source is an open file. Tiles of SRTM (.hgt) are read here; other formats by two plugins, loaded only when a file
 * needs them: GDAL for elevation formats (GeoTIFF, VRT, PGM, PNG, JPEG 2000, ...), OpenImageIO for float EXR and what
 * GDAL does not know.
 * Everything that depends on the file is settled here, once: row order, registration, units, voids. */
#ifndef TC_SOURCE_H
#define TC_SOURCE_H

#include "common/base/outputs.h"
#include "common/terraclip.h"

/* Zero is the default everywhere. */
typedef struct tc_source_options {
    double spacing; /* metres between samples; 0: as the file says, else 1 */
    double unit;    /* metres per stored unit, negative for depths; 0: as the file says, else 1 */
    bool has_offset;
    double offset; /* metres added to all heights; where it is not given and they are radii, minus the body's */
    bool has_nodata;
    double nodata;  /* stored value that means void, beside the file's own */
    bool has_voids; /* the policy was asked for */
    tc_void_policy voids;
    double void_constant; /* metres, for TC_VOIDS_CONSTANT */
    bool has_base;
    double z_base;             /* metres; instead of what suits the file */
    const tc_outputs *outputs; /* files, and files of which they are made, that are refused; NULL none */
    int band;                  /* from 1 on; 0: the first, with a warning where there are others */
    const char *layer;         /* of a file that holds several rasters; NULL: there must be one */
    const char *crs;           /* coordinate system, as PROJ knows it, whatever the file says; NULL: the file's */
    bool lonlat;               /* in longitude and latitude: other maps are brought there, warped where need be */
    bool exact;                /* refuse heights from which, as floats, the stored values do not come back */
    /* Called with one line without newline for what a user should know (a warning: 8-bit steps, ...) or may want to
     * (said with -v: how degrees became metres, ...). NULL: not said. */
    void (*say)(void *context, bool warning, const char *line);
    void *say_context;
    /* Called now and then with what is being done and the share of it that is done, 0 to 1, or negative where that is
     * not known; false stops it, with TC_ERR_IO. NULL: not called. */
    bool (*progress)(void *context, const char *what, double share);
    void *progress_context;
    /* Called with what an opened file says of whose it is, as it says it. NULL: not called. */
    void (*credit)(void *context, const char *text);
    void *credit_context;
} tc_source_options;

/* Says one line to the user by options->say. */
void tc_say(const tc_source_options *options, bool warning, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Tells by options->progress how far it is; fails where it is to stop. */
tc_status tc_tell_progress(const tc_source_options *options, const char *what, double share, tc_error *error);

typedef struct tc_source_info {
    int64_t width, height;       /* samples */
    double spacing_x, spacing_y; /* metres */
    double z_base;               /* metres; subtracted from the heights that tc_source_read gives */
    const char *sample_type;     /* "int16", "float32", ... */
    tc_sample_type type;         /* that holds them all */
    bool integer;                /* stored as integers */
    double unit;                 /* metres per stored unit */
    double offset;               /* metres of the stored value 0, z_base not subtracted */
    bool has_nodata;
    double nodata;             /* stored value: the file's own, else that of the options */
    tc_georef georef;          /* crs_wkt owned by the source */
    bool area_registered;      /* the samples stood for areas */
    double added;              /* metres that were added to heights: the offset of the options, or minus a radius */
    double crs_unit;           /* radians or metres per unit of the transform */
    double inverse_flattening; /* of the georeference's body; 0: a sphere */
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

/* Rows read together at the least cost. */
int64_t tc_source_chunk_rows(const tc_source *source);

/* Metres between samples of a raster of that size with the transform of georef, which is known: degrees at its mean
 * latitude. What the source's info says of the CRS holds. */
void tc_georef_spacing(const tc_source_info *info, const tc_georef *georef, int64_t width, int64_t height,
                       double *spacing_x, double *spacing_y);

/* The stored value of a height that was read, before rounding to its type. base: offset - z_base of the source. */
static inline double tc_stored_value(float z, double base, double unit)
{
    return ((double)z - base) / unit;
}

/* A coordinate system in metres from the terrain's own origin. */
#define TC_LOCAL_CRS "LOCAL_CS[\"terrain\",UNIT[\"metre\",1]]"

/* Writes a GeoTIFF from rows that are asked for as they are needed: row(context, y, values) gives row y counted from
 * the south as stored values, NaN where there is none. Written beside the target and renamed, so that a failure leaves
 * an old file as it was. */
typedef tc_status (*tc_row_function)(void *context, int64_t y, double *values);
typedef struct tc_tiff_options {
    int64_t width, height;
    tc_sample_type type;     /* values are rounded to it; one beyond its range is an error */
    double spacing;          /* metres; for a terrain without a georeference: its south-west sample is the origin */
    const tc_georef *georef; /* NULL or not known: by spacing */
    bool area_registered;
    bool has_nodata;
    double nodata;       /* stands for NaN, for which integers have no other value */
    double unit, offset; /* metres per stored unit, 0 is 1; metres of the stored value 0 */
    const char *credits; /* whose the heights are; NULL: not said */
} tc_tiff_options;
tc_status tc_write_tiff(const char *path, const tc_tiff_options *options, tc_row_function row, void *context,
                        tc_error *error);

/* Writes 8-bit RGB pixels, rows top to bottom, as a picture whose format the extension names (OpenImageIO), beside
 * the target and renamed. */
tc_status tc_write_picture(const char *path, int width, int height, const uint8_t *rgb, tc_error *error);

/* TC_ERR_USAGE where path has no extension that tc_write_picture knows. */
tc_status tc_check_picture_name(const char *path, tc_error *error);

#endif

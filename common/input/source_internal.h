/* source_internal.h - what the files source*.c share. */
#ifndef TC_SOURCE_INTERNAL_H
#define TC_SOURCE_INTERNAL_H

#include "plugin_tables.h"
#include "source.h"

/* ---- Conversion of stored samples to heights (source_convert.c) ---------------------------------------------------
 */

/* Heights are stored * scale + offset, metres above z_base. */
typedef struct tc_conversion {
    tc_sample_type type;
    double scale, offset;
    int nodata_count;
    double nodata[2]; /* stored values */
} tc_conversion;

/* What a stretch of samples held; accumulates. Start with TC_STATISTICS_NONE. */
typedef struct tc_statistics {
    int64_t voids;
    int64_t fills;   /* of them: finite values beyond any height that no nodata value announced */
    float low, high; /* of valid samples */
} tc_statistics;
#define TC_STATISTICS_NONE ((tc_statistics){0, 0, INFINITY, -INFINITY})

size_t tc_sample_size(tc_sample_type type);

/* Converts one row; mask (0 = void) may be NULL. Voids get z = 0. */
void tc_convert_row(const tc_conversion *conversion, const void *samples, const uint8_t *mask, int64_t width, float *z,
                    uint8_t *voids, tc_statistics *statistics);

/* The first sample of a row converted to z that tc_stored_value does not give back; -1: it gives back all. */
int64_t tc_find_inexact(const tc_conversion *conversion, const void *samples, const uint8_t *voids, int64_t width,
                        const float *z);

/* Rounds values to a type; NaN becomes nodata. The index of the first that has no place in the type, else -1. */
int64_t tc_store_row(tc_sample_type type, const double *values, int64_t width, double nodata, void *samples);

/* Metres (not above z_base) of sample i, NaN where void. */
double tc_convert_one(const tc_conversion *conversion, const void *samples, const uint8_t *mask, int64_t i);

/* ---- Georeference (source_georef.c) -------------------------------------------------------------------------------
 */

/* Sets georef (without crs_wkt) and the spacing, in metres, of a raster; says how it came about. flip_x and flip_y: the
 * file's columns run east to west, its rows south to north. */
void tc_settle_georef(const tc_raster_info *raster, const tc_source_options *options, tc_georef *georef,
                      double *spacing_x, double *spacing_y, bool *flip_x, bool *flip_y);

/* Radians or metres per unit of the transform. */
double tc_crs_unit(const tc_raster_info *raster, const tc_georef *georef);

/* Metres per unit of height by the unit's name; 0 for an unknown name. */
double tc_unit_by_name(const char *name);

/* ---- .hgt (source_hgt.c) ------------------------------------------------------------------------------------------
 */

/* The SRTM tile format, which has no header: *recognised by the file's name and its size. */
tc_status tc_hgt_open(const char *path, const tc_source_options *options, bool *recognised, tc_raster **raster_ret,
                      tc_error *error);

/* The same of what an archive held: bytes, which it takes over, of a file `name`; messages name path. */
tc_status tc_hgt_open_bytes(const char *path, const char *name, void *bytes, size_t size,
                            const tc_source_options *options, tc_raster **raster_ret, tc_error *error);

/* ---- Truncated files (source_whole.c) -----------------------------------------------------------------------------
 */

/* TC_ERR_FORMAT where a TIFF or PNG lacks a part whose absence its library does not notice; TC_OK for other files. */
tc_status tc_check_whole(const char *path, tc_error *error);

/* By a file's first bytes. */
bool tc_is_tiff(const unsigned char signature[4]);
bool tc_is_png(const unsigned char signature[4]);
bool tc_is_tclip(const unsigned char signature[8]);

/* ---- Sources (source.c) -------------------------------------------------------------------------------------------
 */

/* tc_source_read, which also accumulates statistics. */
tc_status tc_source_read_counted(tc_source *source, int64_t y0, int64_t rows, float *z, uint8_t *voids,
                                 tc_statistics *statistics, tc_error *error);

/* ---- Values that may stand for no height (source_suspect.c) -------------------------------------------------------
 */

/* What was seen of a source so far, and told. Start with TC_SUSPICION_NONE. */
typedef struct tc_suspicion {
    bool told_lowest, told_fills, told_zeros; /* once is enough */
    bool no_zeros;                            /* heights go on below 0, or come near it from above */
    int64_t zeros, rows;                      /* seen */
    float next, highest;                      /* the lowest height above 0 */
} tc_suspicion;
#define TC_SUSPICION_NONE ((tc_suspicion){.next = INFINITY, .highest = -INFINITY})

/* A row as tc_convert_row() left it, with the statistics of it and of rows before. */
void tc_suspect_row(tc_suspicion *suspicion, const tc_conversion *conversion, const float *z, const uint8_t *voids,
                    int64_t width, const tc_statistics *statistics);

/* That many rows of a source of height rows were looked at: says what is to be said. */
void tc_suspect_rows(tc_suspicion *suspicion, const tc_conversion *conversion, int64_t rows, int64_t height,
                     const tc_statistics *statistics, const tc_source_options *options);

/* TC_ERR_USAGE where a number of the options is nonsense. */
tc_status tc_check_source_options(const tc_source_options *options, tc_error *error);

/* Heights beyond this are taken for a wrong unit: the Earth's radius is 6.4e6 m. */
#define TC_HIGHEST 1e9
/* Floating-point values beyond this mean "none" in every format that has been seen. */
#define TC_FILL_VALUE 1e30

#endif

/* plugin_gdal.h - what the files of terraclip-gdal.so share. */
#ifndef TC_PLUGIN_GDAL_H
#define TC_PLUGIN_GDAL_H

#include "plugin_tables.h"

#include <gdal.h>
#include <ogr_srs_api.h>

/* GDAL's messages during one call: the first failure is the cause, later ones are its echo. */
typedef struct tc_gdal_messages {
    char failure[256];
    char warning[256];
} tc_gdal_messages;

/* Sets GDAL up, once. */
void tc_gdal_start(void);

/* From here on this thread's messages are kept instead of printed; ends that and returns what GDAL said. */
void tc_gdal_listen(tc_gdal_messages *messages);
const char *tc_gdal_heard(const tc_gdal_messages *messages);

/* ---- Datasets (plugin_gdal.c) -------------------------------------------------------------------------------------
 */

/* Opens what a name stands for, with the driver that knows it; messages name path. *recognised: there is one. */
tc_status tc_gdal_open_dataset(const char *path, const char *name, GDALDatasetH *dataset_ret, bool *recognised,
                               tc_error *error);

/* Tells options->credit what a dataset says of whose it is. */
void tc_gdal_tell_credit(GDALDatasetH dataset, const tc_source_options *options);

/* All files of a dataset, to be freed with CSLDestroy. */
char **tc_gdal_all_files(GDALDatasetH dataset);

/* ---- Containers and layers (plugin_gdal_layers.c) -----------------------------------------------------------------
 */

/* The name by which GDAL reads what a .gz, .zip or .tar holds, which the caller frees with CPLFree; NULL for another
 * file. Of several rasters the one that options->layer names (*layer_taken_ret). */
tc_status tc_gdal_look_inside(const char *path, const tc_source_options *options, char **inner_ret,
                              bool *layer_taken_ret, tc_error *error);

tc_status tc_gdal_unpack_hgt(const char *path, const tc_source_options *options, char **name_ret, bool *layer_taken_ret,
                             void **bytes_ret, size_t *size_ret, tc_error *error);

/* Where a dataset is a list of layers (NetCDF, HDF, GeoPackage) it becomes the one that options->layer names, or the
 * only one; else an error lists them. */
tc_status tc_gdal_take_layer(const char *path, const tc_source_options *options, bool layer_taken,
                             GDALDatasetH *dataset, tc_error *error);

/* ---- Grids of text (plugin_gdal_text.c) ---------------------------------------------------------------------------
 */

/* What is to be checked before a grid is read. */
typedef struct tc_gdal_text {
    char *name; /* of the text, as GDAL has it; NULL: nothing (any more) */
    int64_t columns, rows;
    bool whole; /* all its values are whole numbers */
} tc_gdal_text;

/* Of a dataset as it was opened; to be freed. */
tc_gdal_text tc_gdal_text_of(GDALDatasetH dataset);
void tc_gdal_text_free(tc_gdal_text *text);

/* TC_ERR_FORMAT where values are missing or are no numbers. Once that is well there is nothing to check any more. */
tc_status tc_gdal_text_check(tc_gdal_text *text, const char *path, tc_error *error);

/* ---- Coordinate systems (plugin_gdal_crs.c) -----------------------------------------------------------------------
 */

/* Longitude and latitude on a system's body, in degrees east of Greenwich, in that order; the caller destroys it. NULL
 * where it has none. */
OGRSpatialReferenceH tc_gdal_lonlat_of(OGRSpatialReferenceH crs);

/* Sets what a system says; angles become degrees, the transform, which is read already, with them. TC_ERR_UNSUPPORTED
 * for a rotated globe. */
tc_status tc_gdal_read_crs(const char *path, OGRSpatialReferenceH crs, tc_raster_info *info, tc_error *error);

/* Where the columns and rows of a raster lie. */
typedef struct tc_gdal_places {
    OGRCoordinateTransformationH to_lonlat;
    double transform[6]; /* of the raster: corners */
    double semi_major, e2;
} tc_gdal_places;
bool tc_gdal_places_open(OGRSpatialReferenceH crs, OGRSpatialReferenceH lonlat, const double transform[6],
                         tc_gdal_places *places_ret);
void tc_gdal_places_close(tc_gdal_places *places);
/* Longitude and latitude; false where there is no place. */
bool tc_gdal_place_of(const tc_gdal_places *places, double column, double row, double degrees[2]);
/* Metres on the ground between samples along rows and along columns, taken over `half` of them to either side. */
bool tc_gdal_spacing_at(const tc_gdal_places *places, double column, double row, double half, double *x, double *y);

/* As the plugin's table has them: places_open, place_of, places_close. */
void *tc_gdal_ground_open(const char *wkt, const double transform[6]);
bool tc_gdal_ground_at(void *places, double column, double row, double degrees_ret[2]);
void tc_gdal_ground_close(void *places);

/* An angle as -180 .. 180 degrees. */
double tc_gdal_turn(double degrees);

bool tc_gdal_ground(const char *wkt, const double transform[6], int64_t width, int64_t height,
                    tc_ground_scale *ground_ret);

/* Degrees east and north, of the system's own globe, in that system; false where it has no such place. */
bool tc_gdal_from_lonlat(const char *wkt, const double degrees[2], double xy_ret[2]);

/* ---- Longitude and latitude (plugin_gdal_warp.c) ------------------------------------------------------------------
 */

/* A raster that was brought to longitude and latitude. */
typedef struct tc_gdal_lonlat {
    OGRSpatialReferenceH crs; /* of it; NULL: it was not */
    bool straight;            /* its samples are as stored, in `transform` */
    double transform[6];
    GDALDatasetH stored, floats; /* what the warped dataset is made of, else NULL */
} tc_gdal_lonlat;

/* Brings a raster with a coordinate system that is not longitude and latitude there. Where it is warped *dataset
 * becomes the warped one, of one band of floats and one of alpha; the stored one then is lonlat_ret's. On failure, too,
 * it is closed with tc_gdal_lonlat_close, after *dataset. */
tc_status tc_gdal_onto_globe(const char *path, GDALDatasetH *dataset, int band, OGRSpatialReferenceH crs,
                             const tc_source_options *options, tc_gdal_lonlat *lonlat_ret, tc_error *error);
void tc_gdal_lonlat_close(tc_gdal_lonlat *lonlat);

tc_status tc_gdal_write_tiff(const char *path, const char *temporary, const tc_tiff_options *options,
                             tc_sample_row_function row, void *context, tc_error *error);

#endif

/* plugin_gdal_image.h - what the files of terraclip-gdal.so that read pictures share. */
#ifndef TC_PLUGIN_GDAL_IMAGE_H
#define TC_PLUGIN_GDAL_IMAGE_H

#include "plugin_gdal.h"

tc_status tc_gdal_open_image(const char *path, const tc_image_map *map, const tc_image_options *options,
                             bool *recognised, tc_image **image_ret, tc_error *error);
tc_status tc_gdal_cache_image(tc_image_rows *rows, const tc_image_options *options, tc_image **image_ret,
                              tc_error *error);

/* ---- Pixels (plugin_gdal_pixels.c) --------------------------------------------------------------------------------
 */

typedef enum tc_gdal_pixel_kind { TC_PIXELS_GREY, TC_PIXELS_PALETTE, TC_PIXELS_RGB, TC_PIXELS_CMYK } tc_gdal_pixel_kind;

/* How a raster's bands are colours. */
typedef struct tc_gdal_pixels {
    tc_gdal_pixel_kind kind;
    int band[4], count; /* of colours */
    int alpha;          /* band; 0: none */
    bool multiplied;    /* by it colours are stored */
    int masks;          /* of so many of the bands; 0: none */
    double white[5];    /* the number that is, of each of the colours; [4]: of alpha */
    uint8_t (*palette)[4];
    int entries;
} tc_gdal_pixels;

/* TC_ERR_UNSUPPORTED where they are none. To be freed. */
tc_status tc_gdal_pixels_of(const char *name, GDALDatasetH dataset, const tc_source_options *options,
                            tc_gdal_pixels *pixels_ret, tc_error *error);
void tc_gdal_pixels_free(tc_gdal_pixels *pixels);

/* Pixels of the raster (overview -1) or of one of its overviews; false where GDAL cannot read them, which then has said
 * why. */
bool tc_gdal_pixels_read(const tc_gdal_pixels *pixels, GDALDatasetH dataset, int overview, tc_rect rect,
                         uint8_t (*rgba)[4], ptrdiff_t stride, tc_gdal_messages *said);

/* Whether colours are stored times the alpha of that band (plugin_gdal_alpha.c). */
bool tc_gdal_alpha_multiplied(GDALDatasetH dataset, int alpha);

/* ---- Levels kept in files (plugin_gdal_image_cache.c) -------------------------------------------------------------
 */

typedef struct tc_gdal_cache {
    const char *name;      /* of the picture, for messages */
    char base[4096];       /* of the files' names; empty: there is no place for a cache */
    int first, count;      /* levels */
    int64_t width, height; /* of level 0 */
} tc_gdal_cache;

/* Where the cache keeps what was made of a picture of these files, as they are now. */
void tc_gdal_cache_name(tc_gdal_cache *cache, char *const *files);

/* Opens the files that hold the levels, made from rows where they are not there yet. dataset_ret[k], of level first +
 * k: to be closed. */
tc_status tc_gdal_cache_open(const tc_gdal_cache *cache, tc_image_rows *rows, const tc_image_options *options,
                             GDALDatasetH *dataset_ret, tc_error *error);

/* Takes the files away, which are not what they should be. */
void tc_gdal_cache_forget(const tc_gdal_cache *cache);

/* ---- Pictures -----------------------------------------------------------------------------------------------------
 */

/* A level: of the picture's own dataset, a file of the cache, or made in memory. */
typedef struct tc_gdal_level {
    GDALDatasetH dataset;
    const tc_gdal_pixels *pixels;
    int overview;    /* of it; -1: itself */
    tc_image *small; /* instead */
    int small_level; /* of that */
} tc_gdal_level;

typedef struct tc_gdal_image {
    tc_image base;
    GDALDatasetH dataset;
    tc_gdal_pixels pixels;
    tc_gdal_cache cache;
    GDALDatasetH cached[TC_IMAGE_LEVELS];
    tc_gdal_pixels plain; /* of the cached ones */
    tc_gdal_level level[TC_IMAGE_LEVELS];
    tc_image *small; /* levels in memory, the coarsest ones or all; NULL: there are none */
    void *places;
    char path[];
} tc_gdal_image;

/* Settles where each level is (plugin_gdal_image_levels.c). Rows are those of the picture where only another library
 * reads it, else NULL. */
tc_status tc_gdal_image_levels(tc_gdal_image *image, tc_image_rows *rows, const tc_image_options *options,
                               tc_error *error);

/* ---- Places (plugin_gdal_image_place.c) ---------------------------------------------------------------------------
 */

/* The system in which a picture says where it is, which stays its own; NULL: it names none. */
OGRSpatialReferenceH tc_gdal_image_system(GDALDatasetH dataset);

/* From places of a map to pixels, in the picture's own system, or in none, where the map has none. NULL and an error:
 * it cannot be transformed. */
void *tc_gdal_image_places(const char *name, GDALDatasetH dataset, const tc_image_map *map, tc_error *error);
void tc_gdal_image_find(void *places, int count, double *x, double *y);
void tc_gdal_image_locate(void *places, int count, double *x, double *y);
void tc_gdal_image_places_close(void *places);

#endif

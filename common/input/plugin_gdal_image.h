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

/* Pixels of the raster (overview -1) or of one of its overviews; false where GDAL cannot read them. */
bool tc_gdal_pixels_read(const tc_gdal_pixels *pixels, GDALDatasetH dataset, int overview, tc_rect rect,
                         uint8_t (*rgba)[4], ptrdiff_t stride);

/* Whether colours are stored times the alpha of that band (plugin_gdal_alpha.c). */
bool tc_gdal_alpha_multiplied(GDALDatasetH dataset, int alpha);

/* ---- Levels kept in files (plugin_gdal_image_cache.c) -------------------------------------------------------------
 */

/* Opens the files that hold levels first .. first + count - 1, made from rows where they are not there yet; width and
 * height are those of level 0. dataset_ret[k]: to be closed. */
typedef struct tc_gdal_cache {
    const char *name; /* of the picture, for messages */
    char base[4096];  /* of the files' names; empty: there is no place for a cache */
    int first, count;
    int64_t width, height;
} tc_gdal_cache;
tc_status tc_gdal_cache_open(const tc_gdal_cache *cache, tc_image_rows *rows, const tc_image_options *options,
                             GDALDatasetH *dataset_ret, tc_error *error);

/* ---- Places (plugin_gdal_image_place.c) ---------------------------------------------------------------------------
 */

/* From places of a map to pixels. NULL and an error: it cannot be transformed. */
void *tc_gdal_image_places(const char *name, GDALDatasetH dataset, const tc_image_map *map, tc_error *error);
void tc_gdal_image_find(void *places, int count, double *x, double *y);
void tc_gdal_image_locate(void *places, int count, double *x, double *y);
void tc_gdal_image_places_close(void *places);

#endif

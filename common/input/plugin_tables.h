/* plugin_tables.h - what the input plugins export as `tc_plugin`, and the raster they open.
 *
 * A raster is one file as its library sees it: stored samples in their own type, rows in the file's order, metadata
 * as found. What they mean in metres is settled in one place for all libraries (source.c), not in the plugins. */
#ifndef TC_PLUGIN_TABLES_H
#define TC_PLUGIN_TABLES_H

#include "image.h"
#include "source.h"

#ifdef __cplusplus
extern "C" {
#endif

#define TC_RADIANS_PER_DEGREE 0.017453292519943295

/* Coordinate systems by what their unit measures. */
typedef enum tc_crs_kind {
    TC_CRS_NONE,       /* the file names none */
    TC_CRS_GEOGRAPHIC, /* angles */
    TC_CRS_PROJECTED   /* lengths; also local systems */
} tc_crs_kind;

typedef struct tc_raster_info {
    int64_t width, height;
    tc_sample_type type;
    const char *type_name; /* of the stored samples, "int16"; static */
    bool integer;          /* stored as integers */
    int64_t block_rows;    /* rows that the library decodes together */
    bool has_mask;         /* read() fills the mask */
    bool has_nodata;
    double nodata;        /* stored value */
    double scale, offset; /* value = stored * scale + offset */
    char unit_name[32];   /* of the values; empty where not said */
    double vertical_unit; /* metres per unit of heights, by the coordinate system; 0: it says nothing of heights */
    char vertical_name[32];
    bool area_registered;                   /* samples stand for areas; the transform is that of corners either way */
    bool has_transform, has_control_points; /* the latter only without the former */
    double transform[6];                    /* GDAL's geotransform: from (column, row) of pixel corners to the CRS */
    double nominal_x, nominal_y; /* metres between samples, for a format that tells without a transform; 0 unknown */
    tc_crs_kind crs;
    double crs_unit;           /* radians or metres per unit of the CRS */
    char brought_from[32];     /* the meridian of a system that was brought to degrees east of Greenwich; else empty */
    double semi_major;         /* metres; 0 unknown */
    double inverse_flattening; /* 0: a sphere */
    char *crs_wkt;             /* NULL none; freed with the raster */
    char **parts; /* all files that it is made of, NULL at the end; NULL: path alone; freed with the raster */
} tc_raster_info;

/* What a map's projection makes of lengths. */
typedef struct tc_ground_scale {
    double x, y;        /* metres on the ground between samples, in the map's middle */
    double least, most; /* of it over the map, along either axis: metres on the ground per metre of the map */
} tc_ground_scale;

typedef struct tc_raster tc_raster;
struct tc_raster {
    tc_raster_info info;
    /* Reads rows row .. row + rows - 1, counted in the file's order, in the type of info. mask, where the raster has
     * one: 0 = void. Any order; a compressed file read backwards is slow. */
    tc_status (*read)(tc_raster *raster, int64_t row, int64_t rows, void *samples, uint8_t *mask, tc_error *error);
    void (*close)(tc_raster *raster);
};

/* Opens path. *recognised tells whether the file is of a format of this library, also on failure: where it is false,
 * another library may try. */
typedef tc_status (*tc_raster_open)(const char *path, const tc_source_options *options, bool *recognised,
                                    tc_raster **raster_ret, tc_error *error);

typedef tc_status (*tc_sample_row_function)(void *context, int64_t y, void *samples);

/* terraclip-gdal.so */
struct tc_gdal_plugin {
    tc_raster_open open;
    /* As tc_image_open(), of what GDAL knows: *recognised. */
    tc_status (*open_image)(const char *path, const tc_image_map *map, const tc_image_options *options,
                            bool *recognised, tc_image **image_ret, tc_error *error);
    /* The levels of a picture that only another library reads, by way of the cache. */
    tc_status (*cache_image)(tc_image_rows *rows, const tc_image_options *options, tc_image **image_ret,
                             tc_error *error);
    /* What an archive holds where that is an .hgt, which needs no library but must be unpacked: its name, and its
     * bytes, both to be freed; NULL for any other file. *layer_taken_ret: options->layer named it. Errors are those of
     * archives that open() would refuse, too. */
    tc_status (*unpack_hgt)(const char *path, const tc_source_options *options, char **name_ret, bool *layer_taken_ret,
                            void **bytes_ret, size_t *size_ret, tc_error *error);
    /* Whether a file, or a folder (Zarr, MFF2), is of a format of this library. */
    bool (*recognises)(const char *path);
    /* As tc_write_tiff, straight to the file temporary; messages name path. Rows are asked for from the north in the
     * type of options; where row fails, *error is its own. */
    tc_status (*write_tiff)(const char *path, const char *temporary, const tc_tiff_options *options,
                            tc_sample_row_function row, void *context, tc_error *error);
    /* Lengths of a projected map, by its coordinate system and its transform; false where they cannot be told. */
    bool (*ground)(const char *wkt, const double transform[6], int64_t width, int64_t height,
                   tc_ground_scale *ground_ret);
    /* Whether two coordinate systems are the same, however they are written. */
    bool (*same_crs)(const char *wkt, const char *other_wkt);
    /* Degrees east and north, of the system's own globe, in that system: x and y. False where it has no such place. */
    bool (*from_lonlat)(const char *wkt, const double degrees[2], double xy_ret[2]);
    /* Places of a projected map, by its coordinate system and its transform: longitude and latitude, degrees, of a
     * column and row from its corner; false where there are none. NULL: the system is none of a globe, or unknown. */
    void *(*places_open)(const char *wkt, const double transform[6]);
    bool (*place_of)(void *places, double column, double row, double degrees_ret[2]);
    void (*places_close)(void *places);
};

/* terraclip-oiio.so */
struct tc_oiio_plugin {
    tc_raster_open open;
    /* A picture's pixels, row by row. */
    tc_status (*open_rows)(const char *path, const tc_image_options *options, tc_image_rows **rows_ret,
                           tc_error *error);
    /* As tc_write_picture, straight to the file temporary, which has the extension of path; messages name path. */
    tc_status (*write_picture)(const char *path, const char *temporary, int width, int height, const uint8_t *rgb,
                               tc_error *error);
    /* Whether some format writes pictures with path's extension. */
    bool (*can_write)(const char *path);
};

/* What both plugins refuse with the same words: more than one channel, or a palette. */
static inline const char *tc_channels_advice(void)
{
    return "could be Terrarium RGB (256 R + G + B / 256 - 32768), Mapbox terrain-RGB (0.1 (65536 R + 256 G + B) - "
           "10000), heights packed as 65536 R + 256 G + B, or a colour picture; decode it to one channel first";
}

#ifdef __cplusplus
}
#endif
#endif

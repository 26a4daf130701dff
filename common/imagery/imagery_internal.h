/* imagery_internal.h - what the files of imagery share.
 *
 *     imagery.c         the pictures, and how fine colours are
 *     imagery_place.c   from places of charts to pixels
 *     imagery_tile.c    a tile of colours from the pictures
 *     imagery_field.c   tiles as a field */
#ifndef TC_IMAGERY_INTERNAL_H
#define TC_IMAGERY_INTERNAL_H

#include <pthread.h>
#include <stdatomic.h>

#include "common/packed/file/block_cache.h"
#include "common/packed/read/prefetch.h"
#include "common/packed/read/tile_faults.h"
#include "imagery.h"

enum { TC_IMAGERY_TILE = 256 }; /* texels a side */

/* Where on a chart a picture may be: chart coordinates, to which whole turns may be added where the chart has any. */
typedef struct tc_layer_bounds {
    bool everywhere; /* it is not known any better */
    double lo[2], hi[2], turn;
} tc_layer_bounds;

/* A picture over the map. */
typedef struct tc_layer {
    tc_image *image;
    pthread_mutex_t mutex; /* of the image, which serves one thread at a time */
    bool around;           /* without a place of its own it covers the globe, else the map's samples */
    double period;         /* pixels after which columns come round again; 0: never */
    bool joined;           /* the picture itself goes around: its last column is beside its first */
    tc_layer_bounds bounds[TC_MAP_CHARTS];
} tc_layer;

struct tc_imagery {
    const tc_map *map;
    int layers, charts, threads;
    tc_layer *layer;
    struct tc_colour_field *field[TC_MAP_CHARTS];
    tc_block_cache blocks;
    tc_prefetch prefetch;
    tc_tile_faults faults;
    pthread_mutex_t mutex; /* of the error */
    tc_status failed;
    tc_error error;
};

typedef struct tc_colour_field {
    tc_field head;
    tc_imagery *imagery;
    int chart, owner;
    double x0, y0, dx, dy; /* of the finest level's samples, in chart coordinates */
    _Atomic int64_t made, cancelled;
} tc_colour_field;

/* ---- Places (imagery_place.c) -------------------------------------------------------------------------------------
 */

/* Settles what of a layer's place the map decides, and its bounds. */
void tc_layer_place(const tc_map *map, tc_layer *layer);

/* From chart coordinates to pixels of level 0, in place; NAN where there is none. With the layer's mutex held. */
void tc_layer_find(const tc_map *map, tc_layer *layer, int chart, int count, double *x, double *y);

/* From pixels to chart coordinates, likewise. */
void tc_layer_locate(const tc_map *map, tc_layer *layer, int chart, int count, double *x, double *y);

/* Whether a pixel is within the picture. */
bool tc_layer_holds(const tc_layer *layer, double px, double py);

/* Whether the picture may hold places of a rectangle of the chart; false only where it holds none. */
bool tc_layer_may_hold(const tc_layer *layer, int chart, const double lo[2], const double hi[2]);

/* ---- Tiles (imagery_tile.c) ---------------------------------------------------------------------------------------
 */

/* Texels rect of a level, rows stride apart. */
tc_status tc_imagery_make(tc_colour_field *field, int level, tc_rect rect, uint8_t (*texels)[4], ptrdiff_t stride,
                          tc_error *error);

/* ---- The field (imagery_field.c) ----------------------------------------------------------------------------------
 */

/* finest: its level; the first sample is the chart's. NULL: no memory. */
tc_colour_field *tc_colour_field_create(tc_imagery *imagery, int chart, tc_level finest);
tc_piece tc_colour_read_piece(tc_wish *wish);

#endif

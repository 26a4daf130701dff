/* container.h - the head of a packed file and where its parts lie: docs/format.md says it byte by byte.
 *
 *     head | level base + 1 | level base + 2 | ... | level m
 *     level: directory of pages | for each page: the page, then its tiles in order
 *
 * Levels up to `base` have at most TC_BASE_SIZE samples along a side; the heights of level `base` stand in the head,
 * and those of coarser levels are made from them. */
#ifndef TC_CONTAINER_H
#define TC_CONTAINER_H

#include "common/chart/lonlat.h"
#include "common/codec/lifting/codec.h"
#include "common/field/field.h"
#include "common/base/byte_order.h"
#include "head.h"
#include "index_page.h"

enum {
    TC_CONTAINER_VERSION = 2, /* the newest of a container; what needs no more is written as version 1 */
    TC_NEWEST_VERSION = 3,    /* of a file: an envelope of containers (envelope.h) */
    TC_BASE_SIZE = 16,
    TC_DIRECTORY_ENTRY = 16,  /* bytes */
    TC_DIRECTORY_CHUNK = 255, /* entries that share a checksum */
    TC_CAP_CHARTS = 2         /* north, south */
};

/* How a level's tiles are coded. */
typedef enum tc_coder {
    TC_CODER_LIFTING,     /* codec.h */
    TC_CODER_CORRECTIONS, /* codec.h, then codec_correction.h on the heights that result */
    TC_CODER_EXACT,       /* codec_exact.h */
    TC_CODER_LH04,        /* codec_lh04.h */
    TC_CODER_SPARSE,      /* as TC_CODER_CORRECTIONS, by squares; which is read only since this one is written */
    TC_CODERS
} tc_coder;

static inline bool tc_coder_corrects(tc_coder coder)
{
    return coder == TC_CODER_CORRECTIONS || coder == TC_CODER_SPARSE;
}

/* How a chart lies on its body: as chart.h in common/chart has them. */
typedef enum tc_chart_kind {
    TC_CHART_PLANE,
    TC_CHART_LONLAT,
    TC_CHART_NORTH_CAP,
    TC_CHART_SOUTH_CAP,
    TC_CHART_HEX,
    TC_CHART_CUBE,
    TC_CHART_KINDS
} tc_chart_kind;

/* What the faces of an atlas were resampled from: the grid of longitude and latitude that the georeference counts
 * samples of, and how far its samples are from the faces' heights, interpolated, before these were coded. */
typedef struct tc_face_source {
    int64_t width, height;
    double transform[6];
    double rms, max; /* metres */
    /* How far a sample on a side may be from the same one of the chart that it is taken from, metres; of rank k, of as
     * many as are known. */
    int ranks;
    float apart[TC_MAX_FIELD_LEVELS];
} tc_face_source;

/* A level that is coded in tiles. */
typedef struct tc_level_record {
    tc_coder coder;
    bool mask;                               /* some sample is void */
    int64_t begin, end;                      /* bytes of the file */
    int32_t lowest, highest;                 /* reconstructed heights, in height units */
    float rms, max_error, residual_variance; /* metres, square metres */
    int32_t correction_snap;                 /* height units; heights are rounded to multiples before corrections */
    int32_t correction_step;                 /* height units; of coders that correct */
    uint8_t *model;                          /* header of the level's model; owned */
    size_t model_size;
} tc_level_record;

/* Where a level's errors against the finest one stand (error_store.h), and the largest of them, metres. */
typedef struct tc_error_place {
    int shift; /* leaves have 2^shift samples a side */
    float most;
    int64_t begin, bytes; /* of levels that are coded */
} tc_error_place;

typedef struct tc_container {
    tc_packed_info info;              /* terrain.georef.crs_wkt and terrain.credits owned */
    int wraps_from;                   /* the coarsest level that wraps; above `levels`: none does */
    double z_unit, z_origin;          /* a height is z_origin + z_unit * k metres above z_base */
    double z_min, z_max;              /* metres above z_base, of the source without voids */
    int64_t voids;                    /* of the finest level */
    int64_t cap_bytes[TC_CAP_CHARTS]; /* of the caps' containers, which follow level m; planets of 3 charts */
    bool steps; /* pages tell each tile's largest step to the coarser level (index_page.h); version 3 */
    int levels, base;
    tc_level level[TC_MAX_FIELD_LEVELS];         /* [l - 1] */
    tc_level_record record[TC_MAX_FIELD_LEVELS]; /* [l - 1]; for l > base */
    int32_t base_z[TC_BASE_SIZE * TC_BASE_SIZE]; /* [j * width + i] */
    uint8_t base_void[TC_BASE_SIZE * TC_BASE_SIZE];
    bool errors;                               /* the file tells them, of all levels; version 3 */
    tc_error_place error[TC_MAX_FIELD_LEVELS]; /* [l - 1]; for l > 1 */
    int64_t error_bytes;                       /* of all charts: the finest level's record counts them as its own */
    tc_chart_kind kind;                        /* of files of version 3 */
    tc_face_source source;                     /* of the first of several faces; else of no width */
    struct tc_synthesis_fit *synthesis; /* of the file's first chart (synthesis.h); owned. NULL: none is stored */
} tc_container;

/* Sets levels, base and wraps_from from info.terrain. */
void tc_container_set_levels(tc_container *c);

/* Level l > 1 as the transform sees it. It wraps where the next coarser one still does: where its width is even. */
tc_lifting_level tc_container_lifting(const tc_container *c, int l);
void tc_container_free(tc_container *c);

/* Where cap n, 0 or 1, of a planet with 3 charts begins: behind level m and the caps before. */
int64_t tc_container_cap_begin(const tc_container *c, int n);

/* Where a planet's grid of longitude and latitude lies; poles: there can be caps. False where the terrain's
 * georeference has no such grid. */
bool tc_terrain_globe(const tc_pack_terrain *terrain, tc_lonlat *globe_ret);

/* Pages of a level, and where its directory's entries stand in its bytes. */
typedef struct tc_pages {
    int64_t tiles_x, tiles_y, pages_x, pages_y;
} tc_pages;
tc_pages tc_level_pages(const tc_level *level);
int64_t tc_directory_bytes(const tc_pages *pages);
static inline int64_t tc_directory_chunk_offset(int64_t chunk)
{
    return chunk * (TC_DIRECTORY_CHUNK * TC_DIRECTORY_ENTRY + 4);
}

/* Enters page `number` of `count`, which begins at `offset`; adds the checksums at the end. */
void tc_directory_put(uint8_t *directory, int64_t number, uint64_t offset, size_t size, uint32_t crc);
void tc_directory_seal(uint8_t *directory, int64_t count);

/* What its pages tell; steps: as of the container. */
static inline tc_page_form tc_level_form(const tc_level_record *record, bool steps)
{
    return (tc_page_form){tc_coder_corrects(record->coder), record->mask, steps,
                          steps && record->coder == TC_CODER_EXACT};
}

/* Tiles of page (px, py): a rectangle of tiles. */
tc_rect tc_page_tiles(const tc_pages *pages, int64_t px, int64_t py);

/* Head as bytes. Its size does not depend on begin, end, info.bytes and the numbers that measure; so it can be written
 * again once they are known. */
tc_status tc_container_write(const tc_container *c, tc_byte_writer *writer);

/* Reads a head. `size`: bytes at hand; *head_size_ret, also where TC_ERR_FORMAT says that they are too few: how many
 * are needed (0: no packed file). subject is named in errors. */
tc_status tc_container_read(const char *subject, const uint8_t *bytes, size_t size, tc_container *c_ret,
                            size_t *head_size_ret, tc_error *error);

/* The same of a head that stands in another one, which says where its levels lie (envelope.h): that is not checked. */
tc_status tc_container_read_placed(const char *subject, const uint8_t *bytes, size_t size, tc_container *c_ret,
                                   size_t *head_size_ret, tc_error *error);

#endif

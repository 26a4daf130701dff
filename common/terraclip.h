/* terraclip.h - the public interface of the Terraclip core library.
 *
 * Terrains of any size as geometry clipmaps (LH04: Losasso, Hoppe, "Geometry Clipmaps: Terrain Rendering
 * Using Nested Regular Grids", SIGGRAPH 2004). This header is the manual. Nothing in it needs OpenGL, GDAL or
 * a window.
 *
 * Conventions, everywhere unless a comment says otherwise:
 *   - metres and radians; x east, y north, z up; the origin of a flat map is its south-west sample;
 *   - samples are points: sample (i, j) of a level sits at (i * spacing_x, j * spacing_y); rows run south to north;
 *   - levels are numbered as in LH04: coarsest 1, finest m; level l has spacing g_l = 2^(m-l) times the finest;
 *   - rectangles are half-open: x0 <= i < x1;
 *   - a terrain that wraps in x goes once around a globe: its column `width` is column 0;
 *   - functions that can fail return a tc_status, give results through their pointers, leave outputs untouched on
 *     failure, and say what went wrong in words in *error where one is given (error may be NULL);
 *   - destroy and free functions accept NULL.
 */
#ifndef TERRACLIP_H
#define TERRACLIP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default) /* what is declared here is what the library shows */
#endif

/* ---- Status ------------------------------------------------------------------------------------------------- */

typedef enum tc_status {
    TC_OK = 0,
    TC_ERR_USAGE,       /* an argument or option is out of range or nonsense */
    TC_ERR_MEMORY,      /* not enough memory, or more asked for than the machine has */
    TC_ERR_IO,          /* a file cannot be opened, read or written */
    TC_ERR_FORMAT,      /* a file's content is damaged or is not what it should be */
    TC_ERR_UNSUPPORTED, /* well-formed, but nothing here can handle it */
    TC_ERR_CONTEXT      /* no usable display or OpenGL context */
} tc_status;

/* What went wrong, as one line "subject: what, expected, found" without a newline. */
typedef struct tc_error {
    tc_status status;
    char text[512];
} tc_error;

/* The status in a few words; static storage. */
const char *tc_status_text(tc_status status);

/* Exit code of a program that ends with this status: 0 done, 1 failure at run time, 2 usage. */
int tc_exit_code(tc_status status);

/* The library's version, "MAJOR.MINOR.PATCH". */
const char *tc_version(void);

/* ---- Rectangles --------------------------------------------------------------------------------------------- */

/* Half-open rectangle of samples of one level; empty where x1 <= x0 or y1 <= y0. */
typedef struct tc_rect {
    int64_t x0, y0, x1, y1;
} tc_rect;

/* ---- Grids: heights in memory -------------------------------------------------------------------------------- */

/* Where a grid lies on the Earth or another body; zero where the file does not say. */
typedef struct tc_georef {
    bool known;                /* the file had a geotransform */
    bool geographic;           /* its unit is degrees */
    double transform[6];       /* GDAL's geotransform of the file: corner-based, rows north to south, file units */
    double semi_major;         /* metres; 0 unknown. Tells Earth from other bodies */
    double inverse_flattening; /* 0: a sphere, or unknown */
    char *crs_wkt;             /* coordinate system; NULL none; owned by the grid */
} tc_georef;

/* A rectangle of heights held in memory. */
typedef struct tc_grid {
    int64_t width, height; /* samples */
    float *z; /* metres above z_base, [j * width + i], row 0 southernmost; owned. Finite everywhere: voids are filled */
    uint8_t *voids; /* 1 where the source had no height, laid out as z; NULL where there is none; owned */
    int64_t void_count;
    bool voids_flat;             /* voids are shown at the height void_height, which no filter takes into account */
    float void_height;           /* metres above z_base */
    double z_base;               /* metres; what must be added to z. 0 unless the relief would drown in a float */
    double spacing_x, spacing_y; /* metres */
    float z_min, z_max;          /* of z over samples that are not void */
    bool wraps_x;                /* column `width` is column 0 */
    bool area_registered;        /* samples stood for areas: places within half a sample beside them are theirs, too */
    tc_georef georef;
} tc_grid;

/* Frees what the grid owns and zeroes it. */
void tc_grid_free(tc_grid *grid);

/* ---- Pyramid: prefiltered levels ------------------------------------------------------------------------------ */

typedef struct tc_field tc_field;

/* One level of a pyramid. */
typedef struct tc_level {
    int64_t width, height;       /* samples: ceil of half the next finer level's */
    double spacing_x, spacing_y; /* metres */
} tc_level;

/* What is true of the whole terrain. */
typedef struct tc_terrain_info {
    int levels;      /* m; the coarsest level has one sample */
    int synthesised; /* of these, the finest: finer than the data (tc_map_synthesise()) */
    double z_base;   /* metres; added to every height read */
    float z_min,
        z_max; /* metres above z_base, finest level, without voids but for a constant height that is shown there; of a
                * packed file those of the heights that were packed, which its own may be beyond by its largest error */
    int64_t void_count; /* of the finest level */
    bool other_body;    /* georeferenced on a body that is not the Earth */
    bool wraps_x;       /* the finest level wraps; tc_field_wraps() says which coarser ones do */
    double semi_major;  /* metres, of the body that it is georeferenced on; 0: not known */
    double rms;         /* metres, that heights are off the data's as packing declared; 0: they are the data's */
} tc_terrain_info;

/* Builds the pyramid of *grid in memory and takes the grid over (it is zeroed, also on failure freed).
 * threads: 0 as many as there are processors. The result does not depend on it. */
tc_status tc_field_build(tc_grid *grid, int threads, tc_field **field_ret, tc_error *error);
void tc_field_destroy(tc_field *field);

const tc_terrain_info *tc_field_info(const tc_field *field);

/* level in 1..levels. */
tc_level tc_field_level(const tc_field *field, int level);

/* Whether column `width` of the level is column 0: where the terrain wraps and the finest width is a multiple of
 * 2^(m - level), so that all halvings on the way were even. */
bool tc_field_wraps(const tc_field *field, int level);

/* Copies the samples of rect, which must lie within the level (on a level that wraps: its rows), to z[(j - rect.y0) *
 * stride + (i - rect.x0)], metres above z_base. voids, where not NULL, gets 1 for void and 0 for valid samples in the
 * same layout. z may be NULL: then only voids are read. Thread-safe. */
tc_status tc_field_read(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride);

/* Whether samples can be had at once. */
typedef enum tc_ready {
    TC_READY,  /* they can: reading them decodes nothing and reads no file */
    TC_COMING, /* not yet */
    TC_FAILED  /* they could not be read; that is tried again by itself, ever more seldom (0.25 s to 30 s) */
} tc_ready;

/* What a question whether samples are ready asks for beside. */
typedef enum tc_urgency {
    TC_ONLY_ASK, /* nothing */
    TC_LATER,    /* that a thread decodes them once it has nothing better to do; for what may be wanted before long */
    TC_SOON,     /* that a thread decodes them, after what is urgent */
    TC_URGENT    /* that it decodes them first; of what is as urgent, coarser levels first */
} tc_urgency;

/* Whether the samples of rect (cut to the level where that does not wrap) are ready. A rectangle of any size gets
 * ready: what is kept of decoded samples grows beyond tc_open_options.cache_bytes while one question needs more.
 * Thread-safe, takes no time to speak of. */
tc_ready tc_field_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency);

/* As tc_field_read() where the samples are ready, TC_READY; else z and voids hold nothing of use. Also TC_FAILED for
 * what tc_field_read() refuses. Thread-safe, never waits for a file or for decoding. */
tc_ready tc_field_read_ready(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                             tc_urgency urgency);

/* Bounds of heights, metres above z_base. Conservative: may be wider than the truth, never narrower. */
typedef struct tc_range {
    float lo, hi;
    float step;  /* how far a sample may be from the next coarser level's mesh there, and */
    float error; /* the finest level's mesh; INFINITY where that is not known */
} tc_range;

/* Finds what tc_range.error needs, once. A packed file that stores errors, read whole and with voids as it was packed
 * with, tells them page by page, without a look at samples. Else: of a field in memory, and of a packed one of up to
 * 2^27 samples, by a look at all of them; of a larger one, wider, from all of its index, unless that has more than
 * 4,096 pages (some 8 billion samples), for which errors stay unknown, as they do where something cannot be read.
 * Before, they are not known. Thread-safe. */
void tc_field_know_errors(const tc_field *field);

/* What bounds the level's heights over rect (cut to the level where that does not wrap; all of the terrain where
 * nothing is left). At most four reads of memory, however large the rectangle: never waits for a file. Of a packed
 * terrain it may be wide until more of the file's index has been read, which this asks for. Thread-safe. */
tc_range tc_field_range(const tc_field *field, int level, tc_rect rect);

/* Whether samples have changed since the last call with the same *since, 0 at first: then *finest_ret is a rectangle of
 * the finest level around all that has. Any number of readers, each with a *since of its own. Thread-safe. */
bool tc_field_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret);

/* Figures of a field since it was opened. */
typedef struct tc_field_stats {
    size_t bytes;       /* of memory held */
    size_t cache_bytes; /* of these for decoded tiles and masks */
    int64_t damaged;    /* tiles found damaged and read from the next coarser level, each once (of up to 65,536) */
    int64_t unreadable; /* tiles, and pages of index or errors, not readable when last tried, up to 256 */
    int64_t decoded;    /* bytes of tiles decoded */
    int64_t waits;      /* readings that had to wait for a file or for decoding on the thread that asked */
    int64_t ranges;     /* questions for a range, and reads of memory for them */
    int64_t range_reads;
    int64_t cancelled; /* wishes given up, since no window wanted them any more, before they were decoded */
} tc_field_stats;
tc_field_stats tc_field_tell(const tc_field *field);

/* Where it lies; lives as long as the field. */
const tc_georef *tc_field_georef(const tc_field *field);

/* Height of the finest level at (x, y) metres, on its mesh of triangles, in metres above z_base; outside the terrain
 * that of the nearest border point, where the terrain does not wrap. */
tc_status tc_field_height(const tc_field *field, double x, double y, double *z_ret);

/* The same without waiting, of the finest level that is ready there (*level_ret, where not NULL); asks for the finest.
 * False where none is. */
bool tc_field_height_ready(const tc_field *field, double x, double y, double *z_ret, int *level_ret);

/* ---- Packed terrains ------------------------------------------------------------------------------------------ */

/* The pyramid in a file (.tclip; docs/format.md): compressed 10 to 100 times, read by regions of any level. */

/* What shows where the source had no height. */
typedef enum tc_void_policy {
    TC_VOIDS_FILL = 0, /* filled from the surroundings */
    TC_VOIDS_HOLE,     /* filled likewise, and left out of the mesh */
    TC_VOIDS_CONSTANT  /* a constant height */
} tc_void_policy;

typedef enum tc_pack_mode {
    TC_PACK_RMS = 0,   /* root mean square of the finest level's error at most `error`, and at least 0.97 of it (less
                        * where max_error leaves no more); max_error holds, too, where it is set */
    TC_PACK_MAX_ERROR, /* no sample of the finest level off by more than `error` */
    TC_PACK_LOSSLESS   /* the source's values themselves */
} tc_pack_mode;

typedef enum tc_pack_codec {
    TC_CODEC_LIFTING = 0, /* critically sampled four-point lifting with trained prediction */
    TC_CODEC_LH04         /* LH04's redundant pyramid of residuals, to compare; TC_PACK_RMS only */
} tc_pack_codec;

/* How samples lie in memory. Wider or narrower stored types are widened without loss when read (half to float, 64-bit
 * integers to double, the latter exact up to 2^53). */
typedef enum tc_sample_type {
    TC_SAMPLE_UINT8,
    TC_SAMPLE_INT8,
    TC_SAMPLE_UINT16,
    TC_SAMPLE_INT16,
    TC_SAMPLE_UINT32,
    TC_SAMPLE_INT32,
    TC_SAMPLE_FLOAT32,
    TC_SAMPLE_FLOAT64
} tc_sample_type;

/* The terrain that a packed file holds, beside its heights. A planet's georeference is in degrees and not rotated;
 * where it goes once around, the terrain wraps in x, and where it also reaches both poles to within a row, the file
 * gets polar caps, which are made when packing (docs/format.md, section 20). */
typedef struct tc_pack_terrain {
    int64_t width, height;       /* samples of the finest level */
    bool wraps_x;                /* column `width` is column 0 */
    double radius;               /* metres, of the planet that this is on, at its equator; 0: a flat terrain */
    double flattening;           /* of the planet, at least 0 and below 1; 0: a sphere */
    double spacing_x, spacing_y; /* metres */
    double z_base;               /* metres; heights given and read are above it */
    tc_georef georef;            /* of the whole; crs_wkt is copied. Its transform runs rows north to south */
    bool area_registered;        /* the source's samples stood for areas; the transform is corner-based either way */
    tc_sample_type sample_type;  /* of the source */
    double unit;                 /* metres per stored unit of the source */
    double offset;               /* metres of the stored value 0, z_base not subtracted */
    bool has_nodata;
    double nodata;        /* stored value */
    tc_void_policy voids; /* how they are to be shown */
    double void_constant; /* metres */
    char *credits; /* whose the heights are, lines of UTF-8 with newlines between them, below 64 KiB; copied; NULL:
                    * not said */
} tc_pack_terrain;

/* Zero is the default everywhere, but for error. */
typedef struct tc_pack_options {
    tc_pack_mode mode;
    tc_pack_codec codec;
    double error;     /* metres, above 0; not for TC_PACK_LOSSLESS */
    double max_error; /* metres: with TC_PACK_RMS also no sample of the finest level is off by more; 0: no bound. Not
                       * for TC_CODEC_LH04 */
    bool max_error_may_yield; /* a max_error beside an rms that floats or the range of heights cannot hold is dropped,
                               * instead of TC_ERR_UNSUPPORTED */
    bool synthesis_fit; /* what tc_map_synthesise() goes by is fitted to the heights given and stored; takes a second or
                         * less. Else it is fitted to what the file gives, each time anew */
    double lattice;     /* metres: heights are multiples of it, for TC_PACK_LOSSLESS; 0: found out from them */
    bool price_lossless; /* with TC_PACK_RMS: tell about what the file would take without loss, where heights are
                          * multiples of a unit and the rms is not far above their unit; takes a moment */
    const char *atlas;   /* of a planet that reaches both poles: "hex" or "cube", onto whose faces its heights are
                          * resampled; NULL or "lonlat": as they are given. Not for TC_PACK_LOSSLESS */
    int threads;         /* 0: as many as there are processors. The file does not depend on it */
    /* Called now and then, from the calling thread, with the share of the whole work that is done, 0 to 1; false stops
     * the packing with TC_ERR_IO. NULL: not called. */
    bool (*progress)(void *context, double done);
    void *progress_context;
} tc_pack_options;

typedef struct tc_pack_result {
    int64_t samples, voids;
    int64_t bytes;               /* of the file */
    double rms, max_error;       /* metres, finest level, without voids, against the heights given */
    int64_t lossless_bytes;      /* about what the file would take without loss, where asked for; 0: not known */
    int64_t disagreeing;         /* samples given twice with different heights; the first ones hold */
    double largest_disagreement; /* metres */
    double trip_rms, trip_max;   /* metres, of what was resampled: the heights given against what the faces have there,
                                  * interpolated, before it was coded; by area */
} tc_pack_result;

typedef struct tc_packer tc_packer;

/* Starts packing into path, beside which a temporary file without a name takes up to 7 bytes a sample. An old file of
 * that name stays untouched until the end. Nothing else is left behind, however the process ends, but for the moment
 * in which the new file gets its name. */
tc_status tc_packer_create(const char *path, const tc_pack_terrain *terrain, const tc_pack_options *options,
                           tc_packer **packer_ret, tc_error *error);

/* Gives the samples of rect: z[(j - rect.y0) * stride + (i - rect.x0)], metres above z_base, row 0 southernmost; void
 * where voids (same layout; may be NULL) is not 0 or z is not finite. In any order; samples never given are void; of
 * samples given more than once the first valid one holds. */
tc_status tc_packer_put(tc_packer *packer, tc_rect rect, const float *z, const uint8_t *voids, ptrdiff_t stride,
                        tc_error *error);

/* Packs and puts the file in its place; TC_ERR_FORMAT where all samples are void, or a planet's heights reach its
 * centre or a radius beyond its sphere. On failure the packer can only be destroyed. Destroying it without this leaves
 * everything as it was. */
tc_status tc_packer_finish(tc_packer *packer, tc_pack_result *result_ret, tc_error *error);
void tc_packer_destroy(tc_packer *packer);

/* One level of a packed terrain. */
typedef struct tc_packed_level {
    int64_t bytes;            /* tiles and index of the level; 0 for levels that are made from the first coded one */
    double rms, max_error;    /* metres, declared: against the filtered source, without voids */
    double bound;             /* metres: heights that were off by more are corrected; 0: none is */
    double residual_variance; /* square metres: what the level adds to the upsampled coarser one; for synthesis */
} tc_packed_level;

typedef struct tc_packed_info {
    int version;
    int64_t bytes; /* of the whole file, as its header says */
    tc_pack_mode mode;
    tc_pack_codec codec;
    double error; /* metres, as asked for when packing */
    tc_pack_terrain terrain;
    int charts;             /* 1, or 3 of a planet with polar caps; 4 or 6 of one on faces */
    bool cut_short;         /* the file has fewer bytes than its header says */
    int levels_missing;     /* finest levels that a file cut short lacks */
    double mean, deviation; /* metres (z_base included), of the finest level */
    bool synthesis_fit;     /* the file has what tc_map_synthesise() goes by; of chart 0, for all */
} tc_packed_info;

/* How to open; zero is the default. */
typedef struct tc_open_options {
    bool has_policy; /* else as the file says */
    tc_void_policy voids;
    double void_constant; /* metres */
    size_t cache_bytes;   /* of decoded tiles and masks, of all charts together; 0: 40 MiB, else at least 1 MiB */
    bool flat;            /* tc_map_open(): a planet as a flat map, its grid of longitude and latitude alone; one on
                           * faces, which has none, stays a planet */
} tc_open_options;

/* Opens a packed terrain; reads its header only. A file that was cut short opens with the levels that are whole. */
tc_status tc_field_open(const char *path, const tc_open_options *options, tc_field **field_ret, tc_error *error);

/* Where a packed terrain's bytes come from, if not from a file: an archive, a server that gives ranges. */
typedef struct tc_byte_source {
    void *context;
    int64_t size; /* of the whole */
    /* Reads exactly `size` bytes from `offset` on, which lie within the whole; TC_ERR_IO where that fails. Called from
     * any thread, from several at once. */
    tc_status (*read)(void *context, int64_t offset, void *bytes, size_t size);
    void (*close)(void *context); /* when nothing will be read any more, also after a failure to open; may be NULL */
} tc_byte_source;

/* The same from any bytes; name is what errors call it. */
tc_status tc_field_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                              tc_field **field_ret, tc_error *error);

/* NULL for a field that is not read from a packed file; lives as long as the field. */
const tc_packed_info *tc_field_packed_info(const tc_field *field);
tc_packed_level tc_field_packed_level(const tc_field *field, int level);

/* ---- Maps: heights on a body ---------------------------------------------------------------------------------- */

/* A flat terrain or a planet, with all its charts: fields of their own, each a part of the body. A flat terrain has
 * one; a planet has one of longitude and latitude and, where that reaches both poles, polar caps laid over it, or it
 * was resampled to the faces of an octahedron or a cube when it was packed. Heights are read at places: (x, y) metres
 * from the south-west sample, or longitude and latitude in radians. Reading is thread-safe. */
typedef struct tc_map tc_map;

/* Builds a map of *grid in memory and takes the grid over (it is zeroed, also on failure freed).
 * radius: 0 for a flat terrain. Else metres of the sphere that heights are above; the grid's georeference must then be
 * known, in degrees and not rotated, and heights under voids be filled. Where it covers 360 degrees, to within half a
 * sample, it goes around, and its width must be halvable until it and the height are at most 250 samples; where it
 * reaches both poles too, to within a row, there are caps. Spacings are lengths on the equator then.
 * threads: 0 as many as there are processors. The result does not depend on it. TC_ERR_USAGE for a grid or a radius
 * that is not as above, TC_ERR_FORMAT for heights that the radius is too small for, TC_ERR_MEMORY. */
tc_status tc_map_build(tc_grid *grid, double radius, int threads, tc_map **map_ret, tc_error *error);

/* The same of a planet that is an ellipsoid of revolution, with geodetic latitudes: heights are above it, along its
 * normal. semi_major: metres, above 0, at the equator; flattening: at least 0, a sphere, and below 1. */
tc_status tc_map_build_ellipsoid(tc_grid *grid, double semi_major, double flattening, int threads, tc_map **map_ret,
                                 tc_error *error);

/* Opens a packed terrain or planet with all its charts; reads their heads only. A file that was cut short opens with
 * the levels that are whole, and without caps where the head of one is missing. The second one from any bytes, which it
 * closes also where it fails. */
tc_status tc_map_open(const char *path, const tc_open_options *options, tc_map **map_ret, tc_error *error);
tc_status tc_map_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                            tc_map **map_ret, tc_error *error);
void tc_map_destroy(tc_map *map);

/* Metres, at the equator; 0: a flat terrain. */
double tc_map_radius(const tc_map *map);
/* 0: a sphere, or a flat terrain. */
double tc_map_flattening(const tc_map *map);

/* How many charts there are, and the field of one, 0 or above and below that; it lives as long as the map. Chart 0 is
 * the source's own grid. */
int tc_map_charts(const tc_map *map);
const tc_field *tc_map_field(const tc_map *map, int chart);

/* Height of the finest levels at a place, metres (z_base included). Of a flat terrain on its mesh of triangles, outside
 * it that of the nearest border point; of a planet bilinear, and 0 where it has none. */
tc_status tc_map_height(const tc_map *map, double x, double y, double *z_ret);

/* Adds levels finer than the data, made of what the terrain's own levels tell of its detail: samples half as far apart
 * each, to all charts. Heights are the same in whatever order they are read, and on every machine that has the same
 * heights of the data (the last bit of caps that are made while a planet is loaded is the C library's). levels: 0 to
 * TC_SYNTHESIS_MOST, cut to what can be drawn; TC_SYNTHESIS_AUTO: until samples are 0.1 m apart. A map of one sample
 * stays as it is. What a packed file has stored (tc_packed_info.synthesis_fit) is gone by, where its finest levels are
 * not missing; else parts of them are read. Not while anyone else uses the map, and once; after a failure the map can
 * only be destroyed. */
enum { TC_SYNTHESIS_AUTO = -1, TC_SYNTHESIS_MOST = 20 };
tc_status tc_map_synthesise(tc_map *map, int levels, tc_error *error);

/* ---- Camera ------------------------------------------------------------------------------------------------- */

typedef struct tc_camera {
    double x, y, z;        /* eye, metres; z absolute (z_base included) */
    double heading, pitch; /* radians; heading clockwise from north, pitch up from the horizon */
    double fov;            /* horizontal field of view, radians */
    int width, height;     /* pixels of the frame */
} tc_camera;

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif

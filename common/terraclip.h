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
    bool known;          /* the file had a geotransform */
    bool geographic;     /* its unit is degrees */
    double transform[6]; /* GDAL's geotransform of the file: corner-based, rows north to south, file units */
    double semi_major;   /* metres; 0 unknown. Tells Earth from other bodies */
    char *crs_wkt;       /* coordinate system; NULL none; owned by the grid */
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
    tc_georef georef;
} tc_grid;

/* Frees what the grid owns and zeroes it. */
void tc_grid_free(tc_grid *grid);

/* ---- Pyramid: prefiltered levels ------------------------------------------------------------------------------ */

typedef struct tc_pyramid tc_pyramid;

/* One level of a pyramid. */
typedef struct tc_level {
    int64_t width, height;       /* samples: ceil of half the next finer level's */
    double spacing_x, spacing_y; /* metres */
} tc_level;

/* What is true of the whole terrain. */
typedef struct tc_terrain_info {
    int levels;         /* m; the coarsest level has one sample */
    double z_base;      /* metres; added to every height read */
    float z_min, z_max; /* metres above z_base, finest level, without voids */
    int64_t void_count; /* of the finest level */
    bool other_body;    /* georeferenced on a body that is not the Earth */
} tc_terrain_info;

/* Builds the pyramid of *grid in memory and takes the grid over (it is zeroed, also on failure freed).
 * threads: 0 as many as there are processors. The result does not depend on it. */
tc_status tc_pyramid_build(tc_grid *grid, int threads, tc_pyramid **pyramid_ret, tc_error *error);
void tc_pyramid_destroy(tc_pyramid *pyramid);

const tc_terrain_info *tc_pyramid_info(const tc_pyramid *pyramid);

/* level in 1..levels. */
tc_level tc_pyramid_level(const tc_pyramid *pyramid, int level);

/* Copies the samples of rect, which must lie within the level, to z[(j - rect.y0) * stride + (i - rect.x0)],
 * metres above z_base. voids, where not NULL, gets 1 for void and 0 for valid samples in the same layout.
 * Thread-safe. */
tc_status tc_pyramid_read(const tc_pyramid *pyramid, int level, tc_rect rect, float *z, uint8_t *voids,
                          ptrdiff_t stride);

/* Lower and upper bound of the level's heights over rect (cut to the level; metres above z_base). Conservative:
 * may be wider than the truth, never narrower. Thread-safe, takes no time to speak of. */
void tc_pyramid_bounds(const tc_pyramid *pyramid, int level, tc_rect rect, float *z_min_ret, float *z_max_ret);

/* Bytes of memory held. */
size_t tc_pyramid_bytes(const tc_pyramid *pyramid);

/* Height of the finest level at (x, y) metres, on its mesh of triangles, in metres above z_base; outside the terrain
 * that of the nearest border point. */
tc_status tc_pyramid_height(const tc_pyramid *pyramid, double x, double y, double *z_ret);

/* ---- Camera ------------------------------------------------------------------------------------------------- */

typedef struct tc_camera {
    double x, y, z;        /* eye, metres; z absolute (z_base included) */
    double heading, pitch; /* radians; heading clockwise from north, pitch up from the horizon */
    double fov;            /* horizontal field of view, radians */
    int width, height;     /* pixels of the frame */
} tc_camera;

#ifdef __cplusplus
}
#endif
#endif

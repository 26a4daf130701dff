/* load.h - a map from any file: a packed one, or a DEM or picture that is read into memory as a whole. */
#ifndef TC_LOAD_H
#define TC_LOAD_H

#include "common/input/source.h"
#include "globe_choice.h"
#include "common/map/map.h"

/* Zero is the default. */
typedef struct tc_load_options {
    const tc_body_class *body; /* what it is to lie on; NULL: as the file says. Only packed planets say a globe */
    tc_globe_choice globe;     /* of what is to lie on one */
    bool whole;                /* it must go around a globe */
    const tc_atlas *atlas;     /* whose charts it is to have; NULL: as it comes */
    bool synthesises;          /* levels finer than the data are to follow */
    int threads;               /* that build the levels; 0: as many as there are processors */
} tc_load_options;

/* Opens; *map_ret is destroyed with tc_map_destroy(). A packed file has its scale, its nodata and, as a planet, its
 * body from when it was packed: options for them are refused with TC_ERR_USAGE. No library is loaded for one. Other
 * errors are those of tc_grid_load().
 *
 * On a globe: files that go around the globe may begin at any longitude, repeat their first column at the end and have
 * rows on the poles or half a row from them; they are resampled along longitude where their width cannot be halved
 * often enough. Others, packed flat terrains in degrees too, become a part of the globe. A raster without georeference
 * that is twice as wide as high is taken for the whole globe. With an atlas of faces it is resampled in memory; packed
 * planets have one atlas, and are refused for another (TC_ERR_UNSUPPORTED). source->spacing must be 0 (errors of
 * planet_place.h). */
tc_status tc_map_load(const char *path, const tc_source_options *source, const tc_load_options *options,
                      tc_map **map_ret, tc_error *error);

/* The same for packed files only. */
tc_status tc_map_load_packed(const char *path, const tc_source_options *source, const tc_load_options *options,
                             tc_map **map_ret, tc_error *error);

/* Opens, reads, fills voids by the policy: the whole file, or all files of a folder, as a grid that the caller frees
 * with tc_grid_free. Refuses grids that would not fit the machine's memory together with their pyramid, and grids
 * without one valid sample. */
tc_status tc_grid_load(const char *path, const tc_source_options *options, tc_grid *grid_ret, tc_error *error);

/* Room for a grid's heights, whose size is set; TC_ERR_MEMORY where they, with their levels, would not fit. */
tc_status tc_grid_room(const char *path, tc_grid *grid, tc_error *error);

/* Sets the number of voids, and the extremes of what is none. */
void tc_grid_measure(tc_grid *grid);

/* The files of a folder as one grid, voids marked and not filled; on failure, too, tc_grid_free frees it. */
tc_status tc_grid_read_folder(const char *path, const tc_source_options *options, tc_grid *grid, tc_error *error);

/* ---- Of load_flat.c and load_globe.c, for load.c ------------------------------------------------------------------
 */

tc_status tc_load_flat(const char *path, const tc_source_options *source, const tc_load_options *options,
                       tc_map **map_ret, tc_error *error);
tc_status tc_load_globe(const char *path, const tc_source_options *source, const tc_load_options *options,
                        tc_map **map_ret, tc_error *error);

/* A map of a grid that was read from `start` on (tc_clock_ms); takes the grid over as tc_map_build() does. */
tc_status tc_load_build(tc_grid *grid, const tc_body *body, const tc_source_options *source,
                        const tc_load_options *options, double start, tc_map **map_ret, tc_error *error);

/* What else a packed file needs to be shown on a globe. */
tc_status tc_load_onto_globe(const char *path, const tc_source_options *source, const tc_load_options *options,
                             tc_map *map, tc_error *error);

#endif

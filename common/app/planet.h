/* planet.h - a planet from any DEM or picture. */
#ifndef TC_PLANET_H
#define TC_PLANET_H

#include "common/map/atlas.h"
#include "common/input/source.h"

typedef struct tc_planet {
    tc_atlas atlas;
    tc_void_policy voids;
    tc_georef georef;      /* of chart 0's finest level: degrees, rows north to south; without crs_wkt */
    int64_t width, height; /* of chart 0's finest level */
    double read_ms, build_ms;
} tc_planet;

/* Opens. Files that go around the globe may begin at any longitude, repeat their first column at the end and have rows
 * on the poles or half a row from them; they are resampled along longitude where their width cannot be halved often
 * enough. Others become a part of the globe. A raster without georeference that is twice as wide as high is taken for
 * the whole globe.
 *
 * radius: metres; 0: of the file's coordinate system, else the Earth's. whole: the file must go around. threads: 0 as
 * many as there are processors. *planet_ret is closed with tc_planet_close(). Errors are those of tc_grid_load() and
 * planet_place.h. options->spacing must be 0. */
tc_status tc_planet_load(const char *path, const tc_source_options *options, double radius, bool whole, int threads,
                         tc_planet *planet_ret, tc_error *error);
/* The same of a packed planet, whose radius was settled and must be 0 here, of a packed flat terrain in degrees, or of
 * such a file. Options as for tc_terrain_open(). */
tc_status tc_planet_open(const char *path, const tc_source_options *options, double radius, int threads,
                         tc_planet *planet_ret, tc_error *error);
void tc_planet_close(tc_planet *planet);

#endif

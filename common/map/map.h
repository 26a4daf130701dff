/* map.h - a map: heights on a body, as charts. A flat terrain is one chart on a plane; a planet is a grid of longitude
 * and latitude on a globe, with polar caps laid over it where it reaches both poles, or resampled from that to the
 * faces of another atlas, which are joined along their seams. */
#ifndef TC_MAP_H
#define TC_MAP_H

#include <stdatomic.h>

#include "common/chart/atlas.h"
#include "common/chart/chart.h"

/* Where the sea is: where the map's edge says so, nowhere, or over all ground that is below a level. */
typedef enum tc_sea_kind { TC_SEA_FOUND, TC_SEA_NONE, TC_SEA_GIVEN } tc_sea_kind;
typedef struct tc_sea {
    tc_sea_kind kind;
    double level; /* of one that is given: metres, a true height */
} tc_sea;

struct tc_map {
    atomic_int users; /* whoever made it, and drawers */
    tc_body body;
    int charts; /* at least 1 */
    tc_chart *chart;
    /* Of the finest level of the source, which may be missing from a file that was cut short. */
    tc_georef georef; /* without crs_wkt */
    bool area_registered;
    int64_t width, height;
    tc_chart grid; /* what the georeference counts samples of: no field */
    /* Of chart 0's finest level: metres; on a globe at the equator, of faces a quarter of that over their cells. */
    double spacing_x, spacing_y;
    tc_void_policy voids;         /* how they are to be shown */
    double read_ms, build_ms;     /* that it took, where it was loaded from a file */
    int synthesised;              /* levels finer than the data */
    double exaggeration;          /* heights of the charts' fields over those of the data */
    tc_sea sea;                   /* where it is given, heights are nowhere below it */
    struct tc_map_noise *noise;   /* of them, one a chart */
    struct tc_synthesis_fit *fit; /* that they go by: of what the map was resampled from; NULL: its own heights' */
};

enum { TC_MAP_CHARTS = 6 }; /* at most */

/* A map without charts, with room for so many: fields that are put into them become its own. NULL: no memory. */
tc_map *tc_map_create(tc_body body, int charts);

/* The map for one more user, who destroys it likewise. */
tc_map *tc_map_share(tc_map *map);

/* A flat map over one field, which it takes over, also where there is no memory: NULL then. */
tc_map *tc_map_flat(tc_field *field);

/* TC_ERR_FORMAT for a grid's heights, with that at which its voids are shown, that leave the body no surface. */
tc_status tc_map_check_grid(const char *name, const tc_grid *grid, const tc_body *body, tc_error *error);

/* The planet on the faces of an atlas that is not its own, in memory: as many cells a side as make its samples along
 * the equator at least as near to each other. `from`, which stays as it is, has charts in longitude and latitude, with
 * caps. Threads: as ever; the result does not depend on them. TC_ERR_UNSUPPORTED for other maps. */
tc_status tc_map_resample(const tc_map *from, const tc_atlas *atlas, int threads, tc_map **map_ret, tc_error *error);

/* TC_ERR_UNSUPPORTED where that cannot be: `name`, named in the error, is no planet in longitude and latitude, or a
 * part of one. */
tc_status tc_map_check_whole(const tc_map *map, const char *name, tc_error *error);

/* Shares of the charts, one each, in the height at a place, by its unit normal. Where all charts but the first are caps
 * only normal[2], the sine of the latitude, is looked at. */
void tc_map_shares(const tc_map *map, const double normal[3], double *share_ret);

/* Whether what is drawn has no surface at a place, since heights are void there and left out. */
tc_status tc_map_hole(const tc_map *map, double x, double y, bool *hole_ret);

/* Makes all heights those of the data, synthesised ones too, times a factor, from now on: also another factor than
 * before, or 1, which leaves nothing of it. Sea level stays 0. Not while anyone else uses the map or a field of it.
 * TC_ERR_FORMAT where heights would leave the body no surface: all is then as it was. */
#define TC_LEAST_EXAGGERATION 0.01
#define TC_MOST_EXAGGERATION 1000.0
#define TC_EXPECTED_EXAGGERATION "a factor of 0.01..1000"
tc_status tc_map_exaggerate(tc_map *map, double factor, tc_error *error);

/* Puts the sea there, from now on: ground below a level that is given is drawn as its surface. Not while anyone else
 * uses the map or a field of it. TC_ERR_USAGE where such a sea would leave the body no surface: all is then as it was.
 */
tc_status tc_map_flood(tc_map *map, tc_sea sea, tc_error *error);

/* Fits synthesis to the heights, for a map that is resampled from this one: what comes of that is smoother, and no one
 * face is like all of a planet. *fit_ret: to be put there as its own, or freed. */
tc_status tc_map_learn(const tc_map *map, struct tc_synthesis_fit **fit_ret, tc_error *error);

/* Height at a place of levels that every kind of field has at hand: nothing is read or decoded. */
enum { TC_ROUGH_SIZE = 250 };
tc_status tc_map_rough_height(const tc_map *map, double x, double y, double *z_ret);

/* Places between which it lies: metres, or longitudes and latitudes. */
void tc_map_extent(const tc_map *map, double lo_ret[2], double hi_ret[2]);

/* Bounds of all heights of all charts on all levels, metres above z_base; no steps are told. */
tc_range tc_map_range(const tc_map *map);

/* Samples of the source, of which there are width x height, east and north of its south-west one, at coordinates of its
 * georeference, which is known. */
void tc_map_georef_samples(const tc_map *map, double x, double y, double *u_ret, double *v_ret);

/* Whether there is ground at a place: beside a flat terrain there is none. */
bool tc_map_has_ground(const tc_map *map, double x, double y);

/* Makes a packed flat terrain whose georeference is in degrees a part of that globe. TC_ERR_UNSUPPORTED
 * where it is not. *gap_ret: it goes around the globe, where its levels then do not meet. */
tc_status tc_map_onto_globe(tc_map *map, const char *name, tc_body body, bool *gap_ret, tc_error *error);

/* Tiles of all charts found damaged so far, those that cannot be read at the moment, and bytes of tiles decoded; 0 for
 * those in memory. */
int64_t tc_map_damaged(const tc_map *map);
int64_t tc_map_unreadable(const tc_map *map);
int64_t tc_map_bytes_decoded(const tc_map *map);

#endif

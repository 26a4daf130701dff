/* surroundings.h - what a map that ends is shown with: walls below the edge of a flat terrain, a sea to the horizon,
 * the body around a part of a globe. Settled once from the heights along its edge; viewers ask for it, zero is none of
 * it. */
#ifndef TC_SURROUNDINGS_H
#define TC_SURROUNDINGS_H

#include "common/map/map.h"

typedef struct tc_surroundings {
    bool walls;          /* of a flat terrain, from its edge down to the foot, or to the sea where there is one */
    bool sea;            /* around it at the height `level` */
    bool plain;          /* of a part of a globe: the body around it has the height `level` and its colours */
    bool stars;          /* where the sky is black */
    bool night_stars;    /* where it is black by night */
    bool climate;        /* land by latitude */
    double foot;         /* metres, absolute: a little below the lowest height */
    double level;        /* likewise; 0 but of land, and of a sea that is given */
    double depth;        /* metres below that whose colours it has: the sea's at the edge; of land less than 0 */
    double south, north; /* latitudes of a flat terrain's edges, radians, where climate goes by them */
} tc_surroundings;

/* Heights along the edge of a map. */
typedef struct tc_edge {
    int count;
    float *height; /* metres, absolute, from low to high */
} tc_edge;

/* Whether a good share of the edge lies at the sea or below it, and a depth of that share, metres. relief: from the
 * lowest to the highest height, which small heights are small beside. */
bool tc_edge_at_sea(const tc_edge *edge, double relief, double *depth_ret);

/* Height of the land around: few parts of the edge lie lower; and how far below it that lies whose colours it has, so
 * that it looks like most of the edge: less than 0. */
double tc_edge_plain(const tc_edge *edge, double *depth_ret);

/* How far below its lowest height a flat terrain's walls go, metres: enough to be seen as a block, little beside what
 * it stands for. side: the longer one. */
double tc_wall_below(double relief, double side);

/* Of a map, all of it. Reads a coarse level's edge. TC_ERR_MEMORY, or what reading says. */
tc_status tc_surroundings_of(const tc_map *map, tc_surroundings *surroundings_ret, tc_error *error);

#endif

/* plates.h - a sphere in plates that move: where chains of mountains, trenches and ocean ridges run. */
#ifndef TC_PLATES_H
#define TC_PLATES_H

#include <stdint.h>

enum { TC_PLATES = 26, TC_PLATE_EDGES = 15 };

typedef struct tc_plates {
    double centre[TC_PLATES][3]; /* unit vectors */
    double size[TC_PLATES];      /* how far beyond its share a plate reaches */
    float land[TC_PLATES];       /* -1..1: carries an ocean or a continent */
    struct tc_plate_pair {
        double length;     /* between the centres */
        float normal[3];   /* of the plane between them */
        float approach[3]; /* . q: how fast the plates come together at q */
    } pair[TC_PLATES][TC_PLATES];
} tc_plates;

/* A boundary near a place. */
typedef struct tc_plate_edge {
    float distance;  /* radians on the unit sphere; positive on the plate that carries less land and yields */
    float weight;    /* 0..1: 1 where it is the boundary, fading to 0 where other plates come between */
    float approach;  /* -1..1, about: negative where the plates part */
    float land[2];   /* of the plate that stays and of the one that yields */
    uint32_t number; /* of the pair */
    const float *normal;
} tc_plate_edge;

/* Of a place. All is continuous over the sphere, and edges are those whose weight is not 0. */
typedef struct tc_plate_site {
    float land; /* -1..1, blended between plates */
    int edges;
    tc_plate_edge edge[TC_PLATE_EDGES];
} tc_plate_site;

void tc_plates_make(tc_plates *plates, uint64_t seed);
void tc_plates_at(const tc_plates *plates, const double q[3], tc_plate_site *site_ret);

#endif

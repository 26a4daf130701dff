/* erosion.h - rivers and slopes that shape a grid of heights. */
#ifndef TC_EROSION_H
#define TC_EROSION_H

#include <stdint.h>

/* A square grid under erosion. The arrays, n * n each, [j * n + i], are the caller's. */
typedef struct tc_erosion {
    int64_t n;     /* samples a side, 2 .. TC_EROSION_MAX */
    double dx;     /* metres between samples */
    uint32_t seed; /* of the flow's chances */
    int threads;   /* 0: as many as there are processors; no result depends on it */

    /* What the land is made of. */
    float talus; /* slope that the hardest ground stands at, metres per metre */
    float firm;  /* steepness, metres, of ground that stands at 0.8 of talus */
    float broad; /* metres: a river that drains broad^2 cuts twice as fast as the law of the small ones says */
    float gully; /* no river tends to a slope above gully times that of the ground beside it */
    float least; /* slope that every river keeps, metres per metre */

    float *z;         /* metres */
    float *steepness; /* metres: uplift over erodibility, U/K. A river that drains A m^2 tends to slope U/K / sqrt(A) */
    float *area;      /* drainage area, cells */
    uint8_t *flow;    /* direction of flow, 0 east, 1 north-east, ..., 7 south-east; or TC_FLOW_OUTLET */
    int32_t *order;   /* all cells, each behind the one it flows to; scratch of tc_erosion_fill */
} tc_erosion;

enum {
    TC_EROSION_MAX = 46340,     /* or cell numbers would not fit an int32_t */
    TC_EROSION_CELL_BYTES = 17, /* of the five arrays */
    TC_FLOW_OUTLET = 8          /* the sea, or a river's end at the border: keeps its height */
};

/* Raises cells until from each one a path descends to an outlet, of which there must be one. */
void tc_erosion_fill(tc_erosion *e);

/* Sets flow, except of outlets, order and area. */
void tc_erosion_route(tc_erosion *e);

/* One step of uplift, incision and landslides along the routed flow. dt is dimensionless, K times the step: a cell that
 * drains A cells goes dt sqrt(A) / (1 + dt sqrt(A)) of the way to its equilibrium. */
void tc_erosion_incise(tc_erosion *e, float dt);

/* Lets the rivers lay down their load along the flow last routed: a river that drains `reach` cells or more fills its
 * valley `depth` metres deep, smaller ones less, the smallest not at all, and a filled floor rises by `slope` metres
 * per metre up its side valleys. Loses steepness and area. */
void tc_erosion_deposit(tc_erosion *e, float depth, float reach, float slope);

#endif

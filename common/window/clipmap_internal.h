/* clipmap_internal.h - what clipmap.c (regions) and clipmap_fill.c (content) share. */
#ifndef TC_CLIPMAP_INTERNAL_H
#define TC_CLIPMAP_INTERNAL_H

#include "clipmap.h"

typedef struct tc_clip_state {
    tc_clip_level view;
    int field_level;
    int64_t width, height; /* samples that the pyramid has at this level; vertices beyond lie on the edge */
    bool wraps;            /* in x */
    double relief;         /* of its normals: tc_normal_relief() */
    float (*heights)[2];   /* toroidal, (z, z_c) */
    int8_t (*normals)[4];  /* toroidal at twice the resolution, (n, n_c); NULL where not kept */
    uint8_t *voids;        /* toroidal; NULL where not kept */
    tc_rect changes[TC_MAX_CHANGES];
    int change_count;
} tc_clip_state;

struct tc_clipmap {
    const tc_field *field;
    int n, levels;
    tc_clip_state level[TC_MAX_LEVELS]; /* [l - 1] */
    float *scratch;                     /* for clipmap_fill.c, tc_fill_scratch() floats */
    bool failed;                        /* the pyramid could not be read */
};

size_t tc_fill_scratch(int n, bool normals);

/* Reads the samples of rect (within the extent) from the pyramid into the level's toroidal arrays, with z_c from the
 * coarser level's (which must hold rect / 2), and with normals and voids where kept. */
void tc_clipmap_fill(tc_clipmap *clipmap, int level, tc_rect rect);

#endif

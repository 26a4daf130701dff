/* body.h - what a map lies on: a plane, or a sphere. What differs between bodies is in their classes; a new one is a
 * file beside plane.c and sphere.c.
 *
 * A place is two numbers and a height, as a pose and a camera have them: metres east and north, or longitude and
 * latitude in radians; metres above the body. Space is metres, with the body's own axes: of a plane east, north, up; of
 * a globe from its centre, x to longitude 0 on the equator, z to the north pole. */
#ifndef TC_BODY_H
#define TC_BODY_H

#include "common/terraclip.h"

typedef struct tc_body_class tc_body_class;

typedef struct tc_body {
    const tc_body_class *class;
    double radius; /* metres, of what heights are above; 0: a plane's */
} tc_body;

struct tc_body_class {
    const char *name; /* "plane", "sphere" */
    /* A place in space, and the direction of its height, of length 1. */
    void (*position)(const tc_body *body, const double place[3], double p_ret[3]);
    void (*normal)(const tc_body *body, const double place[3], double n_ret[3]);
    /* The place of a position; false where none can be told, deep inside. */
    bool (*place)(const tc_body *body, const double p[3], double place_ret[3]);
    /* East, north and up there, each of length 1. */
    void (*axes)(const tc_body *body, const double place[3], double axes_ret[3][3]);
    /* The place so many metres east, north and up, along the axes at `from`. place_ret may be from. */
    void (*beside)(const tc_body *body, const double from[3], const double way[3], double place_ret[3]);
    /* TC_ERR_FORMAT for heights, metres above the body, that leave it no surface. */
    tc_status (*check_relief)(const tc_body *body, const char *name, double z_min, double z_max, tc_error *error);
    bool solid; /* it is ground itself where no chart is */
    /* What is to be told of one, in a few words; NULL: nothing. */
    void (*describe)(const tc_body *body, char *text, size_t size);
};

extern const tc_body_class tc_plane_body, tc_sphere_body;

/* The body that a file's radius means: 0 is a plane. */
tc_body tc_body_of(double radius);

#endif

/* body.h - what a map lies on: a plane, a sphere or an ellipsoid of revolution. What differs between bodies is in their
 * classes; a new one is a file beside plane.c, sphere.c and ellipsoid.c, and one in shaders/.
 *
 * A place is two numbers and a height, as a pose and a camera have them: metres east and north, or longitude and
 * latitude in radians; metres above the body, along its normal. Latitude is geodetic: longitude and latitude are the
 * direction of the normal. Space is metres, with the body's own axes: of a plane east, north, up; of a globe from its
 * centre, x to longitude 0 on the equator, z to the north pole. */
#ifndef TC_BODY_H
#define TC_BODY_H

#include <string.h>

#include "common/terraclip.h"

typedef struct tc_body_class tc_body_class;

typedef struct tc_body {
    const tc_body_class *class;
    double radius;     /* metres, of what heights are above: at the equator; 0: a plane's */
    double flattening; /* 1 - the polar radius over that; 0: a plane's and a sphere's */
} tc_body;

enum { TC_BODY_VECTORS = 3 }; /* that shaders know a body by (frame.glsl) */

struct tc_body_class {
    const char *name; /* "plane", "sphere", "ellipsoid" */
    /* What loads and draws maps of that class does so for these, too; NULL: of this one alone. */
    const tc_body_class *like;
    /* Part of shaders: offset() and what else depends on the body, in float; its functions are told in
     * shaders/body_sphere.glsl. NULL: its shaders need none. */
    const char *glsl;
    /* A place in space, and the direction of its height, of length 1. */
    void (*position)(const tc_body *body, const double place[3], double p_ret[3]);
    void (*normal)(const tc_body *body, const double place[3], double n_ret[3]);
    /* The place of a position; false where none can be told, deep inside. */
    bool (*place)(const tc_body *body, const double p[3], double place_ret[3]);
    /* East, north and up there, each of length 1. */
    void (*axes)(const tc_body *body, const double place[3], double axes_ret[3][3]);
    /* The place so many metres east, north and up, along the axes at `from`. place_ret may be from. */
    void (*beside)(const tc_body *body, const double from[3], const double way[3], double place_ret[3]);
    /* From a place to the one of the same height whose normal is that of `place` + d, along the axes at `place`:
     * metres, without cancellation however small d is. place[1] and place[2] alone count. NULL: no globe's. */
    void (*offset)(const tc_body *body, const double place[3], const double d[3], double offset_ret[3]);
    /* Metres a radian by which the normal turns, at height 0: along the meridian and the parallel at a latitude; and
     * the least and the most of them anywhere, in any direction. NULL: no globe's. */
    void (*curvature)(const tc_body *body, double latitude, double *meridian_ret, double *parallel_ret);
    void (*curvatures)(const tc_body *body, double *least_ret, double *most_ret);
    /* What shaders know it by: of an eye's place, and a height to which offsets refer. NULL: they know nothing. */
    void (*uniforms)(const tc_body *body, const double eye[3], double reference, float body_ret[TC_BODY_VECTORS][4]);
    /* TC_ERR_FORMAT for heights, metres above the body, that leave it no surface. */
    tc_status (*check_relief)(const tc_body *body, const char *name, double z_min, double z_max, tc_error *error);
    bool solid; /* it is ground itself where no chart is */
    /* What is to be told of one, in a few words; NULL: nothing. */
    void (*describe)(const tc_body *body, char *text, size_t size);
};

extern const tc_body_class tc_plane_body, tc_sphere_body, tc_ellipsoid_body;

/* The body that a file's radius means: 0 is a plane. */
tc_body tc_body_of(double radius);

/* That of a radius at the equator and a flattening, which is at least 0 and below 1. */
tc_body tc_body_flattened(double radius, double flattening);

/* Whether what is for bodies of the class `what` is for those of this one, too. By name: each library has its own. */
static inline bool tc_body_is(const tc_body_class *class, const tc_body_class *what)
{
    return strcmp(class->name, what->name) == 0 || (class->like && strcmp(class->like->name, what->name) == 0);
}

#endif

/* scheme.h - ways of drawing a map: what makes a surface over it. They are a list beside their surface; the build makes
 * the list of all lists (SCHEMES in the Makefile). */
#ifndef TC_SCHEME_H
#define TC_SCHEME_H

#include "scene_needs.h"
#include "surface.h"

/* What the scene and the machine ask of a surface; zero is the default. */
typedef struct tc_surface_request {
    int n, levels, steps;
    double error;      /* pixels that blocks are to be chosen by; 0: by distance */
    const tc_map *map; /* that is to be drawn: how rough it is tells n by the error; NULL: none */
    const tc_scene_needs *needs;
    int halvings; /* of what the frame calls for: the driver has no memory for more */
    const tc_camera *camera;
} tc_surface_request;

typedef struct tc_scheme tc_scheme;
struct tc_scheme {
    const char *name;          /* as in figures and on the command line */
    const char *help;          /* what it is, beside the first one; of that NULL */
    const tc_body_class *body; /* of the maps that it draws */
    /* What a surface's size comes to: another one calls for another surface. */
    int (*size)(const tc_surface_request *request);
    /* A surface over the map, which outlives it. */
    tc_status (*create)(const tc_scheme *scheme, const tc_map *map, const tc_surface_request *request,
                        tc_surface **surface_ret, tc_error *error);
    const tc_atlas *atlas; /* of the maps that it draws; NULL: none */
    const void *kind;      /* which of its surface's, as its list knows them */
    bool by_error;         /* its surfaces can choose blocks by their error */
};

/* All that are built in: lists that end with a NULL name, of which the first one is taken unless another is named;
 * ended by NULL. */
extern const tc_scheme *const tc_scheme_lists[];

/* Number k of the schemes in such lists, and that of a name, of those for a body (NULL: for any). NULL: there is none.
 */
const tc_scheme *tc_scheme_at(const tc_scheme *const *lists, const tc_body_class *body, int k);
const tc_scheme *tc_scheme_for(const tc_scheme *const *lists, const tc_map *map); /* the first that draws its charts */
const tc_scheme *tc_scheme_by_error(const tc_scheme *const *lists); /* the first that can choose blocks so */
const tc_scheme *tc_scheme_named(const tc_scheme *const *lists, const tc_body_class *body, const char *name);

#endif

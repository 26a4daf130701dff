/* scheme_planets.h - planets beside each other in all schemes that there are: the same samples in the charts that each
 * scheme wants, scenes of each, and the views and flights that they share. */
#ifndef SCHEME_PLANETS_H
#define SCHEME_PLANETS_H

#include "common/measure/view_error.h"
#include "common/render/scheme.h"
#include "planet_scene.h"

enum { SCHEMES_MOST = 8, SCHEME_ATLASES = 4 };

/* The schemes for globes, in the order of their lists, which begins with one over longitude and latitude. */
int scheme_count(void);
const tc_scheme *scheme_of(int k);

typedef struct scheme_planet {
    char name[64];
    tc_map *source; /* longitude and latitude, as it was */
    struct {
        const tc_atlas *atlas;
        tc_map *map; /* with the levels finer than the data */
    } own[SCHEME_ATLASES];
    int atlases;
    bool detail;
    double spacing; /* metres between the finest samples of longitude and latitude on the equator */
} scheme_planet;

/* Calls measure with the default planet and with what TERRACLIP_DATA holds of the Moon and ETOPO, saying what is left
 * out. quick: with a smaller default planet alone. */
void scheme_planets(bool quick, void (*measure)(void *context, const scheme_planet *p), void *context);

/* The same with the default planet alone. synthesis: levels finer than the data, fitted to each map; the charts' detail
 * then is alike, not the same. */
void scheme_default_planet(bool quick, int synthesis, void (*measure)(void *context, const scheme_planet *p),
                           void *context);

/* The map that a scheme draws. */
tc_map *scheme_map(const scheme_planet *p, const tc_scheme *scheme);

/* Sizes that are held beside each other, from the smallest one, 0, on: rings of 128, 256, ... steps around, windows of
 * 127, 255, ... samples. */
int scheme_size(const tc_scheme *scheme, int rung);

/* An unlit scene before a flat background without a budget. */
scene scheme_scene(const tc_context *context, const scheme_planet *p, const tc_scheme *scheme, int n);
/* The same with a tolerance in pixels, 0: none. */
scene scheme_scene_within(const tc_context *context, const scheme_planet *p, const tc_scheme *scheme, int n,
                          double error);

/* ---- Views ------------------------------------------------------------------------------------------------------- */

typedef enum scheme_view { VIEW_GROUND, VIEW_AIRCRAFT, VIEW_SPACE, VIEW_POLE, SCHEME_VIEWS } scheme_view;
extern const char *const scheme_view_name[SCHEME_VIEWS];

/* A view of that kind, at random: from 2 to 100 m above the ground; from 5 to 50 km; from 300 to 20,000 km; from 5 to
 * 2,000 km within a degree of a pole, each tenth one on it. Log-uniform, from 5 km on shares of the Earth's radius; all
 * places alike, at the ground and from an aircraft towards the horizon, else down to it. 60 degrees. */
tc_camera scheme_camera(test_random *r, const scheme_planet *p, scheme_view kind, int width, int height);

/* Height of the eye above the ground: the highest of what the schemes' maps have there. */
double scheme_above(const scheme_planet *p, const tc_camera *c);

/* Straight on by so many metres of the body's ground, as high above it as ever; the pitch stays. */
tc_camera scheme_onward(const scheme_planet *p, const tc_camera *c, double above, double metres);

#endif

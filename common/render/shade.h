/* shade.h - how the ground is coloured: as it might look, or as maps show it. A shade is one row of a table. */
#ifndef TC_SHADE_H
#define TC_SHADE_H

#include "colour_ramp.h"

typedef struct tc_shade {
    const char *name;       /* "slope" */
    bool natural;           /* sun and air, rock and snow; else what maps show */
    bool lit;               /* unless all is to be without light */
    double degrees;         /* 0: colours are those of heights. Else of an angle of the ground, up to that: */
    const char *define;     /* which one: of shaders/shade.glsl */
    tc_colour_ramp colours; /* stops in degrees */
} tc_shade;

enum { TC_SHADE_NATURAL, TC_SHADE_SLOPE, TC_SHADE_ASPECT, TC_SHADE_HEIGHT, TC_SHADE_NONE, TC_SHADES };
extern const tc_shade tc_shades[TC_SHADES];

/* By name; NULL: there is none. */
const tc_shade *tc_shade_named(const char *name);

/* Of all of them. */
#define TC_SHADE_NAMES "natural, slope, aspect, height or none"

#endif

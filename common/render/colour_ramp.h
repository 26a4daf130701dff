/* colour_ramp.h - colours of heights that a user gives, in place of those of the terrain's kind. */
#ifndef TC_COLOUR_RAMP_H
#define TC_COLOUR_RAMP_H

#include <stdbool.h>
#include <stdint.h>

/* A colour and the height that has it; between two they are mixed as they are seen, beyond the last ones they stay. */
typedef struct tc_colour_stop {
    double at; /* metres; a share, 0 .. 1, of the way from the lowest to the highest height where `share` */
    bool share;
    uint8_t rgba[4]; /* as seen; where a is less than 255, that much shows of the colours that there would be without */
} tc_colour_stop;

typedef struct tc_colour_ramp {
    int count; /* at least 1 */
    tc_colour_stop *stop;
} tc_colour_ramp;

/* The colour at a height of a terrain that lies from low to high, 0 .. 1 each. Of several stops at one height the last
 * one in order holds above it, the first below. */
void tc_colour_ramp_at(const tc_colour_ramp *ramp, double height, double low, double high, double rgba_ret[4]);

#endif

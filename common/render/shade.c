/* shade.c - the shades of the ground. */
#include "shade.h"

#include <stddef.h>
#include <string.h>

/* Steepness, as maps for mountaineers have it: white and greens where one walks, yellow from 30 degrees on, orange from
 * 35, red from 40, where avalanches start, violet beyond 45, and towards black for cliffs. */
static tc_colour_stop steepness[] = {{0, false, {250, 250, 246, 255}},  {10, false, {214, 231, 198, 255}},
                                     {20, false, {158, 203, 130, 255}}, {27, false, {222, 226, 110, 255}},
                                     {30, false, {252, 217, 66, 255}},  {35, false, {243, 146, 43, 255}},
                                     {40, false, {219, 50, 42, 255}},   {45, false, {158, 32, 118, 255}},
                                     {60, false, {74, 32, 128, 255}},   {90, false, {16, 12, 32, 255}}};

/* Direction of the fall: a wheel of colours, clockwise from north. */
static tc_colour_stop wheel[] = {
    {0, false, {222, 50, 44, 255}},   {45, false, {240, 142, 40, 255}},  {90, false, {242, 220, 60, 255}},
    {135, false, {92, 182, 66, 255}}, {180, false, {60, 186, 170, 255}}, {225, false, {66, 148, 222, 255}},
    {270, false, {62, 76, 190, 255}}, {315, false, {168, 62, 176, 255}}, {360, false, {222, 50, 44, 255}}};

#define STOPS(list)                                                                                                    \
    {                                                                                                                  \
        sizeof list / sizeof *list, list                                                                               \
    }
const tc_shade tc_shades[TC_SHADES] = {
    [TC_SHADE_NATURAL] = {.name = "natural", .natural = true, .lit = true},
    [TC_SHADE_SLOPE] = {.name = "slope", .define = "SHADE_SLOPE", .degrees = 90, .colours = STOPS(steepness)},
    [TC_SHADE_ASPECT] = {.name = "aspect", .define = "SHADE_ASPECT", .degrees = 360, .colours = STOPS(wheel)},
    [TC_SHADE_HEIGHT] = {.name = "height", .lit = true},
    [TC_SHADE_NONE] = {.name = "none"},
};

const tc_shade *tc_shade_named(const char *name)
{
    for (int i = 0; i < TC_SHADES; i++)
        if (strcmp(name, tc_shades[i].name) == 0)
            return &tc_shades[i];
    return NULL;
}

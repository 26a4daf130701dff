/* scene_needs.c - from options and terrain to needs, from needs to defines and to what is told of them. */
#include "scene_needs.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "palette.h"

tc_scene_needs tc_scene_needs_of(const tc_scene_options *options, const tc_terrain_info *info)
{
    const tc_palette palette = tc_palette_make(info);
    return (tc_scene_needs){.light = !options->unlit,
                            .sky = !options->background_set,
                            .haze = !options->background_set && palette.natural, /* no air in space */
                            .land = palette.natural,
                            .water = palette.water && !options->colours,
                            .given = options->colours != NULL,
                            .imagery = options->imagery != NULL,
                            .holes = options->holes && info->void_count > 0,
                            .level_colours = options->level_colours,
                            .detail = info->synthesised > 0,
                            .morph = !options->frame.no_morph,
                            .multisampled = options->samples > 1};
}

/* define: that brings a need into the shaders; NULL where it is none of theirs. why: it is left out. */
static const struct need {
    size_t offset;
    const char *define, *why;
} table[] = {
    {offsetof(tc_scene_needs, light), "LIT", "normal map and lighting: unlit"},
    {offsetof(tc_scene_needs, haze), "HAZE", "haze: a body without air"},
    {offsetof(tc_scene_needs, holes), "HOLES", "void mask: no holes to show"},
    {offsetof(tc_scene_needs, morph), NULL, "morph: switched off"},
    {offsetof(tc_scene_needs, detail), NULL, "synthesis: no levels finer than the data"},
    {offsetof(tc_scene_needs, land), "NATURAL_LAND", "rock and snow: another body's dust"},
    {offsetof(tc_scene_needs, water), "WATER", "water: nothing lies below the sea"},
    {offsetof(tc_scene_needs, given), "GIVEN_COLOURS", NULL},
    {offsetof(tc_scene_needs, imagery), "IMAGERY", "imagery: none given"},
    {offsetof(tc_scene_needs, level_colours), "LEVEL_COLOURS", "level colours: not asked for"},
    {offsetof(tc_scene_needs, multisampled), "MULTISAMPLED", "smooth edges: one sample a pixel"},
    {offsetof(tc_scene_needs, linear), "LINEAR_LIGHT", NULL},
};
enum { NEEDS = sizeof table / sizeof *table };

static bool needed(const tc_scene_needs *needs, const struct need *n)
{
    return *(const bool *)((const char *)needs + n->offset);
}

void tc_scene_needs_defines(const tc_scene_needs *needs, char text[TC_SCENE_DEFINES])
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < NEEDS; i++)
        if (table[i].define && needed(needs, &table[i]))
            used += (size_t)snprintf(text + used, TC_SCENE_DEFINES - used, "#define %s\n", table[i].define);
}

int tc_scene_needs_left_out(const tc_scene_needs *needs, const char *lines[TC_SCENE_LEFT_OUT])
{
    int n = 0;
    for (int i = 0; i < NEEDS; i++) {
        bool both = table[i].offset == offsetof(tc_scene_needs, haze) && !needs->sky;
        bool dry = table[i].offset == offsetof(tc_scene_needs, water) && needs->given;
        if (table[i].why && !needed(needs, &table[i]))
            lines[n++] = both  ? "sky and haze: flat background"
                         : dry ? "water, rock and snow: colours are given"
                               : table[i].why;
    }
    return n;
}

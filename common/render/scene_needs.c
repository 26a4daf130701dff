/* scene_needs.c - from options and terrain to needs, from needs to defines and to what is told of them. */
#include "scene_needs.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "palette.h"

/* Whether stars are seen above a plane, where the sun is as high everywhere. */
static bool dark(const tc_sun *sun)
{
    double d[3];
    const tc_body plane = tc_body_of(0);
    tc_sun_direction(sun, &plane, (const double[3]){0}, d);
    return tc_stars_at_dusk(tc_sun_day(d[2])) > 0;
}

tc_scene_needs tc_scene_needs_of(const tc_scene_options *options, const tc_terrain_info *info)
{
    const tc_terrain_info told = tc_palette_heights(info, tc_scene_exaggeration(options));
    const tc_palette palette = tc_palette_make(&told);
    const tc_shade *shade = options->shade ? options->shade : &tc_shades[TC_SHADE_NATURAL];
    const bool angles = shade->degrees > 0, lit = shade->lit && !options->unlit, light = lit && shade->natural;
    const bool flood = options->sea.kind == TC_SEA_GIVEN;
    const bool water =
        palette.water && !options->colours && !angles && options->sea.kind == TC_SEA_FOUND; /* by colours alone */
    return (tc_scene_needs){
        .shade = shade,
        .normals = angles || lit,
        .fine_normals = angles || (lit && !shade->natural),
        .light = light,
        .hillshade = lit && !shade->natural,
        .sky = !options->background_set,
        .air = palette.air,
        .haze = !options->background_set && palette.air && shade->natural, /* none in space */
        .land = palette.natural && shade->natural,
        .water = water,
        .flood = flood,
        .dry = options->sea.kind == TC_SEA_NONE,
        .sea_level = options->sea.level * tc_scene_exaggeration(options),
        .given = options->colours || angles,
        .imagery = options->imagery && !angles,
        .contours = options->contours > 0,
        .exaggerated = tc_scene_exaggeration(options) != 1,
        .holes = options->holes && info->void_count > 0,
        .walls = options->around.walls,
        .sea = options->around.walls && options->around.sea && !options->background_set && (water || flood),
        .plain = options->around.plain,
        .stars = (options->around.stars || (options->around.night_stars && light && dark(&options->sun))) &&
                 !options->background_set && shade->natural,
        .climate = options->around.climate && palette.natural && shade->natural && !options->colours,
        .around = options->around,
        .throttle = options->throttle,
        .level_colours = options->level_colours,
        .detail = info->synthesised > 0,
        .morph = !options->frame.no_morph,
        .multisampled = options->samples > 1};
}

/* define: that brings a need into the shaders; NULL where it is none of theirs. why: it is left out, unless a reason
 * below says more; NULL: it is not told of. */
static const struct need {
    size_t offset;
    const char *define, *why;
} table[] = {
    {offsetof(tc_scene_needs, normals), "NORMALS", "normal map: unlit"},
    {offsetof(tc_scene_needs, fine_normals), "FINE_NORMALS", NULL},
    {offsetof(tc_scene_needs, light), "LIT", "lighting: unlit"},
    {offsetof(tc_scene_needs, hillshade), "HILLSHADE", NULL},
    {offsetof(tc_scene_needs, air), "UNDER_AIR", NULL},
    {offsetof(tc_scene_needs, haze), "HAZE", "haze: a body without air"},
    {offsetof(tc_scene_needs, holes), "HOLES", "void mask: no holes to show"},
    {offsetof(tc_scene_needs, morph), NULL, "morph: switched off"},
    {offsetof(tc_scene_needs, detail), NULL, "synthesis: no levels finer than the data"},
    {offsetof(tc_scene_needs, land), "NATURAL_LAND", "rock and snow: another body's dust"},
    {offsetof(tc_scene_needs, water), "WATER", "water: nothing lies below the sea"},
    {offsetof(tc_scene_needs, flood), "FLOOD", NULL},
    {offsetof(tc_scene_needs, given), "GIVEN_COLOURS", NULL},
    {offsetof(tc_scene_needs, imagery), "IMAGERY", "imagery: none given"},
    {offsetof(tc_scene_needs, contours), "CONTOURS", "contours: not asked for"},
    {offsetof(tc_scene_needs, exaggerated), "EXAGGERATED", "exaggeration: heights as they are"},
    {offsetof(tc_scene_needs, walls), NULL, "walls: not asked for, or no flat terrain"},
    {offsetof(tc_scene_needs, sea), "SEA", "sea around: not asked for, or not at the edge"},
    {offsetof(tc_scene_needs, plain), "PLAIN", "land around: not asked for, or no part of a globe"},
    {offsetof(tc_scene_needs, stars), NULL, "stars: not asked for, or no sky that shows them"},
    {offsetof(tc_scene_needs, climate), "ZONES", "climate: not asked for, or latitudes not known"},
    {offsetof(tc_scene_needs, throttle), NULL, "throttling: frames may take as long as they do"},
    {offsetof(tc_scene_needs, throttled), "THROTTLED", NULL},
    {offsetof(tc_scene_needs, level_colours), "LEVEL_COLOURS", "level colours: not asked for"},
    {offsetof(tc_scene_needs, multisampled), "MULTISAMPLED", "smooth edges: one sample a pixel"},
    {offsetof(tc_scene_needs, linear), "LINEAR_LIGHT", NULL},
};
enum { NEEDS = sizeof table / sizeof *table };

static bool flat(const tc_scene_needs *needs)
{
    return !needs->sky;
}

static bool mapped(const tc_scene_needs *needs)
{
    return !needs->shade->natural;
}

static bool angles(const tc_scene_needs *needs)
{
    return needs->shade->degrees > 0;
}

static bool flooded(const tc_scene_needs *needs)
{
    return needs->flood;
}

static bool dry(const tc_scene_needs *needs)
{
    return needs->dry;
}

static bool given(const tc_scene_needs *needs)
{
    return needs->given;
}

/* Why a need is left out in particular: the first that holds. */
static const struct reason {
    size_t offset;
    bool (*holds)(const tc_scene_needs *needs);
    const char *why;
} reasons[] = {
    {offsetof(tc_scene_needs, normals), mapped, "normal map: a map of heights alone"},
    {offsetof(tc_scene_needs, light), mapped, "lighting: a map's shade"},
    {offsetof(tc_scene_needs, haze), flat, "sky and haze: flat background"},
    {offsetof(tc_scene_needs, haze), mapped, "haze: a map's shade"},
    {offsetof(tc_scene_needs, land), mapped, "rock and snow: a map's shade"},
    {offsetof(tc_scene_needs, water), flooded, "water of what lies below 0: a sea is given"},
    {offsetof(tc_scene_needs, water), dry, "water: no sea is asked for"},
    {offsetof(tc_scene_needs, sea), dry, "sea around: no sea is asked for"},
    {offsetof(tc_scene_needs, water), angles, "water, colours of heights: angles are shown"},
    {offsetof(tc_scene_needs, imagery), angles, "imagery: angles are shown"},
    {offsetof(tc_scene_needs, water), given, "water, rock and snow: colours are given"},
};

static const char *why(const tc_scene_needs *needs, const struct need *n)
{
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].offset == n->offset && reasons[i].holds(needs))
            return reasons[i].why;
    return n->why;
}

static bool needed(const tc_scene_needs *needs, const struct need *n)
{
    return *(const bool *)((const char *)needs + n->offset);
}

static size_t define(char text[TC_SCENE_DEFINES], size_t used, const char *name)
{
    return used + (size_t)snprintf(text + used, TC_SCENE_DEFINES - used, "#define %s\n", name);
}

void tc_scene_needs_defines(const tc_scene_needs *needs, char text[TC_SCENE_DEFINES])
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < NEEDS; i++)
        if (table[i].define && needed(needs, &table[i]))
            used = define(text, used, table[i].define);
    if (needs->shade->define)
        define(text, used, needs->shade->define);
}

int tc_scene_needs_left_out(const tc_scene_needs *needs, const char *lines[TC_SCENE_LEFT_OUT])
{
    int n = 0;
    for (int i = 0; i < NEEDS; i++)
        if (table[i].why && !needed(needs, &table[i]))
            lines[n++] = why(needs, &table[i]);
    return n;
}

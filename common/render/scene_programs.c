/* scene_programs.c - programs by name of their parts and defines. */
#include "scene_programs.h"

#include <stdio.h>
#include <string.h>

#include "common/gl/program.h"
#include "drape.h"

enum { MAX_PARTS = 16, SCENE = TC_SCENE_DEFINES + 384, DEFINES = TC_FRAME_DEFINES + SCENE };

/* What stages begin with, before the surface's parts, and what they end with. */
static const struct stage {
    const char *first[6], *last;
} terrain_vertex = {{"frame.glsl"}, "renderer.vert"},
  terrain_fragment = {{"frame.glsl", "encode.glsl", "ground.glsl"}, "renderer.frag"},
  draped_fragment = {{"frame.glsl", "encode.glsl", "ground.glsl", "stack.glsl", "imagery.glsl"}, "renderer.frag"},
  sky_fragment = {{"frame.glsl", "encode.glsl"}, NULL},
  starry_fragment = {{"frame.glsl", "encode.glsl", "stars.glsl"}, NULL};
static const char *const sky_vertex[] = {"frame.glsl", "sky.vert", NULL};
static const char *const sea_vertex_parts[] = {"sea.glsl", NULL}, *const sea_parts[] = {"sea.frag", NULL};

/* more: between those; NULL: nothing. */
static void list_parts(const char *parts[MAX_PARTS], const struct stage *stage, const char *const *surface,
                       const char *more)
{
    int count = 0;
    for (const char *const *first = stage->first; *first; first++)
        parts[count++] = *first;
    for (; *surface && count < MAX_PARTS - 3; surface++) {
        bool there = false; /* a part that the stage needs as well */
        for (int i = 0; i < count && !there; i++)
            there = strcmp(parts[i], *surface) == 0;
        if (!there)
            parts[count++] = *surface;
    }
    if (more)
        parts[count++] = more;
    parts[count++] = stage->last;
    parts[count] = NULL;
}

/* What maps show. */
static const char *map_part(const tc_scene_needs *needs)
{
    return needs->hillshade || needs->contours || needs->shade->define ? "shade.glsl" : NULL;
}

/* How what is drawn is told of, and the line that its program is compiled with beside the scene's. */
static const struct kind {
    const char *name, *define;
} kinds[TC_PROGRAM_KINDS] = {[TC_DRAWS_BLOCKS] = {"terrain", ""},
                             [TC_DRAWS_CLOSERS] = {"crack closers", "#define CLOSERS\n"},
                             [TC_DRAWS_WALLS] = {"walls", "#define WALLS\n"},
                             [TC_DRAWS_SEA] = {"sea around", ""}};

/* Pictures lie over the terrain alone, and what is level has no lines, no voids and no levels. */
static tc_scene_needs needs_of(const tc_scene_needs *scene, tc_program_kind kind)
{
    tc_scene_needs needs = *scene;
    needs.imagery &= kind == TC_DRAWS_BLOCKS || kind == TC_DRAWS_CLOSERS;
    if (kind == TC_DRAWS_SEA)
        needs.contours = needs.holes = needs.level_colours = false;
    return needs;
}

static void list_stages(const tc_surface *surface, const tc_scene_needs *needs, tc_program_kind kind,
                        const char *vertex[MAX_PARTS], const char *fragment[MAX_PARTS])
{
    const bool sea = kind == TC_DRAWS_SEA;
    list_parts(vertex, &terrain_vertex, sea ? sea_vertex_parts : surface->vertex_parts, NULL);
    list_parts(fragment, needs->imagery ? &draped_fragment : &terrain_fragment,
               sea                      ? sea_parts
               : kind == TC_DRAWS_WALLS ? surface->wall_parts
                                        : surface->fragment_parts,
               map_part(needs));
}

void tc_scene_frame_defines(char text[TC_FRAME_DEFINES])
{
    snprintf(text, TC_FRAME_DEFINES,
             "#define LAYERS %d\n#define LAYER_VECTORS %d\n#define SURFACE_VECTORS %d\n#define SURFACE_INTEGERS %d\n"
             "#define CHARTS %d\n#define BODY_VECTORS %d\n#define MAP_END %d.0\n",
             TC_MAX_LAYERS, TC_LAYER_VECTORS, TC_SURFACE_VECTORS, TC_SURFACE_INTEGERS, TC_MAX_CHARTS, TC_BODY_VECTORS,
             TC_DRAPE_END);
}

/* Those before the lines of a scene. */
static void add_sizes(const char *scene, char defines[DEFINES])
{
    tc_scene_frame_defines(defines);
    const size_t used = strlen(defines);
    snprintf(defines + used, DEFINES - used, "%s", scene);
}

/* Defines of a program. Across a triangle without area nothing can be interpolated, so crack closers take all from one
 * corner. Where a pixel of the terrain has several samples each is shaded by itself: at the middle of one
 * that is covered in part, outside of the triangle, there is no ground (nor at a centroid, where drivers have none). */
static void list_defines(const tc_surface *surface, const tc_scene_needs *needs, tc_program_kind kind,
                         char defines[SCENE])
{
    char scene[TC_SCENE_DEFINES];
    tc_scene_needs_defines(needs, scene);
    snprintf(defines, SCENE,
             "#define WINDOW_MASK %d\n#define INTERPOLATED %s\n#define NEARNESS gl_FragCoord.%s\n"
             "#define NEARNESS_AT(p) (p.%s / p.w)\n%s%s",
             surface->n,
             kind == TC_DRAWS_CLOSERS                         ? "flat"
             : needs->multisampled && kind == TC_DRAWS_BLOCKS ? "sample"
                                                              : "centroid",
             needs->by_w ? "w" : "z", needs->by_w ? "w / p.w" : "z", kinds[kind].define, scene);
    if (needs->imagery) { /* smooth edges bring several samples a pixel, and finer texels with them */
        const bool filter = needs->image_filter > 1;
        const size_t used = strlen(defines);
        snprintf(defines + used, SCENE - used,
                 "#define IMAGE_MASK %d\n#define IMAGE_ANISOTROPY %d.0\n#define IMAGE_BIAS %s\n", needs->image_n,
                 filter ? needs->image_filter : needs->image_taps, needs->multisampled ? "-0.5" : "0.0");
        if (!filter)
            snprintf(defines + strlen(defines), SCENE - strlen(defines), "#define IMAGE_TAPS %d\n", needs->image_taps);
    }
    for (const char *const *own = surface->defines; own && *own; own++) {
        size_t used = strlen(defines);
        snprintf(defines + used, SCENE - used, "#define %s\n", *own);
    }
}

static const struct stage *sky_stage(const tc_scene_needs *needs)
{
    return needs->stars ? &starry_fragment : &sky_fragment;
}

enum { SKY_DEFINES = 96 };
static void sky_defines(const tc_scene_needs *needs, char text[SKY_DEFINES])
{
    snprintf(text, SKY_DEFINES, "#define AIR %s\n%s%s", needs->air ? "1.0" : "0.0",
             needs->stars ? "#define STARS\n" : "", needs->linear ? "#define LINEAR_LIGHT\n" : "");
}

bool tc_scene_closers(const tc_surface *surface, const tc_windows *windows)
{
    return surface->closers && tc_clipmap_levels(windows->clipmap[0]) > 1;
}

static tc_status build_terrain(const tc_gl *gl, const tc_surface *surface, const tc_scene_needs *needs,
                               tc_program_kind kind, GLuint *program_ret, tc_error *error)
{
    char scene[SCENE], defines[DEFINES];
    const char *vertex[MAX_PARTS], *fragment[MAX_PARTS];
    const tc_scene_needs own = needs_of(needs, kind);
    list_defines(surface, &own, kind, scene);
    add_sizes(scene, defines);
    list_stages(surface, &own, kind, vertex, fragment);
    return tc_program_build(gl, vertex, fragment, surface->texts, defines, program_ret, error);
}

tc_status tc_scene_programs_build(const tc_gl *gl, const tc_surface *surface, bool with_closers,
                                  const tc_scene_needs *needs, tc_scene_programs *programs, tc_error *error)
{
    GLuint *terrain = programs->terrain[tc_program_variant(needs)];
    tc_status status = TC_OK;
    const bool needed[TC_PROGRAM_KINDS] = {true, with_closers, needs->walls && surface->wall_parts, needs->sea};
    for (int kind = 0; kind < TC_PROGRAM_KINDS && !status; kind++)
        if (needed[kind] && !terrain[kind])
            status = build_terrain(gl, surface, needs, (tc_program_kind)kind, &terrain[kind], error);
    GLuint *sky = &programs->sky[needs->linear];
    if (!status && !*sky && needs->sky) {
        char defines[DEFINES], own[SKY_DEFINES];
        const char *fragment[MAX_PARTS];
        list_parts(fragment, sky_stage(needs), surface->sky_parts, NULL);
        sky_defines(needs, own);
        add_sizes(own, defines);
        status = tc_program_build(gl, sky_vertex, fragment, surface->texts, defines, sky, error);
    }
    return status;
}

void tc_scene_programs_destroy(const tc_gl *gl, tc_scene_programs *programs)
{
    for (int i = 0; i < TC_PROGRAM_KINDS * TC_PROGRAM_VARIANTS; i++) /* 0 is silently ignored */
        gl->DeleteProgram(programs->terrain[i / TC_PROGRAM_KINDS][i % TC_PROGRAM_KINDS]);
    for (int i = 0; i < 2; i++)
        gl->DeleteProgram(programs->sky[i]);
}

/* ---- Telling ---------------------------------------------------------------------------------------------------- */

static void print_parts(const char *const *parts, FILE *file)
{
    for (int i = 0; parts[i]; i++)
        fprintf(file, "%s%s", i ? " + " : "", parts[i]);
}

/* The lines "#define NAME VALUE" as "NAME VALUE, ...". */
static void print_defines(const char *defines, FILE *file)
{
    const char *before = "; ";
    for (const char *line = defines; *line; line += strcspn(line, "\n") + 1) {
        const char *text = line + strlen("#define ");
        fprintf(file, "%s%.*s", before, (int)strcspn(text, "\n"), text);
        before = ", ";
    }
    fputc('\n', file);
}

void tc_scene_programs_explain(const tc_surface *surface, const tc_scene_needs *needs,
                               const tc_scene_programs *programs, FILE *file)
{
    const char *vertex[MAX_PARTS], *fragment[MAX_PARTS];
    for (int kind = 0; kind < TC_PROGRAM_KINDS; kind++) {
        char defines[SCENE];
        if (!programs->terrain[tc_program_variant(needs)][kind])
            continue;
        const tc_scene_needs own = needs_of(needs, (tc_program_kind)kind);
        list_stages(surface, &own, (tc_program_kind)kind, vertex, fragment);
        fprintf(file, "uses: shaders: %s: ", kinds[kind].name);
        print_parts(vertex, file);
        fputs(", ", file);
        print_parts(fragment, file);
        list_defines(surface, &own, (tc_program_kind)kind, defines);
        print_defines(defines, file);
    }
    if (programs->sky[needs->linear]) {
        char own[SKY_DEFINES];
        sky_defines(needs, own);
        fputs("uses: shaders: sky: ", file);
        print_parts(sky_vertex, file);
        list_parts(fragment, sky_stage(needs), surface->sky_parts, NULL);
        fputs(", ", file);
        print_parts(fragment, file);
        print_defines(own, file);
    }
}

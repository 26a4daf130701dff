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
  sky_fragment = {{"frame.glsl", "encode.glsl"}, NULL};
static const char *const sky_vertex[] = {"frame.glsl", "sky.vert", NULL};

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

static const struct stage *fragment_stage(const tc_scene_needs *needs)
{
    return needs->imagery ? &draped_fragment : &terrain_fragment;
}

/* What maps show. */
static const char *map_part(const tc_scene_needs *needs)
{
    return needs->hillshade || needs->contours || needs->shade->define ? "shade.glsl" : NULL;
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

/* Defines of the strips' program, or of the crack closers': across a triangle without area nothing can be interpolated,
 * so theirs takes all from one corner. Where a pixel has several samples each is shaded by itself: at the middle of one
 * that is covered in part, outside of the triangle, there is no ground (nor at a centroid, where drivers have none). */
static void list_defines(const tc_surface *surface, const tc_scene_needs *needs, bool closers, char defines[SCENE])
{
    char scene[TC_SCENE_DEFINES];
    tc_scene_needs_defines(needs, scene);
    snprintf(defines, SCENE,
             "#define WINDOW_MASK %d\n#define INTERPOLATED %s\n#define NEARNESS gl_FragCoord.%s\n"
             "#define NEARNESS_AT(p) (p.%s / p.w)\n%s%s",
             surface->n,
             closers               ? "flat"
             : needs->multisampled ? "sample"
                                   : "centroid",
             needs->by_w ? "w" : "z", needs->by_w ? "w / p.w" : "z", closers ? "#define CLOSERS\n" : "", scene);
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

static const char *sky_defines(const tc_scene_needs *needs)
{
    static const char *const defines[2][2] = {
        {"#define AIR 0.0\n", "#define AIR 1.0\n"},
        {"#define AIR 0.0\n#define LINEAR_LIGHT\n", "#define AIR 1.0\n#define LINEAR_LIGHT\n"}};
    return defines[needs->linear][needs->air];
}

bool tc_scene_closers(const tc_surface *surface, const tc_windows *windows)
{
    return surface->closers && tc_clipmap_levels(windows->clipmap[0]) > 1;
}

static tc_status build_terrain(const tc_gl *gl, const tc_surface *surface, const tc_scene_needs *needs, bool closers,
                               GLuint *program_ret, tc_error *error)
{
    char scene[SCENE], defines[DEFINES];
    const char *vertex[MAX_PARTS], *fragment[MAX_PARTS];
    list_defines(surface, needs, closers, scene);
    add_sizes(scene, defines);
    list_parts(vertex, &terrain_vertex, surface->vertex_parts, NULL);
    list_parts(fragment, fragment_stage(needs), surface->fragment_parts, map_part(needs));
    return tc_program_build(gl, vertex, fragment, surface->texts, defines, program_ret, error);
}

tc_status tc_scene_programs_build(const tc_gl *gl, const tc_surface *surface, bool with_closers,
                                  const tc_scene_needs *needs, tc_scene_programs *programs, tc_error *error)
{
    GLuint *terrain = programs->terrain[tc_program_variant(needs)];
    tc_status status = TC_OK;
    for (int closers = 0; closers <= (with_closers ? 1 : 0) && !status; closers++)
        if (!terrain[closers])
            status = build_terrain(gl, surface, needs, closers, &terrain[closers], error);
    GLuint *sky = &programs->sky[needs->linear];
    if (!status && !*sky && needs->sky) {
        char defines[DEFINES];
        const char *fragment[MAX_PARTS];
        list_parts(fragment, &sky_fragment, surface->sky_parts, NULL);
        add_sizes(sky_defines(needs), defines);
        status = tc_program_build(gl, sky_vertex, fragment, surface->texts, defines, sky, error);
    }
    return status;
}

void tc_scene_programs_destroy(const tc_gl *gl, tc_scene_programs *programs)
{
    for (int i = 0; i < 2 * TC_PROGRAM_VARIANTS; i++) /* 0 is silently ignored */
        gl->DeleteProgram(programs->terrain[i / 2][i % 2]);
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
    list_parts(vertex, &terrain_vertex, surface->vertex_parts, NULL);
    list_parts(fragment, fragment_stage(needs), surface->fragment_parts, map_part(needs));
    for (int closers = 0; closers < 2; closers++) {
        char defines[SCENE];
        if (!programs->terrain[tc_program_variant(needs)][closers])
            continue;
        fprintf(file, "uses: shaders: %s: ", closers ? "crack closers" : "terrain");
        print_parts(vertex, file);
        fputs(", ", file);
        print_parts(fragment, file);
        list_defines(surface, needs, closers, defines);
        print_defines(defines, file);
    }
    if (programs->sky[needs->linear]) {
        fputs("uses: shaders: sky: ", file);
        print_parts(sky_vertex, file);
        list_parts(fragment, &sky_fragment, surface->sky_parts, NULL);
        fputs(", ", file);
        print_parts(fragment, file);
        print_defines(sky_defines(needs), file);
    }
}

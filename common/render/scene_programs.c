/* scene_programs.c - programs by name of their parts and defines. */
#include "scene_programs.h"

#include <stdio.h>
#include <string.h>

#include "common/gl/program.h"

enum { MAX_PARTS = 16, DEFINES = TC_SCENE_DEFINES + 128 };

static const char *const sky_vertex[] = {"frame.glsl", "sky.vert", NULL};

/* A stage: what all know, the surface's parts, the renderer's own. */
static void list_parts(const char *parts[MAX_PARTS], const char *const *surface, const char *own)
{
    int count = 0;
    parts[count++] = "frame.glsl";
    while (*surface && count < MAX_PARTS - 2)
        parts[count++] = *surface++;
    parts[count++] = own;
    parts[count] = NULL;
}

/* Defines of the strips' program, or of the crack closers': across a triangle without area nothing can be interpolated,
 * so theirs takes all from one corner. Where a pixel has several samples each is shaded by itself: at the middle of one
 * that is covered in part, outside of the triangle, there is no ground (nor at a centroid, where drivers have none). */
static void list_defines(const tc_surface *surface, const tc_scene_needs *needs, bool closers, char defines[DEFINES])
{
    char scene[TC_SCENE_DEFINES];
    tc_scene_needs_defines(needs, scene);
    snprintf(defines, DEFINES, "#define WINDOW_MASK %d\n#define INTERPOLATED %s\n%s%s",
             tc_clipmap_n(surface->clipmap[0]),
             closers               ? "flat"
             : needs->multisampled ? "sample"
                                   : "centroid",
             closers ? "#define CLOSERS\n" : "", scene);
}

static const char *sky_defines(const tc_scene_needs *needs)
{
    return needs->land ? "#define AIR 1.0\n" : "#define AIR 0.0\n";
}

bool tc_scene_closers(const tc_surface *surface)
{
    return surface->closers && tc_clipmap_levels(surface->clipmap[0]) > 1;
}

static tc_status build_terrain(const tc_gl *gl, const tc_surface *surface, const tc_scene_needs *needs, bool closers,
                               GLuint *program_ret, tc_error *error)
{
    char defines[DEFINES];
    const char *vertex[MAX_PARTS], *fragment[MAX_PARTS];
    list_defines(surface, needs, closers, defines);
    list_parts(vertex, surface->vertex_parts, "renderer.vert");
    list_parts(fragment, surface->fragment_parts, "renderer.frag");
    return tc_program_build(gl, vertex, fragment, defines, program_ret, error);
}

tc_status tc_scene_programs_build(const tc_gl *gl, const tc_surface *surface, const tc_scene_needs *needs,
                                  tc_scene_programs *programs, tc_error *error)
{
    GLuint *terrain = programs->terrain[needs->level_colours];
    tc_status status = TC_OK;
    for (int closers = 0; closers <= (tc_scene_closers(surface) ? 1 : 0) && !status; closers++)
        if (!terrain[closers])
            status = build_terrain(gl, surface, needs, closers, &terrain[closers], error);
    if (!status && !programs->sky && needs->sky)
        status = tc_program_build(gl, sky_vertex, (const char *[]){"frame.glsl", surface->sky, NULL},
                                  sky_defines(needs), &programs->sky, error);
    return status;
}

void tc_scene_programs_destroy(const tc_gl *gl, tc_scene_programs *programs)
{
    for (int i = 0; i < 4; i++) /* 0 is silently ignored */
        gl->DeleteProgram(programs->terrain[i / 2][i % 2]);
    gl->DeleteProgram(programs->sky);
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
    list_parts(vertex, surface->vertex_parts, "renderer.vert");
    list_parts(fragment, surface->fragment_parts, "renderer.frag");
    for (int closers = 0; closers < 2; closers++) {
        char defines[DEFINES];
        if (!programs->terrain[needs->level_colours][closers])
            continue;
        fprintf(file, "uses: shaders: %s: ", closers ? "crack closers" : "terrain");
        print_parts(vertex, file);
        fputs(", ", file);
        print_parts(fragment, file);
        list_defines(surface, needs, closers, defines);
        print_defines(defines, file);
    }
    if (programs->sky) {
        fputs("uses: shaders: sky: ", file);
        print_parts(sky_vertex, file);
        fprintf(file, ", frame.glsl + %s", surface->sky);
        print_defines(sky_defines(needs), file);
    }
}

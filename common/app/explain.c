/* explain.c - lines about what a scene uses and what was left out. */
#include "explain.h"

#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/packed/read/prefetch.h"
#include "common/render/drape.h"
#include "common/render/palette.h"
#include "common/input/plugin.h"

static const struct library {
    const char *plugin, *name, *use;
} libraries[] = {{"gdal", "GDAL", "for elevation files; it cannot be unloaded"},
                 {"oiio", "OpenImageIO", "for pictures; it cannot be unloaded"},
                 {"window", "GLFW", "for the window"}};
enum { LIBRARIES = sizeof libraries / sizeof *libraries };

/* ---- Left out --------------------------------------------------------------------------------------------------- */

static void add(tc_left_out *list, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void add(tc_left_out *list, const char *format, ...)
{
    if (list->count == TC_LEFT_OUT_LINES)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(list->text[list->count], TC_LEFT_OUT_TEXT, format, arguments);
    va_end(arguments);
    list->lines[list->count] = list->text[list->count];
    list->lines[++list->count] = NULL;
}

/* Charts without a layer, and layers that there would be for all levels of all charts. */
static void count_layers(const tc_renderer_use *use, int *unseen_ret, int *all_ret)
{
    *unseen_ret = *all_ret = 0;
    for (int chart = 0; chart < use->windows->charts; chart++) {
        *unseen_ret += use->textures->layers.held[chart] == 0;
        *all_ret += tc_clipmap_levels(use->windows->clipmap[chart]);
    }
}

/* Of the last frame. */
static void add_frame(const tc_renderer_use *use, tc_left_out *list)
{
    const tc_frame_stats *f = use->frame;
    const tc_surface_words *words = use->surface->words;
    int levels = f->levels_active + f->levels_fine + f->levels_beyond, unseen, layers;
    count_layers(use, &unseen, &layers);
    if (words->beyond)
        add(list, "%d of %d %s: %s", f->levels_beyond, levels, words->levels, words->beyond);
    add(list, "%d of %d %s: %s", f->levels_fine, levels, words->levels, words->fine);
    if (unseen > 0)
        add(list, "%d of %d charts: not in sight so far", unseen, use->windows->charts);
    if (use->textures->depth < layers)
        add(list, "%d of %d layers of vertex textures: no view has asked for them", layers - use->textures->depth,
            layers);
    add(list, "%" PRId64 " of %" PRId64 " triangles: %s", f->triangles_unculled - f->triangles, f->triangles_unculled,
        words->outside);
}

void tc_explain_left_out(const tc_renderer *renderer, tc_left_out *list)
{
    const tc_renderer_use use = tc_renderer_used(renderer);
    const char *needless[TC_SCENE_LEFT_OUT];
    int count = tc_scene_needs_left_out(use.needs, needless);
    list->count = 0;
    list->lines[0] = NULL;
    for (int i = 0; i < count; i++)
        add(list, "%s", needless[i]);
    if (use.surface->closers && !tc_scene_closers(use.surface, use.windows))
        add(list, "crack closers: one level");
    add_frame(&use, list);
    for (int i = 0; i < LIBRARIES; i++)
        if (!tc_plugin_loaded(libraries[i].plugin))
            add(list, "%s: not loaded", libraries[i].name);
}

/* ---- Used ------------------------------------------------------------------------------------------------------- */

static void print_textures(const tc_level_textures *t, FILE *file)
{
    for (int k = 0; k < t->contents; k++) {
        const tc_level_texture *c = &t->content[k];
        fprintf(file, "uses: texture: %s: %s, %d x %d x %d, %zu bytes\n", c->content->name,
                tc_gl_format_of(c->content->format)->name, c->size, c->size, t->depth, c->bytes);
    }
}

static void print_ramp(const tc_scene_needs *needs, FILE *file)
{
    const char *format = needs->given ? "RGBA16" : "RGBA8";
    const int size = needs->given ? TC_GIVEN_SIZE : TC_RAMP_SIZE;
    fprintf(file, "uses: texture: colours of %s: %s, %d, %d bytes\n", needs->shade->degrees > 0 ? "angles" : "heights",
            format, size, (needs->given ? 8 : 4) * size);
}

static void print_drape(const tc_drape *d, FILE *file)
{
    int all = 0;
    for (int chart = 0; chart < d->windows.charts; chart++)
        all += tc_clipmap_levels(d->windows.clipmap[chart]);
    print_textures(&d->textures, file);
    fprintf(file, "uses: imagery: %d of %d levels hold colours\n", tc_drape_levels(d), all);
}

static void print_frame(const tc_renderer_use *use, FILE *file)
{
    const tc_windows *windows = use->windows;
    const tc_frame_stats *f = use->frame;
    const tc_surface_words *words = use->surface->words;
    int held = 0, all = 0;
    for (int chart = 0; chart < windows->charts; chart++)
        for (int level = 1; level <= tc_clipmap_levels(windows->clipmap[chart]); level++, all++)
            held += level <= use->textures->layers.held[chart] &&
                    !tc_rect_empty(tc_clipmap_level(windows->clipmap[chart], level)->clip);
    for (int chart = 0; words->charts && chart < windows->charts; chart++)
        fprintf(file, "uses: chart %d: %d of %d levels have room\n", chart, use->textures->layers.held[chart],
                tc_clipmap_levels(windows->clipmap[chart]));
    fprintf(file, "uses: levels: %d of %d hold samples\n", held, all);
    fprintf(file, "uses: %s: %d of %d drawn\n", words->levels, f->levels_active,
            f->levels_active + f->levels_fine + f->levels_beyond);
    fprintf(file, "uses: %s: %d of %d drawn\n", words->blocks, f->blocks, f->blocks_unculled);
    if (f->draws > f->blocks)
        fprintf(file, "uses: crack closers: %d draws\n", f->draws - f->blocks);
    if (f->wall_draws > 0)
        fprintf(file, "uses: walls: %d draws, %" PRId64 " triangles\n", f->wall_draws, f->wall_triangles);
    if (use->needs->sea)
        fprintf(file, "uses: sea around: one draw, 8 triangles\n");
    if (f->tolerance > 0 && isfinite(f->error_bound))
        fprintf(file, "uses: error: at most %.3g pixels, of %.3g asked for\n", f->error_bound, f->tolerance);
    else if (f->tolerance > 0)
        fprintf(file, "uses: error: not known of this terrain; levels by distance alone\n");
    fprintf(file, "uses: triangles: %" PRId64 " of %" PRId64 " drawn\n", f->triangles, f->triangles_unculled);
}

/* The threads of this process. What is not ours is the driver's and the libraries'; work of ours that goes on several
 * ends them with it. Where the system does not tell, nothing. */
static void print_threads(FILE *file)
{
    DIR *tasks = opendir("/proc/self/task");
    int all = 0, ahead = 0;
    for (struct dirent *e; tasks && (e = readdir(tasks));) {
        char path[300], name[32] = "";
        if (e->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "/proc/self/task/%s/comm", e->d_name);
        FILE *comm = fopen(path, "r");
        all++;
        ahead += comm && fgets(name, sizeof name, comm) && strcmp(name, TC_PREFETCH_NAME "\n") == 0;
        if (comm)
            fclose(comm);
    }
    if (tasks)
        closedir(tasks);
    if (all)
        fprintf(file, "uses: threads: drawing%s; %d of the driver and of libraries\n", ahead ? ", reading ahead" : "",
                all - 1 - ahead);
}

void tc_explain_uses(const tc_renderer *renderer, FILE *file)
{
    const tc_renderer_use use = tc_renderer_used(renderer);
    tc_scene_programs_explain(use.surface, use.needs, use.programs, file);
    print_textures(use.textures, file);
    print_ramp(use.needs, file);
    if (use.drape)
        print_drape(use.drape, file);
    int finer = tc_field_info(tc_clipmap_field(use.windows->clipmap[0]))->synthesised;
    if (finer > 0)
        fprintf(file, "uses: synthesis: %d levels finer than the data\n", finer);
    if (use.surface->refined > 0)
        fprintf(file, "uses: curved cells: %d levels finer than the map's, on its mesh\n", use.surface->refined);
    print_frame(&use, file);
    for (int i = 0; i < LIBRARIES; i++)
        if (tc_plugin_loaded(libraries[i].plugin))
            fprintf(file, "uses: library: %s: %s\n", libraries[i].name, libraries[i].use);
    print_threads(file);
}

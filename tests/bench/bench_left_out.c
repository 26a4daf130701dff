/* bench_left_out.c - what each omission saves: for each scene, drawn as it is and with one thing forced upon it that it
 * does not need, in turns; milliseconds a frame as the median of differences, bytes as they were asked for. saved_ms of
 * the table is the time of all processors where they draw, else the time that passed.
 *
 * How a thing is forced: light, morph by the options; the sky without haze, haze and holes by the shaders' defines (and
 * windows with a mask), culling by the option that draws all, levels by asking for windows as if from the ground, rings
 * beyond the horizon and charts out of sight by adding them to what the surface hands over. Libraries are loaded, and
 * the reading thread is started, in a process of their own, which is this program run again. Not measured: drawing
 * rings finer than a pixel, which nothing in the program can be made to do. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "common/packed/read/prefetch.h"
#include "common/base/clock.h"
#include "common/input/plugin.h"
#include "spherical/rings_internal.h"
#include "tests/support/lean_scenes.h"
#include "tests/support/measure.h"

enum { PAIRS = 15, QUICK_PAIRS = 4, RUNS = 5, QUICK_RUNS = 2, MOST_DRAWS = 8192 };

/* ---- Forcing ---------------------------------------------------------------------------------------------------- */

typedef enum force { NOTHING, ALL_LEVELS, ALL_CHARTS, BEYOND_HORIZON, OUTSIDE_VIEW } force;

/* Surfaces' functions take no context: what the forced surface really is. */
static struct {
    force what;
    tc_surface own;
    tc_draw draws[MOST_DRAWS];
} forced;

/* Levels: as from the ground. Charts: a few samples of each level of those out of sight, so that all of them have
 * layers. */
static void forced_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    double ground = 0;
    if (forced.what == ALL_LEVELS) {
        tc_view *low = tc_view_allocate(view->surface);
        tc_camera c = view->camera;
        c.z = tc_field_info(view->surface->field)->z_base;
        if (forced.own.height(view, c.x, c.y, &ground))
            c.z = ground;
        if (!low)
            exit(99);
        forced.own.look(view->surface, view->windows, &c, &view->options, true, low);
        forced.own.wanted(low, wanted);
        free(low);
    } else {
        forced.own.wanted(view, wanted);
    }
    for (int chart = 0; chart < view->windows->charts && forced.what == ALL_CHARTS; chart++) {
        const tc_clipmap *clipmap = view->windows->clipmap[chart];
        bool unseen = true;
        for (int l = 1; l <= tc_clipmap_levels(clipmap); l++)
            unseen &= tc_rect_empty(wanted[chart][l - 1]);
        for (int l = 1; unseen && l <= tc_clipmap_levels(clipmap); l++) {
            tc_rect held = tc_clipmap_level(clipmap, 1)->clip;
            int64_t x = held.x0 << (l - 1), y = held.y0 << (l - 1);
            wanted[chart][l - 1] = l == 1 ? held : (tc_rect){x + 8, y + 8, x + 16, y + 16};
        }
    }
}

/* The draws of rings beyond the horizon are the last ones of a frame where nothing is culled. */
static void forced_draws(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    const tc_surface *surface = view->surface;
    forced.own.draws(view, layers, frame);
    if (forced.what != BEYOND_HORIZON && forced.what != OUTSIDE_VIEW)
        return;
    int count = frame->strip_draws, beyond = 0;
    if (surface->words->charts)
        beyond = frame->levels_beyond * ((const rings_surface *)surface)->geometry.sectors;
    if (count > MOST_DRAWS)
        exit(99);
    memcpy(forced.draws, frame->draws, (size_t)count * sizeof *forced.draws);
    tc_view *all = tc_view_allocate(surface);
    if (!all)
        exit(99);
    memcpy(all, view, surface->view_bytes);
    all->options.no_cull = true;
    forced.own.draws(all, layers, frame);
    free(all);
    frame->strip_draws -= beyond;
    if (forced.what == OUTSIDE_VIEW)
        return;
    if (count + beyond > surface->draw_capacity)
        exit(99);
    memmove(frame->draws + count, frame->draws + frame->strip_draws, (size_t)beyond * sizeof *frame->draws);
    memcpy(frame->draws, forced.draws, (size_t)count * sizeof *forced.draws);
    frame->strip_draws = count + beyond;
}

/* ---- Pairs ------------------------------------------------------------------------------------------------------ */

/* A scene as it is drawn, and what it asked OpenGL for. */
typedef struct side {
    scene scene;
    gl_record record;
    tc_gl gl;
} side;

static struct {
    const tc_context *context;
    measure_options options;
    const lean_scene *l;
    tc_camera camera;
    side as_is;
    bool software; /* the processors draw */
} bench;

typedef struct cost {
    double ms, cpu_ms; /* of all threads: on a software renderer that is what others on the machine change least */
} cost;

static double cpu_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static cost draw(side *s)
{
    tc_frame_stats stats;
    tc_error error;
    gl_record_on(&s->record);
    double start = tc_clock_ms(), cpu = cpu_ms();
    if (tc_renderer_frame(s->scene.renderer, &bench.camera, true, &stats, &error)) {
        fprintf(stderr, "bench_left_out: %s\n", error.text);
        exit(1);
    }
    return (cost){tc_clock_ms() - start, cpu_ms() - cpu};
}

/* record.add and drop are set. */
static void open_side(side *s, const tc_scene_options *options, const tc_scene_needs *needs, force what)
{
    tc_scene_options o = *options;
    o.budget = -1;
    s->gl = gl_record_begin(tc_context_gl(bench.context), &s->record);
    s->scene = lean_create(&s->gl, bench.l, &o, needs);
    if (what != NOTHING) {
        forced.what = what;
        forced.own = *s->scene.surface;
        s->scene.surface->wanted = forced_wanted;
        s->scene.surface->draws = forced_draws;
    }
    scene_draw(&s->scene, &bench.camera, true);
}

static void close_side(side *s)
{
    gl_record_on(&s->record);
    scene_destroy(&s->scene);
    gl_record_end(&s->record);
}

/* Of the driver's objects, of shader text and of the windows beside the textures. */
static int64_t bytes_of(const side *s)
{
    int64_t bytes = gl_record_bytes(&s->record) + (int64_t)s->record.text_bytes;
    for (int chart = 0; chart < tc_renderer_used(s->scene.renderer).windows->charts; chart++) {
        size_t heights, normals;
        tc_ground_bytes(tc_renderer_used(s->scene.renderer).windows->clipmap[chart], &heights, &normals);
        bytes += (int64_t)(heights + normals);
    }
    return bytes;
}

/* Where the processors draw, their time goes into the table: the same work takes them about as long whatever else they
 * do. */
static void tell(const char *feature, measure_spread ms, measure_spread cpu, int64_t bytes, int64_t text)
{
    printf("| %s | %s | %.2f | %.2f .. %.2f | ", bench.l->name, feature, ms.median, ms.low, ms.high);
    printf("%.2f | %.2f .. %.2f | ", cpu.median, cpu.low, cpu.high);
    printf("%lld | %lld |\n", (long long)bytes, (long long)text);
    fflush(stdout);
    if (bench.options.csv)
        fprintf(bench.options.csv, "%s,%s,%.3f,%lld\n", bench.l->name, feature, bench.software ? cpu.median : ms.median,
                (long long)bytes);
}

/* A thing forced upon the scene, against the scene as it is. */
static void measure_pair(const char *feature, const tc_scene_options *options, const tc_scene_needs *needs,
                         const char *add, const char *drop, force what)
{
    static side other;
    double ms[PAIRS], cpu[PAIRS];
    int pairs = bench.options.quick ? QUICK_PAIRS : PAIRS;
    other = (side){.record = {.add = add, .drop = drop}};
    open_side(&other, options, needs, what);
    for (int i = -1; i < pairs; i++) { /* -1 is not counted; who comes first changes */
        cost with, without;
        if (i & 1)
            without = draw(&bench.as_is), with = draw(&other);
        else
            with = draw(&other), without = draw(&bench.as_is);
        if (i >= 0)
            ms[i] = with.ms - without.ms, cpu[i] = with.cpu_ms - without.cpu_ms;
    }
    int64_t bytes = bytes_of(&other) - bytes_of(&bench.as_is);
    int64_t text = (int64_t)other.record.text_bytes - (int64_t)bench.as_is.record.text_bytes;
    tell(feature, measure_of(ms, pairs), measure_of(cpu, pairs), bytes, text);
    close_side(&other);
}

static void measure_parts(const tc_scene_options *own)
{
    unsigned needs = bench.l->needs;
    tc_scene_options o = *own;
    tc_scene_needs more = tc_scene_needs_of(own, tc_field_info(bench.as_is.scene.field));
    if (!(needs & LEAN_NORMALS)) {
        o.unlit = false;
        measure_pair("normals and light", &o, NULL, NULL, NULL, NOTHING);
        o = *own;
    }
    if (!(needs & LEAN_SKY)) {
        o.background_set = false;
        measure_pair("sky", &o, NULL, NULL, "HAZE", NOTHING);
        o = *own;
    }
    if (!(needs & LEAN_HAZE))
        measure_pair("haze", own, NULL, "HAZE", NULL, NOTHING);
    if (!(needs & LEAN_WATER))
        measure_pair("water", own, NULL, "WATER", NULL, NOTHING);
    if (!(needs & LEAN_LAND))
        measure_pair("rock and snow", own, NULL, "NATURAL_LAND", NULL, NOTHING);
    if (!(needs & LEAN_CONTOURS)) {
        o.contours = 20;
        measure_pair("contours", &o, NULL, NULL, NULL, NOTHING);
        o = *own;
    }
    if (own->frame.no_morph) {
        o.frame.no_morph = false;
        measure_pair("morph", &o, NULL, NULL, NULL, NOTHING);
    }
    if (!(needs & LEAN_HOLES)) {
        more.holes = true;
        measure_pair("void mask", own, &more, "HOLES", NULL, NOTHING);
    }
}

static void measure_extents(const tc_scene_options *own)
{
    const tc_renderer_use use = tc_renderer_used(bench.as_is.scene.renderer);
    const tc_frame_stats *f = use.frame;
    int unseen = 0;
    for (int chart = 0; chart < use.windows->charts; chart++)
        unseen += use.textures->layers.held[chart] == 0;
    if (f->blocks < f->blocks_unculled)
        measure_pair("triangles outside the view", own, NULL, NULL, NULL, OUTSIDE_VIEW);
    if (f->levels_beyond > 0)
        measure_pair("rings beyond the horizon", own, NULL, NULL, NULL, BEYOND_HORIZON);
    if (!use.surface->words->beyond && f->levels_fine > 0)
        measure_pair("levels too fine", own, NULL, NULL, NULL, ALL_LEVELS);
    if (unseen > 0)
        measure_pair("charts out of sight", own, NULL, NULL, NULL, ALL_CHARTS);
}

static void measure_scene(const lean_scene *l)
{
    bench.l = l;
    int width = bench.options.quick ? 320 : 640;
    bench.camera = lean_camera(l, width, width * 3 / 4);
    bench.as_is = (side){.record = {.add = NULL}};
    open_side(&bench.as_is, &l->options, NULL, NOTHING);
    measure_parts(&l->options);
    measure_extents(&l->options);
    close_side(&bench.as_is);
}

/* ---- Libraries and threads -------------------------------------------------------------------------------------- */

static int64_t resident_bytes(void)
{
    long long size = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%lld %lld", &size, &resident) != 2)
        exit(99);
    fclose(file);
    return resident * sysconf(_SC_PAGESIZE);
}

static tc_piece read_nothing(tc_wish *wish)
{
    *(_Atomic bool *)wish->field = true;
    return TC_PIECE_LAST;
}

/* In a process of its own: loads a library, or starts the thread; prints milliseconds and bytes. */
static int child(const char *what)
{
    static _Atomic bool done;
    tc_prefetch prefetch;
    tc_error error;
    const void *table;
    int64_t before = resident_bytes();
    double start = tc_clock_ms(), cpu = cpu_ms();
    if (strcmp(what, "thread") == 0) {
        tc_prefetch_init(&prefetch, read_nothing, 1);
        if (!tc_prefetch_ask(&prefetch, &(tc_wish){.field = (void *)&done, .level = 1, .rect = {0, 0, 1, 1}}))
            return 1;
        while (!done)
            usleep(10);
    } else if (tc_plugin_load(what, &table, &error)) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    double ms = tc_clock_ms() - start;
    printf("%f %f %lld\n", ms, cpu_ms() - cpu, (long long)(resident_bytes() - before));
    if (strcmp(what, "thread") == 0)
        tc_prefetch_free(&prefetch);
    return 0;
}

static void measure_child(const char *program, const char *what, const char *feature)
{
    double ms[RUNS], cpu[RUNS], bytes[RUNS];
    int runs = bench.options.quick ? QUICK_RUNS : RUNS, got = 0;
    for (int i = -1; i < runs; i++) { /* -1 warms the caches */
        char command[4200];
        long long growth = 0;
        double took = 0, worked = 0;
        snprintf(command, sizeof command, "'%s' --load %s", program, what);
        FILE *pipe = popen(command, "r");
        int read = pipe ? fscanf(pipe, "%lf %lf %lld", &took, &worked, &growth) : 0;
        int status = pipe ? pclose(pipe) : -1;
        if (read != 3 || status != 0) {
            printf("| %s | %s | not measured: it cannot be loaded here | | | | | |\n", bench.l->name, feature);
            return;
        }
        if (i >= 0)
            ms[got] = took, cpu[got] = worked, bytes[got++] = (double)growth;
    }
    tell(feature, measure_of(ms, got), measure_of(cpu, got), (int64_t)measure_of(bytes, got).median, 0);
}

/* ---- All -------------------------------------------------------------------------------------------------------- */

static bool in_quick(const char *name)
{
    static const char *const names[] = {"flat-unlit", "high", "packed", "planet-pole"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--load") == 0)
        return child(argv[2]);
    bench.options = measure_begin(argc, argv, "scene,feature,saved_ms,saved_bytes");
    tc_context *context = scene_context();
    if (!context)
        return 1;
    bench.context = context;
    bench.software = tc_gl_software((const char *)tc_context_gl(context)->GetString(GL_RENDERER));
    puts(
        "left out: what it saves. ms a frame, median of differences between a tenth below and a tenth above (of "
        "libraries and threads once, on starting); likewise of all processors; bytes of textures, buffers, shader text "
        "and windows (of libraries and threads: resident); of them shader text\n"
        "| scene | left out | ms | spread | processors' ms | spread | bytes | text |\n"
        "|---|---|---:|---:|---:|---:|---:|---:|");
    for (int k = 0; k < LEAN_SCENES; k++) {
        const lean_scene *l = &lean_scenes[k];
        if (bench.options.quick && !in_quick(l->name))
            continue;
        measure_scene(l);
        if (l->ground == LEAN_PACKED) {
            measure_child(argv[0], "gdal", "GDAL");
            measure_child(argv[0], "oiio", "OpenImageIO");
            measure_child(argv[0], "window", "GLFW");
        }
        if (k == 0)
            measure_child(argv[0], "thread", "thread that reads ahead");
    }
    puts("not measured: drawing rings finer than a pixel");
    lean_free_all();
    tc_context_destroy(context);
    return measure_end(&bench.options);
}

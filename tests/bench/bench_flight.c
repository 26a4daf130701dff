/* bench_flight.c - whether frames ever stutter: 3 km/s at 100 m over a packed terrain of 8193 x 8193, as a window
 * flies.
 *
 * Frames follow each other sixtieths of a second apart or, where the machine is slower, without a pause; the eye moves
 * by a sixtieth of a second's way in each. What a frame costs is processor time: the drawing thread's own and that of
 * the driver's threads, which is all of the process but for the threads that read ahead. flight.csv. */
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "common/packed/read/prefetch.h"
#include "tests/support/made_files.h"
#include "tests/support/measure.h"
#include "tests/support/scene.h"
#include "tests/support/terrain_files.h"
#include "tests/support/terrains.h"

enum { SPACING = 30, RATE = 60, SPEED = 3000, ABOVE = 100, MARGIN = 12000, MOST_FRAMES = 1 << 13 };

/* ---- Clocks ------------------------------------------------------------------------------------------------------ */

static double clock_of(clockid_t clock)
{
    struct timespec t;
    return clock_gettime(clock, &t) == 0 ? 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec : 0;
}

/* Milliseconds of processor time of the threads that read ahead. */
static double ahead_ms(void)
{
    double ms = 0;
    DIR *tasks = opendir("/proc/self/task");
    for (const struct dirent *d; tasks && (d = readdir(tasks));) {
        char path[300], name[32] = "";
        snprintf(path, sizeof path, "/proc/self/task/%s/comm", d->d_name);
        FILE *comm = fopen(path, "r");
        if (comm && fgets(name, sizeof name, comm) && strcmp(name, TC_PREFETCH_NAME "\n") == 0)
            ms +=
                clock_of((clockid_t)(~(unsigned)atoi(d->d_name) << 3 | 6)); /* a thread's clock, as Linux numbers it */
        if (comm)
            fclose(comm);
    }
    if (tasks)
        closedir(tasks);
    return ms;
}

typedef struct clocks {
    double thread, process, ahead, wall;
} clocks;

static clocks clocks_now(void)
{
    return (clocks){clock_of(CLOCK_THREAD_CPUTIME_ID), clock_of(CLOCK_PROCESS_CPUTIME_ID), ahead_ms(),
                    clock_of(CLOCK_MONOTONIC)};
}

static void sleep_until(double ms)
{
    double left = ms - clock_of(CLOCK_MONOTONIC);
    if (left > 0)
        usleep((useconds_t)(1e3 * left));
}

/* ---- The way ----------------------------------------------------------------------------------------------------- */

/* From a corner towards the opposite one, not quite along the diagonal. */
typedef struct way {
    tc_camera camera[MOST_FRAMES];
    int count;
} way;

static void lay_way(const tc_field *field, int64_t size, int frames, way *w)
{
    const double step = (double)SPEED / RATE, extent = (double)(size - 1) * SPACING, east = 0.6;
    const double most = (extent - 2 * MARGIN) / fmax(sin(east), cos(east)) / step;
    w->count = (int)fmin(frames, most);
    for (int i = 0; i < w->count; i++) {
        tc_camera *c = &w->camera[i];
        double ground = 0;
        *c = (tc_camera){.x = MARGIN + i * step * sin(east),
                         .y = MARGIN + i * step * cos(east),
                         .heading = east,
                         .pitch = -0.1,
                         .fov = M_PI / 2,
                         .width = 640,
                         .height = 360};
        terrain_must(tc_field_height(field, c->x, c->y, &ground), &(tc_error){.text = "the terrain cannot be read"});
        c->z = ground + ABOVE;
    }
}

/* ---- Flying ------------------------------------------------------------------------------------------------------ */

typedef struct figures {
    double frame[MOST_FRAMES], thread[MOST_FRAMES], update[MOST_FRAMES];
    int count, late;  /* frames; of them those that lacked something */
    double late_area; /* the mean share of what windows wanted that they lacked */
    int64_t waits, decoded;
} figures;

static double lacking(const tc_clipmap *c)
{
    int64_t wanted = 0, held = 0;
    for (int l = 2; l <= tc_clipmap_levels(c); l++) {
        const tc_clip_level *v = tc_clipmap_level(c, l);
        wanted += (v->wanted.x1 - v->wanted.x0) * (v->wanted.y1 - v->wanted.y0);
        held += (v->clip.x1 - v->clip.x0) * (v->clip.y1 - v->clip.y0);
    }
    return wanted ? (double)(wanted - held) / (double)wanted : 0;
}

static void draw(const tc_gl *gl, scene *s, const tc_camera *camera, tc_frame_stats *stats)
{
    tc_error error;
    terrain_must(tc_renderer_frame(s->renderer, camera, false, stats, &error), &error);
    gl->Finish();
}

static void fly(const tc_context *context, const char *path, const way *w, const tc_scene_options *options, figures *f)
{
    const tc_gl *gl = tc_context_gl(context);
    tc_field *field = terrain_open(path);
    scene s = scene_create(context, field, 255, options);
    tc_frame_stats stats;
    *f = (figures){.count = w->count};
    for (int i = 0; i < 4 * RATE; i++) { /* standing at the start */
        double next = clock_of(CLOCK_MONOTONIC) + 1e3 / RATE;
        draw(gl, &s, &w->camera[0], &stats);
        sleep_until(next);
    }
    tc_field_stats before = tc_field_tell(field);
    for (int i = 0; i < w->count; i++) {
        clocks start = clocks_now();
        draw(gl, &s, &w->camera[i], &stats);
        clocks end = clocks_now();
        f->thread[i] = end.thread - start.thread;
        f->frame[i] = fmax(end.process - start.process - (end.ahead - start.ahead), f->thread[i]);
        f->update[i] = stats.update_ms;
        f->late += !stats.resident;
        f->late_area += lacking(s.clipmap) / w->count;
        sleep_until(start.wall + 1e3 / RATE);
    }
    tc_field_stats after = tc_field_tell(field);
    f->waits = after.waits - before.waits;
    f->decoded = after.decoded - before.decoded;
    scene_destroy(&s);
    tc_field_destroy(field);
}

/* ---- Table ------------------------------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_times(const measure_options *o, const char *name, const char *what, double *ms, int count)
{
    qsort(ms, (size_t)count, sizeof *ms, compare);
    double median = measure_quantile(ms, count, 0.5), p99 = measure_quantile(ms, count, 0.99), most = ms[count - 1];
    printf("%-28s %-22s %8.2f %8.2f %8.2f %8.2f\n", name, what, median, p99, most, p99 / median);
    if (o->csv)
        fprintf(o->csv, "%s,%s,%.3f,%.3f,%.3f\n", name, what, median, p99, most);
}

static void print(const measure_options *o, const char *name, figures *f)
{
    print_times(o, name, "frame with driver", f->frame, f->count);
    print_times(o, name, "drawing thread", f->thread, f->count);
    print_times(o, name, "update (by the wall)", f->update, f->count);
    printf("%-28s %d frames: %lld waited for decoding, %d lacked something, %.4f %% of the windows in the mean; "
           "%.2f MB decoded\n",
           name, f->count, (long long)f->waits, f->late, 100 * f->late_area, 1e-6 * (double)f->decoded);
}

int main(int argc, char **argv)
{
    measure_options o = measure_begin(argc, argv, "flight,what,median_ms,p99_ms,max_ms");
    static const struct {
        const char *name;
        tc_scene_options options;
    } kinds[] = {{"as it is", {0}}, {"nothing asked for ahead", {.ahead = -1}}};
    enum { KINDS = sizeof kinds / sizeof *kinds };
    const int64_t size = o.quick ? 2049 : 8193;
    static figures f;
    static way w;
    tc_context *context = scene_context();
    if (!context)
        return 1;
    tc_grid grid = terrain_grid(TERRAIN_DEFAULT, size, size, SPACING, 1);
    const char *path = made_path("flight.tclip");
    const terrain_file about = {{"default", 0, 0}, TC_SAMPLE_FLOAT32, 0};
    terrain_pack(&grid, &about, &(tc_pack_options){.mode = TC_PACK_RMS, .error = 1}, path);
    tc_grid_free(&grid);
    tc_field *field = terrain_open(path);
    lay_way(field, size, o.quick ? 10 * RATE : 60 * RATE, &w);
    tc_field_destroy(field);
    printf("%lld x %lld, %d m apart; %d m/s, %d m above ground, %d frames of 640 x 360\n", (long long)size,
           (long long)size, SPACING, SPEED, ABOVE, w.count);
    printf("%-28s %-22s %8s %8s %8s %8s\n", "", "ms of a processor", "median", "99 %", "most", "99 %/med");
    for (int k = 0; k < KINDS; k++) {
        fly(context, path, &w, &kinds[k].options, &f);
        print(&o, kinds[k].name, &f);
        fflush(stdout);
    }
    tc_context_destroy(context);
    made_folder_remove();
    return measure_end(&o);
}

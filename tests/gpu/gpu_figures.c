/* gpu_figures.c - what a scheme draws and costs on the driver at hand, beside what a software renderer drew:
 *     gpu_figures SCHEME OUT [--software FOLDER | --in-software] [--seconds S] [--within S] [--quick]
 *
 * Writes OUT/SCHEME.csv, a figure a row, and OUT/pictures/. A case is a scheme in a view of a size, of the default
 * terrain as it is, or of the default planet with synthesis down to 10 m. FOLDER is the OUT of an earlier
 * run: figures and pictures are held against its own.
 *
 * Frames are those of a flight straight on, a 250th of the height above the ground each, and go into the renderer's own
 * framebuffer: gpu_ms is GL_TIME_ELAPSED around one, cpu_ms the drawing thread's own time until all is handed over,
 * frame_ms the clock's until the GPU has answered. They go on for S seconds a case. Uploads are those of a flight of
 * STEPS frames without draws, so that their bytes do not depend on the driver. Errors are
 * view_error.h's against the finest samples, of some 6,000 pixels of a frame.
 *
 * Views of a size share windows, so that they are filled once. A case that fails is a row of its own, and the next one
 * follows; so is one that, by what others took, would not be done within S seconds from when the terrain is there. Ends
 * with 1 where a figure is wrong or one failed, with 2 for wrong usage, and with 3 where OpenGL cannot be had, or,
 * where that is asked for, none that draws in software. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "common/base/clock.h"
#include "common/map/map.h"
#include "tests/support/measure.h"
#include "tests/support/scheme_planets.h"

enum { STEPS = 32, FRAMES_LEAST = 2, FRAMES_MOST = 2000, ERROR_PIXELS = 6000, FEW_GREYS = 8, SYNTHESIS = 10 };
#define DEGREE (M_PI / 180)
#define EARTH 6371000.0

/* ---- Cases ------------------------------------------------------------------------------------------------------- */

/* What depends on the body, flat or round. */
typedef struct ground ground;
struct ground {
    const tc_body_class *body;
    int64_t size[2];                                                       /* samples across: quick, else */
    tc_map *(*open)(int64_t size, const tc_atlas *atlas, tc_error *error); /* NULL: see *error */
    void (*begin)(const tc_map *map, tc_camera *camera);                   /* its place */
    tc_camera (*onward)(const tc_map *map, const tc_camera *from, double above, double metres);
};

static tc_map *open_flat(int64_t size, const tc_atlas *atlas, tc_error *error)
{
    (void)atlas;
    tc_map *map = tc_map_flat(terrain_field(TERRAIN_DEFAULT, size, size, 30, 4));
    if (!map)
        snprintf(error->text, sizeof error->text, "not enough memory for the terrain");
    return map;
}

static void begin_flat(const tc_map *map, tc_camera *c)
{
    const tc_level finest = tc_field_level(map->chart[0].field, tc_field_info(map->chart[0].field)->levels);
    c->x = 0.53 * (double)finest.width * finest.spacing_x, c->y = 0.48 * (double)finest.height * finest.spacing_y;
}

static tc_camera onward_flat(const tc_map *map, const tc_camera *from, double above, double metres)
{
    tc_camera to = *from;
    double z;
    to.x += metres * sin(to.heading), to.y += metres * cos(to.heading);
    if (tc_map_height(map, to.x, to.y, &z) == TC_OK)
        to.z = z + above;
    return to;
}

static tc_map *open_round(int64_t size, const tc_atlas *atlas, tc_error *error)
{
    tc_map *source = planet_made(PLANET_DEFAULT, size, EARTH, 1), *map = source;
    tc_status status = TC_OK;
    if (source->chart[0].class != atlas->class) {
        status = tc_map_resample(source, atlas, 0, &map, error);
        tc_map_destroy(source);
    }
    if (status == TC_OK && (status = tc_map_synthesise(map, SYNTHESIS, error)) != TC_OK)
        tc_map_destroy(map);
    return status == TC_OK ? map : NULL;
}

static void begin_round(const tc_map *map, tc_camera *c)
{
    (void)map;
    c->x = 119.9 * DEGREE, c->y = 16 * DEGREE;
}

static tc_camera onward_round(const tc_map *map, const tc_camera *from, double above, double metres)
{
    const scheme_planet p = {.source = (tc_map *)map, .own = {{.map = (tc_map *)map}}, .atlases = 1};
    return scheme_onward(&p, from, above, metres);
}

static const ground grounds[] = {{&tc_plane_body, {513, 4097}, open_flat, begin_flat, onward_flat},
                                 {&tc_sphere_body, {512, 4096}, open_round, begin_round, onward_round}};
enum { GROUNDS = sizeof grounds / sizeof *grounds };

static const struct view {
    const char *name;
    double above[GROUNDS]; /* metres above the ground, and of the flight for uploads */
    double way[GROUNDS];
    double down[GROUNDS]; /* degrees below the horizontal */
} views[] = {{"ground", {10, 10}, {320, 320}, {3, 3}},
             {"aircraft", {3e3, 10e3}, {3200, 3200}, {12, 6}},
             {"space", {120e3, 5e6}, {32e3, 320e3}, {90, 80}}};
enum { VIEWS = sizeof views / sizeof *views };

static const int sizes[2][2][2] = {{{1920, 1080}, {3840, 2160}}, {{192, 108}, {384, 216}}}; /* the second: quick */

/* ---- Figures ----------------------------------------------------------------------------------------------------- */

typedef enum figure_name {
    HALVINGS,
    TRIANGLES,
    DRAWS,
    MEMORY,
    UPLOADED,
    UPLOAD_MS,
    ERROR_RMS,
    ERROR_P999,
    ERROR_MAX,
    GREY_MEAN,
    GREY_MOST,
    PIXELS_OFF,
    SHARE_OFF,
    FRAMES,
    GPU_MS,
    GPU_P99_MS,
    CPU_MS,
    CPU_P99_MS,
    FRAME_MS,
    FRAME_P99_MS,
    FIGURES
} figure_name;

/* How a figure is held against the software one. */
typedef enum rule {
    TOLD, /* not at all: a time */
    LIKE, /* is the same or differs, which is told */
    NEAR, /* is wrong where it is larger by more than a part of the software one and a bit */
    MOST  /* is a difference itself, and wrong above a bound */
} rule;

static const struct figure {
    const char *name, *unit;
    rule rule;
    double part, bit; /* of NEAR; bit: the bound of MOST */
} figures[FIGURES] = {
    [HALVINGS] = {"halvings", "", LIKE, 0, 0},
    [TRIANGLES] = {"triangles", "", LIKE, 0, 0},
    [DRAWS] = {"draws", "", LIKE, 0, 0},
    [MEMORY] = {"memory", "bytes", TOLD, 0, 0},
    [UPLOADED] = {"uploaded", "bytes", LIKE, 0, 0},
    [UPLOAD_MS] = {"upload_ms", "ms", TOLD, 0, 0},
    [ERROR_RMS] = {"error_rms", "px", NEAR, 0.1, 0.01},
    [ERROR_P999] = {"error_p999", "px", NEAR, 0.25, 0.05},
    [ERROR_MAX] = {"error_max", "px", LIKE, 0, 0},
    [GREY_MEAN] = {"grey_mean", "greys", MOST, 0, 2},
    [GREY_MOST] = {"grey_most", "greys", MOST, 0, 256},
    [PIXELS_OFF] = {"pixels_off", "pixels", MOST, 0, INFINITY},
    [SHARE_OFF] = {"share_off", "%", MOST, 0, 2},
    [FRAMES] = {"frames", "", TOLD, 0, 0},
    [GPU_MS] = {"gpu_ms", "ms", TOLD, 0, 0},
    [GPU_P99_MS] = {"gpu_p99_ms", "ms", TOLD, 0, 0},
    [CPU_MS] = {"cpu_ms", "ms", TOLD, 0, 0},
    [CPU_P99_MS] = {"cpu_p99_ms", "ms", TOLD, 0, 0},
    [FRAME_MS] = {"frame_ms", "ms", TOLD, 0, 0},
    [FRAME_P99_MS] = {"frame_p99_ms", "ms", TOLD, 0, 0},
};

/* A figure of the software run. */
typedef struct known {
    char key[96]; /* "VIEW,WIDTHxHEIGHT,FIGURE" */
    double value;
} known;
enum { KNOWN_MOST = VIEWS * 2 * FIGURES };

typedef struct report {
    const char *scheme, *out, *software; /* NULL: none */
    double seconds, within;
    double end; /* by the clock, milliseconds */
    bool quick, in_software;
    FILE *csv;
    known known[KNOWN_MOST];
    int knows;
    bool wrong;

    tc_context *context;
    const tc_gl *gl;
    const char *renderer;
    const ground *ground;
    int body; /* of views[] */
    const tc_scheme *kind;
    tc_map *map;
    char at[64]; /* the case: "VIEW,WIDTHxHEIGHT" */
} report;

/* A row, on disk before a driver that falls can take it along. known: what software drew, NAN: not known. */
static void put_row(report *r, const char *figure, const char *value, const char *unit, double software,
                    const char *verdict)
{
    fprintf(r->csv, "%s,%s,%s,", r->scheme, r->at, figure);
    measure_put_text(r->csv, value);
    fprintf(r->csv, ",%s,", unit);
    if (!isnan(software))
        fprintf(r->csv, "%.12g", software);
    fprintf(r->csv, ",%s,", verdict);
    measure_put_text(r->csv, r->renderer);
    fputc('\n', r->csv);
    fflush(r->csv);
}

static void put_failure(report *r, const char *why)
{
    printf("%s,%s: failed: %s\n", r->scheme, r->at, why);
    fflush(stdout);
    put_row(r, "failed", why, "", NAN, "failed");
    r->wrong = true;
}

static double software_figure(const report *r, const char *name)
{
    char key[sizeof r->known->key];
    snprintf(key, sizeof key, "%s,%s", r->at, name);
    for (int k = 0; k < r->knows; k++)
        if (strcmp(r->known[k].key, key) == 0)
            return r->known[k].value;
    return NAN;
}

static const char *verdict_of(const struct figure *f, double value, double software)
{
    if (f->rule == TOLD || (f->rule != MOST && isnan(software)))
        return "";
    const double than = f->rule == MOST ? 0 : software, most = f->rule == MOST   ? f->bit
                                                               : f->rule == NEAR ? (1 + f->part) * software + f->bit
                                                                                 : INFINITY;
    return fabs(value - than) <= 1e-9 * fabs(than) ? "same" : value <= most ? "differs" : "wrong";
}

static void put(report *r, figure_name name, double value)
{
    const struct figure *f = &figures[name];
    const double software = f->rule == TOLD || f->rule == MOST ? NAN : software_figure(r, f->name);
    char text[32];
    snprintf(text, sizeof text, "%.12g", value);
    const double written = strtod(text, NULL); /* as the software one was */
    const char *verdict = verdict_of(f, written, software);
    put_row(r, f->name, text, f->unit, software, verdict);
    r->wrong |= strcmp(verdict, "wrong") == 0;
}

/* Of SOFTWARE/SCHEME.csv; what it lacks is not compared. */
static void read_software(report *r)
{
    char path[4096], line[4096];
    snprintf(path, sizeof path, "%s/%s.csv", r->software, r->scheme);
    FILE *f = fopen(path, "r");
    while (f && fgets(line, sizeof line, f) && r->knows < KNOWN_MOST) {
        char view[24], size[24], figure[32];
        known *k = &r->known[r->knows];
        if (sscanf(line, "%*[^,],%23[^,],%23[^,],%31[^,],%lf", view, size, figure, &k->value) == 4) {
            snprintf(k->key, sizeof k->key, "%s,%s,%s", view, size, figure);
            r->knows++;
        }
    }
    if (f)
        fclose(f);
    if (r->knows == 0)
        printf("%s: no software figures in %s: nothing is compared\n", r->scheme, r->software);
}

/* ---- Pictures ---------------------------------------------------------------------------------------------------- */

static void to_grey(const uint8_t *rgb, size_t pixels, uint8_t *grey)
{
    for (size_t k = 0; k < pixels; k++)
        grey[k] = (uint8_t)((54 * rgb[3 * k] + 183 * rgb[3 * k + 1] + 19 * rgb[3 * k + 2]) >> 8);
}

static void picture_path(const report *r, const char *folder, char *path, size_t size)
{
    snprintf(path, size, "%s/pictures/%s-%s.pgm", folder, r->scheme, r->at);
    char *comma = strrchr(path, ',');
    if (comma)
        *comma = '-';
}

static bool write_picture(const char *path, const uint8_t *grey, int width, int height)
{
    FILE *f = fopen(path, "wb");
    if (!f)
        return false;
    const size_t pixels = (size_t)width * (size_t)height;
    bool whole = fprintf(f, "P5\n%d %d\n255\n", width, height) > 0 && fwrite(grey, 1, pixels, f) == pixels;
    return fclose(f) == 0 && whole;
}

static bool read_picture(const char *path, uint8_t *grey, int width, int height)
{
    FILE *f = fopen(path, "rb");
    const size_t pixels = (size_t)width * (size_t)height;
    int w, h;
    bool whole = f && fscanf(f, "P5 %d %d 255", &w, &h) == 2 && fgetc(f) == '\n' && w == width && h == height &&
                 fread(grey, 1, pixels, f) == pixels;
    if (f)
        fclose(f);
    return whole;
}

static void put_difference(report *r, const uint8_t *a, const uint8_t *b, size_t pixels)
{
    int64_t sum = 0, off = 0;
    int most = 0;
    for (size_t k = 0; k < pixels; k++) {
        const int d = abs(a[k] - b[k]);
        sum += d, off += d > FEW_GREYS, most = d > most ? d : most;
    }
    put(r, GREY_MEAN, (double)sum / (double)pixels);
    put(r, GREY_MOST, most);
    put(r, PIXELS_OFF, (double)off);
    put(r, SHARE_OFF, 100 * (double)off / (double)pixels);
}

/* The frame as it was drawn, into OUT, and against software's. */
static void put_picture(report *r, const uint8_t *rgb, const tc_camera *c)
{
    const size_t pixels = (size_t)c->width * (size_t)c->height;
    uint8_t *grey = malloc(2 * pixels);
    char path[4200];
    if (!grey) {
        put_failure(r, "not enough memory for a picture");
        return;
    }
    to_grey(rgb, pixels, grey);
    picture_path(r, r->out, path, sizeof path);
    if (!write_picture(path, grey, c->width, c->height))
        put_failure(r, "the picture cannot be written");
    if (r->software) {
        picture_path(r, r->software, path, sizeof path);
        if (read_picture(path, grey + pixels, c->width, c->height))
            put_difference(r, grey, grey + pixels, pixels);
        else
            printf("%s,%s: no software picture: not compared\n", r->scheme, r->at);
    }
    free(grey);
}

/* ---- One case ---------------------------------------------------------------------------------------------------- */

typedef struct drawn {
    scene s;
    tc_camera camera;
    double above;
} drawn;

static bool frame(report *r, drawn *d, const tc_camera *c, bool finish, tc_frame_stats *stats)
{
    tc_error error;
    if (tc_renderer_frame(d->s.renderer, c, finish, stats, &error) == TC_OK)
        return true;
    put_failure(r, error.text);
    return false;
}

/* As fine as the frame calls for or, as in the viewers, as the driver has memory for. */
static bool make(report *r, drawn *d)
{
    enum { MOST_HALVINGS = 4 };
    const tc_scene_options options = {0};
    const tc_scene_needs needs = tc_scene_needs_of(&options, tc_field_info(r->map->chart[0].field));
    tc_surface_request request = {.needs = &needs, .camera = &d->camera};
    tc_status status = TC_ERR_MEMORY;
    tc_error error;
    for (; status == TC_ERR_MEMORY && request.halvings <= MOST_HALVINGS; request.halvings++) {
        scene_destroy(&d->s);
        d->s = (scene){0};
        status = r->kind->create(r->kind, r->map, &request, &d->s.surface, &error);
        if (status == TC_OK)
            status = tc_renderer_create(r->gl, d->s.surface, &options, &d->s.renderer, &error);
    }
    if (status != TC_OK) {
        put_failure(r, error.text);
        return false;
    }
    put(r, HALVINGS, request.halvings - 1);
    return true;
}

static tc_status true_height(void *map, double x, double y, double *z_ret)
{
    return tc_map_height(map, x, y, z_ret);
}

static void put_error(report *r, drawn *d, float *depth)
{
    const int pixels = d->camera.width * d->camera.height, every = (pixels / ERROR_PIXELS) | 1;
    const tc_truth truth = {true_height, r->map};
    tc_error_stats e;
    for (int k = 0; k < pixels; k++)
        depth[k] = k % every ? 0 : depth[k];
    if (tc_error_stats_init(&e)) {
        put_failure(r, "not enough memory for errors");
        return;
    }
    if (tc_view_error_add(&d->camera, d->s.surface->near_plane, &r->map->body, depth, &truth, &e)) {
        put_failure(r, "the error of the view cannot be told");
    } else if (e.count == 0) {
        put_failure(r, "no pixel shows terrain");
    } else {
        put(r, ERROR_RMS, tc_error_stats_rms(&e));
        put(r, ERROR_P999, tc_error_stats_percentile(&e, 0.999));
        put(r, ERROR_MAX, e.max);
    }
    tc_error_stats_free(&e);
}

/* The view with all that it needs: counts, error, picture. */
static bool put_still(report *r, drawn *d)
{
    const size_t pixels = (size_t)d->camera.width * (size_t)d->camera.height;
    tc_frame_stats stats;
    do
        if (!frame(r, d, &d->camera, true, &stats))
            return false;
    while (!stats.resident && !stats.failed);
    tc_memory_stats memory;
    tc_renderer_memory(d->s.renderer, &memory);
    put(r, TRIANGLES, (double)stats.triangles), put(r, DRAWS, stats.draws);
    put(r, MEMORY, (double)(memory.geometry + memory.heights + memory.normals));
    uint8_t *rgb = malloc(3 * pixels);
    float *depth = malloc(sizeof *depth * pixels);
    if (rgb && depth) {
        tc_renderer_read(d->s.renderer, rgb, depth);
        put_picture(r, rgb, &d->camera);
        put_error(r, d, depth);
    } else
        put_failure(r, "not enough memory for a frame");
    free(rgb), free(depth);
    return true;
}

/* Without draws, each frame with all that it needs. */
static bool put_uploads(report *r, drawn *d, double way)
{
    tc_camera c = d->camera;
    double ms = 0, bytes = 0;
    bool drew = true;
    scene_leave_draws_out(d->s.surface);
    for (int step = 0; step < STEPS && drew; step++) {
        tc_frame_stats stats;
        c = r->ground->onward(r->map, &c, d->above, way / STEPS);
        do {
            drew = frame(r, d, &c, true, &stats);
            ms += drew ? stats.update_ms : 0, bytes += drew ? (double)stats.bytes_uploaded : 0;
        } while (drew && !stats.resident && !stats.failed);
    }
    scene_put_draws_back(d->s.surface);
    if (drew)
        put(r, UPLOADED, bytes), put(r, UPLOAD_MS, ms);
    return drew;
}

static double thread_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static void put_spread(report *r, figure_name median, double *ms, int count)
{
    put(r, median, measure_of(ms, count).median);
    put(r, median + 1, measure_quantile(ms, count, 0.99));
}

static void put_frames(report *r, drawn *d)
{
    static double gpu[FRAMES_MOST], cpu[FRAMES_MOST], all[FRAMES_MOST];
    const double begin = tc_clock_ms();
    tc_camera c = d->camera;
    tc_frame_stats stats;
    GLint bits = 0;
    GLuint query;
    int count = 0;
    bool drew = frame(r, d, &c, true, &stats); /* back where the flight without pixels began */
    r->gl->GetQueryiv(GL_TIME_ELAPSED, GL_QUERY_COUNTER_BITS, &bits);
    r->gl->CreateQueries(GL_TIME_ELAPSED, 1, &query);
    while (drew && count < FRAMES_MOST && (count < FRAMES_LEAST || tc_clock_ms() - begin < 1e3 * r->seconds)) {
        GLuint64 ns = 0;
        c = r->ground->onward(r->map, &c, d->above, d->above / 250);
        r->gl->Finish();
        const double start = tc_clock_ms(), processor = thread_ms();
        r->gl->BeginQuery(GL_TIME_ELAPSED, query);
        drew = frame(r, d, &c, false, &stats);
        r->gl->EndQuery(GL_TIME_ELAPSED);
        cpu[count] = thread_ms() - processor;
        r->gl->GetQueryObjectui64v(query, GL_QUERY_RESULT, &ns); /* waits for it */
        r->gl->Finish();
        all[count] = tc_clock_ms() - start;
        gpu[count++] = 1e-6 * (double)ns;
    }
    r->gl->DeleteQueries(1, &query);
    if (!drew)
        return;
    put(r, FRAMES, count);
    if (bits > 0)
        put_spread(r, GPU_MS, gpu, count);
    put_spread(r, CPU_MS, cpu, count);
    put_spread(r, FRAME_MS, all, count);
}

static tc_camera camera_of(const report *r, const struct view *view, const int size[2])
{
    tc_camera c = {.heading = 0.5, .fov = 60 * DEGREE, .width = size[0], .height = size[1]};
    c.pitch = -view->down[r->body] * DEGREE;
    r->ground->begin(r->map, &c);
    return r->ground->onward(r->map, &c, view->above[r->body], 0);
}

static void measure_case(report *r, drawn *d, const struct view *view)
{
    const double start = tc_clock_ms();
    bool drew = put_still(r, d);
    const double still = tc_clock_ms();
    drew = drew && put_uploads(r, d, view->way[r->body]);
    const double uploads = tc_clock_ms();
    if (drew && r->seconds > 0)
        put_frames(r, d);
    const GLenum fault = r->gl->GetError();
    if (fault != GL_NO_ERROR) {
        char text[64];
        snprintf(text, sizeof text, "the driver's error 0x%x", fault);
        put_failure(r, text);
    }
    printf("%s,%s: picture %.1f s, uploads %.1f s, frames %.1f s\n", r->scheme, r->at, 1e-3 * (still - start),
           1e-3 * (uploads - still), 1e-3 * (tc_clock_ms() - uploads));
    fflush(stdout);
}

/* Whether so many milliseconds more are within the time; else a row says that they are not. */
static bool has_time(report *r, double foreseen)
{
    if (tc_clock_ms() + foreseen <= r->end)
        return true;
    printf("%s,%s: skipped: would take some %.0f s\n", r->scheme, r->at, 1e-3 * foreseen);
    put_row(r, "skipped", "no time", "", NAN, "skipped");
    return false;
}

/* foreseen: milliseconds of the first view. */
static void measure_size(report *r, const int size[2], double foreseen)
{
    drawn d = {.camera = camera_of(r, &views[0], size)};
    bool made = false;
    for (int k = 0; k < VIEWS; k++) {
        const double begin = tc_clock_ms();
        snprintf(r->at, sizeof r->at, "%s,%dx%d", views[k].name, size[0], size[1]);
        if (!has_time(r, foreseen))
            continue;
        if (!made && !(made = make(r, &d)))
            break;
        d.camera = camera_of(r, &views[k], size), d.above = views[k].above[r->body];
        measure_case(r, &d, &views[k]);
        foreseen = (tc_clock_ms() - begin) / 2; /* windows are filled */
    }
    scene_destroy(&d.s);
}

/* ---- The program ------------------------------------------------------------------------------------------------- */

static bool read_arguments(int argc, char **argv, report *r)
{
    const char **places[2] = {&r->scheme, &r->out};
    int words = 0;
    r->seconds = 2, r->within = INFINITY;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0)
            r->quick = true;
        else if (strcmp(argv[i], "--in-software") == 0)
            r->in_software = true;
        else if (strcmp(argv[i], "--software") == 0 && i + 1 < argc)
            r->software = argv[++i];
        else if (strcmp(argv[i], "--seconds") == 0 && i + 1 < argc)
            r->seconds = atof(argv[++i]);
        else if (strcmp(argv[i], "--within") == 0 && i + 1 < argc)
            r->within = atof(argv[++i]);
        else if (argv[i][0] != '-' && words < 2)
            *places[words++] = argv[i];
        else
            return false;
    }
    return words == 2;
}

static bool find_scheme(report *r)
{
    for (r->body = 0; r->body < GROUNDS; r->body++) {
        r->ground = &grounds[r->body];
        r->kind = tc_scheme_named(tc_scheme_lists, r->ground->body, r->scheme);
        if (r->kind)
            return true;
    }
    return false;
}

int main(int argc, char **argv)
{
    static report r;
    char path[4200];
    tc_error error = {.text = ""};
    double foreseen = 0;
    if (!read_arguments(argc, argv, &r) || !find_scheme(&r)) {
        fprintf(stderr,
                "usage: %s SCHEME OUT [--software FOLDER | --in-software] [--seconds S] [--within S] [--quick]\n",
                argv[0]);
        return 2;
    }
    snprintf(path, sizeof path, "%s/pictures", r.out);
    snprintf(r.at, sizeof r.at, ",");
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        printf("%s: %s\n", path, strerror(errno));
    snprintf(path, sizeof path, "%s/%s.csv", r.out, r.scheme);
    if (!(r.csv = fopen(path, "w"))) {
        fprintf(stderr, "%s: cannot be written\n", path);
        return 1;
    }
    fputs("scheme,view,size,figure,value,unit,software,verdict,renderer\n", r.csv);
    if (!(r.context = scene_context()))
        return 3;
    r.gl = tc_context_gl(r.context);
    r.renderer = (const char *)r.gl->GetString(GL_RENDERER);
    if (r.in_software && !tc_gl_software(r.renderer)) {
        printf("%s does not draw in software\n", r.renderer);
        return 3;
    }
    if (r.software)
        read_software(&r);
    r.map = r.ground->open(r.ground->size[!r.quick], r.kind->atlas, &error);
    r.end = tc_clock_ms() + 1e3 * r.within;
    if (r.map)
        for (int k = 0; k < 2; k++) {
            const double begin = tc_clock_ms();
            measure_size(&r, sizes[r.quick][k], foreseen);
            foreseen =
                tc_clock_ms() - begin; /* of the larger one's first view, about what all of the smaller one's are */
        }
    else
        put_failure(&r, error.text);
    tc_map_destroy(r.map);
    tc_context_destroy(r.context);
    return fclose(r.csv) != 0 || r.wrong;
}

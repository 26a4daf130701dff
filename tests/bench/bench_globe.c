/* bench_globe.c - what frames of a planet cost, and how far they are from its finest level.
 *
 * The first table: triangles of CH06's three situations (section 5.2: 16 levels, n_phi 512, m 20), in all levels, with
 * horizon and pixel size looked at, and drawn. The second: error_time.csv's rows; brute force is not measured.
 * Argument: `csv`, for the second one alone. TERRACLIP_DATA: real planets, too. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/core/clipmap/view_error.h"
#include "common/shell/clock.h"
#include "common/shell/planet.h"
#include "spherical/rings_internal.h"
#include "tests/support/measure.h"
#include "tests/support/planet_scene.h"

#define DEGREE (M_PI / 180)
enum { WIDTH = 640, HEIGHT = 480, FRAMES = 9, SITUATIONS = 4 };

static const struct {
    const char *name;
    double altitude; /* above ground */
    double pitch;    /* degrees */
    int paper;       /* triangles drawn by CH06 */
} situation[SITUATIONS] = {
    {"2m", 2, -5, 330000}, {"10km", 10e3, -25, 140000}, {"1000km", 1e6, -50, 0}, {"10000km", 1e7, -90, 100000}};

static tc_camera camera_of(const tc_atlas *atlas, int k)
{
    tc_camera c = {
        .x = 10.3 * DEGREE, .y = 46.4 * DEGREE, .heading = 0.6, .fov = M_PI / 3, .width = WIDTH, .height = HEIGHT};
    double ground;
    if (planet_atlas_height((void *)atlas, c.x, c.y, &ground))
        exit(1);
    c.z = ground + situation[k].altitude;
    c.pitch = situation[k].pitch * DEGREE;
    return c;
}

/* Median time of a frame whose windows are held. */
static double measure(scene *s, const tc_camera *c, tc_frame_stats *stats)
{
    double ms[FRAMES];
    *stats = scene_draw(s, c, true);
    for (int i = 0; i < FRAMES; i++) {
        double start = tc_clock_ms();
        *stats = scene_draw(s, c, false);
        ms[i] = tc_clock_ms() - start;
    }
    return measure_of(ms, FRAMES).median;
}

static void triangles(const tc_context *context, const tc_atlas *atlas)
{
    const tc_scene_options options = {.budget = -1};
    scene s = planet_scene(context, atlas, &(tc_rings_options){.n_phi = 512, .m = 20}, &options);
    const rings_geometry *g = &((const rings_surface *)s.surface)->geometry;
    const int64_t level = 2 * (int64_t)g->m * g->n_phi, disc = (2 * (int64_t)g->fill - 1) * g->n_phi;
    printf("globe: default planet, n_phi %d, m %d, %d levels of %lld triangles and a disc of %lld; CH06's 16 levels: "
           "%lld\n",
           g->n_phi, g->m, g->levels, (long long)level, (long long)disc, (long long)(16 * level + disc));
    printf(
        "| situation | all levels | to the pixel | and from the horizon | drawn | CH06 | draws | levels | frame ms |\n"
        "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
    for (int k = 0; k < SITUATIONS; k++) {
        tc_camera c = camera_of(atlas, k);
        tc_frame_stats stats;
        double ms = measure(&s, &c, &stats);
        printf("| %s | %lld | %lld | %lld | %lld | %d | %d | %d | %.2f |\n", situation[k].name,
               (long long)(g->levels * level + disc), (long long)stats.triangles_unculled,
               (long long)(stats.levels_active * level + disc), (long long)stats.triangles, situation[k].paper,
               stats.draws, stats.levels_active, ms);
    }
    scene_destroy(&s);
}

static void errors(const tc_context *context, const tc_atlas *atlas, const char *name)
{
    static const int n[4] = {128, 256, 512, 1024};
    float *depth = malloc(sizeof *depth * WIDTH * HEIGHT);
    for (int scheme = 0; scheme < 2; scheme++)
        for (int i = 0; i < 4; i++) {
            const tc_scene_options options = {.budget = -1};
            const tc_rings_options rings = {.n_phi = n[i], .m = 20, .scheme = scheme ? TC_RINGS_CH06 : TC_RINGS_EXACT};
            scene s = planet_scene(context, atlas, &rings, &options);
            for (int k = 0; k < SITUATIONS; k++) {
                tc_camera c = camera_of(atlas, k);
                tc_frame_stats stats;
                tc_error_stats e;
                double ms = measure(&s, &c, &stats);
                if (!depth || tc_error_stats_init(&e))
                    exit(99);
                tc_renderer_read(s.renderer, NULL, depth);
                const tc_truth truth = {planet_atlas_height, (void *)atlas};
                if (tc_view_error_add(&c, s.surface->near_plane, atlas->radius, depth, &truth, &e))
                    exit(1);
                printf("%s-%s,%s,%d,%lld,%.3f,,%.4f,%.4f,%.4f\n", name, situation[k].name, s.surface->name, n[i],
                       (long long)stats.triangles, ms, tc_error_stats_rms(&e), tc_error_stats_percentile(&e, 0.999),
                       e.max);
                tc_error_stats_free(&e);
            }
            scene_destroy(&s);
        }
    free(depth);
}

static void data_errors(const tc_context *context, const char *file, const char *name)
{
    const char *folder = getenv("TERRACLIP_DATA");
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "", file);
    if (!folder || !*folder || access(path, R_OK) != 0) {
        fprintf(stderr, "globe: %s: skipped: not in TERRACLIP_DATA\n", file);
        return;
    }
    tc_planet p;
    tc_error error;
    if (tc_planet_load(path, &(tc_source_options){0}, 0, true, 0, &p, &error)) {
        fprintf(stderr, "globe: %s\n", error.text);
        exit(1);
    }
    errors(context, &p.atlas, name);
    tc_planet_close(&p);
}

int main(int argc, char **argv)
{
    tc_context *context = scene_context();
    if (!context)
        return 1;
    tc_atlas planet = planet_made(PLANET_DEFAULT, 2048, 6371000, 4);
    if (argc < 2 || strcmp(argv[1], "csv") != 0)
        triangles(context, &planet);
    puts("scene,scheme,n,triangles,frame_ms,brute_ms,err_rms_px,err_p999_px,err_max_px");
    errors(context, &planet, "default");
    data_errors(context, "moon_gld100_global_5760x2880.tif", "moon");
    data_errors(context, "earth_etopo20_1080x540_f32.tif", "earth");
    tc_atlas_free(&planet);
    tc_context_destroy(context);
    return 0;
}

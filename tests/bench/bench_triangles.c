/* bench_triangles.c - triangles of CH06's situations (section 5.2: 16 levels, n_phi 512, m 20): in all levels of rings,
 * in those whose steps are not below a pixel, in those of them that the horizon does not hide, and drawn once sectors
 * outside the view are left out. triangles.csv. */
#include <stdio.h>

#include "spherical/rings_internal.h"
#include "tests/support/measure.h"
#include "tests/support/measured.h"

static const struct {
    int height; /* as measured_camera() counts them */
    int paper;  /* triangles drawn by CH06 */
} situation[] = {{0, 330000}, {1, 140000}, {3, 100000}};
enum { SITUATIONS = sizeof situation / sizeof *situation };

static void measure_scheme(const tc_context *context, const measured *m, tc_rings_scheme scheme, FILE *csv)
{
    const tc_rings_options rings = {.scheme = scheme, .m = 20};
    scene s = measured_scene(context, m, 512, &rings, &(tc_scene_options){0});
    const rings_geometry *g = &((const rings_surface *)s.surface)->geometry;
    const int64_t level = 2 * (int64_t)g->m * g->n_phi, disc = (2 * (int64_t)g->fill - 1) * g->n_phi;
    printf("triangles: %s: n_phi %d, m %d, %d levels of %lld and a disc of %lld; CH06's 16 levels: %lld\n",
           s.surface->name, g->n_phi, g->m, g->levels, (long long)level, (long long)disc,
           (long long)(16 * level + disc));
    printf("| situation | all levels | to the pixel | and from the horizon | drawn | CH06 | draws | levels |\n"
           "|---|---:|---:|---:|---:|---:|---:|---:|\n");
    for (int k = 0; k < SITUATIONS; k++) {
        tc_camera c = measured_camera(m, situation[k].height, 0, 640, 480);
        tc_frame_stats stats = scene_draw(&s, &c, true);
        long long all = (long long)(g->levels * level + disc),
                  horizon = (long long)(stats.levels_active * level + disc);
        char name[96];
        measured_scene_name(m, situation[k].height, name, sizeof name);
        printf("| %s | %lld | %lld | %lld | %lld | %d | %d | %d |\n", name, all, (long long)stats.triangles_unculled,
               horizon, (long long)stats.triangles, situation[k].paper, stats.draws, stats.levels_active);
        if (csv)
            fprintf(csv, "%s,%s,%lld,%lld,%lld,%lld,%d\n", name, s.surface->name, all,
                    (long long)stats.triangles_unculled, horizon, (long long)stats.triangles, situation[k].paper);
    }
    scene_destroy(&s);
}

int main(int argc, char **argv)
{
    measure_options o = measure_begin(argc, argv, "scene,scheme,all,to_pixel,to_horizon,drawn,paper");
    tc_context *context = scene_context();
    if (!context)
        return 1;
    measured planet = measured_default_planet();
    measure_scheme(context, &planet, TC_RINGS_EXACT, o.csv);
    measure_scheme(context, &planet, TC_RINGS_CH06, o.csv);
    measured_close(&planet);
    tc_context_destroy(context);
    return measure_end(&o);
}

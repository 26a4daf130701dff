/* bench_fidelity.c - whole pictures against pictures cast ray by ray from the finest level: fidelity.csv.
 *
 * Unlit, coloured by height, over a flat background, one sample a pixel, 640 x 480: structural similarity of luminance
 * (1: equal), root mean square difference in levels of 8 bits, and the pixels that show terrain in the cast picture.
 * What is compared is therefore everything: silhouettes, heights and colours. And a terrain of 2048 x 2048 samples
 * under a picture of as many pixels, seen at -40 degrees from 1 km above its tops. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/fidelity.h"
#include "tests/support/measure.h"

typedef struct bench {
    measure_options options;
    tc_context *context;
} bench;

static const uint8_t background[3] = {92, 120, 170};

static void compare(bench *b, const measured *m, const char *name, const tc_camera *c, const cast_picture *truth, int n,
                    const tc_imagery *imagery)
{
    tc_scene_options look = {.background = {background[0], background[1], background[2]}, .imagery = imagery};
    scene s = measured_scene(b->context, m, n, &(tc_rings_options){0}, &look);
    scene_draw(&s, c, true);
    uint8_t *rgb = scene_pixels(&s, c);
    double ssim = picture_ssim(rgb, truth->rgb, c->width, c->height),
           rmse = picture_rmse(rgb, truth->rgb, c->width, c->height);
    printf("%-44s %-8s %4d  SSIM %.5f  RMSE %.3f levels  %lld pixels\n", name, s.surface->name, n, ssim, rmse,
           (long long)truth->covered);
    fflush(stdout);
    if (b->options.csv)
        fprintf(b->options.csv, "%s,%s,%d,%.6f,%.4f,%lld\n", name, s.surface->name, n, ssim, rmse,
                (long long)truth->covered);
    free(rgb);
    scene_destroy(&s);
}

static void measure_terrain(void *context, const measured *m)
{
    bench *b = context;
    static const int flat[] = {63, 127, 255, 511}, round[] = {128, 256, 512, 1024};
    const int *n = m->round ? round : flat;
    caster *c = caster_create(m);
    for (int height = b->options.quick ? 1 : 0; height < MEASURED_HEIGHTS; height += b->options.quick ? 2 : 1) {
        tc_camera camera = measured_camera(m, height, 0, 640, 480);
        char name[96];
        measured_scene_name(m, height, name, sizeof name);
        cast_picture truth = caster_picture(c, &camera, background);
        for (int i = b->options.quick ? 1 : 0; i < (b->options.quick ? 3 : 4); i++)
            compare(b, m, name, &camera, &truth, n[i], NULL);
        cast_picture_free(&truth);
    }
    caster_destroy(c);
}

static void measure_draped(bench *b)
{
    enum { SIDE = 2048 };
    static const int n[] = {127, 255, 511};
    measured m = {.name = "draped", .field = terrain_field(TERRAIN_DEFAULT, SIDE, SIDE, 30, 1)};
    tc_map *map = tc_map_flat(m.field);
    tc_image *image = draped_image(draped_land, SIDE, SIDE), *rays = draped_image(draped_land, SIDE, SIDE);
    tc_imagery *imagery;
    tc_error error;
    if (tc_imagery_create(map, &image, 1, 0, &imagery, &error)) {
        fprintf(stderr, "%s\n", error.text);
        exit(1);
    }
    const tc_terrain_info *info = tc_field_info(m.field);
    const tc_camera c = {.x = 0.5 * (SIDE - 1) * 30,
                         .y = 0.3 * (SIDE - 1) * 30,
                         .z = info->z_base + info->z_max + 1000,
                         .heading = 0.3,
                         .pitch = -40 * 3.14159265358979 / 180,
                         .fov = 75 * 3.14159265358979 / 180,
                         .width = 640,
                         .height = 480};
    caster *cast = caster_create(&m);
    caster_drape(cast, rays);
    cast_picture truth = caster_picture(cast, &c, background);
    for (int i = b->options.quick ? 1 : 0; i < (b->options.quick ? 2 : 3); i++)
        compare(b, &m, "draped-1km", &c, &truth, n[i], imagery);
    cast_picture_free(&truth);
    caster_destroy(cast);
    tc_imagery_destroy(imagery);
    rays->close(rays);
    tc_map_destroy(map);
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv, "scene,scheme,n,ssim,rmse,pixels");
    b.context = scene_context();
    if (!b.context)
        return 1;
    measure_draped(&b);
    measured_all(b.options.quick, measure_terrain, &b);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}

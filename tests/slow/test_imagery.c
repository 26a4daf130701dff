/* test_imagery.c - pictures over terrains and planets: the colour under a pixel is the picture's there; nothing moves
 * in a slow flight but what the picture itself moves. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/field.h"
#include "common/imagery/imagery.h"
#include "common/measure/view_error.h"
#include "tests/support/draped.h"
#include "tests/support/planet_scene.h"

enum { WIDTH = 192, HEIGHT = 144 };

static tc_context *context;

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_context_destroy(context);
    return 0;
}

static tc_imagery *imagery_over(const tc_map *map, tc_image *const *images, int count)
{
    tc_imagery *imagery;
    tc_error error;
    if (tc_imagery_create(map, images, count, 0, &imagery, &error))
        fail_msg("%s", error.text);
    return imagery;
}

static tc_scene_options options_with(const tc_imagery *imagery)
{
    return (tc_scene_options){
        .unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1, .imagery = imagery};
}

/* ---- The colour under a pixel -------------------------------------------------------------------------------------
 */

typedef struct tally {
    int places, off;
    double most; /* levels of 8 bits beyond what half a pixel allows */
} tally;

/* Pixels of a frame against the picture at the places where they saw the ground. */
static void compare(scene *s, const tc_map *map, const tc_camera *c, tc_image *image, int count, test_random *r,
                    tally *t)
{
    const tc_chart *chart = &map->chart[0];
    const bool around = chart->wraps;
    uint8_t *rgb = scene_pixels(s, c);
    float *depth = planet_depth(s, c);
    double w = (double)image->level[0].width, h = (double)image->level[0].height;
    for (int tries = 0; count > 0 && tries < 1000; tries++) {
        int x = (int)test_random_int(r, 1, c->width - 2), y = (int)test_random_int(r, 1, c->height - 2);
        float d = depth[y * c->width + x];
        double p[3], lo[3], hi[3];
        if (d <= 0)
            continue;
        tc_view_unproject(c, s->surface->near_plane, &map->body, x + 0.5, y + 0.5, d, p);
        double px =
            around ? (p[0] / (2 * M_PI) + 0.5) * w : ((p[0] - chart->x0) / chart->dx + 0.5) / (double)map->width * w;
        double py = around ? (0.5 - p[1] / M_PI) * h
                           : ((double)map->height - 0.5 - (p[1] - chart->y0) / chart->dy) / (double)map->height * h;
        draped_bounds(image, px, py, around, lo, hi);
        double most = 0;
        for (int k = 0; k < 3; k++) {
            double found = rgb[3 * (y * c->width + x) + k];
            most = fmax(most, fmax(lo[k] - found, found - hi[k]));
        }
        t->places++, count--;
        t->off += most > 2;
        t->most = fmax(t->most, most);
    }
    free(rgb), free(depth);
}

static void a_plane_has_its_pictures_colours(void **state)
{
    (void)state;
    enum { SIDE = 513 };
    static const int sizes[][2] = {
        {513, 513}, {2048, 2048}, {300, 257}, {1537, 900}}; /* pixels: as fine, finer, coarser */
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        tc_field *field = terrain_field(TERRAIN_SMOOTH, SIDE, SIDE, 30, 3);
        tc_map *map = tc_map_flat(field);
        tc_image *image = draped_image(draped_waves, sizes[k][0], sizes[k][1]);
        tc_imagery *imagery = imagery_over(map, &image, 1);
        tc_scene_options options = options_with(imagery);
        scene s = scene_create(context, field, 63, &options);
        test_random r = {k};
        tally t = {0};
        for (int view = 0; view < 25; view++) {
            const double extent = (SIDE - 1) * 30, pixel = extent / fmax(sizes[k][0], sizes[k][1]);
            tc_camera c = {.x = test_random_range(&r, 0, extent),
                           .y = test_random_range(&r, 0, extent),
                           .heading = test_random_range(&r, 0, 6.28),
                           .pitch = test_random_range(&r, -1.57, -1.1),
                           .fov = 1,
                           .width = WIDTH,
                           .height = HEIGHT};
            double ground;
            assert_int_equal(tc_field_height(field, c.x, c.y, &ground), TC_OK);
            c.z = ground + test_random_range(&r, 10, 0.6 * pixel * WIDTH); /* a pixel is seen at least as large */
            scene_draw(&s, &c, true);
            compare(&s, map, &c, image, 40, &r, &t);
        }
        printf("plane, %d x %d: %d places, %d off, the most %.2f\n", sizes[k][0], sizes[k][1], t.places, t.off, t.most);
        assert_true(t.places >= 900);
        assert_int_equal(t.off, 0);
        scene_destroy(&s);
        tc_imagery_destroy(imagery);
        tc_map_destroy(map);
    }
}

static void a_planet_has_its_pictures_colours(void **state)
{
    (void)state;
    const double radius = 6371e3;
    static const int64_t sizes[] = {1024, 3000, 300};
    tc_map *map = planet_made(PLANET_SMOOTH, 512, radius, 1);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        tc_image *image = draped_image(draped_globe, sizes[k], sizes[k] / 2);
        tc_imagery *imagery = imagery_over(map, &image, 1);
        tc_scene_options options = options_with(imagery);
        scene s = planet_scene(context, map, &(tc_rings_options){.n_phi = 128}, &options);
        test_random r = {k};
        tally t = {0};
        for (int view = 0; view < 40; view++) {
            static const double places[][2] = {{0, 90},        {70, -90}, {180, 10},   {-180, -40},
                                               {179.99, 57.5}, {40, 58},  {-100, 89.9}};
            bool named = view < (int)(sizeof places / sizeof *places);
            double pixel = 2 * M_PI * radius / (double)sizes[k], ground;
            tc_camera c = {.x = named ? places[view][0] * M_PI / 180 : test_random_range(&r, -3.14, 3.14),
                           .y = named ? places[view][1] * M_PI / 180 : asin(test_random_range(&r, -1, 1)),
                           .heading = test_random_range(&r, 0, 6.28),
                           .pitch = test_random_range(&r, -1.57, -1.2),
                           .fov = 0.8,
                           .width = WIDTH,
                           .height = HEIGHT};
            assert_int_equal(tc_map_height(map, c.x, c.y, &ground), TC_OK);
            c.z = fmax(ground, 0) + test_random_range(&r, 1000, 0.25 * pixel * WIDTH * fmax(cos(c.y), 0.05));
            scene_draw(&s, &c, true);
            compare(&s, map, &c, image, 25, &r, &t);
        }
        printf("planet, %d x %d: %d places, %d off, the most %.2f\n", (int)sizes[k], (int)sizes[k] / 2, t.places, t.off,
               t.most);
        assert_true(t.places >= 900);
        assert_int_equal(t.off, 0);
        scene_destroy(&s);
        tc_imagery_destroy(imagery);
    }
    tc_map_destroy(map);
}

/* ---- Where columns come round -------------------------------------------------------------------------------------
 */

/* Light that is greatest at one meridian, and least opposite to it; green, where the first meets the last column. */
static void once_light(double column, double row, double width, double height, double rgba[4])
{
    (void)row, (void)height;
    for (int k = 0; k < 3; k++)
        rgba[k] = pow(0.5 + 0.4 * sin(2 * M_PI * column / width + 1.5 * (k - 1)), 1 / 2.2);
    rgba[3] = 1;
}

/* As shown, over so many columns around the middle one. */
static void once_mean(double column, double columns, double width, double rgb[3])
{
    enum { STEPS = 64 };
    double sum[3] = {0, 0, 0};
    for (int n = 0; n < STEPS; n++) {
        double c[4];
        once_light(column + columns * ((n + 0.5) / STEPS - 0.5), 0, width, 1, c);
        for (int k = 0; k < 3; k++)
            sum[k] += (c[k] <= 0.04045 ? c[k] / 12.92 : pow((c[k] + 0.055) / 1.055, 2.4)) / STEPS;
    }
    for (int k = 0; k < 3; k++)
        rgb[k] = 255 * (sum[k] <= 0.0031308 ? 12.92 * sum[k] : 1.055 * pow(sum[k], 1 / 2.4) - 0.055);
}

/* Colours of levels down to a few texels around the globe are the picture's means there, at 180 degrees as elsewhere,
 * though the levels of the picture have no whole number of columns. */
static void coarse_levels_come_round(void **state)
{
    (void)state;
    static const int64_t widths[] = {1024, 1025, 1057, 999, 1500, 2047};
    tc_map *map = planet_made(PLANET_SMOOTH, 512, 6371e3, 1);
    double worst = 0;
    for (size_t n = 0; n < sizeof widths / sizeof *widths; n++) {
        tc_image *image = draped_image(once_light, widths[n], widths[n] / 2);
        tc_imagery *imagery = imagery_over(map, &image, 1);
        const tc_field *field = tc_imagery_field(imagery, 0);
        const int levels = tc_field_info(field)->levels;
        double texel[2], most = 0, seam = 0;
        tc_imagery_texel(imagery, 0, texel);
        for (int level = 1; level <= levels; level++) {
            const tc_level size = tc_field_level(field, level);
            uint8_t(*rgba)[4] = malloc((size_t)size.width * 4);
            const int64_t row = size.height / 2;
            double step = (double)widths[n] / (double)size.width;
            if (size.width >= 32) {
                assert_int_equal(
                    tc_field_read_samples(field, level, (tc_rect){0, row, size.width, row + 1}, rgba, NULL, size.width),
                    TC_OK);
                for (int64_t i = 0; i < size.width; i++) {
                    double rgb[3], x = map->chart[0].x0 + (double)i * ldexp(texel[0], levels - level), off = 0;
                    once_mean((x / (2 * M_PI) + 0.5) * (double)widths[n], step, (double)widths[n], rgb);
                    for (int k = 0; k < 3; k++)
                        off = fmax(off, fabs(rgba[i][k] - rgb[k]));
                    most = fmax(most, off);
                    if (i < 2 || i >= size.width - 2)
                        seam = fmax(seam, off);
                }
            }
            free(rgba);
        }
        printf("%d columns around: off by at most %.2f of 255, at the seam %.2f\n", (int)widths[n], most, seam);
        worst = fmax(worst, most);
        tc_imagery_destroy(imagery);
    }
    tc_map_destroy(map);
    assert_true(worst <= 2);
}

/* ---- Layers -------------------------------------------------------------------------------------------------------
 */

/* Waves over all, then red over the west half: what is transparent shows the waves, and without them heights. */
static void later_pictures_lie_over_earlier_ones(void **state)
{
    (void)state;
    enum { SIDE = 257 };
    tc_field *field = terrain_field(TERRAIN_SMOOTH, SIDE, SIDE, 30, 3);
    tc_map *map = tc_map_flat(field);
    const tc_camera c = {
        .x = 3840, .y = 3840, .z = 12000, .pitch = -1.5707963, .fov = 0.7, .width = WIDTH, .height = HEIGHT};
    uint8_t *plain = NULL;
    for (int layers = 0; layers < 3; layers++) {
        tc_image *images[2] = {draped_image(draped_waves, 256, 256), draped_image(draped_half, 256, 256)};
        int first = layers == 2 ? 1 : 0, count = layers == 1 ? 2 : 1; /* both, or red alone */
        tc_imagery *imagery = layers ? imagery_over(map, images + first, count) : NULL;
        tc_scene_options options = options_with(imagery);
        scene s = scene_create(context, field, 63, &options);
        scene_draw(&s, &c, true);
        uint8_t *rgb = scene_pixels(&s, &c);
        const uint8_t *west = rgb + 3 * (HEIGHT / 2 * WIDTH + WIDTH / 4),
                      *east = rgb + 3 * (HEIGHT / 2 * WIDTH + 3 * WIDTH / 4);
        if (layers)
            assert_true(west[0] >= 253 && west[1] <= 2 && west[2] <= 2);
        if (layers == 0)
            plain = rgb;
        else if (layers == 1)
            assert_true(abs(east[2] - plain[3 * (HEIGHT / 2 * WIDTH + 3 * WIDTH / 4) + 2]) > 8);
        else
            assert_memory_equal(east, plain + 3 * (HEIGHT / 2 * WIDTH + 3 * WIDTH / 4), 3);
        if (layers)
            free(rgb);
        scene_destroy(&s);
        tc_imagery_destroy(imagery);
        if (layers != 1) /* not taken over */
            for (int k = 0; k < 2; k++)
                if (layers == 0 || k < first)
                    images[k]->close(images[k]);
    }
    free(plain);
    tc_map_destroy(map);
}

static void nowhere_near(tc_image *image, int count, double *x, double *y)
{
    (void)image;
    for (int i = 0; i < count; i++)
        x[i] += 1e6, y[i] = i % 2 ? NAN : y[i] - 1e6;
}

static void a_picture_of_another_place_is_refused(void **state)
{
    (void)state;
    tc_field *field = terrain_field(TERRAIN_SMOOTH, 65, 65, 30, 3);
    tc_map *map = tc_map_flat(field);
    map->georef.known = true, map->georef.transform[1] = 30, map->georef.transform[5] = -30;
    tc_image *image = draped_image(draped_waves, 64, 64);
    image->find = image->locate = nowhere_near;
    tc_imagery *imagery = NULL;
    tc_error error = {0};
    assert_int_equal(tc_imagery_create(map, &image, 1, 0, &imagery, &error), TC_ERR_UNSUPPORTED);
    assert_null(imagery);
    assert_non_null(strstr(error.text, "another place"));
    tc_map_destroy(map);
}

/* ---- Fronts -------------------------------------------------------------------------------------------------------
 */

static void close_nothing(tc_image *image)
{
    (void)image;
}

/* A picture whose levels are greys, each 40 brighter than the finer one. */
static tc_status read_greys(tc_image *image, int level, tc_rect rect, uint8_t (*rgba)[4], ptrdiff_t stride,
                            tc_error *error)
{
    (void)image, (void)error;
    for (int64_t y = 0; y < rect.y1 - rect.y0; y++)
        for (int64_t x = 0; x < rect.x1 - rect.x0; x++) {
            memset(rgba[y * stride + x], 10 + 40 * level, 3);
            rgba[y * stride + x][3] = 255;
        }
    return TC_OK;
}

/* Over level ground: a pixel shows a level of the picture, or two of them mixed, by its distance alone. So from frame
 * to frame it hardly changes, though windows move and grow meanwhile: a front would be a step of up to 40. And the
 * levels are all seen. */
static void a_slow_flight_shows_no_front(void **state)
{
    (void)state;
    enum { SIDE = 1025, PICTURE = 8192, FRAMES = 150, W = 160, H = 100 };
    const double extent = (SIDE - 1) * 30;
    float *z = calloc((size_t)SIDE * SIDE, sizeof *z);
    tc_grid grid = {.width = SIDE, .height = SIDE, .spacing_x = 30, .spacing_y = 30, .z = z};
    tc_field *field;
    assert_int_equal(tc_field_build(&grid, 1, &field, NULL), TC_OK);
    tc_map *map = tc_map_flat(field);
    tc_image greys = {.name = "greys", .read = read_greys, .close = close_nothing, .levels = 6};
    for (int k = 0; k < greys.levels; k++)
        greys.level[k] = (tc_image_size){PICTURE >> k, PICTURE >> k};
    tc_image *image = &greys;
    tc_imagery *imagery = imagery_over(map, &image, 1);
    tc_scene_options options = options_with(imagery);
    options.budget = 2000; /* a few rows */
    scene s = scene_create(context, field, 63, &options);
    tc_camera c = {.x = 0.4 * extent,
                   .y = 0.4 * extent,
                   .z = 60,
                   .heading = 0.6,
                   .pitch = -0.4,
                   .fov = 1.2,
                   .width = W,
                   .height = H};
    int most = 0, moved = 0, darkest = 255, brightest = 0;
    uint8_t *last = NULL;
    for (int frame = 0; frame < FRAMES; frame++) {
        c.x += 0.7, c.y += 1.1;
        tc_frame_stats stats = scene_draw(&s, &c, frame == 0);
        moved += stats.texels_updated > 0;
        uint8_t *rgb = scene_pixels(&s, &c);
        for (int i = 0; i < W * H; i++) {
            const uint8_t *pixel = rgb + 3 * i;
            if (pixel[1] == 0) /* the background */
                continue;
            darkest = pixel[1] < darkest ? pixel[1] : darkest, brightest = pixel[1] > brightest ? pixel[1] : brightest;
            if (last && last[3 * i + 1])
                most = abs(pixel[1] - last[3 * i + 1]) > most ? abs(pixel[1] - last[3 * i + 1]) : most;
        }
        free(last);
        last = rgb;
    }
    printf("slow flight: greys %d to %d, the largest change of a pixel %d; windows moved in %d of %d frames\n", darkest,
           brightest, most, moved, FRAMES);
    assert_true(moved > FRAMES / 8);
    assert_true(brightest - darkest > 100);
    assert_true(most <= 4);
    free(last);
    scene_destroy(&s);
    tc_imagery_destroy(imagery);
    tc_map_destroy(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_has_its_pictures_colours),
        cmocka_unit_test(a_planet_has_its_pictures_colours),
        cmocka_unit_test(coarse_levels_come_round),
        cmocka_unit_test(later_pictures_lie_over_earlier_ones),
        cmocka_unit_test(a_picture_of_another_place_is_refused),
        cmocka_unit_test(a_slow_flight_shows_no_front),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

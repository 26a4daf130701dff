/* test_face_imagery.c - pictures over planets on faces: a texel has the picture's colour at its place, whichever face
 * it is on, also where several meet. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/field.h"
#include "common/imagery/imagery.h"
#include "common/map/map.h"
#include "tests/support/draped.h"

static tc_map *planet(const tc_atlas *atlas)
{
    enum { WIDTH = 256, HEIGHT = 128 };
    tc_grid g = {.width = WIDTH, .height = HEIGHT, .spacing_x = 1, .spacing_y = 1, .z_max = 1};
    const double step = 360.0 / WIDTH, t[6] = {-180, step, 0, 90, 0, -step};
    g.georef = (tc_georef){.known = true, .geographic = true, .semi_major = 6371000};
    memcpy(g.georef.transform, t, sizeof t);
    g.z = calloc(WIDTH * HEIGHT, sizeof *g.z);
    assert_non_null(g.z);
    tc_map *from, *map;
    assert_int_equal(tc_map_build(&g, 6371000, 0, &from, NULL), TC_OK);
    assert_int_equal(tc_map_resample(from, atlas, 0, &map, NULL), TC_OK);
    tc_map_destroy(from);
    return map;
}

static void texels_are_the_pictures(const tc_atlas *atlas, int64_t width)
{
    tc_map *map = planet(atlas);
    tc_image *image = draped_image(draped_globe, width, width / 2),
             *mine = draped_image(draped_globe, width, width / 2);
    tc_imagery *imagery;
    tc_error error;
    if (tc_imagery_create(map, &image, 1, 0, &imagery, &error))
        fail_msg("%s", error.text);
    int off = 0, looked = 0, seen[3] = {0, 0, 0};
    for (int k = 0; k < map->charts; k++) {
        const tc_field *field = tc_imagery_field(imagery, k);
        const tc_chart *c = &map->chart[k];
        int finest = tc_field_info(field)->levels;
        const tc_level size = tc_field_level(field, finest);
        double texel[2];
        tc_imagery_texel(imagery, k, texel);
        assert_true(fabs((double)(size.width - 1) * texel[0] - 1) < 1e-9); /* from side to side */
        uint8_t(*pixel)[4] = malloc((size_t)(size.width * size.height) * sizeof *pixel);
        assert_non_null(pixel);
        assert_int_equal(
            tc_field_read_samples(field, finest, (tc_rect){0, 0, size.width, size.height}, pixel, NULL, size.width),
            TC_OK);
        for (int64_t j = 0; j<size.height; j += j> 1 && j < size.height - 3 ? 3 : 1)
            for (int64_t i = 0; i<size.width; i += i> 1 && i < size.width - 3 ? 3 : 1) {
                double lon, lat, lo[3], hi[3];
                const uint8_t *p = pixel[j * size.width + i];
                c->class->to_place(c, (double)i * texel[0], (double)j * texel[1], &lon, &lat);
                draped_bounds(mine, (lon / (2 * M_PI) + 0.5) * (double)width, (0.5 - lat / M_PI) * (double)width / 2,
                              true, lo, hi);
                bool good = p[3] == 255;
                for (int n = 0; n < 3; n++)
                    good &= p[n] >= lo[n] - 3 && p[n] <= hi[n] + 3, seen[n] = p[n] > seen[n] ? p[n] : seen[n];
                off += !good, looked++;
            }
        free(pixel);
    }
    assert_true(looked > 500 && off == 0 && seen[0] > 100);
    mine->close(mine);
    tc_imagery_destroy(imagery);
    tc_map_destroy(map);
}

static void faces_have_their_colours(void **state)
{
    (void)state;
    texels_are_the_pictures(&tc_atlas_hex, 256);
    texels_are_the_pictures(&tc_atlas_cube, 256);
    texels_are_the_pictures(&tc_atlas_hex, 64); /* coarser than heights */
    texels_are_the_pictures(&tc_atlas_cube, 64);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(faces_have_their_colours)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

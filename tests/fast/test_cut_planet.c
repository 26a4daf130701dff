/* test_cut_planet.c - a packed planet whose file ends with any of its ranks is drawn, caps and all, without a hole. */
#include "tests/support/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/map/map.h"
#include "common/packed/file/envelope.h"
#include "tests/support/globe_holes.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/planet_scene.h"

enum { WIDTH = 256, VIEWS = 24 };
static const double radius = 1737400;

static tc_context *context;

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    tc_context_destroy(context);
    return 0;
}

/* Cliffs everywhere, so that a gap between what two levels or two charts draw would be a hole. */
static uint8_t *packed_planet(size_t *size_ret)
{
    tc_map *map = planet_made(PLANET_CLIFF, WIDTH, radius, 5);
    tc_pack_terrain terrain = {.width = WIDTH,
                               .height = WIDTH / 2,
                               .wraps_x = true,
                               .radius = radius,
                               .spacing_x = map->spacing_x,
                               .spacing_y = map->spacing_y,
                               .georef = map->georef,
                               .area_registered = true,
                               .sample_type = TC_SAMPLE_INT16,
                               .unit = 1};
    const tc_pack_options how = {.mode = TC_PACK_RMS, .error = 200};
    const tc_field *field = map->chart[0].field;
    float *z = packing_read(field, tc_field_info(field)->levels, NULL);
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error error;
    const char *path = made_path("planet.tclip");
    if (tc_packer_create(path, &terrain, &how, &packer, &error) ||
        tc_packer_put(packer, (tc_rect){0, 0, WIDTH, WIDTH / 2}, z, NULL, WIDTH, &error) ||
        tc_packer_finish(packer, &result, &error))
        fail_msg("%s", error.text);
    tc_packer_destroy(packer);
    tc_map_destroy(map);
    free(z);
    return packing_bytes(path, size_ret);
}

static tc_status read_bytes(void *context_of, int64_t offset, void *to, size_t size)
{
    memcpy(to, (const uint8_t *)context_of + offset, size);
    return TC_OK;
}

static void look_around(const tc_map *map, int missing)
{
    const tc_scene_options options = {.unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1};
    scene s = planet_scene(context, map, &(tc_rings_options){.n_phi = 64, .m = 6}, &options);
    test_random r = {7};
    int64_t terrain = 0;
    for (int v = 0; v < VIEWS; v++) {
        tc_camera c = planet_view(&r, map, 100, 3 * radius);
        scene_draw(&s, &c, true);
        const globe_mesh mesh = globe_mesh_of_rings(s.surface, NULL);
        globe_holes h = globe_holes_of(&s, &mesh, &c, NULL, 2000);
        terrain += h.terrain;
        if (h.holes || h.cracks)
            fail_msg("%d levels cut off, view %d: %d holes, %d cracks", missing, v, (int)h.holes, (int)h.cracks);
    }
    assert_true(terrain > VIEWS * 1000);
    scene_destroy(&s);
}

static void whole_at_the_end_of_every_rank(void **state)
{
    (void)state;
    if (!context)
        skip();
    size_t size, head_size;
    uint8_t *bytes = packed_planet(&size);
    tc_envelope *e;
    assert_int_equal(tc_envelope_read("planet", bytes, size, &e, &head_size, NULL), TC_OK);
    int ranks = e->chart[0].container.levels - e->chart[0].container.base;
    assert_true(e->charts == 3 && ranks >= 4 && e->chart[1].container.levels > e->chart[1].container.base);
    for (int missing = 0; missing <= ranks; missing++) {
        size_t part = (size_t)e->rank_end[missing];
        uint8_t *copy = malloc(part); /* so that no byte beyond is read unseen */
        assert_non_null(copy);
        memcpy(copy, bytes, part);
        const tc_byte_source source = {copy, (int64_t)part, read_bytes, NULL};
        tc_map *map;
        tc_error error;
        if (tc_map_open_bytes("planet", &source, NULL, &map, &error))
            fail_msg("%s", error.text);
        assert_int_equal(map->charts, 3);
        for (int n = 0; n < 3; n++)
            assert_int_equal(tc_field_info(map->chart[n].field)->levels, e->chart[n].container.levels - missing);
        look_around(map, missing);
        tc_map_destroy(map);
        free(copy);
    }
    tc_envelope_free(e);
    free(bytes);
}

int main(void)
{
    context = scene_context();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_at_the_end_of_every_rank),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}

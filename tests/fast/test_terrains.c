/* test_terrains.c - default terrains and planets that one test program keeps for the next. */
#include "tests/support/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/loading.h"
#include "tests/support/planet_scene.h"
#include "tests/support/terrains.h"

enum { SIZE = 65 };

static void same(const float *truth, double spacing, uint64_t seed, bool equal)
{
    tc_grid g = terrain_grid(TERRAIN_DEFAULT, SIZE, SIZE, spacing, seed);
    assert_int_equal(memcmp(g.z, truth, sizeof *truth * SIZE * SIZE) == 0, equal);
    assert_true(g.z_min < g.z_max);
    tc_grid_free(&g);
}

/* What is kept is what was made; a file of another length is not taken for one; others have files of their own. */
static void kept(void **state)
{
    (void)state;
    tc_grid truth = terrain_grid(TERRAIN_DEFAULT, SIZE, SIZE, 30, 4);
    setenv("TERRACLIP_TERRAINS", made_folder(), 1);
    same(truth.z, 30, 4, true);
    assert_int_equal(made_folder_count(), 1);
    same(truth.z, 30, 4, true);
    same(truth.z, 30, 5, false);
    same(truth.z, 60, 4, false);
    assert_int_equal(made_folder_count(), 3);

    const char *path = made_path("default-65-30-4");
    cut_file(path, -4);
    same(truth.z, 30, 4, true);
    /* That files are read at all. */
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    assert_int_equal(fwrite(&(float){-1e4f}, sizeof(float), 1, f), 1);
    fclose(f);
    same(truth.z, 30, 4, false);

    setenv("TERRACLIP_TERRAINS", "/nowhere", 1);
    same(truth.z, 30, 4, true);
    unsetenv("TERRACLIP_TERRAINS");
    tc_grid_free(&truth);
}

/* The sum of a default planet's finest heights. */
static double planet_sum(uint64_t seed)
{
    tc_map *atlas = planet_made(PLANET_DEFAULT, 64, 1e6, seed);
    double sum = 0;
    for (int i = 0; i < 64; i++) {
        double z;
        assert_int_equal(planet_atlas_height(atlas, 0.1 * i - 3, 0.04 * i - 1.3, &z), TC_OK);
        sum += z;
    }
    tc_map_destroy(atlas);
    return sum;
}

static void kept_planets(void **state)
{
    (void)state;
    double truth = planet_sum(4);
    setenv("TERRACLIP_TERRAINS", made_folder(), 1);
    int before = made_folder_count();
    assert_true(planet_sum(4) == truth);
    assert_int_equal(made_folder_count(), before + 1);
    assert_true(planet_sum(4) == truth);
    assert_true(planet_sum(5) != truth);
    assert_int_equal(made_folder_count(), before + 2);
    unsetenv("TERRACLIP_TERRAINS");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(kept), cmocka_unit_test(kept_planets)};
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}

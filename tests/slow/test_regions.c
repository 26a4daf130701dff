/* test_regions.c - LH04's region constraints and the windows' content after each of 100,000 random moves.
 *
 * Terrains of several sizes (odd, even, narrow, smaller than a window), window sizes and budgets share the moves.
 * After every move the constraints are checked on all levels and every height held is compared with the pyramid's; so
 * are the morph targets, normals and heights on the terrain's edge in some rows of one level, drawn anew for each move,
 * and all of them at the end. Packed terrains, whose tiles a thread decodes meanwhile, take part, and fields that are
 * never ready for all at once and that fail now and then. */
#include "tests/support/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "planar/square_internal.h"
#include "tests/support/moody.h"
#include "tests/support/regions.h"
#include "tests/support/sweep.h"

enum { MOVES = 100000 };

typedef struct tour {
    terrain_kind kind;
    int64_t width, height;
    int n;
    int64_t budget;
    bool normals;
    int moves;
    bool packed; /* decoded by a thread of its own */
    int tiles;   /* of a level that a field in bad mood has ready at once; 0: another field */
} tour;

static void check(const char *broken, int move)
{
    if (broken) {
        printf("after move %d: %s\n", move, broken);
        fail();
    }
}

/* The terrain packed into a file and opened again; the file's name is gone by then. */
static tc_field *packed(tc_field *p)
{
    char path[] = "/tmp/terraclip-regions-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    int m = tc_field_info(p)->levels;
    tc_level top = tc_field_level(p, m);
    tc_rect all = {0, 0, top.width, top.height};
    float *z = malloc((size_t)(top.width * top.height) * sizeof *z);
    assert_int_equal(tc_field_read(p, m, all, z, NULL, top.width), TC_OK);
    tc_pack_terrain about = {.width = top.width,
                             .height = top.height,
                             .spacing_x = top.spacing_x,
                             .spacing_y = top.spacing_y,
                             .sample_type = TC_SAMPLE_FLOAT32,
                             .unit = 1};
    tc_pack_options how = {.mode = TC_PACK_RMS, .error = 2};
    tc_packer *packer;
    tc_pack_result result;
    assert_int_equal(tc_packer_create(path, &about, &how, &packer, NULL), TC_OK);
    assert_int_equal(tc_packer_put(packer, all, z, NULL, top.width, NULL), TC_OK);
    assert_int_equal(tc_packer_finish(packer, &result, NULL), TC_OK);
    tc_packer_destroy(packer);
    tc_field_destroy(p);
    free(z);
    assert_int_equal(tc_field_open(path, NULL, &p, NULL), TC_OK);
    unlink(path);
    return p;
}

static int64_t run(const tour *t, uint64_t seed)
{
    tc_field *p = terrain_field(t->kind, t->width, t->height, 30, seed);
    if (t->packed)
        p = packed(p);
    moody_field *m = moody_create(p, seed);
    tc_clipmap *c;
    tc_ground_options options = {.n = t->n, .normals = t->normals};
    assert_int_equal(tc_ground_create(t->tiles ? &m->head : p, &options, &c, NULL), TC_OK);
    m->most = t->tiles, m->failing = 0.02;
    bool wait = !t->packed && !t->tiles;
    double now = 0;
    wanderer w = wanderer_start(p, seed);
    test_random r = {seed + 1};
    tc_rect wanted[TC_MAX_LEVELS];
    int64_t samples = 0;
    for (int move = 0; move < sweep_of(t->moves); move++) {
        wanderer_move(&w, p);
        square_viewer viewer = tc_square_viewer(c, &w.camera, true);
        tc_square_wanted(c, tc_clipmap_n(c), &viewer, wanted);
        m->on = true;
        int64_t filled = tc_clipmap_update(c, wanted, t->budget, wait, now += 1. / 60);
        m->on = false;
        moody_work(m);
        assert_true(t->budget < 0 || filled <= t->budget);
        samples += filled;
        check(regions_broken(c), move);
        check(heights_broken(c), move);
        int level = (int)test_random_int(&r, 1, tc_clipmap_levels(c));
        check(content_broken(c, level, test_random_int(&r, 0, 15), t->normals ? 61 : 31), move);
    }
    for (int frames = 0; !tc_clipmap_resident(c); frames++) { /* it catches up once the viewer stands still */
        assert_true(frames < 10000);
        if (t->packed)
            usleep(1000); /* for the thread that decodes */
        m->on = true;
        tc_clipmap_update(c, wanted, t->budget, wait, now += 1. / 60);
        m->on = false;
        moody_work(m);
    }
    assert_int_equal(m->waits, 0);
    if (t->tiles)
        printf("regions: %d reads failed meanwhile\n", m->tries);
    for (int level = 1; level <= tc_clipmap_levels(c); level++)
        check(content_broken(c, level, 0, 1), t->moves);
    tc_clipmap_destroy(c);
    moody_destroy(m);
    tc_field_destroy(p);
    return samples;
}

static void constraints_and_content_hold(void **state)
{
    (void)state;
    const tour tours[] = {
        {TERRAIN_CLIFF, 1025, 1025, 63, 63 * 63, false, 25000, false, 0},
        {TERRAIN_CLIFF, 1500, 1001, 31, -1, false, 20000, false, 0},
        {TERRAIN_CLIFF, 3001, 2000, 63, 1000, false, 20000, false, 0},
        {TERRAIN_SMOOTH, 777, 778, 31, 400, true, 10000, false, 0},
        {TERRAIN_CLIFF, 20, 500, 15, 225, true, 10000, false, 0},
        {TERRAIN_CLIFF, 2, 4099, 15, 60, false, 5000, false, 0},
        {TERRAIN_CLIFF, 9, 13, 31, 1000, true, 4000, false, 0},
        {TERRAIN_CLIFF, 2600, 2600, 255, 255 * 255, true, 6000, false, 0},
        {TERRAIN_SMOOTH, 1500, 1301, 63, 63 * 63, true, 3000, true, 0},
        {TERRAIN_CLIFF, 2600, 700, 31, 800, false, 3000, true, 0},
        {TERRAIN_CLIFF, 1500, 1301, 63, 63 * 63, true, 5000, false, 50},
        {TERRAIN_CLIFF, 1025, 700, 31, -1, false, 8000, false, 12},
        {TERRAIN_SMOOTH, 2600, 2000, 255, 255 * 255, true, 1500, false, 200},
    };
    int moves = 0;
    for (size_t i = 0; i < sizeof tours / sizeof *tours; i++) {
        int64_t samples = run(&tours[i], i + 1);
        moves += sweep_of(tours[i].moves);
        printf("regions: %lldx%lld%s n %d: %d moves, %lld samples read\n", (long long)tours[i].width,
               (long long)tours[i].height,
               tours[i].packed  ? " packed"
               : tours[i].tiles ? " in bad mood"
                                : "",
               tours[i].n, sweep_of(tours[i].moves), (long long)samples);
    }
    assert_true(moves >= sweep_of(MOVES));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(constraints_and_content_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* test_packed_faces.c - planets packed onto the faces of an octahedron or a cube: they come back as they are resampled
 * in memory, to the error asked for; seams are one on all levels, also of what was decoded, and levels are memory's but
 * next to them; a file cut short is a coarser planet; tables of charts and sections that contradict themselves are
 * refused. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "common/base/crc32c.h"
#include "common/base/rect.h"
#include "common/chart/joined.h"
#include "common/map/map.h"
#include "common/packed/file/packed_file.h"
#include "common/packed/read/tile_store.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"

enum { WIDTH = 256, HEIGHT = 128, ATLASES = 2 };
static const tc_atlas *const atlases[ATLASES] = {&tc_atlas_hex, &tc_atlas_cube};
static const double radius = 1737400;

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

/* Rows half a sample from the poles; a void across two seams of either atlas, and one around a pole. */
static tc_grid grid_of(bool voids)
{
    tc_grid g = {.width = WIDTH, .height = HEIGHT, .wraps_x = true, .area_registered = true};
    double step = 180.0 / HEIGHT;
    g.spacing_x = g.spacing_y = step * M_PI / 180 * radius;
    g.georef = (tc_georef){.known = true, .geographic = true, .semi_major = radius};
    const double t[6] = {-180, step, 0, 90, 0, -step};
    memcpy(g.georef.transform, t, sizeof t);
    g.z = malloc(sizeof *g.z * WIDTH * HEIGHT);
    g.voids = voids ? calloc(WIDTH * HEIGHT, 1) : NULL;
    assert_non_null(g.z);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++) {
            double lat = (step * (j + 0.5) - 90) * M_PI / 180, lon = (step * (i + 0.5) - 180) * M_PI / 180;
            double x = cos(lat) * cos(lon), y = cos(lat) * sin(lon), z = sin(lat);
            int at = j * WIDTH + i;
            g.z[at] =
                (float)(2000 * sin(3 * x + 2 * y) + 900 * sin(9 * z + 4 * x) + 70 * sin(30 * y) * cos(25 * x + 15 * z));
            if (voids && (hypot(i - 128, j - 64) < 12 || j > 124))
                g.voids[at] = 1, g.void_count++;
            else
                g.z_min = fminf(g.z_min, g.z[at]), g.z_max = fmaxf(g.z_max, g.z[at]);
        }
    return g;
}

static tc_pack_terrain terrain_of(const tc_grid *g)
{
    return (tc_pack_terrain){.width = g->width,
                             .height = g->height,
                             .wraps_x = true,
                             .radius = radius,
                             .flattening = 0.01,
                             .spacing_x = g->spacing_x,
                             .spacing_y = g->spacing_y,
                             .georef = g->georef,
                             .area_registered = true,
                             .sample_type = TC_SAMPLE_FLOAT32,
                             .unit = 1};
}

static void pack(const char *path, const tc_atlas *atlas, bool voids, tc_pack_options how, tc_pack_result *result)
{
    tc_grid g = grid_of(voids);
    tc_pack_terrain terrain = terrain_of(&g);
    tc_packer *packer = NULL;
    tc_error error = {TC_OK, ""};
    how.atlas = atlas->name;
    tc_status status = tc_packer_create(path, &terrain, &how, &packer, &error);
    if (!status)
        status = tc_packer_put(packer, (tc_rect){0, 0, WIDTH, HEIGHT}, g.z, g.voids, WIDTH, &error);
    if (!status)
        status = tc_packer_finish(packer, result, &error);
    if (status)
        fail_msg("%s", error.text);
    tc_packer_destroy(packer);
    tc_grid_free(&g);
}

static tc_map *open_file(const char *path)
{
    tc_map *map;
    tc_error error;
    if (tc_map_open(path, NULL, &map, &error))
        fail_msg("%s", error.text);
    return map;
}

/* The same in memory. */
static tc_map *made(const tc_atlas *atlas, bool voids)
{
    tc_grid g = grid_of(voids);
    if (voids)
        packing_fill(g.z, g.voids, WIDTH, HEIGHT, true);
    tc_map *from, *map;
    assert_int_equal(tc_map_build(&g, radius, 0, &from, NULL), TC_OK);
    assert_int_equal(tc_map_resample(from, atlas, 0, &map, NULL), TC_OK);
    tc_map_destroy(from);
    return map;
}

/* ---- What comes back --------------------------------------------------------------------------------------------- */

static void faces_come_back(void **state)
{
    (void)state;
    const tc_pack_options ways[] = {{.mode = TC_PACK_RMS, .error = 3},
                                    {.mode = TC_PACK_MAX_ERROR, .error = 2},
                                    {.mode = TC_PACK_RMS, .error = 3, .max_error = 8}};
    for (int k = 0; k < 3 * ATLASES; k++) {
        const tc_atlas *atlas = atlases[k % ATLASES];
        const tc_pack_options *how = &ways[k / ATLASES];
        bool voids = how->max_error > 0;
        tc_pack_result result;
        pack(made_path("a.tclip"), atlas, voids, *how, &result);
        assert_int_equal(made_folder_count(), 1);
        tc_map *file = open_file(made_path("a.tclip")), *truth = made(atlas, voids);
        assert_true(file->charts == atlas->charts && truth->charts == atlas->charts);
        assert_true(file->body.radius == radius && file->body.flattening == 0.01);
        assert_true(file->width == WIDTH && file->height == HEIGHT && file->georef.known && file->area_registered);
        assert_true(fabs(file->grid.x0 - truth->grid.x0) < 1e-12 && fabs(file->grid.dy - truth->grid.dy) < 1e-15);
        double sum = 0, count = 0, most = 0;
        int64_t holes = 0;
        for (int c = 0; c < file->charts; c++) {
            const tc_chart *a = &file->chart[c], *b = &truth->chart[c];
            int m = tc_field_info(b->field)->levels;
            assert_true(a->class == b->class && a->face == c && a->dx == b->dx);
            assert_int_equal(tc_field_info(a->field)->levels, m);
            assert_int_equal(tc_field_info(a->field)->void_count, tc_field_info(b->field)->void_count);
            const tc_level size = tc_field_level(b->field, m);
            assert_float_equal(tc_field_level(a->field, m).spacing_x, size.spacing_x, 1e-6);
            uint8_t *v, *u;
            float *z = packing_read(a->field, m, &v), *y = packing_read(b->field, m, &u);
            for (int64_t i = 0; i < size.width * size.height; i++) {
                assert_int_equal(v[i], u[i]);
                holes += v[i];
                double off = v[i] ? 0 : fabs((double)z[i] - y[i]);
                sum += off * off, count += !v[i], most = fmax(most, off);
            }
            free(z), free(v), free(y), free(u);
        }
        assert_true(voids == (holes > 100));
        double rms = sqrt(sum / count);
        /* On sides a sample stands for several. */
        assert_true(fabs(rms / result.rms - 1) < 0.02 && fabs(most - result.max_error) < 0.01);
        assert_true(how->mode == TC_PACK_RMS ? rms < how->error * 1.001 && rms > 0.9 * how->error
                                             : most < how->error + 1e-3);
        assert_true(how->max_error == 0 || most < how->max_error + 1e-3);
        const tc_container *head = tc_field_container(file->chart[0].field);
        assert_true(result.trip_rms > 0 && result.trip_rms < 6 && result.trip_max < 60); /* of waves 10 samples long */
        assert_true(head->source.rms == result.trip_rms && head->source.max == result.trip_max);
        tc_map_destroy(file), tc_map_destroy(truth);
    }
}

static float sample(const tc_map *map, int chart, int level, int64_t i, int64_t j)
{
    float z;
    assert_int_equal(tc_field_read(map->chart[chart].field, level, (tc_rect){i, j, i + 1, j + 1}, &z, NULL, 1), TC_OK);
    return z;
}

/* The same bits from either side, within ranges, and next to what a neighbour has beyond. */
static void seams_are_one(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_pack_result result;
        pack(made_path("a.tclip"), atlases[a], false, (tc_pack_options){.mode = TC_PACK_RMS, .error = 20}, &result);
        tc_map *map = open_file(made_path("a.tclip"));
        int differ = 0, m = tc_field_info(map->chart[0].field)->levels;
        int64_t finest = tc_field_level(map->chart[0].field, m).width - 1;
        for (int l = m, coarser = 0; (finest >> coarser) << coarser == finest && l > 1; l--, coarser++)
            for (int k = 0; k < map->charts; k++)
                for (int side = 0; side < TC_SIDES; side++) {
                    int64_t cells = finest >> coarser, at = side == TC_EAST || side == TC_NORTH ? cells : 0;
                    const tc_seam s = map->chart[k].class->seam(k, side, cells);
                    bool along_y = side == TC_WEST || side == TC_EAST;
                    for (int64_t t = 0; t <= cells; t++) {
                        int64_t i = along_y ? at : t, j = along_y ? t : at, u = s.m[0] * i + s.m[1] * j + s.dx,
                                v = s.m[2] * i + s.m[3] * j + s.dy;
                        float z = sample(map, k, l, i, j), its = sample(map, s.chart, l, u, v);
                        assert_memory_equal(&z, &its, sizeof z);
                        tc_range r = tc_field_range(map->chart[k].field, l, (tc_rect){i, j, i + 1, j + 1});
                        assert_true(z >= r.lo && z <= r.hi);
                    }
                }
        /* Without that they would not be: each chart's own samples differ. */
        tc_field *own[2];
        const tc_chart *c = &map->chart[1];
        for (int n = 0; n < 2; n++) {
            tc_byte_source source;
            assert_int_equal(tc_file_source(made_path("a.tclip"), &source, NULL), TC_OK);
            assert_int_equal(tc_packed_open_chart("a", &source, n, &(tc_open_options){0}, NULL, &own[n], NULL), TC_OK);
        }
        for (int side = 0; side < TC_SIDES; side++)
            for (int64_t t = 1; t < finest && c->side[side].chart == 0; t++) {
                const tc_seam *s = &c->side[side];
                int64_t at = side == TC_EAST || side == TC_NORTH ? finest : 0;
                int64_t i = side < 2 ? at : t, j = side < 2 ? t : at, u = s->m[0] * i + s->m[1] * j + s->dx,
                        v = s->m[2] * i + s->m[3] * j + s->dy;
                float z, its;
                assert_int_equal(tc_field_read(own[1], m, (tc_rect){i, j, i + 1, j + 1}, &z, NULL, 1), TC_OK);
                assert_int_equal(tc_field_read(own[0], m, (tc_rect){u, v, u + 1, v + 1}, &its, NULL, 1), TC_OK);
                differ += z != its;
            }
        assert_true(differ > 30);
        tc_field_destroy(own[0]), tc_field_destroy(own[1]);
        tc_map_destroy(map);
    }
}

/* Levels are filtered up to a seam, not across: coarser ones are those in memory but next to the sides. There they are
 * off by what a straight line beyond a side takes of the second difference across it, 19/1024 on it and one sample
 * inside and -3/1024 two inside, a third more with the finer levels' share; on the side by what a neighbour's details
 * would add, too (tests/bench/bench_seams.c has real planets). */
static void coarser_levels_are_memorys(void **state)
{
    (void)state;
    enum { BESIDE = 3 }; /* samples inside from which on nothing is left of it */
    static const double most[BESIDE + 1] = {0.09, 0.035, 0.005, 0.0002}; /* of second differences */
    const double error = 0.01;
    for (int a = 0; a < ATLASES; a++) {
        tc_pack_result result;
        pack(made_path("a.tclip"), atlases[a], false, (tc_pack_options){.mode = TC_PACK_RMS, .error = error}, &result);
        tc_map *file = open_file(made_path("a.tclip")), *memory = made(atlases[a], false);
        int m = tc_field_info(memory->chart[0].field)->levels;
        for (int l = m - 1; l >= m - 2; l--) {
            double square[BESIDE + 1] = {0}, count[BESIDE + 1] = {0}, bends = 0, bent = 0;
            for (int k = 0; k < memory->charts; k++) {
                int64_t w = tc_field_level(memory->chart[k].field, l).width, n = w - 1;
                float *z = packing_read(file->chart[k].field, l, NULL),
                      *truth = packing_read(memory->chart[k].field, l, NULL);
                for (int64_t at = 0; at < w * w; at++) {
                    const int64_t i = at % w, j = at / w, d = tc_min64(tc_min64(i, n - i), tc_min64(j, n - j));
                    const double off = (double)z[at] - (double)truth[at];
                    square[tc_min64(d, BESIDE)] += off * off, count[tc_min64(d, BESIDE)]++;
                    if (i > 0 && i < n) {
                        double bend = (double)truth[at - 1] - 2 * (double)truth[at] + (double)truth[at + 1];
                        bends += bend * bend, bent++;
                    }
                }
                free(z), free(truth);
            }
            double bend = sqrt(bends / bent), on = sqrt(square[0] / count[0]);
            for (int d = 0; d <= BESIDE; d++)
                if (sqrt(square[d] / count[d]) > most[d] * bend + 3 * error)
                    fail_msg("%s, m - %d, %d samples inside: %g m off, second differences of %g m", atlases[a]->name,
                             m - l, d, sqrt(square[d] / count[d]), bend);
            assert_true(on > 0.01 * bend); /* once levels are filtered across, docs/design.md is to be changed */
        }
        tc_map_destroy(file), tc_map_destroy(memory);
    }
}

/* Largest steps next to sides still are no less than what is drawn there. */
static void steps_hold_at_seams(void **state)
{
    (void)state;
    tc_pack_result result;
    pack(made_path("a.tclip"), &tc_atlas_cube, false, (tc_pack_options){.mode = TC_PACK_RMS, .error = 20}, &result);
    tc_map *map = open_file(made_path("a.tclip"));
    int m = tc_field_info(map->chart[0].field)->levels;
    for (int k = 0; k < map->charts; k++)
        for (int l = m; l > m - 2; l--) {
            const tc_field *field = map->chart[k].field;
            int64_t cells = tc_field_level(field, l).width - 1;
            float inside = 0, wide = 0;
            for (int64_t t = 1; t < cells; t += 2) { /* in the middle of coarse edges on the side, and next to it */
                double on = fabs((double)sample(map, k, l, 0, t) - 0.5 * ((double)sample(map, k, l - 1, 0, t / 2) +
                                                                          (double)sample(map, k, l - 1, 0, t / 2 + 1)));
                double next =
                    fabs((double)sample(map, k, l, 1, t + 1) - 0.5 * ((double)sample(map, k, l - 1, 0, (t + 1) / 2) +
                                                                      (double)sample(map, k, l - 1, 1, (t + 1) / 2)));
                float step = tc_field_range(field, l, (tc_rect){0, t, 2, t + 2}).step;
                assert_true(on <= (double)step && next <= (double)step);
                inside = fmaxf(inside, tc_field_range(field, l, (tc_rect){cells / 2, t, cells / 2 + 2, t + 2}).step);
                wide = fmaxf(wide, step);
            }
            assert_true(k == 0 ? wide < 2 * inside : wide < inside + 450); /* errors of up to 80 m, on both sides */
        }
    tc_map_destroy(map);
}

/* What is not at hand comes, what lies beyond a side with all that it takes of the neighbours; then it is what is read
 * by who waits. */
static void what_is_asked_for_comes(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_pack_result result;
        pack(made_path("a.tclip"), atlases[a], true, (tc_pack_options){.mode = TC_PACK_RMS, .error = 5}, &result);
        tc_map *map = open_file(made_path("a.tclip")), *again = open_file(made_path("a.tclip"));
        int waited = 0;
        for (int k = 0; k < map->charts; k++) {
            const tc_field *field = map->chart[k].field;
            int m = tc_field_info(field)->levels;
            int64_t side = tc_field_level(field, m).width;
            const tc_rect rects[] = {{-8, -8, 20, 20}, {side - 10, 40, side + 8, 60}, {20, side - 2, 60, side + 8}};
            for (int n = 0; n < 3; n++) {
                enum { ROOM = 40 * 28 };
                float now[ROOM], then[ROOM];
                uint8_t v[ROOM], u[ROOM];
                int64_t w = rects[n].x1 - rects[n].x0;
                size_t count = (size_t)tc_rect_area(rects[n]);
                tc_ready ready;
                while ((ready = tc_field_read_ready(field, m, rects[n], now, v, w, TC_SOON)) == TC_COMING) {
                    waited++;
                    nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
                }
                assert_int_equal(ready, TC_READY);
                assert_int_equal(tc_field_ready(field, m, rects[n], TC_ONLY_ASK), TC_READY);
                assert_int_equal(tc_field_read(again->chart[k].field, m, rects[n], then, u, w), TC_OK);
                assert_memory_equal(now, then, count * sizeof *now);
                assert_memory_equal(v, u, count);
            }
        }
        assert_true(waited > 0);
        tc_map_destroy(map), tc_map_destroy(again);
    }
}

static void threads_make_no_difference(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        uint8_t *bytes[2];
        size_t size[2];
        for (int k = 0; k < 2; k++) {
            tc_pack_result result;
            pack(made_path("a.tclip"), atlases[a], true, (tc_pack_options){.error = 5, .threads = k ? 3 : 1}, &result);
            bytes[k] = packing_bytes(made_path("a.tclip"), &size[k]);
        }
        assert_true(size[0] == size[1] && !memcmp(bytes[0], bytes[1], size[0]));
        free(bytes[0]), free(bytes[1]);
    }
}

/* ---- Parts of a file ----------------------------------------------------------------------------------------------
 */

static tc_status read_memory(void *context, int64_t offset, void *to, size_t size)
{
    memcpy(to, (const uint8_t *)context + offset, size);
    return TC_OK;
}

static tc_status open_part(uint8_t *bytes, size_t size, tc_map **map, tc_error *error)
{
    const tc_byte_source source = {bytes, (int64_t)size, read_memory, NULL};
    *error = (tc_error){TC_OK, ""};
    return tc_map_open_bytes("memory", &source, NULL, map, error);
}

static void a_part_is_a_coarser_planet(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_pack_result result;
        size_t size, head;
        pack(made_path("a.tclip"), atlases[a], false, (tc_pack_options){.error = 5}, &result);
        uint8_t *bytes = packing_bytes(made_path("a.tclip"), &size);
        tc_envelope *e;
        tc_map *whole, *part;
        tc_error error;
        assert_int_equal(tc_envelope_read("memory", bytes, size, &e, &head, NULL), TC_OK);
        assert_int_equal(open_part(bytes, size, &whole, &error), TC_OK);
        int m = tc_field_info(whole->chart[0].field)->levels, opened = 0;
        for (int rank = 0; rank < m; rank++)
            for (int more = -1; more <= 0; more++) {
                int64_t left = e->rank_end[rank] + more;
                int missing = 0;
                while (missing < m - 1 && e->rank_end[missing] > left)
                    missing++;
                tc_status status = open_part(bytes, (size_t)left, &part, &error);
                if (left < (int64_t)head || (WIDTH / 4 >> missing) << missing != WIDTH / 4) {
                    assert_true(status == TC_ERR_FORMAT && strstr(error.text, "cut short"));
                    continue;
                }
                assert_int_equal(status, TC_OK);
                assert_int_equal(tc_field_info(part->chart[0].field)->levels, m - missing);
                assert_true(part->charts == atlases[a]->charts);
                int64_t cells = tc_field_level(part->chart[0].field, m - missing).width - 1;
                for (int k = 0; k < part->charts; k++)
                    for (int64_t i = 0; i <= cells; i += 3) {
                        float z = sample(part, k, m - missing, i, cells - i),
                              its = sample(whole, k, m - missing, i, cells - i);
                        assert_memory_equal(&z, &its, sizeof z);
                    }
                opened++;
                tc_map_destroy(part);
            }
        assert_true(opened >= 4);
        tc_map_destroy(whole);
        tc_envelope_free(e);
        free(bytes);
    }
}

/* ---- Damage ------------------------------------------------------------------------------------------------------ */

/* Of the table of charts and what follows it: offsets in the head. */
enum { CHARTS_AT = 28, SECTIONS_AT = 29, TABLE_AT = 31, ROW = 154, SIZE_AT = 8, SIDES = 66 };

static void seal(uint8_t *bytes, size_t head)
{
    tc_store(bytes + 16, 0, 4);
    tc_store(bytes + 16, tc_crc32c(0, bytes, head), 4);
}

static void contradictions_are_refused(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_pack_result result;
        size_t size, head;
        pack(made_path("a.tclip"), atlases[a], false, (tc_pack_options){.error = 5}, &result);
        uint8_t *bytes = packing_bytes(made_path("a.tclip"), &size), *copy = malloc(size);
        assert_non_null(copy);
        tc_envelope *e;
        tc_map *map;
        tc_error error;
        assert_int_equal(tc_envelope_read("memory", bytes, size, &e, &head, NULL), TC_OK);
        tc_envelope_free(e);
        memcpy(copy, bytes, size);
        seal(copy, head);
        assert_memory_equal(copy, bytes, size); /* the checksum is where it is thought to be */
        const size_t sections = TABLE_AT + (size_t)atlases[a]->charts * ROW;
        const size_t faces = sections + 16; /* behind the body's, which has 8 bytes */
        assert_int_equal(bytes[faces], 3);
        const struct {
            size_t at;
            uint8_t value;
        } wrong[] = {{TABLE_AT, 1},                  /* the first chart is a grid */
                     {TABLE_AT + ROW, a ? 4 : 5},    /* another atlas' face among them */
                     {TABLE_AT + ROW, 0},            /* or a plane */
                     {TABLE_AT + SIDES, 0},          /* a seam leads elsewhere */
                     {TABLE_AT + SIDES + 1, 5},      /* a seam that stretches */
                     {TABLE_AT + ROW + 1 + 7, 0x40}, /* x0 is 2 */
                     {TABLE_AT + 17 + 6, 0x55},      /* another spacing */
                     {faces, 77},                    /* nothing is told of faces */
                     {faces + 4, 80},                /* too little is */
                     {faces + 8 + 7, 0x80 | 0x41},   /* a radius below 0 */
                     {faces + 8 + 8, 0},
                     {faces + 8 + 15, 0xff},      /* no width, one that is none */
                     {faces + 8 + 24 + 15, 0xbf}, /* columns run westwards */
                     {faces + 8 + 72 + 7, 0xff}}; /* an rms that is no number */
        for (size_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
            memcpy(copy, bytes, size);
            if (copy[wrong[n].at] == wrong[n].value)
                copy[wrong[n].at] ^= 1;
            else
                copy[wrong[n].at] = wrong[n].value;
            if (wrong[n].at == faces + 8 + 8) /* of 512 */
                copy[faces + 8 + 9] = 0;
            seal(copy, head);
            tc_status status = open_part(copy, size, &map, &error);
            if (status != TC_ERR_FORMAT && status != TC_ERR_UNSUPPORTED)
                fail_msg("%s: case %d opens", atlases[a]->name, (int)n);
        }
        free(bytes), free(copy);
    }
}

/* ---- What cannot be ---------------------------------------------------------------------------------------------- */

static void others_are_refused(void **state)
{
    (void)state;
    tc_grid g = grid_of(false);
    const tc_pack_terrain whole = terrain_of(&g);
    tc_packer *packer = NULL;
    tc_error error;
    tc_pack_options how = {.error = 5, .atlas = "hex"};
    tc_pack_terrain t = whole;
    t.height -= 4, t.georef.transform[3] += 2 * t.georef.transform[5]; /* two rows from either pole */
    assert_int_equal(tc_packer_create(made_path("b.tclip"), &t, &how, &packer, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "as a whole"));
    t = whole, t.height -= 2, t.georef.transform[3] += t.georef.transform[5]; /* one row short */
    t.georef.transform[3] -= 0.5 * t.georef.transform[5];
    t.radius = t.flattening = 0, t.wraps_x = false;
    assert_int_equal(tc_packer_create(made_path("b.tclip"), &t, &how, &packer, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "a flat terrain"));
    how.mode = TC_PACK_LOSSLESS;
    assert_int_equal(tc_packer_create(made_path("b.tclip"), &whole, &how, &packer, &error), TC_ERR_UNSUPPORTED);
    how = (tc_pack_options){.error = 5, .atlas = "globe"};
    assert_int_equal(tc_packer_create(made_path("b.tclip"), &whole, &how, &packer, &error), TC_ERR_USAGE);
    /* A face without any height. */
    how.atlas = "cube";
    tc_pack_result result;
    assert_int_equal(tc_packer_create(made_path("b.tclip"), &whole, &how, &packer, &error), TC_OK);
    assert_int_equal(tc_packer_put(packer, (tc_rect){0, 0, WIDTH, HEIGHT / 8}, g.z, NULL, WIDTH, &error), TC_OK);
    assert_int_equal(tc_packer_finish(packer, &result, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "all void"));
    tc_packer_destroy(packer);
    tc_grid_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faces_come_back),
        cmocka_unit_test(seams_are_one),
        cmocka_unit_test(coarser_levels_are_memorys),
        cmocka_unit_test(what_is_asked_for_comes),
        cmocka_unit_test(steps_hold_at_seams),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(a_part_is_a_coarser_planet),
        cmocka_unit_test(contradictions_are_refused),
        cmocka_unit_test(others_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}

/* test_packed_planet.c - planets packed: all charts come back as they are made in memory; files cut short are
 * coarser planets, with their caps; heads that contradict themselves are refused. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/map/map.h"
#include "common/base/rect.h"
#include "common/packed/file/packed_file.h"
#include "tests/support/containers.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/terrains.h"

enum { WIDTH = 384, HEIGHT = 193 };
static const double radius = 1737400;

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

/* ---- A planet ---------------------------------------------------------------------------------------------------- */

static float height_at(double lambda, double phi)
{
    double x = cos(phi) * cos(lambda), y = cos(phi) * sin(lambda), z = sin(phi);
    return (float)rint(2000 * sin(3 * x + 2 * y) + 900 * sin(9 * z + 4 * x) + 70 * sin(60 * y) * cos(50 * x + 30 * z));
}

/* Longitudes from 0 on, rows from pole to pole; a void of a cap near the north pole and one on the seam. */
static tc_grid planet_grid(bool voids)
{
    tc_grid g = {.width = WIDTH, .height = HEIGHT, .wraps_x = true, .spacing_x = 1, .spacing_y = 1};
    double step = 180.0 / (HEIGHT - 1), across = 360.0 / WIDTH;
    g.georef = (tc_georef){.known = true, .geographic = true, .semi_major = radius};
    const double t[6] = {-0.5 * across, across, 0, 90 + 0.5 * step, 0, -step};
    memcpy(g.georef.transform, t, sizeof t);
    g.z = malloc(sizeof *g.z * WIDTH * HEIGHT);
    g.voids = voids ? calloc(WIDTH * HEIGHT, 1) : NULL;
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++) {
            int at = j * WIDTH + i, column = i < WIDTH / 2 ? i : WIDTH - i;
            g.z[at] = height_at(across * i * M_PI / 180, (step * j - 90) * M_PI / 180);
            bool is_void = voids && (hypot(column, j - 80) < 12 || (j > 170 && j < 180 && i > 40 && i < 90));
            if (is_void)
                g.voids[at] = 1, g.void_count++;
            else
                g.z_min = fminf(g.z_min, g.z[at]), g.z_max = fmaxf(g.z_max, g.z[at]);
        }
    return g;
}

static tc_pack_terrain planet_terrain(const tc_grid *g)
{
    double metres = radius * M_PI / 180;
    return (tc_pack_terrain){.width = g->width,
                             .height = g->height,
                             .wraps_x = true,
                             .radius = radius,
                             .spacing_x = metres * g->georef.transform[1],
                             .spacing_y = -metres * g->georef.transform[5],
                             .georef = g->georef,
                             .sample_type = TC_SAMPLE_INT16,
                             .unit = 1};
}

static tc_status pack_planet(const char *path, const tc_pack_options *how, bool voids, tc_pack_result *result,
                             tc_error *error)
{
    tc_grid g = planet_grid(voids);
    tc_pack_terrain terrain = planet_terrain(&g);
    tc_packer *packer = NULL;
    tc_status status = tc_packer_create(path, &terrain, how, &packer, error);
    for (int j = HEIGHT - 1; j >= 0 && !status; j--) { /* a row at a time, from the north */
        const uint8_t *v = voids ? g.voids + j * WIDTH : NULL;
        status = tc_packer_put(packer, (tc_rect){0, j, WIDTH, j + 1}, g.z + j * WIDTH, v, WIDTH, error);
    }
    if (!status)
        status = tc_packer_finish(packer, result, error);
    tc_packer_destroy(packer);
    tc_grid_free(&g);
    return status;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* What was promised is for all charts together, whichever is read, and all of it is for one that is read alone. */
static void charts_share_a_cache(void **state)
{
    (void)state;
    enum { BYTES = 1 << 20, CHARTS = 3 };
    tc_pack_result result;
    tc_map *map;
    assert_int_equal(
        pack_planet(made_path("shared.tclip"), &(tc_pack_options){.mode = TC_PACK_LOSSLESS}, true, &result, NULL),
        TC_OK);
    assert_int_equal(tc_map_open(made_path("shared.tclip"), &(tc_open_options){.cache_bytes = BYTES}, &map, NULL),
                     TC_OK);
    assert_int_equal(map->charts, CHARTS);
    size_t held[CHARTS], most = 0;
    for (int chart = 0; chart < CHARTS; chart++) {
        size_t sum = 0;
        const tc_field *field = map->chart[chart].field;
        uint8_t *voids;
        free(packing_read(field, tc_field_info(field)->levels, &voids));
        free(voids);
        for (int k = 0; k < CHARTS; k++)
            sum += held[k] = tc_field_tell(map->chart[k].field).cache_bytes;
        assert_true(sum <= BYTES);
        most = held[chart] > most ? held[chart] : most;
    }
    assert_true(most > BYTES / 2); /* of one */
    tc_map_destroy(map);
}

/* ---- All of it comes back ---------------------------------------------------------------------------------------- */

/* Root mean square and the largest of the errors of a level, over samples that are not void. */
static void compare_level(const tc_field *file, const tc_field *truth, int l, double *rms, double *most)
{
    tc_level level = tc_field_level(truth, l), other = tc_field_level(file, l);
    assert_true(level.width == other.width && level.height == other.height);
    assert_float_equal(level.spacing_y, other.spacing_y, 1e-6 * level.spacing_y);
    uint8_t *v, *u;
    float *z = packing_read(file, l, &v), *y = packing_read(truth, l, &u);
    double sum = 0, count = 0;
    *most = 0;
    for (int64_t i = 0; i < level.width * level.height; i++) {
        assert_int_equal(v[i], u[i]);
        if (v[i])
            continue;
        double e = fabs((double)z[i] - y[i]);
        sum += e * e, count++, *most = fmax(*most, e);
    }
    *rms = sqrt(sum / fmax(count, 1));
    free(z), free(v), free(y), free(u);
}

/* Coarser levels' errors are as declared, but for height units. */
static bool declared_well(const tc_field *file, int l, double rms)
{
    double declared = tc_field_packed_level(file, l).rms;
    return fabs(rms - declared) <= 1e-4 * declared + 2 * tc_field_container(file)->z_unit;
}

static const tc_pack_options ways[] = {
    {.mode = TC_PACK_RMS, .error = 5},
    {.mode = TC_PACK_MAX_ERROR, .error = 12},
    {.mode = TC_PACK_LOSSLESS},
    {.mode = TC_PACK_RMS, .codec = TC_CODEC_LH04, .error = 5},
    {.mode = TC_PACK_RMS, .error = 5, .max_error = 15},
};
enum { WAYS = sizeof ways / sizeof *ways };

static void charts_come_back(void **state)
{
    (void)state;
    const char *path = made_path("a.tclip");
    for (int k = 0; k < 2 * WAYS; k++) {
        const tc_pack_options *how = &ways[k / 2];
        tc_pack_result result;
        tc_error error = {TC_OK, ""};
        tc_map *file, *truth;
        bool voids = k % 2;
        if (pack_planet(path, how, voids, &result, &error))
            fail_msg("%s", error.text);
        assert_int_equal(made_folder_count(), 1);
        tc_grid g = planet_grid(voids);
        if (voids)
            packing_fill(g.z, g.voids, WIDTH, HEIGHT, true);
        assert_int_equal(tc_map_build(&g, radius, 0, &truth, NULL), TC_OK);
        if (tc_map_open(path, NULL, &file, &error))
            fail_msg("%s", error.text);
        assert_true(file->charts == 3 && truth->charts == 3 && file->body.radius == radius);
        for (int c = 0; c < 3; c++) {
            const tc_chart *a = &file->chart[c], *b = &truth->chart[c];
            assert_true(a->class == b->class && a->wraps == b->wraps && a->wraps == (c == 0));
            assert_float_equal(a->x0, b->x0, 1e-12), assert_float_equal(a->y0, b->y0, 1e-12);
            assert_float_equal(a->dx, b->dx, 1e-14), assert_float_equal(a->dy, b->dy, 1e-14);
            int m = tc_field_info(b->field)->levels;
            assert_int_equal(tc_field_info(a->field)->levels, m);
            assert_int_equal(tc_field_info(a->field)->void_count, tc_field_info(b->field)->void_count);
            for (int l = m; l > m - 4; l--) {
                double rms, most, bound = how->mode == TC_PACK_LOSSLESS ? c ? 0.5 : 0 : how->error;
                compare_level(a->field, b->field, l, &rms, &most);
                if (how->mode == TC_PACK_RMS && l == m)
                    assert_true(rms <= bound * (1 + 1e-6) && rms > 0.9 * bound &&
                                (how->max_error == 0 || most <= how->max_error + 1e-3));
                else if (l == m)
                    assert_true(most <= bound + 1e-3);
                else
                    assert_true(tc_field_wraps(a->field, l) == (c == 0) && declared_well(a->field, l, rms));
            }
        }
        /* The flat map is chart 0. */
        tc_field *flat;
        assert_int_equal(tc_field_open(path, NULL, &flat, NULL), TC_OK);
        const tc_packed_info *info = tc_field_packed_info(flat);
        assert_true(info->charts == 3 && info->terrain.radius == radius && info->version == 3 && !info->cut_short);
        assert_true(tc_field_info(flat)->wraps_x && info->bytes == result.bytes);
        size_t size;
        free(packing_bytes(path, &size));
        assert_int_equal(size, result.bytes);
        tc_field_destroy(flat);
        tc_map_destroy(file), tc_map_destroy(truth);
    }
}

/* The void on the seam is filled from both sides. */
static void filled_voids_meet_at_the_seam(void **state)
{
    (void)state;
    const tc_pack_options how = {.mode = TC_PACK_MAX_ERROR, .error = 1};
    tc_pack_result result;
    tc_field *file;
    assert_int_equal(pack_planet(made_path("a.tclip"), &how, true, &result, NULL), TC_OK);
    assert_int_equal(tc_field_open(made_path("a.tclip"), NULL, &file, NULL), TC_OK);
    int m = tc_field_info(file)->levels;
    double inner = 0, seam = 0;
    for (int64_t j = 68; j < 92; j++) {
        float z[8];
        assert_int_equal(tc_field_read(file, m, (tc_rect){-4, j, 4, j + 1}, z, NULL, 8), TC_OK);
        for (int i = 0; i < 7; i++)
            *(i == 3 ? &seam : &inner) = fmax(i == 3 ? seam : inner, fabs((double)z[i + 1] - z[i]));
    }
    assert_true(seam < 1.5 * inner);
    tc_field_destroy(file);
}

/* A cap without any height, and maps that end before the poles: chart 0 is all there is. */
static void planets_without_caps(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const tc_pack_options how = {.error = 5};
        tc_grid g = planet_grid(false);
        tc_pack_terrain terrain = planet_terrain(&g);
        int64_t rows = k ? 100 : HEIGHT, first = k ? 40 : 0, valid = k ? rows : 120;
        terrain.height = rows;
        terrain.georef.transform[3] += (double)(HEIGHT - rows - first) * terrain.georef.transform[5];
        tc_packer *packer = NULL;
        tc_pack_result result;
        assert_int_equal(tc_packer_create(made_path("a.tclip"), &terrain, &how, &packer, NULL), TC_OK);
        assert_int_equal(tc_packer_put(packer, (tc_rect){0, 0, WIDTH, valid}, g.z + first * WIDTH, NULL, WIDTH, NULL),
                         TC_OK);
        assert_int_equal(tc_packer_finish(packer, &result, NULL), TC_OK);
        tc_packer_destroy(packer);
        tc_grid_free(&g);
        tc_map *atlas;
        assert_int_equal(tc_map_open(made_path("a.tclip"), NULL, &atlas, NULL), TC_OK);
        const tc_packed_info *info = tc_field_packed_info(atlas->chart[0].field);
        assert_true(atlas->charts == 1 && info->charts == 1 && atlas->chart[0].wraps && info->terrain.radius == radius);
        assert_int_equal(result.voids, (rows - valid) * WIDTH);
        tc_map_destroy(atlas);
    }
}

static void threads_make_no_difference(void **state)
{
    (void)state;
    uint8_t *bytes[2];
    size_t size[2];
    for (int k = 0; k < 2; k++) {
        tc_pack_options how = {.error = 5, .threads = k ? 3 : 1};
        tc_pack_result result;
        assert_int_equal(pack_planet(made_path("a.tclip"), &how, true, &result, NULL), TC_OK);
        bytes[k] = packing_bytes(made_path("a.tclip"), &size[k]);
    }
    assert_true(size[0] == size[1] && !memcmp(bytes[0], bytes[1], size[0]));
    free(bytes[0]), free(bytes[1]);
}

/* ---- Parts of a file ----------------------------------------------------------------------------------------------
 */

typedef struct memory {
    const uint8_t *bytes;
    int closed;
} memory;

static tc_status read_memory(void *context, int64_t offset, void *to, size_t size)
{
    memcpy(to, ((memory *)context)->bytes + offset, size);
    return TC_OK;
}

static void close_memory(void *context)
{
    ((memory *)context)->closed++;
}

/* Opens the first `size` bytes; whatever comes of it, the source is closed once in the end. */
static tc_status open_part(const uint8_t *bytes, size_t size, tc_map **atlas, tc_error *error)
{
    static memory m;
    m = (memory){bytes, 0};
    tc_byte_source source = {&m, (int64_t)size, read_memory, close_memory};
    *error = (tc_error){TC_OK, ""};
    tc_status status = tc_map_open_bytes("memory", &source, NULL, atlas, error);
    assert_int_equal(m.closed, status != TC_OK);
    assert_true((status == TC_OK) == (*error->text == 0));
    return status;
}

static uint8_t *packed_planet(size_t *size_ret)
{
    const tc_pack_options how = {.error = 5};
    tc_pack_result result;
    assert_int_equal(pack_planet(made_path("a.tclip"), &how, true, &result, NULL), TC_OK);
    return packing_bytes(made_path("a.tclip"), size_ret);
}

static tc_envelope *head_of(const uint8_t *bytes, size_t size)
{
    tc_envelope *e;
    size_t head;
    assert_int_equal(tc_envelope_read("memory", bytes, size, &e, &head, NULL), TC_OK);
    return e;
}

/* All levels of a chart that are there are those of the whole file. */
static void check_coarser(const tc_field *part, const tc_field *whole)
{
    for (int l = 1; l <= tc_field_info(part)->levels; l++) {
        tc_level level = tc_field_level(part, l), same = tc_field_level(whole, l);
        assert_true(level.width == same.width && level.height == same.height && level.spacing_y == same.spacing_y);
        uint8_t *v, *u;
        float *z = packing_read(part, l, &v), *y = packing_read(whole, l, &u);
        size_t count = (size_t)(level.width * level.height);
        assert_memory_equal(z, y, count * sizeof *z), assert_memory_equal(v, u, count);
        free(z), free(v), free(y), free(u);
    }
    assert_int_equal(tc_field_tell(part).damaged, 0);
}

/* The first `part` bytes: nothing below the head, above it a planet of all charts, as fine as the last whole rank. */
static void check_part(const uint8_t *bytes, size_t size, size_t part, const tc_envelope *e, const tc_map *whole,
                       bool heights)
{
    uint8_t *copy = malloc(part + 1); /* that no byte beyond is read */
    memcpy(copy, bytes, part);
    tc_map *atlas;
    tc_error error;
    tc_status status = open_part(copy, part, &atlas, &error);
    assert_int_equal(status, part >= tc_load(bytes + TC_HEAD_SIZE_AT, 4) ? TC_OK : TC_ERR_FORMAT);
    int missing = 0;
    while (!status && e->rank_end[missing] > (int64_t)part)
        missing++;
    if (!status) {
        assert_int_equal(atlas->charts, 3);
        for (int n = 0; n < 3; n++) {
            const tc_chart *c = &atlas->chart[n], *finest = &whole->chart[n];
            const tc_packed_info *info = tc_field_packed_info(c->field);
            assert_int_equal(info->levels_missing, missing);
            assert_int_equal(tc_field_info(c->field)->levels, tc_field_info(finest->field)->levels - missing);
            assert_true(info->cut_short == (part < size) && info->charts == 3);
            assert_true(c->x0 == finest->x0 && c->y0 == finest->y0 && c->class == finest->class);
            assert_true(c->dx == ldexp(finest->dx, missing) && c->dy == ldexp(finest->dy, missing));
            if (heights)
                check_coarser(c->field, finest->field);
        }
        tc_map_destroy(atlas);
    }
    free(copy);
}

static void files_cut_short_are_coarser_planets(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = packed_planet(&size);
    tc_envelope *e = head_of(bytes, size);
    tc_map *whole;
    tc_error error;
    assert_int_equal(open_part(bytes, size, &whole, &error), TC_OK);
    size_t head = (size_t)tc_load(bytes + TC_HEAD_SIZE_AT, 4);
    int64_t errors = 0; /* bytes at the end, without which levels are whole */
    for (int n = 0; n < e->charts; n++)
        errors += e->chart[n].container.error_bytes;
    assert_true(errors > 0 && e->rank_end[0] == (int64_t)size - errors);
    assert_true(e->rank_end[TC_MAX_FIELD_LEVELS - 1] == (int64_t)head);
    /* Caps have fewer levels that are not in the head than the planet, or this would not test what it does. */
    assert_true(e->chart[1].container.levels - e->chart[1].container.base <
                e->chart[0].container.levels - e->chart[0].container.base);
    for (size_t part = 0; part <= size; part += part + 97 < size ? 97 : 1)
        check_part(bytes, size, part, e, whole, false);
    check_part(bytes, size, head, e, whole, true);
    for (int n = 0; n < 3; n++) /* at the end of every level of every chart, of which the last ends a rank */
        for (int l = e->chart[n].container.base; l < e->chart[n].container.levels; l++)
            for (int off = -1; off <= 1; off++) {
                size_t at = (size_t)(e->chart[n].container.record[l].end + off);
                if (at <= size)
                    check_part(bytes, size, at, e, whole, off == 0);
            }
    tc_map_destroy(whole);
    tc_envelope_free(e);
    free(bytes);
}

/* Heads that a first read does not get whole: a long coordinate system. */
static void long_heads_are_read_whole(void **state)
{
    (void)state;
    enum { LENGTH = 30000 };
    tc_grid g = planet_grid(false);
    tc_pack_terrain terrain = planet_terrain(&g);
    const tc_pack_options how = {.error = 5};
    tc_packer *packer = NULL;
    tc_pack_result result;
    terrain.georef.crs_wkt = memset(calloc(LENGTH + 1, 1), 'x', LENGTH);
    assert_int_equal(tc_packer_create(made_path("a.tclip"), &terrain, &how, &packer, NULL), TC_OK);
    assert_int_equal(tc_packer_put(packer, (tc_rect){0, 0, WIDTH, HEIGHT}, g.z, NULL, WIDTH, NULL), TC_OK);
    assert_int_equal(tc_packer_finish(packer, &result, NULL), TC_OK);
    tc_packer_destroy(packer);
    free(terrain.georef.crs_wkt);
    tc_grid_free(&g);
    size_t size;
    uint8_t *bytes = packing_bytes(made_path("a.tclip"), &size);
    tc_envelope *e = head_of(bytes, size);
    size_t head = (size_t)tc_load(bytes + TC_HEAD_SIZE_AT, 4);
    assert_true(head > LENGTH);
    tc_map *whole;
    tc_error error;
    assert_int_equal(open_part(bytes, size, &whole, &error), TC_OK);
    assert_int_equal(strlen(tc_field_packed_info(whole->chart[0].field)->terrain.georef.crs_wkt), LENGTH);
    const size_t parts[] = {16 << 10, (16 << 10) + 1, head - 1, head, (size_t)e->rank_end[2], size};
    for (int k = 0; k < 6; k++)
        check_part(bytes, size, parts[k], e, whole, true);
    tc_map_destroy(whole);
    tc_envelope_free(e);
    free(bytes);
}

/* ---- Heads --------------------------------------------------------------------------------------------------------
 */

/* Puts a number at an offset of the head and gives all heads their checksums; then back. */
static tc_status try_u64(const uint8_t *bytes, size_t size, size_t at, uint64_t v, int count)
{
    uint8_t *head = malloc(size);
    memcpy(head, bytes, size);
    tc_store(head + at, v, count);
    envelope_sign(head);
    tc_map *atlas;
    tc_error error;
    tc_status status = open_part(head, size, &atlas, &error);
    assert_true(!strchr(error.text, '\n'));
    if (!status)
        tc_map_destroy(atlas);
    free(head);
    return status;
}

static tc_status try_f64(const uint8_t *bytes, size_t size, size_t at, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, 8);
    return try_u64(bytes, size, at, bits, 8);
}

/* Of the planet within the file; test_envelope.c has the table of charts. */
static void heads_that_lie_are_refused(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = packed_planet(&size);
    size_t first = envelope_head_at(bytes, 0), radius_at = envelope_head_at(bytes, 1) - 8;
    static const double radii[] = {0, -1, NAN, INFINITY, -INFINITY};
    for (int k = 0; k < 5; k++)
        assert_int_equal(try_f64(bytes, size, radius_at, radii[k]), TC_ERR_FORMAT);
    assert_int_equal(try_f64(bytes, size, radius_at, 1e6), TC_OK);
    assert_int_equal(try_f64(bytes, size, radius_at, 1), TC_ERR_FORMAT); /* less than its relief */
    assert_int_equal(try_u64(bytes, size, 8, 1, 4), TC_ERR_UNSUPPORTED); /* version */
    assert_int_equal(try_u64(bytes, size, 8, 2, 4), TC_ERR_UNSUPPORTED); /* whose atlas would be another one */
    assert_int_equal(try_u64(bytes, size, 8, 4, 4), TC_ERR_UNSUPPORTED);
    assert_int_equal(try_u64(bytes, size, first + 28, 2, 1), TC_ERR_UNSUPPORTED); /* atlas */
    assert_int_equal(try_u64(bytes, size, first + 28, 0, 1), TC_ERR_FORMAT);
    assert_int_equal(try_u64(bytes, size, first + 30, 0, 1), TC_ERR_FORMAT); /* wraps in x */
    assert_int_equal(try_u64(bytes, size, first + 30, 2, 1), TC_ERR_FORMAT);
    assert_int_equal(try_u64(bytes, size, first + 117, 0, 1), TC_ERR_FORMAT); /* georeference */
    assert_int_equal(try_u64(bytes, size, first + 118, 0, 1), TC_ERR_FORMAT);
    const double t[6] = {1e5, 0.9, 1e-9, 95, 1e-9, -0.9};
    for (size_t k = 0; k < 6; k++) {
        assert_int_equal(try_f64(bytes, size, first + 119 + 8 * k, t[k]), TC_ERR_FORMAT);
        assert_int_equal(try_f64(bytes, size, first + 119 + 8 * k, NAN), TC_ERR_FORMAT);
    }
    free(bytes);
}

/* A cap that is well made but of another size than the planet needs. */
static void caps_must_reach_the_planet(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = packed_planet(&size);
    static const int64_t sides[] = {3, 63, 451, 1001};
    for (int k = 0; k < 4; k++) {
        test_random r = {7};
        tc_envelope *e = head_of(bytes, size);
        tc_container *cap = &e->chart[1 + k % 2].container;
        double z_base = cap->info.terrain.z_base;
        tc_container_free(cap);
        *cap = container_make_cap(&r, sides[k], z_base);
        tc_byte_writer w = envelope_bytes(e, true);
        uint8_t *all = calloc((size_t)e->bytes, 1);
        memcpy(all, w.bytes, w.size);
        tc_map *atlas;
        tc_error error;
        assert_int_equal(open_part(all, (size_t)e->bytes, &atlas, &error), TC_ERR_FORMAT);
        assert_non_null(strstr(error.text, "does not fit"));
        free(all), free(w.bytes);
        tc_envelope_free(e);
    }
    free(bytes);
}

static void flat_terrains_are_no_planets(void **state)
{
    (void)state;
    packing p = {.width = 60, .height = 50, .error = 1};
    tc_pack_result result;
    tc_map *atlas;
    tc_error error;
    assert_int_equal(packing_write(&p, made_path("a.tclip"), &result, NULL), TC_OK);
    assert_int_equal(tc_map_open(made_path("a.tclip"), NULL, &atlas, &error), TC_OK);
    assert_true(tc_map_radius(atlas) == 0 && tc_map_charts(atlas) == 1 && atlas->chart[0].class == &tc_chart_plane);
    bool gap;
    assert_int_equal(tc_map_onto_globe(atlas, "a.tclip", tc_body_of(1e6), &gap, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "flat"));
    tc_map_destroy(atlas);
    assert_int_equal(tc_map_open(made_path("none.tclip"), NULL, &atlas, &error), TC_ERR_IO);
}

static void planets_need_a_georeference(void **state)
{
    (void)state;
    tc_grid g = planet_grid(false);
    const tc_pack_options how = {.error = 5};
    for (int k = 0; k < 6; k++) {
        tc_pack_terrain t = planet_terrain(&g);
        tc_packer *packer = NULL;
        tc_error error;
        switch (k) {
        case 0: t.radius = -1; break;
        case 1: t.radius = NAN; break;
        case 2: t.georef.known = false; break;
        case 3: t.georef.geographic = false; break;
        case 4: t.wraps_x = false; break;
        default: t.georef.transform[3] = 95;
        }
        assert_int_equal(tc_packer_create(made_path("a.tclip"), &t, &how, &packer, &error), TC_ERR_USAGE);
        assert_null(packer);
    }
    tc_grid_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charts_come_back),
        cmocka_unit_test(charts_share_a_cache),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(planets_without_caps),
        cmocka_unit_test(filled_voids_meet_at_the_seam),
        cmocka_unit_test(files_cut_short_are_coarser_planets),
        cmocka_unit_test(long_heads_are_read_whole),
        cmocka_unit_test(caps_must_reach_the_planet),
        cmocka_unit_test(heads_that_lie_are_refused),
        cmocka_unit_test(flat_terrains_are_no_planets),
        cmocka_unit_test(planets_need_a_georeference),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}

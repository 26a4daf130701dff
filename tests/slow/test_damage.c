/* test_damage.c - damaged packed files, made one after the other from a few intact ones: whatever is damaged is said to
 * be, and what is read is either right or the coarser level's; nothing crashes, hangs, or takes more memory than an
 * intact file of the size.
 *
 * The Makefile links this test with --wrap for the functions that allocate, so that the largest piece and the sum are
 * known. */
#include "tests/support/test.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "common/base/crc32c.h"
#include "common/packed/file/envelope.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/terrains.h"
#include "tests/wrapped/allocations.h"

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

enum { MOST_PIECE = 20 << 20, MOST_BYTES = 64 << 20 }; /* what opening and reading small files may take */

/* ---- Intact files ------------------------------------------------------------------------------------------------ */

enum { KINDS = 8, TILE = 128 };

static const packing kinds[KINDS] = {
    {.width = 300, .height = 200, .kind = PACKING_HILLS, .error = 2, .type = TC_SAMPLE_FLOAT32},
    {.width = 290, .height = 170, .kind = PACKING_HILLS, .voids = PACKING_LAKES, .error = 2, .type = TC_SAMPLE_FLOAT32},
    {.width = 200, .height = 140, .kind = PACKING_INTEGERS, .mode = TC_PACK_MAX_ERROR, .error = 12, .type = 3},
    {.width = 150,
     .height = 135,
     .kind = PACKING_INTEGERS,
     .voids = PACKING_LAKES,
     .mode = TC_PACK_LOSSLESS,
     .type = 3},
    {.width = 270, .height = 150, .kind = PACKING_HILLS, .error = 2, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_FLOAT32},
    {.width = 288, .height = 150, .voids = PACKING_LAKES, .error = 2, .type = TC_SAMPLE_FLOAT32, .wraps = true},
    {.width = 160, .height = 135, .kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS, .type = 3, .wraps = true},
    {.width = 272, .height = 150, .error = 2, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_FLOAT32, .wraps = true},
};

typedef struct intact {
    uint8_t *bytes;
    size_t size;
    tc_container c; /* its head */
    int levels;
    float *z[TC_MAX_FIELD_LEVELS]; /* [l - 1] */
    uint8_t *v[TC_MAX_FIELD_LEVELS];
} intact;

static intact files[KINDS];
static int cases;

static int set_up(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        intact *f = &files[k];
        tc_pack_result result;
        tc_error error;
        size_t needed;
        tc_envelope *e;
        tc_field *p;
        if (packing_write(&kinds[k], made_path("intact"), &result, &error) ||
            !(f->bytes = packing_bytes(made_path("intact"), &f->size)) ||
            tc_envelope_read("intact", f->bytes, f->size, &e, &needed, &error) ||
            tc_field_open(made_path("intact"), NULL, &p, &error))
            return puts(error.text), -1;
        f->c = e->chart[0].container;
        e->chart[0].container = (tc_container){0};
        tc_envelope_free(e);
        f->levels = tc_field_info(p)->levels;
        for (int l = 1; l <= f->levels; l++)
            f->z[l - 1] = packing_read(p, l, &f->v[l - 1]);
        tc_field_destroy(p);
        printf("kind %d: %zu bytes, head %d, levels %d to %d, coder %d\n", k, f->size,
               (int)f->c.record[f->c.base].begin, f->c.base, f->levels, f->c.record[f->levels - 1].coder);
    }
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        for (int l = 0; l < files[k].levels; l++)
            free(files[k].z[l]), free(files[k].v[l]);
        tc_container_free(&files[k].c);
        free(files[k].bytes);
    }
    made_folder_remove();
    printf("%d damaged files\n", cases);
    return 0;
}

/* ---- Reading what may be damaged -----------------------------------------------------------------------------------
 */

typedef struct outcome {
    tc_status opened, read; /* read: the last that is not TC_OK */
    int levels, missing;
    int64_t damaged;
    int64_t differing;             /* samples of all levels read whole that differ from the intact file's */
    tc_rect where;                 /* of the finest level: which */
    float *z[TC_MAX_FIELD_LEVELS]; /* where asked for */
} outcome;

static void add_point(tc_rect *r, int64_t x, int64_t y)
{
    *r = tc_rect_empty(*r)
             ? (tc_rect){x, y, x + 1, y + 1}
             : (tc_rect){tc_min64(r->x0, x), tc_min64(r->y0, y), tc_max64(r->x1, x + 1), tc_max64(r->y1, y + 1)};
}

static void read_level(const tc_field *p, int l, const intact *of, outcome *o, bool keep)
{
    enum { WHOLE = 1024, PART = 50 };
    tc_level level = tc_field_level(p, l);
    tc_rect all = {0, 0, level.width, level.height}, r = all;
    if (level.width > WHOLE || level.height > WHOLE)
        r = (tc_rect){tc_max64(0, all.x1 - PART), tc_max64(0, all.y1 - PART), all.x1, all.y1};
    int64_t w = r.x1 - r.x0, samples = tc_rect_area(r);
    float *z = __real_malloc((size_t)samples * sizeof *z);
    uint8_t *v = __real_malloc((size_t)samples);
    assert_true(z && v);
    tc_range range = tc_field_range(p, l, r);
    assert_true(isfinite(range.lo) && isfinite(range.hi) && range.lo <= range.hi);
    tc_status status = tc_field_read(p, l, r, z, v, w);
    o->read = status ? status : o->read;
    const tc_level *same = &of->c.level[l - 1];
    bool comparable = !status && l <= of->levels && same->width == level.width && same->height == level.height;
    if (!status && !comparable)
        o->differing += samples;
    for (int64_t i = 0; i < samples && !status; i++) {
        assert_true(isfinite(z[i]) && v[i] <= 1);
        if (comparable && (z[i] != of->z[l - 1][i] || v[i] != of->v[l - 1][i])) {
            o->differing++;
            if (l == of->levels)
                add_point(&o->where, i % w, i / w);
        }
    }
    if (keep && !status)
        o->z[l - 1] = z;
    else
        __real_free(z);
    __real_free(v);
}

/* Opens, asks and reads; and sees to it that memory is what it should be. Ends by SIGALRM where it hangs. */
static outcome look_at(const char *path, const intact *of, bool keep)
{
    outcome o = {0};
    tc_field *p = NULL;
    tc_error error = {TC_OK, ""};
    long long before = allocations.most_live = allocations.live;
    allocations.largest = 0;
    cases++;
    alarm(20);
    o.opened = tc_field_open(path, &(tc_open_options){.cache_bytes = cases % 3 == 0}, &p, &error);
    if (o.opened) {
        assert_true(!p && error.status == o.opened && error.text[0] && !strchr(error.text, '\n'));
    } else {
        o.levels = tc_field_info(p)->levels, o.missing = tc_field_packed_info(p)->levels_missing;
        for (int l = o.levels; l >= 1; l--) {
            read_level(p, l, of, &o, keep);
            tc_field_packed_level(p, l);
        }
        o.damaged = tc_field_tell(p).damaged;
        assert_true(tc_field_tell(p).bytes < MOST_BYTES);
        tc_field_destroy(p);
    }
    alarm(0);
    assert_true(allocations.largest < MOST_PIECE && allocations.most_live - before < MOST_BYTES);
    assert_true(allocations.live <= before);
    return o;
}

static void forget(outcome *o)
{
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        __real_free(o->z[l]);
}

static outcome look_at_bytes(const uint8_t *bytes, size_t size, const intact *of)
{
    const char *path = made_path("damaged");
    make_bytes(path, bytes, size);
    return look_at(path, of, false);
}

/* Damage must be told: by a status, missing levels or damaged tiles. */
static bool is_told(const outcome *o)
{
    return o->opened || o->read || o->missing > 0 || o->damaged > 0;
}

/* ---- Bytes ------------------------------------------------------------------------------------------------------- */

/* One byte changed in four ways. */
static void change_byte(const intact *f, size_t at, const char *what)
{
    uint8_t *bytes = malloc(f->size);
    assert_non_null(bytes);
    memcpy(bytes, f->bytes, f->size);
    const uint8_t values[] = {(uint8_t)(bytes[at] ^ 1 << cases % 8), 0, 0xff};
    for (int k = 0; k < 3; k++) {
        if (values[k] == f->bytes[at])
            continue;
        bytes[at] = values[k];
        outcome o = look_at_bytes(bytes, f->size, f);
        if (!is_told(&o))
            fail_msg("kind %d: %s: byte %d as %d goes unseen, %d samples differ", (int)(f - files), what, (int)at,
                     values[k], (int)o.differing);
    }
    free(bytes);
}

/* Every byte of the head: opening fails. */
static void a_damaged_head_is_refused(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        const intact *f = &files[k];
        size_t head = (size_t)f->c.record[f->c.base].begin;
        uint8_t *bytes = malloc(f->size);
        memcpy(bytes, f->bytes, f->size);
        for (size_t at = 0; at < head; at++)
            for (int n = k ? 2 : 0; n < 3; n++) {
                static const uint8_t masks[] = {0x01, 0x80, 0xff};
                bytes[at] ^= masks[n];
                make_bytes(made_path("damaged"), bytes, f->size);
                tc_field *p = NULL;
                tc_error error = {TC_OK, ""};
                long long before = allocations.live;
                allocations.largest = 0;
                cases++;
                if (tc_field_open(made_path("damaged"), NULL, &p, &error) == TC_OK || p || !error.text[0])
                    fail_msg("kind %d: byte %d of the head goes unseen", k, (int)at);
                assert_true(allocations.live <= before && allocations.largest < 1 << 20);
                bytes[at] = f->bytes[at];
            }
        free(bytes);
    }
}

/* Where pages and tiles lie: byte offsets of everything that begins, in order. */
typedef struct part {
    size_t at, size;
    int l, kind; /* 0: directory, 1: page, 2: tile */
    tc_rect tile;
} part;

static size_t find_parts(const intact *f, const char *path, part *parts, size_t room)
{
    size_t count = 0;
    tc_packed_file file;
    make_bytes(path, f->bytes, f->size);
    assert_int_equal(tc_packed_file_open(path, &file, NULL), TC_OK);
    for (int l = f->c.base + 1; l <= f->levels; l++) {
        const tc_level_record *r = &f->c.record[l - 1];
        tc_pages pages = tc_level_pages(&f->c.level[l - 1]);
        parts[count++] = (part){(size_t)r->begin, (size_t)tc_directory_bytes(&pages), l, 0, {0, 0, 0, 0}};
        for (int64_t n = 0; n < pages.pages_x * pages.pages_y; n++) {
            const uint8_t *entry = f->bytes + r->begin + n * TC_DIRECTORY_ENTRY;
            parts[count++] =
                (part){(size_t)r->begin + (size_t)tc_load(entry, 8), (size_t)tc_load(entry + 8, 4), l, 1, {0, 0, 0, 0}};
        }
        for (int64_t ty = 0; ty < pages.tiles_y; ty++)
            for (int64_t tx = 0; tx < pages.tiles_x; tx++) {
                tc_tile_entry e;
                assert_int_equal(tc_packed_file_entry(&file, l, tx, ty, &e), TC_OK);
                assert_true(count < room);
                tc_rect rect = {tx * TILE, ty * TILE, (tx + 1) * TILE, (ty + 1) * TILE};
                if (tc_tile_bytes(&e))
                    parts[count++] = (part){(size_t)e.offset, tc_tile_bytes(&e), l, 2, rect};
            }
    }
    tc_packed_file_close(&file);
    return count;
}

enum { MOST_PARTS = 400 };

static void damaged_parts_are_told(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        part parts[MOST_PARTS];
        size_t count = find_parts(&files[k], made_path("damaged"), parts, MOST_PARTS);
        for (size_t n = 0; n < count; n++) {
            const part *p = &parts[n];
            size_t step = p->kind == 0 ? 1 : p->kind == 1 ? 3 : 1 + p->size / 3;
            for (size_t at = 0; at < p->size; at += step)
                change_byte(&files[k], p->at + at, p->kind == 0 ? "directory" : p->kind == 1 ? "page" : "tile");
            change_byte(&files[k], p->at + p->size - 1, "last byte");
        }
    }
}

/* ---- Cut, longer, mixed ------------------------------------------------------------------------------------------ */

static void cut_files_open_with_what_is_whole(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        const intact *f = &files[k];
        part parts[MOST_PARTS];
        size_t count = find_parts(f, made_path("damaged"), parts, MOST_PARTS),
               head = (size_t)f->c.record[f->c.base].begin;
        for (size_t n = 0; n < 3 * count + 40; n++) {
            size_t size = n < 3 * count ? parts[n / 3].at + (n % 3 == 1) - (n % 3 == 2) : (n - 3 * count) * head / 39;
            outcome o = look_at_bytes(f->bytes, size, f);
            if (size < head) {
                assert_true(o.opened == TC_ERR_FORMAT);
                continue;
            }
            int whole = f->c.base;
            while (whole < f->levels && f->c.record[whole].end <= (int64_t)size)
                whole++;
            if (o.opened || o.read || o.levels != whole || o.missing != f->levels - whole || o.differing || o.damaged)
                fail_msg("kind %d cut to %d: levels %d, missing %d, differing %d", k, (int)size, o.levels, o.missing,
                         (int)o.differing);
        }
        /* Longer: what lies behind means nothing. */
        uint8_t *bytes = calloc(f->size + 100, 1);
        memcpy(bytes, f->bytes, f->size);
        outcome o = look_at_bytes(bytes, f->size + 100, f);
        assert_true(!is_told(&o) && o.differing == 0 && o.levels == f->levels);
        free(bytes);
    }
}

/* Every pair of parts beside each other of one kind, the bytes of the one in the place of the other. */
static void swapped_parts_are_told(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        const intact *f = &files[k];
        part parts[MOST_PARTS];
        size_t count = find_parts(f, made_path("damaged"), parts, MOST_PARTS);
        uint8_t *bytes = malloc(f->size);
        for (size_t n = 0; n < count; n++)
            for (size_t m = n + 1; m < count && m < n + 12; m++) {
                size_t size = parts[n].size < parts[m].size ? parts[n].size : parts[m].size;
                if (parts[n].kind != parts[m].kind || !memcmp(f->bytes + parts[n].at, f->bytes + parts[m].at, size))
                    continue;
                memcpy(bytes, f->bytes, f->size);
                memcpy(bytes + parts[n].at, f->bytes + parts[m].at, size);
                memcpy(bytes + parts[m].at, f->bytes + parts[n].at, size);
                outcome o = look_at_bytes(bytes, f->size, f);
                if (!is_told(&o))
                    fail_msg("kind %d: parts %d and %d, swapped, go unseen", k, (int)n, (int)m);
                break;
            }
        free(bytes);
    }
}

/* ---- How far damage reaches -------------------------------------------------------------------------------------- */

/* Where heights of the finest level differ, of a terrain that wraps: columns beyond a side are told there where `reach`
 * goes over that side. */
static tc_rect go_round(const intact *f, const outcome *o, const tc_rect *reach)
{
    const tc_level *level = &f->c.level[f->levels - 1];
    tc_rect where = {0, 0, 0, 0};
    for (int64_t y = 0; y < level->height; y++)
        for (int64_t x = 0; x < level->width; x++)
            if (o->z[f->levels - 1][y * level->width + x] != f->z[f->levels - 1][y * level->width + x])
                add_point(&where, x < reach->x0 ? x + level->width : x >= reach->x1 ? x - level->width : x, y);
    return where;
}

/* One tile of the finest level: the rest is right but for what the filters and predictions carry over its edge, and
 * where it is, heights are what the coarser level upsampled gives. */
static void damage_stays_where_it_is(void **state)
{
    (void)state;
    enum { EDGE = 8 }; /* samples that the transform reaches beyond a tile */
    for (int k = 0; k < KINDS; k++) {
        const intact *f = &files[k];
        part parts[MOST_PARTS];
        size_t count = find_parts(f, made_path("damaged"), parts, MOST_PARTS);
        uint8_t *bytes = malloc(f->size);
        for (size_t n = 0; n < count; n++) {
            const part *p = &parts[n];
            if (p->kind != 2 || p->l != f->levels)
                continue;
            memcpy(bytes, f->bytes, f->size);
            bytes[p->at + p->size / 2] ^= 0x10;
            make_bytes(made_path("damaged"), bytes, f->size);
            outcome o = look_at(made_path("damaged"), f, true);
            assert_true(!o.opened && !o.read && o.damaged == 1 && o.missing == 0);
            int edge = f->c.record[p->l - 1].coder == TC_CODER_EXACT ? 0 : EDGE;
            tc_rect reach = {p->tile.x0 - edge, p->tile.y0 - edge, p->tile.x1 + edge, p->tile.y1 + edge};
            if (kinds[k].wraps)
                o.where = go_round(f, &o, &reach);
            if (!tc_rect_empty(o.where) && !tc_rect_within(o.where, reach))
                fail_msg("kind %d: damage of the tile at (%d, %d) reaches %d to %d, %d to %d", k, (int)p->tile.x0,
                         (int)p->tile.y0, (int)o.where.x0, (int)o.where.x1, (int)o.where.y0, (int)o.where.y1);
            for (int l = 1; l < f->levels; l++) {
                size_t size = (size_t)(f->c.level[l - 1].width * f->c.level[l - 1].height) * sizeof(float);
                assert_memory_equal(o.z[l - 1], f->z[l - 1], size);
            }
            /* The coarser level's heights stand on every other sample (but for the lifting's update, which zero details
             * leave alone), and at the middle between them the four-point mean, or for exact tiles their mean. */
            const float *coarse = f->z[f->levels - 2], *fine = o.z[f->levels - 1];
            int64_t w = kinds[k].width, cw = f->c.level[f->levels - 2].width;
            bool exact = f->c.record[p->l - 1].coder == TC_CODER_EXACT;
            double unit = f->c.z_unit, snap = f->c.record[p->l - 1].correction_snap * unit, slack = 1.6 * unit + snap;
            tc_rect in = tc_rect_intersect(
                (tc_rect){p->tile.x0 + 2 * EDGE, p->tile.y0 + 2 * EDGE, p->tile.x1 - 2 * EDGE, p->tile.y1 - 2 * EDGE},
                (tc_rect){8, 8, w - 8, kinds[k].height - 8});
            for (int64_t y = in.y0; y < in.y1; y += 2)
                for (int64_t x = in.x0; x < in.x1; x++) {
                    const float *c = coarse + y / 2 * cw + x / 2;
                    double expected = x % 2 == 0 ? c[0]
                                      : exact    ? 0.5 * ((double)c[0] + c[1])
                                                 : (9 * ((double)c[0] + c[1]) - ((double)c[-1] + c[2])) / 16;
                    if (fabs(fine[y * w + x] - expected) > slack)
                        fail_msg("kind %d: a damaged tile has %g at (%d, %d) instead of %g", k, fine[y * w + x], (int)x,
                                 (int)y, expected);
                }
            forget(&o);
        }
        free(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_damaged_head_is_refused),         cmocka_unit_test(damaged_parts_are_told),
        cmocka_unit_test(cut_files_open_with_what_is_whole), cmocka_unit_test(swapped_parts_are_told),
        cmocka_unit_test(damage_stays_where_it_is),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

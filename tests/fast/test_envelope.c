/* test_envelope.c - heads of files of version 3: what is written comes back, levels lie rank by rank, and heads that
 * contradict themselves are refused. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/crc32c.h"
#include "common/synthesis/synthesis_store.h"
#include "tests/support/containers.h"

/* Fields of a row of the chart table. */
enum { KIND = 0, X0 = 1, Y0 = 9, DX = 17, DY = 25, WIDTH = 33, HEIGHT = 41, LEVELS = 49, FIRST = 50, BYTES = 58 };
enum { SIDES = 66, SIDE = 21, HEAD_SIZE = 150, ROW = 154, SIZE_AT = 20, CHARTS_AT = 28, SECTIONS_AT = 29 };

/* One chart of any terrain, or a planet with its caps; not laid out. */
static tc_envelope *make_envelope(test_random *r, bool planet)
{
    tc_envelope *e = calloc(1, sizeof *e);
    assert_non_null(e);
    for (tc_container *c = &e->chart[0].container; c->levels == 0 || (c->info.charts > 1) != planet;) {
        tc_container_free(c);
        *c = container_make(r);
    }
    tc_container *first = &e->chart[0].container;
    memset(first->cap_bytes, 0, sizeof first->cap_bytes);
    e->charts = planet ? 3 : 1;
    for (int n = 1; n < e->charts; n++)
        e->chart[n].container =
            container_make_cap(r, 2 * test_random_int(r, 1, n == 1 ? 900 : 20) + 1, first->info.terrain.z_base);
    return e;
}

/* Gives it a fit of numbers made up. */
static void add_fit(tc_envelope *e, test_random *r)
{
    tc_synthesis_fit *fit = e->chart[0].container.synthesis = calloc(1, sizeof *fit);
    assert_non_null(fit);
    fit->none = test_random_int(r, 0, 3) == 0;
    fit->energy_floor = 1 + (float)test_random_unit(r), fit->slope_floor = 1e-6f, fit->spacing = test_random_unit(r);
    for (int k = 0; k < TC_SYNTHESIS_MOST; k++) {
        fit->level[k].a = (float)test_random_range(r, -300, 300), fit->level[k].b = (float)test_random_range(r, 0, 4);
        fit->level[k].c = (float)test_random_range(r, 0, 8), fit->level[k].cap = (float)test_random_range(r, 0, 1e6);
    }
    fit->smear = (float)test_random_range(r, -1, 1), fit->peak = (float)test_random_unit(r);
    fit->kurtosis = test_random_range(r, 0, 100), fit->ratio = test_random_range(r, 1, 4);
}

static tc_status read_bytes(const uint8_t *bytes, size_t size, tc_envelope **e_ret)
{
    size_t needed = 0;
    tc_error error = {TC_OK, ""};
    *e_ret = NULL;
    tc_status status = tc_envelope_read("test", bytes, size, e_ret, &needed, &error);
    assert_true(status ? !*e_ret && error.text[0] && !strchr(error.text, '\n') : *e_ret && needed == size);
    return status;
}

/* The levels of a rank are beside each other, in the order of the charts, and ranks follow from the coarsest on. */
static void check_layout(const tc_envelope *e, size_t head)
{
    int64_t at = (int64_t)head;
    for (int rank = TC_MAX_FIELD_LEVELS - 1; rank >= 0; rank--) {
        for (int n = 0; n < e->charts; n++) {
            const tc_container *c = &e->chart[n].container;
            int l = c->levels - rank;
            if (l <= c->base)
                continue;
            assert_true(c->record[l - 1].begin == at && c->record[l - 1].end > at);
            at = c->record[l - 1].end;
        }
        assert_true(e->rank_end[rank] == at);
    }
    assert_true(e->bytes == at);
}

static void check_same(const tc_envelope *a, const tc_envelope *b)
{
    const tc_synthesis_fit *fit = a->chart[0].container.synthesis, *fit_back = b->chart[0].container.synthesis;
    assert_true(a->bytes == b->bytes && a->charts == b->charts);
    assert_true(!fit == !fit_back && b->chart[0].container.info.synthesis_fit == !!fit);
    assert_true(!fit || (fit->none == fit_back->none && !memcmp(fit->level, fit_back->level, sizeof fit->level)));
    for (int n = 0; n < a->charts; n++) {
        const tc_envelope_chart *x = &a->chart[n], *y = &b->chart[n];
        const tc_container *c = &x->container, *d = &y->container;
        assert_true(x->kind == y->kind && x->x0 == y->x0 && x->y0 == y->y0 && x->dx == y->dx && x->dy == y->dy);
        for (int side = 0; side < TC_SIDES; side++)
            assert_true(x->side[side].chart == y->side[side].chart && x->side[side].dx == y->side[side].dx);
        assert_true(c->levels == d->levels && c->base == d->base && c->wraps_from == d->wraps_from &&
                    c->voids == d->voids && c->z_unit == d->z_unit);
        assert_true(d->steps && d->info.version == 3 && d->info.charts == b->charts && d->info.bytes == b->bytes);
        for (int l = c->base; l < c->levels; l++)
            assert_true(c->record[l].begin == d->record[l].begin && c->record[l].end == d->record[l].end &&
                        c->record[l].model_size == d->record[l].model_size);
    }
}

static void envelopes_come_back(void **state)
{
    (void)state;
    test_random r = {31};
    for (int n = 0; n < 200; n++) {
        tc_envelope *e = make_envelope(&r, n % 2), *back;
        if (n % 3 == 0)
            add_fit(e, &r);
        tc_byte_writer w = envelope_bytes(e, true);
        assert_true(tc_envelope_is(w.bytes));
        if (read_bytes(w.bytes, w.size, &back))
            fail_msg("case %d is refused", n);
        check_layout(back, w.size);
        check_same(e, back);
        const tc_envelope_chart *first = &back->chart[0];
        bool planet = e->chart[0].container.info.terrain.radius > 0;
        assert_int_equal(first->kind, planet ? TC_CHART_LONLAT : TC_CHART_PLANE);
        assert_int_equal(first->side[0].chart, e->chart[0].container.info.terrain.wraps_x ? 0 : -1);
        /* Bytes say all. */
        tc_byte_writer again = {0};
        assert_int_equal(tc_envelope_write(back, &again), TC_OK);
        assert_true(again.size == w.size && !memcmp(again.bytes, w.bytes, w.size));
        tc_envelope_free(back);
        /* Cut: how much is needed is told where it is known. */
        size_t cut = (size_t)test_random_int(&r, 0, (int64_t)w.size - 1), needed;
        assert_int_equal(tc_envelope_read("test", w.bytes, cut, &back, &needed, NULL), TC_ERR_FORMAT);
        assert_true(needed == (cut < 20 ? 0 : w.size));
        free(w.bytes), free(again.bytes);
        tc_envelope_free(e);
    }
}

/* ---- Sections ---------------------------------------------------------------------------------------------------- */

static void unknown_sections_are_skipped(void **state)
{
    (void)state;
    test_random r = {32};
    for (int n = 0; n < 60; n++) {
        enum { MOST = 600 };
        uint8_t section[3 * (8 + MOST)];
        size_t size = 0;
        int count = (int)test_random_int(&r, 1, 3);
        for (int k = 0; k < count; k++) {
            size_t length = (size_t)test_random_int(&r, 0, MOST);
            tc_store(section + size, test_random_bits(&r), 4), tc_store(section + size + 4, length, 4);
            memset(section + size + 8, 0xa5, length);
            size += 8 + length;
        }
        tc_envelope *e = make_envelope(&r, n % 2), *back;
        tc_byte_writer w = envelope_bytes(e, true);
        tc_envelope_lay_out(e, w.size + size);
        size_t head = w.size + size, rows = envelope_row_at(e->charts);
        w.size = 0;
        assert_int_equal(tc_envelope_write(e, &w), TC_OK);
        uint8_t *bytes = malloc(head + 1);
        assert_non_null(bytes);
        memcpy(bytes, w.bytes, rows), memcpy(bytes + rows, section, size);
        memcpy(bytes + rows + size, w.bytes + rows, w.size - rows);
        tc_store(bytes + SECTIONS_AT, (uint64_t)count, 2), tc_store(bytes + TC_HEAD_SIZE_AT, head, 4);
        envelope_sign(bytes);
        assert_int_equal(read_bytes(bytes, head, &back), TC_OK);
        check_layout(back, head);
        check_same(e, back);
        tc_envelope_free(back);
        /* One more, or one that is longer than what is left. */
        tc_store(bytes + SECTIONS_AT, (uint64_t)count + 1, 2);
        envelope_sign(w.bytes);
        bytes[16] = bytes[17] = bytes[18] = bytes[19] = 0;
        tc_store(bytes + 16, tc_crc32c(0, bytes, head), 4);
        assert_int_equal(read_bytes(bytes, head, &back), TC_ERR_FORMAT);
        tc_store(bytes + SECTIONS_AT, (uint64_t)count, 2), tc_store(bytes + rows + 4, UINT32_MAX, 4);
        bytes[16] = bytes[17] = bytes[18] = bytes[19] = 0;
        tc_store(bytes + 16, tc_crc32c(0, bytes, head), 4);
        assert_int_equal(read_bytes(bytes, head, &back), TC_ERR_FORMAT);
        free(bytes), free(w.bytes);
        tc_envelope_free(e);
    }
}

/* Bytes of the head with its one section replaced by `count` of those bytes, and what becomes of them. */
static tc_status try_sections(tc_envelope *e, int count, unsigned kind, const uint8_t *bytes, size_t size,
                              bool *kept_ret)
{
    tc_synthesis_fit *fit = e->chart[0].container.synthesis;
    tc_envelope *back;
    tc_byte_writer w = {0}, head = {0};
    e->chart[0].container.synthesis = NULL;
    free(envelope_bytes(e, true).bytes);
    assert_int_equal(tc_envelope_write(e, &w), TC_OK);
    tc_envelope_lay_out(e, w.size + (size_t)count * (8 + size));
    w.size = 0;
    assert_int_equal(tc_envelope_write(e, &w), TC_OK);
    size_t rows = envelope_row_at(e->charts);
    tc_put_bytes(&head, w.bytes, rows);
    for (int n = 0; n < count; n++)
        tc_put(&head, kind, 4), tc_put(&head, size, 4), tc_put_bytes(&head, bytes, size);
    tc_put_bytes(&head, w.bytes + rows, w.size - rows);
    tc_store(head.bytes + SECTIONS_AT, (uint64_t)count, 2), tc_store(head.bytes + TC_HEAD_SIZE_AT, head.size, 4);
    envelope_sign(head.bytes);
    tc_status status = read_bytes(head.bytes, head.size, &back);
    if (kept_ret)
        *kept_ret = back && back->chart[0].container.synthesis;
    tc_envelope_free(back);
    free(w.bytes), free(head.bytes);
    e->chart[0].container.synthesis = fit;
    return status;
}

/* A flattening stands in a section of its own where there is one, and then comes back; out of range, cut short, twice,
 * or of what is no planet it is refused. */
static void flattening_comes_back(void **state)
{
    (void)state;
    enum { BODY = 2 };
    test_random r = {41};
    for (int k = 0; k < 2; k++) {
        tc_envelope *e = make_envelope(&r, k), *back;
        tc_pack_terrain *t = &e->chart[0].container.info.terrain;
        const double wrong[] = {0, -0.1, 1, 1.5, NAN, INFINITY}, right = 1 / 298.257223563;
        bool planet = t->radius > 0;
        tc_byte_writer round = envelope_bytes(e, true);
        if (planet) {
            t->flattening = right;
            tc_byte_writer w = envelope_bytes(e, true);
            assert_int_equal(w.size, round.size + 16);
            assert_int_equal(read_bytes(w.bytes, w.size, &back), TC_OK);
            assert_true(back->chart[0].container.info.terrain.flattening == right);
            tc_envelope_free(back);
            free(w.bytes);
            t->flattening = 0;
        }
        assert_int_equal(read_bytes(round.bytes, round.size, &back), TC_OK);
        assert_true(back->chart[0].container.info.terrain.flattening == 0);
        tc_envelope_free(back);
        free(round.bytes);
        tc_byte_writer number = {0};
        tc_put_f64(&number, right), tc_put(&number, 0, 1);
        assert_int_equal(try_sections(e, 1, BODY, number.bytes, 8, NULL), planet ? TC_OK : TC_ERR_FORMAT);
        assert_int_equal(try_sections(e, 2, BODY, number.bytes, 8, NULL), TC_ERR_FORMAT);
        assert_int_equal(try_sections(e, 1, BODY, number.bytes, 7, NULL), TC_ERR_FORMAT);
        assert_int_equal(try_sections(e, 1, BODY, number.bytes, 9, NULL), TC_ERR_FORMAT);
        for (int i = 0; i < 6; i++) {
            number.size = 0;
            tc_put_f64(&number, wrong[i]);
            assert_int_equal(try_sections(e, 1, BODY, number.bytes, 8, NULL), TC_ERR_FORMAT);
        }
        free(number.bytes);
        tc_envelope_free(e);
    }
}

/* Whose the heights are comes back; of no byte, of too many, with a zero among them, or twice it is refused. */
static void credits_come_back(void **state)
{
    (void)state;
    enum { CREDITS = 5 };
    test_random r = {43};
    char longest[TC_CREDITS_BYTES + 1];
    memset(longest, 'a', sizeof longest);
    for (int k = 0; k < 2; k++) {
        tc_envelope *e = make_envelope(&r, k), *back;
        char text[] = "(c) A. Person\nB. Person";
        tc_byte_writer without = envelope_bytes(e, true);
        e->chart[0].container.info.terrain.credits = text;
        tc_byte_writer w = envelope_bytes(e, true);
        e->chart[0].container.info.terrain.credits = NULL;
        assert_int_equal(w.size, without.size + 8 + strlen(text));
        assert_int_equal(read_bytes(w.bytes, w.size, &back), TC_OK);
        assert_string_equal(back->chart[0].container.info.terrain.credits, text);
        for (int n = 1; n < back->charts; n++)
            assert_null(back->chart[n].container.info.terrain.credits);
        tc_envelope_free(back);
        assert_int_equal(read_bytes(without.bytes, without.size, &back), TC_OK);
        assert_null(back->chart[0].container.info.terrain.credits);
        tc_envelope_free(back);
        free(w.bytes), free(without.bytes);
        const uint8_t *bytes = (const uint8_t *)text, *most = (const uint8_t *)longest;
        assert_int_equal(try_sections(e, 1, CREDITS, bytes, 1, NULL), TC_OK);
        assert_int_equal(try_sections(e, 1, CREDITS, bytes, 0, NULL), TC_ERR_FORMAT);
        assert_int_equal(try_sections(e, 1, CREDITS, bytes, sizeof text, NULL), TC_ERR_FORMAT);
        assert_int_equal(try_sections(e, 2, CREDITS, bytes, sizeof text - 1, NULL), TC_ERR_FORMAT);
        assert_int_equal(try_sections(e, 1, CREDITS, most, TC_CREDITS_BYTES, NULL), TC_OK);
        assert_int_equal(try_sections(e, 1, CREDITS, most, TC_CREDITS_BYTES + 1, NULL), TC_ERR_FORMAT);
        tc_envelope_free(e);
    }
}

/* Cut short or too long, twice, of a later form, and with every number out of its range in turn. */
static void fits_that_lie_are_refused(void **state)
{
    (void)state;
    enum { SYNTHESIS = 1, UNKNOWN = 77, FORM_AT = 0, NONE_AT = 2, NARROW_AT = 3, WIDE_AT = 43, LEVELS_AT = 99 };
    test_random r = {37};
    for (int k = 0; k < 2; k++) {
        tc_envelope *e = make_envelope(&r, k);
        tc_byte_writer w = {0};
        bool kept;
        add_fit(e, &r), e->chart[0].container.synthesis->none = false;
        tc_synthesis_put(e->chart[0].container.synthesis, &w);
        assert_int_equal(w.size, TC_SYNTHESIS_BYTES);
        assert_int_equal(try_sections(e, 1, SYNTHESIS, w.bytes, w.size, &kept), TC_OK);
        assert_true(kept);
        assert_int_equal(try_sections(e, 2, SYNTHESIS, w.bytes, w.size, NULL), TC_ERR_FORMAT);
        assert_int_equal(try_sections(e, 2, UNKNOWN, w.bytes, w.size, &kept), TC_OK);
        assert_false(kept);
        for (size_t size = 0; size < w.size; size += size < 8 ? 1 : 10)
            assert_int_equal(try_sections(e, 1, SYNTHESIS, w.bytes, size, NULL), TC_ERR_FORMAT);
        tc_put(&w, 0, 1);
        assert_int_equal(try_sections(e, 1, SYNTHESIS, w.bytes, w.size, NULL), TC_ERR_FORMAT);
        for (int form = 0; form < 4; form++) { /* others may be of any length, and count as none */
            tc_store(w.bytes + FORM_AT, (uint64_t)form, 2);
            for (size_t size = 2; form != 1 && size <= w.size; size += 139) {
                assert_int_equal(try_sections(e, 1, SYNTHESIS, w.bytes, size, &kept), TC_OK);
                assert_false(kept);
            }
        }
        tc_store(w.bytes + FORM_AT, 1, 2);
        tc_store(w.bytes + NONE_AT, 2, 1);
        assert_int_equal(try_sections(e, 1, SYNTHESIS, w.bytes, TC_SYNTHESIS_BYTES, NULL), TC_ERR_FORMAT);
        tc_store(w.bytes + NONE_AT, 0, 1);
        for (size_t at = NARROW_AT; at < TC_SYNTHESIS_BYTES; at += at >= WIDE_AT && at < LEVELS_AT ? 8 : 4) {
            const float narrow[] = {NAN, INFINITY, -INFINITY, -301, 2e20f};
            const double wide[] = {NAN, INFINITY, -INFINITY, -1, 2e20};
            uint8_t was[8];
            size_t size = at >= WIDE_AT && at < LEVELS_AT ? 8 : 4;
            memcpy(was, w.bytes + at, size);
            for (int b = 0; b < 5; b++) {
                memcpy(w.bytes + at, size == 8 ? (const void *)&wide[b] : (const void *)&narrow[b], size);
                if (try_sections(e, 1, SYNTHESIS, w.bytes, TC_SYNTHESIS_BYTES, NULL) != TC_ERR_FORMAT)
                    fail_msg("number %d at %zu is not refused", b, at);
            }
            memcpy(w.bytes + at, was, size);
        }
        tc_store(w.bytes + NARROW_AT, 0, 4); /* no floor, whose logarithm would be taken */
        assert_int_equal(try_sections(e, 1, SYNTHESIS, w.bytes, TC_SYNTHESIS_BYTES, NULL), TC_ERR_FORMAT);
        tc_store(w.bytes + NONE_AT, 1, 1); /* but where there is nothing to go by */
        assert_int_equal(try_sections(e, 1, SYNTHESIS, w.bytes, TC_SYNTHESIS_BYTES, &kept), TC_OK);
        assert_true(kept);
        free(w.bytes);
        tc_envelope_free(e);
    }
}

/* ---- Heads that lie ---------------------------------------------------------------------------------------------- */

/* Puts a number into a copy of the head; all checksums are right. */
static tc_status try_at(const tc_byte_writer *w, size_t at, uint64_t v, int count)
{
    uint8_t *bytes = malloc(w->size);
    tc_envelope *e;
    assert_non_null(bytes);
    memcpy(bytes, w->bytes, w->size);
    if (at >= envelope_head_at(bytes, 0)) { /* of a container: its checksum too */
        tc_store(bytes + at, v, count);
        envelope_sign(bytes);
    } else {
        tc_store(bytes + at, v, count);
        memset(bytes + 16, 0, 4);
        tc_store(bytes + 16, tc_crc32c(0, bytes, w->size), 4);
    }
    tc_status status = read_bytes(bytes, w->size, &e);
    tc_envelope_free(e);
    free(bytes);
    return status;
}

static void refuse(const tc_byte_writer *w, size_t at, uint64_t v, int count)
{
    if (tc_load(w->bytes + at, count) != v && try_at(w, at, v, count) != TC_ERR_FORMAT)
        fail_msg("%llu in %d bytes at %zu is not refused", (unsigned long long)v, count, at);
}

static uint64_t bits_of(double v)
{
    uint64_t bits;
    memcpy(&bits, &v, 8);
    return bits;
}

static void tables_that_lie_are_refused(void **state)
{
    (void)state;
    test_random r = {33};
    for (int k = 0; k < 24; k++) {
        tc_envelope *e = make_envelope(&r, k % 3 > 0);
        tc_byte_writer w = envelope_bytes(e, true);
        const uint64_t sizes[] = {0,         19,         w.size - 1, (uint64_t)e->bytes - 1, (uint64_t)e->bytes + 1,
                                  INT64_MAX, 1ull << 63, UINT64_MAX};
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            refuse(&w, SIZE_AT, sizes[i], 8);
        for (int charts = 0; charts < 256; charts += charts < 10 ? 1 : 49)
            if (charts != e->charts)
                assert_int_equal(try_at(&w, CHARTS_AT, (uint64_t)charts, 1),
                                 charts > TC_MOST_CHARTS ? TC_ERR_UNSUPPORTED : TC_ERR_FORMAT);
        refuse(&w, SECTIONS_AT, 1, 2), refuse(&w, SECTIONS_AT, 257, 2), refuse(&w, SECTIONS_AT, 65535, 2);
        for (int n = 0; n < e->charts; n++) {
            size_t row = envelope_row_at(n);
            const tc_envelope_chart *c = &e->chart[n];
            for (unsigned kind = 0; kind < 256; kind += kind < 5 ? 1 : 50)
                refuse(&w, row + KIND, kind, 1);
            const double place[] = {c->x0, c->y0, c->dx, c->dy};
            for (size_t i = 0; i < 4; i++) {
                const double bad[] = {nextafter(place[i], INFINITY), -place[i] - 1, NAN, INFINITY, 1e300};
                for (int b = 0; b < 5; b++)
                    refuse(&w, row + X0 + 8 * i, bits_of(bad[b]), 8);
            }
            for (size_t at = row + WIDTH; at < row + SIDES; at += at == row + LEVELS ? 1 : 8) { /* sizes, places */
                int count = at == row + LEVELS ? 1 : 8;
                uint64_t v = tc_load(w.bytes + at, count);
                const uint64_t bad[] = {v + 1, v - 1, 0, UINT64_MAX, INT64_MAX, 1ull << 63, v + 256};
                for (int b = 0; b < 7; b++) {
                    uint64_t there = count == 1 ? bad[b] & 255 : bad[b];
                    refuse(&w, at, there, count);
                }
            }
            for (size_t at = row + SIDES; at < row + HEAD_SIZE; at++) /* seams: every byte of them */
                for (int b = 0; b < 8; b++)
                    refuse(&w, at, (uint64_t)w.bytes[at] ^ 1u << b, 1);
            uint64_t size = tc_load(w.bytes + row + HEAD_SIZE, 4);
            const uint64_t bad[] = {0, 19, size - 1, size + 1, UINT32_MAX, 1 << 24};
            for (int b = 0; b < 6; b++) { /* heads no longer stand where they did: their checksums stay as they are */
                uint8_t *bytes = malloc(w.size);
                tc_envelope *none;
                memcpy(bytes, w.bytes, w.size);
                tc_store(bytes + row + HEAD_SIZE, bad[b], 4);
                memset(bytes + 16, 0, 4);
                tc_store(bytes + 16, tc_crc32c(0, bytes, w.size), 4);
                assert_int_equal(read_bytes(bytes, w.size, &none), TC_ERR_FORMAT);
                free(bytes);
            }
        }
        free(w.bytes);
        tc_envelope_free(e);
    }
}

/* The envelope as it now is must be refused; its levels are put back by the caller. */
static void refuse_envelope(const tc_envelope *e, const char *what)
{
    tc_byte_writer w = {0};
    tc_envelope *back;
    assert_int_equal(tc_envelope_write(e, &w), TC_OK);
    if (read_bytes(w.bytes, w.size, &back) != TC_ERR_FORMAT)
        fail_msg("%s: not refused", what);
    free(w.bytes);
}

static void levels_must_lie_in_order(void **state)
{
    (void)state;
    test_random r = {34};
    for (int k = 0; k < 40; k++) {
        tc_envelope *e = make_envelope(&r, k % 4 > 0);
        tc_byte_writer w = envelope_bytes(e, true);
        for (int n = 0; n < e->charts; n++)
            for (int l = e->chart[n].container.base; l < e->chart[n].container.levels; l++) {
                tc_level_record *a = &e->chart[n].container.record[l], kept = *a;
                int64_t size = a->end - a->begin;
                a->begin++, a->end++;
                refuse_envelope(e, "a level a byte later");
                *a = kept, a->begin--;
                refuse_envelope(e, "a level that overlaps the one before");
                *a = kept, a->begin = (int64_t)w.size - 1, a->end = a->begin + size;
                refuse_envelope(e, "a level in the head");
                *a = kept, a->end = INT64_MAX;
                refuse_envelope(e, "a level without end");
                *a = kept, a->begin = INT64_MIN;
                refuse_envelope(e, "a level before the file");
                *a = kept, a->end = a->begin;
                refuse_envelope(e, "a level of no bytes");
                for (int m = 0; m < e->charts; m++) { /* two levels exchanged: of another chart, of another rank */
                    const tc_container *d = &e->chart[m].container;
                    int other = (int)test_random_int(&r, d->base, d->levels);
                    tc_level_record *b = &e->chart[m].container.record[other], b_kept = *b;
                    if (other == d->levels || b == a)
                        continue;
                    *a = kept;
                    int64_t b_size = b->end - b->begin, at = b->begin;
                    b->begin = a->begin, b->end = a->begin + b_size, a->begin = at, a->end = at + size;
                    refuse_envelope(e, "two levels exchanged");
                    *b = b_kept;
                }
                *a = kept;
            }
        free(w.bytes);
        tc_envelope_free(e);
    }
}

/* Sums of sizes that no file has. */
static void endless_levels_are_refused(void **state)
{
    (void)state;
    test_random r = {35};
    for (int k = 0; k < 20; k++) {
        tc_envelope *e = make_envelope(&r, k % 2);
        free(envelope_bytes(e, true).bytes);
        for (int n = 0; n < e->charts; n++)
            for (int l = e->chart[n].container.base; l < e->chart[n].container.levels; l++) {
                tc_level_record *a = &e->chart[n].container.record[l];
                a->begin = 1, a->end = k % 4 < 2 ? INT64_MAX : INT64_MAX / 4;
            }
        for (int m = 0; m < 3; m++) {
            e->bytes = m == 0 ? INT64_MAX : m == 1 ? INT64_MAX - 1 : INT64_MAX / 4 + 10000;
            for (int n = 0; n < e->charts; n++)
                e->chart[n].container.info.bytes = e->bytes;
            refuse_envelope(e, "levels longer than any file");
        }
        tc_envelope_free(e);
    }
}

/* Charts whose containers do not fit each other. */
static void charts_must_fit(void **state)
{
    (void)state;
    test_random r = {36};
    for (int k = 0; k < 12; k++) {
        tc_envelope *e = make_envelope(&r, true);
        e->chart[1 + k % 2].container.info.terrain.z_base += k < 6;
        if (k >= 6) {
            tc_container *c = &e->chart[1 + k % 2].container;
            tc_container_free(c);
            *c = container_make_cap(&r, 2 * test_random_int(&r, 1, 300), e->chart[0].container.info.terrain.z_base);
        }
        free(envelope_bytes(e, true).bytes);
        refuse_envelope(e, k < 6 ? "a cap with another base" : "a cap with an even side");
        tc_envelope_free(e);
        /* Caps of a flat terrain, one cap alone. */
        e = make_envelope(&r, k % 2);
        e->charts = k % 2 ? 2 : 3;
        for (int n = 1; n < e->charts && k % 2 == 0; n++)
            e->chart[n].container = container_make_cap(&r, 33, e->chart[0].container.info.terrain.z_base);
        free(envelope_bytes(e, true).bytes);
        bool planet = e->chart[0].container.info.terrain.radius > 0;
        if (k % 2 || !planet)
            refuse_envelope(e, k % 2 ? "one cap alone" : "caps of a flat terrain");
        e->charts = 3;
        tc_envelope_free(e);
    }
}

/* A container that is of another version, or a planet with caps of its own. */
static void containers_within_are_plain(void **state)
{
    (void)state;
    test_random r = {37};
    tc_envelope *e = make_envelope(&r, true);
    tc_byte_writer w = envelope_bytes(e, true);
    for (int n = 0; n < 3; n++) {
        size_t head = envelope_head_at(w.bytes, n);
        refuse(&w, head, 0, 1);                                                          /* magic */
        assert_int_equal(try_at(&w, head + 8, 3, 4), TC_ERR_UNSUPPORTED);                /* version */
        refuse(&w, head + 8, n == 0 ? 1 : 2, 4), refuse(&w, head + 20, e->bytes + 1, 8); /* size of the file */
        assert_int_equal(try_at(&w, head + 29, 2, 1), TC_ERR_UNSUPPORTED);               /* charts */
        assert_true(try_at(&w, head + 29, 3, 1) != TC_OK);
        refuse(&w, head + 30, !w.bytes[head + 30], 1); /* wraps */
    }
    free(w.bytes);
    tc_envelope_free(e);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(envelopes_come_back),       cmocka_unit_test(unknown_sections_are_skipped),
        cmocka_unit_test(flattening_comes_back),     cmocka_unit_test(credits_come_back),
        cmocka_unit_test(fits_that_lie_are_refused), cmocka_unit_test(tables_that_lie_are_refused),
        cmocka_unit_test(levels_must_lie_in_order),  cmocka_unit_test(endless_levels_are_refused),
        cmocka_unit_test(charts_must_fit),           cmocka_unit_test(containers_within_are_plain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* moody.c - a field that is not always ready. */
#include "moody.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"

static int64_t tiles_across(const moody_field *m, int level)
{
    return m->head.level[level - 1].width / MOODY_TILE + 1;
}

static int64_t tiles_of(const moody_field *m, int level)
{
    return tiles_across(m, level) * (m->head.level[level - 1].height / MOODY_TILE + 1);
}

/* Tiles that rect touches, of which some may be the same where the level wraps. */
static tc_rect touched(tc_rect r)
{
    return (tc_rect){tc_floor_shift(r.x0, 5), tc_floor_shift(r.y0, 5), tc_floor_shift(r.x1 - 1, 5) + 1,
                     tc_floor_shift(r.y1 - 1, 5) + 1};
}

/* Columns of tiles go on around a level that wraps; the last one of those may be narrower, which is all one here. */
static bool *tile(moody_field *m, int level, int64_t tx, int64_t ty)
{
    int64_t across = tiles_across(m, level);
    return &m->decoded[level - 1][ty * across + (tx % across + across) % across];
}

static bool all_decoded(moody_field *m, int level, tc_rect rect)
{
    tc_rect t = touched(rect);
    for (int64_t ty = t.y0; ty < t.y1; ty++)
        for (int64_t tx = t.x0; tx < t.x1; tx++)
            if (!*tile(m, level, tx, ty))
                return false;
    return true;
}

static tc_ready ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    moody_field *m = (moody_field *)field;
    if (m->on && m->says_so && m->failing_level && level >= m->failing_level) {
        m->tries++;
        return TC_FAILED;
    }
    if (!m->on || !m->most || all_decoded(m, level, rect))
        return TC_READY;
    if (urgency != TC_ONLY_ASK)
        m->wish[level - 1] = rect;
    return TC_COMING;
}

static tc_status read_mood(const tc_field *field, int level, tc_rect rect, void *z, uint8_t *voids, ptrdiff_t stride)
{
    moody_field *m = (moody_field *)field;
    if (m->on && m->most && !all_decoded(m, level, rect))
        m->waits++;
    if (m->on && ((m->failing_level && level >= m->failing_level) || test_random_unit(&m->random) < m->failing)) {
        m->tries++;
        return TC_ERR_IO;
    }
    return tc_field_read(m->base, level, rect, z, voids, stride);
}

static tc_range range(const tc_field *field, int level, tc_rect rect)
{
    return tc_field_range(((const moody_field *)field)->base, level, rect);
}

moody_field *moody_create(const tc_field *base, uint64_t seed)
{
    static const tc_field_class class = {.read = read_mood, .range = range, .ready = ready};
    moody_field *m = calloc(1, sizeof *m);
    if (m) {
        m->head = *base;
        m->head.class = &class;
        m->base = base;
        m->random = (test_random){seed};
        for (int l = 1; l <= base->info.levels; l++)
            if (!(m->decoded[l - 1] = calloc((size_t)tiles_of(m, l), sizeof(bool))))
                exit(99);
    }
    return m;
}

void moody_destroy(moody_field *m)
{
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        free(m->decoded[l]);
    free(m);
}

void moody_work(moody_field *m)
{
    for (int l = 1; l <= m->head.info.levels; l++) {
        tc_rect t = touched(m->wish[l - 1]);
        int64_t there = 0, all = tiles_of(m, l);
        if (tc_rect_empty(m->wish[l - 1]) || tc_rect_area(t) > m->most)
            continue; /* the first ones would make room for the last */
        for (int64_t k = 0; k < all; k++)
            there += m->decoded[l - 1][k];
        if (there + tc_rect_area(t) > m->most)
            memset(m->decoded[l - 1], 0, (size_t)all * sizeof(bool));
        for (int64_t ty = t.y0; ty < t.y1; ty++)
            for (int64_t tx = t.x0; tx < t.x1; tx++)
                *tile(m, l, tx, ty) = true;
        m->wish[l - 1] = (tc_rect){0, 0, 0, 0};
    }
}

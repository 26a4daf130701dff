/* packed_range.c - bounds of heights from what has been read of the index; the rest of it is asked for. */
#include <math.h>

#include "common/base/rect.h"
#include "packed_internal.h"

/* Asks for pages, of the index or of errors, that would make bounds narrower. */
static void ask_for(packed_field *p, int index, int l, const tc_missing_pages *missing)
{
    for (int n = 0; n < missing->count; n++) {
        int64_t x = missing->page[n][0], y = missing->page[n][1];
        if (tc_faults_pause(&p->store->faults, tc_packed_wish_key(p, index, l, x, y)))
            continue;
        tc_wish wish = {.field = p, .level = l, .index = index, .rect = {x, y, x + 1, y + 1}, .urgency = TC_SOON};
        if (!tc_prefetch_ask(&p->store->prefetch, &wish))
            return;
    }
}

/* tiles: of the index; of a level that stands in the head its samples. */
static float error_of(packed_field *p, int l, tc_rect samples, tc_rect tiles, int64_t most_x, int *reads)
{
    if (!p->errors_known)
        return INFINITY;
    if (p->errors == ERRORS_BY_STEPS)
        return tc_range_ask(&p->error[l - 1], tiles, most_x, reads).error;
    if (p->errors == ERRORS_MEASURED)
        return tc_measured_error(&p->error[l - 1], samples, most_x, reads);
    tc_missing_pages missing;
    const float error = tc_packed_file_error(&p->file, l, samples, most_x, reads, &missing);
    ask_for(p, TC_WISH_ERRORS, l, &missing);
    return error;
}

tc_range tc_packed_range(const tc_field *field, int l, tc_rect rect)
{
    enum { FINE = 2 * TC_TILE };
    packed_field *p = (packed_field *)field;
    const tc_container *c = &p->file.container;
    tc_range all = TC_NO_RANGE;
    float error = 0;
    tc_rect piece[2];
    int reads = 0, pieces = tc_rect_round(rect, field->level[l - 1].width, piece);
    for (int n = 0; n < pieces; n++) {
        tc_rect r = piece[n], tiles = {r.x0 / FINE, r.y0 / FINE, (r.x1 - 1) / FINE + 1, (r.y1 - 1) / FINE + 1};
        int64_t most_x = pieces == 1 ? 2 : 1;
        if (l <= c->base) {
            tiles = r;
            all = tc_range_both(all, tc_range_ask(&p->base[l - 1], r, most_x, &reads));
        } else {
            tc_missing_pages missing;
            all = tc_range_both(all, tc_packed_file_range(&p->file, l, tiles, most_x, &reads, &missing));
            ask_for(p, TC_WISH_INDEX, l, &missing);
        }
        error = fmaxf(error, error_of(p, l, r, tiles, most_x, &reads));
    }
    all.error = p->damaged > 0 ? INFINITY : error;
    if (l > c->base && p->damaged > 0) { /* what stands in for damaged tiles lies about within the terrain's range */
        double margin = 0.1 * (c->z_max - c->z_min);
        all = (tc_range){(float)(c->z_min - margin), (float)(c->z_max + margin), INFINITY, INFINITY};
    }
    if (c->voids > 0 && p->voids == TC_VOIDS_CONSTANT)
        all = (tc_range){fminf(all.lo, p->void_height), fmaxf(all.hi, p->void_height), INFINITY,
                         p->errors_known && p->errors == ERRORS_BY_STEPS ? INFINITY : all.error};
    p->ranges++;
    p->range_reads += reads;
    return all;
}

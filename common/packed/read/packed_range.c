/* packed_range.c - bounds of heights from what has been read of the index; the rest of it is asked for. */
#include <math.h>

#include "common/base/rect.h"
#include "packed_internal.h"

/* Asks for pages of the index that would make bounds narrower. */
static void ask_for(packed_field *p, int l, const tc_missing_pages *missing)
{
    for (int n = 0; n < missing->count; n++) {
        int64_t x = missing->page[n][0], y = missing->page[n][1];
        if (tc_faults_pause(&p->store->faults, tc_packed_page_key(p, l, x, y)))
            continue;
        tc_wish wish = {.field = p, .level = l, .index = true, .rect = {x, y, x + 1, y + 1}, .urgency = TC_SOON};
        if (!tc_prefetch_ask(&p->store->prefetch, &wish))
            return;
    }
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
            ask_for(p, l, &missing);
        }
        if (!p->errors_known)
            error = INFINITY;
        else if (p->errors_measured)
            error = fmaxf(error, tc_measured_error(&p->error[l - 1], r, most_x, &reads));
        else
            error = fmaxf(error, tc_range_ask(&p->error[l - 1], tiles, most_x, &reads).error);
    }
    all.error = p->damaged > 0 ? INFINITY : error;
    if (l > c->base && p->damaged > 0) { /* what stands in for damaged tiles lies about within the terrain's range */
        double margin = 0.1 * (c->z_max - c->z_min);
        all = (tc_range){(float)(c->z_min - margin), (float)(c->z_max + margin), INFINITY, INFINITY};
    }
    if (c->voids > 0 && p->voids == TC_VOIDS_CONSTANT)
        all = (tc_range){fminf(all.lo, p->void_height), fmaxf(all.hi, p->void_height), INFINITY,
                         p->errors_measured ? all.error : INFINITY};
    p->ranges++;
    p->range_reads += reads;
    return all;
}

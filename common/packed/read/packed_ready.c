/* packed_ready.c - whether a rectangle can be read without waiting, and the reading ahead that sees to it. */
#include "common/base/rect.h"
#include "packed_internal.h"

enum {
    GUESS_TILES = 16, /* of a level whose coder is not there yet */
    LATER_SHARE = 8   /* of a cache, at most, for one thing that is decoded without being wanted yet */
};

/* What reading a rectangle takes. */
typedef struct survey {
    bool missing, failed;
    size_t own, all; /* bytes of the level's tiles and masks; of coarser levels' too */
} survey;

/* Tiles of a level, and what of the coarser level they and the samples need. */
static tc_rect survey_level(packed_field *p, int l, tc_rect rect, survey *v)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    if (!coder->level.wrap_x && (rect.x0 < 0 || rect.x1 > coder->level.width))
        rect.x0 = 0, rect.x1 = coder->level.width;
    tc_rect r = tc_packed_positions(coder, rect), need = tc_packed_coarse(coder, rect);
    tile_columns t = tc_packed_columns(coder, r.x0, r.x1);
    int64_t y0 = r.y0 / TC_TILE, y1 = (r.y1 - 1) / TC_TILE + 1;
    v->all += (size_t)((y1 - y0) * t.count) * tc_decoded_tile_bytes(coder->coder);
    bool whole = !v->missing || p->store->faults.count > 0; /* else nothing new can be found */
    for (int64_t ty = y0; ty < y1 && whole; ty++)
        for (int64_t n = 0; n < t.count; n++) {
            wanted_tile tile = tc_packed_column(coder, &t, n, ty);
            uint64_t key = tc_packed_tile_key(p, l, t.across, &tile);
            if (tc_block_has(&p->store->blocks, key))
                continue;
            if (tc_packed_known_empty(p, l, &tile)) {
                need = tc_rect_around(need, tc_codec_tile_needs(coder->codec, r));
                continue;
            }
            v->missing = true;
            v->failed |= tc_faults_pause(&p->store->faults, key);
            tc_rect own = tc_level_coder_needs(coder, tile.tx, tile.ty);
            own.x0 += tile.turn, own.x1 += tile.turn;
            need = tc_rect_around(need, own);
        }
    return need;
}

/* Masks are kept whole: those of the level are all that is needed. */
static void survey_masks(packed_field *p, int l, tc_rect rect, survey *v)
{
    const tc_container *c = &p->file.container;
    if (c->voids == 0 || l <= c->base || !c->record[l - 1].mask)
        return;
    tc_rect piece[2];
    int64_t across = tc_level_pages(&c->level[l - 1]).tiles_x;
    for (int n = tc_rect_round(rect, c->level[l - 1].width, piece) - 1; n >= 0; n--)
        for (int64_t ty = piece[n].y0 / MASK_SIDE; ty * MASK_SIDE < piece[n].y1; ty++)
            for (int64_t tx = piece[n].x0 / MASK_SIDE; tx * MASK_SIDE < piece[n].x1; tx++) {
                uint64_t key = tc_packed_key(p, l, true, ty * across + tx);
                v->all += MASK_SIDE * MASK_SIDE;
                if (tc_block_has(&p->store->blocks, key))
                    continue;
                v->missing = true;
                v->failed |= tc_faults_pause(&p->store->faults, key);
            }
}

static survey survey_rect(packed_field *p, int l, tc_rect rect)
{
    survey v = {0};
    survey_masks(p, l, rect, &v);
    for (int k = l; !tc_packed_is_whole(p, k) && !tc_rect_empty(rect); k--) {
        if (p->level[k - 1].ready && !p->level[k - 1].status) {
            rect = survey_level(p, k, rect, &v);
        } else {
            v.missing = true;
            v.failed |= p->level[k - 1].ready; /* its model is damaged */
            v.all += GUESS_TILES * sizeof(tc_decoded_tile);
            break;
        }
        if (k == l)
            v.own = v.all;
        if (tc_packed_is_whole(p, k - 1) && !tc_rect_empty(rect))
            v.missing |= !p->level[k - 2].ready, v.failed |= p->level[k - 2].ready && p->level[k - 2].status;
    }
    if (tc_packed_is_whole(p, l))
        v.missing |= !p->level[l - 1].ready, v.failed |= p->level[l - 1].ready && p->level[l - 1].status;
    return v;
}

tc_ready tc_packed_ready(const tc_field *field, int l, tc_rect rect, tc_urgency urgency)
{
    packed_field *p = (packed_field *)field;
    survey v = survey_rect(p, l, rect);
    tc_block_cache_needs(&p->store->blocks, 2 * v.all);
    if (!v.missing) {
        tc_prefetch_collect(&p->store->prefetch, p, l, rect);
        return TC_READY;
    }
    if (v.failed)
        return TC_FAILED;
    if (urgency == TC_LATER && v.all > p->store->blocks.promised / LATER_SHARE)
        return TC_COMING; /* it would push out what is wanted now */
    tc_wish wish = {.field = p, .level = l, .rect = rect, .urgency = urgency, .bytes = v.own};
    return urgency == TC_ONLY_ASK || tc_prefetch_ask(&p->store->prefetch, &wish) ? TC_COMING : TC_FAILED;
}

void tc_packed_overtaken(const tc_field *field, int l, tc_rect rect)
{
    packed_field *p = (packed_field *)field;
    p->cancelled += tc_prefetch_cancel(&p->store->prefetch, p, l, rect);
}

/* Once around at most, since no more is needed, and on the level. */
static tc_piece read_samples(packed_field *p, tc_wish *wish)
{
    tc_rect block = tc_packed_next_block(wish->rect, block_ahead, &wish->rest), piece[2];
    int pieces = tc_rect_round(block, p->head.level[wish->level - 1].width, piece);
    bool last = tc_rect_empty(wish->rest);
    if (survey_rect(p, wish->level, block).failed)
        return TC_PIECE_FAILED;
    size_t samples = (size_t)tc_rect_area(block);
    scratch *s = tc_packed_borrow(p);
    float *z = malloc(samples * sizeof *z);
    uint8_t *voids = p->file.container.voids > 0 ? malloc(samples) : NULL;
    tc_status status = s && z && (voids || p->file.container.voids == 0) ? TC_OK : TC_ERR_MEMORY;
    for (int n = 0; n < pieces && !status; n++)
        status = tc_packed_read_block(p, wish->level, piece[n],
                                      &(packed_target){piece[n], z, voids, piece[n].x1 - piece[n].x0}, s);
    if (s)
        tc_packed_give_back(p, s);
    free(z), free(voids);
    return status == TC_ERR_MEMORY ? TC_PIECE_NO_MEMORY
           : status                ? TC_PIECE_FAILED
           : last                  ? TC_PIECE_LAST
                                   : TC_PIECE_MORE;
}

tc_piece tc_packed_read_piece(tc_wish *wish)
{
    packed_field *p = wish->field;
    if (!wish->index)
        return read_samples(p, wish);
    const uint64_t key = tc_packed_wish_key(p, wish->index, wish->level, wish->rect.x0, wish->rect.y0);
    tc_status status = wish->index == TC_WISH_ERRORS
                           ? tc_packed_file_error_page(&p->file, wish->level, wish->rect.x0, wish->rect.y0)
                           : tc_packed_file_page(&p->file, wish->level, wish->rect.x0, wish->rect.y0);
    if (status && status != TC_ERR_FORMAT && status != TC_ERR_MEMORY)
        tc_faults_add(&p->store->faults, key);
    else if (!status)
        tc_faults_remove(&p->store->faults, key);
    return status == TC_ERR_MEMORY ? TC_PIECE_NO_MEMORY : status ? TC_PIECE_FAILED : TC_PIECE_LAST;
}

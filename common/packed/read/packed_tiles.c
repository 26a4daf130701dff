/* packed_tiles.c - the tiles of a rectangle: found, made, waited for, and copied to where heights are made of them. */
#include "common/base/rect.h"
#include "packed_internal.h"

static void copy_rect(const int32_t *from, ptrdiff_t stride, tc_rect rect, const tc_plane *to)
{
    tc_rect r = tc_rect_intersect(rect, to->rect);
    for (int64_t y = r.y0; y < r.y1; y++)
        memcpy(tc_plane_at(to, r.x0, y), from + (y - rect.y0) * stride + r.x0 - rect.x0,
               (size_t)(r.x1 - r.x0) * sizeof *from);
}

/* The same for planes that may stick out of a level `width` wide, on every turn that they reach into. */
void tc_packed_copy_round(const int32_t *from, ptrdiff_t stride, tc_rect rect, int64_t width, const tc_plane *to)
{
    for (int64_t turn = tc_turn(to->rect.x0, width); turn < to->rect.x1; turn += width)
        copy_rect(from, stride, (tc_rect){rect.x0 + turn, rect.y0, rect.x1 + turn, rect.y1}, to);
}

static void copy_tile(const tc_level_coder *c, int64_t tx, int64_t ty, const tc_decoded_tile *tile,
                      const tile_planes *to)
{
    tc_rect samples = tc_level_coder_samples(c, tx, ty), positions = tc_level_coder_positions(c, tx, ty);
    int64_t width = c->level.width, cw = tc_coarse_size(width);
    if (c->codec)
        for (int b = 0; b < TC_BANDS; b++)
            tc_packed_copy_round(tile->band[b][0], TC_TILE, positions, cw, &to->band[b]);
    else
        tc_packed_copy_round(tile->sample[0], TC_TILE_SIDE, samples, width, &to->sample);
    if (c->correction)
        tc_packed_copy_round(tile->correction[0], TC_TILE_SIDE, samples, width, &to->correction);
}

/* ---- Empty tiles -------------------------------------------------------------------------------------------------
 *
 * What a tile without a byte gives follows from the coarser level alone, so that it need neither be kept nor made as a
 * whole: it is worked out where it is wanted. */

/* The rectangle, in positions, of a tile on the turn that begins at `turn`. */
static tc_rect tile_on_turn(const tc_level_coder *c, int64_t tx, int64_t ty, int64_t turn)
{
    tc_rect r = tc_level_coder_positions(c, tx, ty);
    return (tc_rect){r.x0 + turn, r.y0, r.x1 + turn, r.y1};
}

static void clear_rect(tc_rect rect, int64_t width, const tc_plane *to)
{
    for (int64_t turn = tc_turn(to->rect.x0, width); turn < to->rect.x1; turn += width) {
        tc_rect r = tc_rect_intersect((tc_rect){rect.x0 + turn, rect.y0, rect.x1 + turn, rect.y1}, to->rect);
        for (int64_t y = r.y0; y < r.y1; y++)
            memset(tc_plane_at(to, r.x0, y), 0, (size_t)(r.x1 - r.x0) * sizeof *to->z);
    }
}

/* As copy_tile() of what decoding `count` empty tiles side by side would give. */
static void predict_tiles(const tc_level_coder *c, const wanted_tile *tile, int count, const tc_plane *coarse,
                          const tile_planes *to, scratch *s)
{
    tc_rect all = to->band[0].rect;
    int64_t cw = tc_coarse_size(c->level.width), tx = tile->tx, ty = tile->ty;
    for (int64_t turn = tc_turn(all.x0, cw); turn < all.x1; turn += cw) {
        tc_rect part = tile_on_turn(c, tx, ty, turn);
        part.x1 = tile_on_turn(c, tx + count - 1, ty, turn).x1;
        part = tc_rect_intersect(part, all);
        if (!tc_rect_empty(part))
            tc_codec_predict(c->codec, part, coarse, to->band, s->work[0], TC_SIMD_AUTO);
    }
    for (int n = 0; n < count && c->correction; n++)
        clear_rect(tc_level_coder_samples(c, tx + n, ty), c->level.width, &to->correction);
}

/* How many tiles, the first of them empty, lie side by side and are empty. */
static int empty_run(const wanted_tile *tile, int count)
{
    int n = 1;
    while (n < count && tile[n].empty && tile[n].ty == tile->ty && tile[n].tx == tile->tx + n)
        n++;
    return n;
}

/* ---- Tiles of a rectangle ---------------------------------------------------------------------------------------- */

tile_columns tc_packed_columns(const tc_level_coder *c, int64_t x0, int64_t x1)
{
    int64_t cw = tc_coarse_size(c->level.width), turn = tc_turn(x0, cw), last_turn = tc_turn(x1 - 1, cw);
    tile_columns t = {turn, (x0 - turn) / TC_TILE, 0, (cw + TC_TILE - 1) / TC_TILE};
    t.count = tc_min64(t.across, (last_turn - turn) / cw * t.across + (x1 - 1 - last_turn) / TC_TILE - t.first + 1);
    return t;
}

wanted_tile tc_packed_column(const tc_level_coder *c, const tile_columns *t, int64_t n, int64_t ty)
{
    int64_t at = t->first + n;
    int64_t turn = t->turn + at / t->across * tc_coarse_size(c->level.width);
    return (wanted_tile){.tx = at % t->across, .ty = ty, .turn = turn};
}

uint64_t tc_packed_tile_key(const packed_field *p, int l, int64_t across, const wanted_tile *t)
{
    return tc_packed_key(p, l, false, t->ty * across + t->tx);
}

/* Whether it is known to be empty. */
static bool is_empty(packed_field *p, int l, const wanted_tile *t)
{
    tc_tile_entry entry;
    return p->level[l - 1].coder.codec && tc_packed_file_entry(&p->file, l, t->tx, t->ty, &entry) == TC_OK &&
           tc_tile_bytes(&entry) == 0;
}

bool tc_packed_known_empty(packed_field *p, int l, const wanted_tile *t)
{
    return tc_packed_file_known(&p->file, l, t->tx, t->ty) && is_empty(p, l, t);
}

tc_rect tc_packed_positions(const tc_level_coder *c, tc_rect rect)
{
    return c->codec ? tc_lifting_needs(&c->level, rect)
                    : (tc_rect){tc_floor_shift(rect.x0, 1), rect.y0 / 2, tc_ceil_shift(rect.x1, 1), (rect.y1 + 1) / 2};
}

tc_rect tc_packed_coarse(const tc_level_coder *c, tc_rect rect)
{
    return c->codec  ? tc_lifting_needs(&c->level, rect)
           : c->lh04 ? tc_lh04_needs(&c->level, rect)
                     : (tc_rect){0, 0, 0, 0};
}

/* ---- Making tiles ------------------------------------------------------------------------------------------------ */

/* Reads the part of the coarser level that `need` and making the tiles take. */
static tc_status read_coarse(packed_field *p, int l, tc_rect need, const wanted_tile *tile, int count, tc_plane *coarse,
                             scratch *s)
{
    for (int n = 0; n < count; n++)
        if (tile[n].once || (tile[n].block && !tile[n].block->made)) {
            tc_rect own = tc_level_coder_needs(&p->level[l - 1].coder, tile[n].tx, tile[n].ty);
            own.x0 += tile[n].turn, own.x1 += tile[n].turn;
            need = tc_rect_around(need, own);
        }
    tc_status status = tc_scratch_plane(s, need, coarse);
    return status ? status : tc_packed_units(p, l - 1, coarse, s);
}

/* Tiles of one turn read and decoded, a few; those that are wanted once to `to`. What is wrong with them is counted
 * once, and they count as empty. */
static tc_status make_few(packed_field *p, int l, const wanted_tile *const *tile, int count, const tc_plane *coarse,
                          const tile_planes *to, scratch *s)
{
    tc_level_tile job[AT_ONCE];
    tc_plane band[TC_BANDS]; /* as the tiles see them */
    for (int b = 0; b < TC_BANDS && to; b++) {
        band[b] = to->band[b];
        band[b].rect.x0 -= tile[0]->turn, band[b].rect.x1 -= tile[0]->turn;
    }
    int64_t across = (tc_coarse_size(p->head.level[l - 1].width) + TC_TILE - 1) / TC_TILE;
    s->waited = true;
    for (int n = 0; n < count; n++) {
        tc_level_tile *t = &job[n];
        *t = (tc_level_tile){.tx = tile[n]->tx, .ty = tile[n]->ty, .work = s->work[n]};
        if (tile[n]->once)
            t->band = band;
        else
            t->to = (tc_decoded_tile *)tile[n]->block->bytes;
        tc_status status = tc_packed_file_entry(&p->file, l, t->tx, t->ty, &t->entry);
        if (!status)
            status = tc_packed_file_tile(&p->file, &t->entry, s->stream[n], tc_level_coder_bound());
        if (status && status != TC_ERR_FORMAT) { /* no damage: it may come another time */
            if (status != TC_ERR_MEMORY)
                tc_faults_add(&p->store->faults, tc_packed_tile_key(p, l, across, tile[n]));
            return status;
        }
        tc_faults_remove(&p->store->faults, tc_packed_tile_key(p, l, across, tile[n]));
        t->bytes = status ? NULL : s->stream[n];
    }
    tc_plane turned = *coarse; /* as the tiles see it */
    turned.rect.x0 -= tile[0]->turn, turned.rect.x1 -= tile[0]->turn;
    tc_level_coder_decode(&p->level[l - 1].coder, job, count, &turned);
    for (int n = 0; n < count; n++)
        if (job[n].status)
            p->damaged += tc_tile_set_add(&p->damage, tc_packed_tile_key(p, l, across, tile[n]));
        else
            p->decoded += tc_tile_bytes(&job[n].entry);
    return TC_OK;
}

/* Bytes of a level's tile, decoded. */
static size_t tile_bytes(const packed_field *p, int l)
{
    return tc_decoded_tile_bytes(p->file.container.record[l - 1].coder);
}

/* Whether a tile that a large block takes is of no use to what may be read next to it. Of a block of a coarser level
 * all are of use, to the finer level's. */
static bool is_wanted_once(const packed_field *p, int l, const wanted_tile *t, tc_rect positions, const scratch *s)
{
    const tc_level_coder *c = &p->level[l - 1].coder;
    /* How far another block reaches into this one; in coarser levels it takes what lies around whole tiles. */
    int64_t reach = l == s->large ? 2 * TC_LIFTING_REACH : TC_TILE;
    tc_rect inner = {positions.x0 + reach, positions.y0 + reach, positions.x1 - reach, positions.y1 - reach};
    return s->large && c->coder == TC_CODER_LIFTING && positions.x1 - positions.x0 <= tc_coarse_size(c->level.width) &&
           tc_rect_within(tile_on_turn(c, t->tx, t->ty, t->turn), inner);
}

/* Takes a tile that is kept or is to be made, or finds that it is empty or that another thread is making it. */
static tc_status take_tile(packed_field *p, int l, uint64_t key, wanted_tile *t, tc_rect positions, scratch *s)
{
    bool busy = false;
    if ((t->block = tc_block_find(&p->store->blocks, key)))
        return TC_OK;
    bool at_hand = tc_packed_file_known(&p->file, l, t->tx, t->ty);
    if (s->only_ready) {
        t->empty = at_hand && is_empty(p, l, t);
        s->missed = !t->empty;
        return t->empty ? TC_OK : TC_ERR_IO;
    }
    s->waited |= !at_hand;
    tc_tile_entry entry;
    tc_status status = tc_packed_file_entry(&p->file, l, t->tx, t->ty, &entry);
    if (status && status != TC_ERR_FORMAT) { /* nor could its neighbours' */
        if (status != TC_ERR_MEMORY)
            tc_faults_add(&p->store->faults, key);
        return status;
    }
    t->empty = !status && p->level[l - 1].coder.codec && tc_tile_bytes(&entry) == 0;
    if (!status) { /* its page was read, and is no fault any more; nor is a tile without bytes */
        tc_faults_remove(&p->store->faults, tc_packed_page_key(p, l, t->tx / TC_PAGE_COLUMNS, t->ty / TC_PAGE_ROWS));
        if (t->empty)
            tc_faults_remove(&p->store->faults, key);
    }
    if (t->empty || (t->once = !status && is_wanted_once(p, l, t, positions, s)))
        return TC_OK;
    t->block = tc_block_try(&p->store->blocks, key, tile_bytes(p, l), &busy);
    return t->block || busy ? TC_OK : TC_ERR_MEMORY;
}

/* Makes the next few of the tiles that nobody else has made or is making; behind row ty only what is kept. */
static tc_status make_next(gathering *g, int64_t ty, const tile_planes *to)
{
    const wanted_tile *few[AT_ONCE];
    int held = 0;
    for (; g->begun < g->count && held < AT_ONCE; g->begun++) {
        const wanted_tile *t = &g->tile[g->begun];
        if (!t->once && (!t->block || t->block->made))
            continue;
        if ((t->once && t->ty > ty) || (held > 0 && t->turn != few[0]->turn))
            break;
        few[held++] = t;
    }
    tc_status status = held > 0 ? make_few(g->field, g->level, few, held, &g->coarse, to, g->scratch) : TC_OK;
    for (int n = 0; n < held; n++)
        if (few[n]->block)
            tc_block_made(&g->field->store->blocks, few[n]->block, !status);
    return status;
}

/* A tile that another thread was making. */
static tc_status await_tile(const gathering *g, wanted_tile *t)
{
    packed_field *p = g->field;
    int l = g->level;
    g->scratch->waited = true;
    t->block = tc_block_pin(&p->store->blocks, tc_packed_tile_key(p, l, g->across, t), tile_bytes(p, l));
    if (!t->block)
        return TC_ERR_MEMORY;
    if (t->block->made)
        return TC_OK;
    mark m = tc_scratch_here(g->scratch);
    tc_plane coarse = {0};
    tc_status status = read_coarse(p, l, (tc_rect){0, 0, 0, 0}, t, 1, &coarse, g->scratch);
    if (!status)
        status = make_few(p, l, (const wanted_tile *[]){t}, 1, &coarse, NULL, g->scratch);
    tc_block_made(&p->store->blocks, t->block, !status);
    tc_scratch_return(g->scratch, m);
    return status;
}

/* ---- Gathering --------------------------------------------------------------------------------------------------- */

tc_status tc_gather_begin(packed_field *p, int l, tc_rect positions, tc_rect need, scratch *s, gathering *g)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    tile_columns t = tc_packed_columns(coder, positions.x0, positions.x1);
    int64_t ty = positions.y0 / TC_TILE, all = ((positions.y1 - 1) / TC_TILE + 1 - ty) * t.count;
    *g = (gathering){.field = p, .level = l, .scratch = s, .across = t.across};
    if (!(g->tile = tc_scratch_take(s, (size_t)all * sizeof *g->tile)))
        return TC_ERR_MEMORY;
    tc_status status = TC_OK;
    for (int64_t k = 0; k < all && !status; k++) {
        wanted_tile *w = &g->tile[g->count];
        *w = tc_packed_column(coder, &t, k % t.count, ty + k / t.count);
        status = take_tile(p, l, tc_packed_tile_key(p, l, t.across, w), w, positions, s);
        if (w->empty)
            need = tc_rect_around(need, tc_codec_tile_needs(coder->codec, positions));
        g->count += status == TC_OK;
    }
    return status ? status : read_coarse(p, l, need, g->tile, g->count, &g->coarse, s);
}

tc_status tc_gather_row(gathering *g, int64_t ty, const tile_planes *to)
{
    const tc_level_coder *coder = &g->field->level[g->level - 1].coder;
    tc_status status = TC_OK;
    while (!status && g->done < g->count && g->tile[g->done].ty <= ty) {
        wanted_tile *t = &g->tile[g->done];
        if (t->empty) {
            int run = empty_run(t, g->count - g->done);
            predict_tiles(coder, t, run, &g->coarse, to, g->scratch);
            g->done += run;
            continue;
        }
        while (!status && g->begun < g->count && g->tile[g->begun].ty <= ty)
            status = make_next(g, ty, to);
        if (!status && !t->block && !t->once)
            status = await_tile(g, t);
        if (status)
            break;
        g->done++;
        if (t->once)
            continue;
        copy_tile(coder, t->tx, t->ty, (const tc_decoded_tile *)t->block->bytes, to);
        tc_block_release(&g->field->store->blocks, t->block);
    }
    return status;
}

void tc_gather_end(gathering *g)
{
    tc_block_cache *blocks = &g->field->store->blocks;
    for (int n = g->done; n < g->count; n++) {
        tc_block *block = g->tile[n].block;
        if (block && !block->made)
            tc_block_made(blocks, block, false);
        if (block)
            tc_block_release(blocks, block);
    }
}

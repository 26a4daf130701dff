/* packed_heights.c - heights of a rectangle, in height units: from the coarser level around half of it and from the
 * tiles that it touches; the coarser level's likewise, down to a level small enough to be held whole. A damaged tile
 * counts as one without details. */
#include "common/base/rect.h"
#include "packed_internal.h"

bool tc_packed_is_whole(const packed_field *p, int l)
{
    const tc_level *level = &p->head.level[l - 1];
    return l <= p->file.container.base || (level->width <= WHOLE_SIZE && level->height <= WHOLE_SIZE);
}

tc_status tc_scratch_plane(scratch *s, tc_rect rect, tc_plane *plane_ret)
{
    *plane_ret = (tc_plane){tc_scratch_take(s, (size_t)tc_rect_area(rect) * sizeof(int32_t)), rect.x1 - rect.x0, rect};
    return plane_ret->z ? TC_OK : TC_ERR_MEMORY;
}

/* Where a level's tiles go: those of the planes that the coder makes use of. */
typedef struct tile_planes {
    tc_plane band[TC_BANDS], sample, correction;
} tile_planes;

static void copy_rect(const int32_t *from, ptrdiff_t stride, tc_rect rect, const tc_plane *to)
{
    tc_rect r = tc_rect_intersect(rect, to->rect);
    for (int64_t y = r.y0; y < r.y1; y++)
        memcpy(tc_plane_at(to, r.x0, y), from + (y - rect.y0) * stride + r.x0 - rect.x0,
               (size_t)(r.x1 - r.x0) * sizeof *from);
}

/* The same for planes that may stick out of a level `width` wide, on every turn that they reach into. */
static void copy_round(const int32_t *from, ptrdiff_t stride, tc_rect rect, int64_t width, const tc_plane *to)
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
            copy_round(tile->band[b][0], TC_TILE, positions, cw, &to->band[b]);
    else
        copy_round(tile->sample[0], TC_TILE_SIDE, samples, width, &to->sample);
    if (c->correction)
        copy_round(tile->correction[0], TC_TILE_SIDE, samples, width, &to->correction);
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

/* As copy_tile() of what decoding the tile would give. */
static void predict_tile(const tc_level_coder *c, int64_t tx, int64_t ty, const tc_plane *coarse, const tile_planes *to,
                         scratch *s)
{
    tc_rect all = to->band[0].rect;
    int64_t cw = tc_coarse_size(c->level.width);
    for (int64_t turn = tc_turn(all.x0, cw); turn < all.x1; turn += cw) {
        tc_rect part = tc_rect_intersect(tile_on_turn(c, tx, ty, turn), all);
        if (!tc_rect_empty(part))
            tc_codec_predict(c->codec, part, coarse, to->band, s->work[0], TC_SIMD_AUTO);
    }
    if (c->correction)
        clear_rect(tc_level_coder_samples(c, tx, ty), c->level.width, &to->correction);
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
    return (wanted_tile){at % t->across, ty, t->turn + at / t->across * tc_coarse_size(c->level.width), false, NULL};
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

/* Reads the part of the coarser level that `need` and making the tiles take. */
static tc_status read_coarse(packed_field *p, int l, tc_rect need, const wanted_tile *tile, int count, tc_plane *coarse,
                             scratch *s)
{
    for (int n = 0; n < count; n++)
        if (tile[n].block && !tile[n].block->made) {
            tc_rect own = tc_level_coder_needs(&p->level[l - 1].coder, tile[n].tx, tile[n].ty);
            own.x0 += tile[n].turn, own.x1 += tile[n].turn;
            need = tc_rect_around(need, own);
        }
    tc_status status = tc_scratch_plane(s, need, coarse);
    return status ? status : tc_packed_units(p, l - 1, coarse, s);
}

/* Tiles of one turn read and decoded, a few. What is wrong with them is counted, and they count as empty. */
static tc_status make_few(packed_field *p, int l, const wanted_tile *const *tile, int count, const tc_plane *coarse,
                          scratch *s)
{
    tc_level_tile job[AT_ONCE];
    int64_t across = (tc_coarse_size(p->head.level[l - 1].width) + TC_TILE - 1) / TC_TILE;
    s->waited = true;
    for (int n = 0; n < count; n++) {
        tc_level_tile *t = &job[n];
        *t = (tc_level_tile){
            .tx = tile[n]->tx, .ty = tile[n]->ty, .to = (tc_decoded_tile *)tile[n]->block->bytes, .work = s->work[n]};
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
            p->damaged++;
        else
            p->decoded += tc_tile_bytes(&job[n].entry);
    return TC_OK;
}

/* Makes those tiles that nobody else has made or is making; where the coarser level could not be had (NULL), or bytes
 * cannot, they fail. */
static tc_status make_tiles(packed_field *p, int l, const wanted_tile *tile, int count, const tc_plane *coarse,
                            scratch *s)
{
    const wanted_tile *few[AT_ONCE];
    int held = 0;
    tc_status status = TC_OK;
    for (int n = 0; n < count; n++) {
        if (tile[n].block && !tile[n].block->made)
            few[held++] = &tile[n];
        if (held == 0 || (held < AT_ONCE && n < count - 1 && tile[n + 1].turn == few[0]->turn))
            continue;
        if (coarse && !status)
            status = make_few(p, l, few, held, coarse, s);
        for (; held > 0; held--)
            tc_block_made(&p->store->blocks, few[held - 1]->block, coarse && !status);
    }
    return status;
}

/* Bytes of a level's tile, decoded. */
static size_t tile_bytes(const packed_field *p, int l)
{
    return tc_decoded_tile_bytes(p->file.container.record[l - 1].coder);
}

/* Takes a tile that is kept or is to be made, or finds that it is empty or that another thread is making it. */
static tc_status take_tile(packed_field *p, int l, uint64_t key, wanted_tile *t, scratch *s)
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
    if (t->empty)
        return TC_OK;
    t->block = tc_block_try(&p->store->blocks, key, tile_bytes(p, l), &busy);
    return t->block || busy ? TC_OK : TC_ERR_MEMORY;
}

/* A tile that another thread was making. */
static tc_status await_tile(packed_field *p, int l, uint64_t key, wanted_tile *t, scratch *s)
{
    s->waited = true;
    if (!(t->block = tc_block_pin(&p->store->blocks, key, tile_bytes(p, l))))
        return TC_ERR_MEMORY;
    if (t->block->made)
        return TC_OK;
    mark m = tc_scratch_here(s);
    tc_plane coarse = {0};
    tc_status status = read_coarse(p, l, (tc_rect){0, 0, 0, 0}, t, 1, &coarse, s);
    tc_status made = make_tiles(p, l, t, 1, status ? NULL : &coarse, s);
    tc_scratch_return(s, m);
    return status ? status : made;
}

/* Reads at least `need` of the coarser level, and copies from all tiles that touch the positions; empty ones it works
 * out. First it takes the tiles that nobody is making, makes what is missing of them from one reading of the coarser
 * level, and only then waits for others: who waits for a tile holds no unmade one of its level or a coarser one, so
 * that somebody always goes on. */
static tc_status gather(packed_field *p, int l, tc_rect positions, tc_rect need, const tile_planes *to,
                        tc_plane *coarse, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    tile_columns t = tc_packed_columns(coder, positions.x0, positions.x1);
    int64_t across = t.across, ty = positions.y0 / TC_TILE, all = ((positions.y1 - 1) / TC_TILE + 1 - ty) * t.count;
    wanted_tile *tile = tc_scratch_take(s, (size_t)all * sizeof *tile);
    if (!tile)
        return TC_ERR_MEMORY;
    int count = 0;
    tc_status status = TC_OK;
    for (int64_t k = 0; k < all && !status; k++) {
        wanted_tile *w = &tile[count];
        *w = tc_packed_column(coder, &t, k % t.count, ty + k / t.count);
        status = take_tile(p, l, tc_packed_tile_key(p, l, across, w), w, s);
        if (w->empty)
            need = tc_rect_around(need, tc_codec_tile_needs(coder->codec, positions));
        count += status == TC_OK;
    }
    if (!status)
        status = read_coarse(p, l, need, tile, count, coarse, s);
    tc_status made = make_tiles(p, l, tile, count, status ? NULL : coarse, s);
    status = status ? status : made;
    for (int n = 0; n < count; n++) {
        if (tile[n].empty) {
            if (!status)
                predict_tile(coder, tile[n].tx, tile[n].ty, coarse, to, s);
            continue;
        }
        if (!tile[n].block && !status)
            status = await_tile(p, l, tc_packed_tile_key(p, l, across, &tile[n]), &tile[n], s);
        if (!tile[n].block)
            continue;
        if (!status)
            copy_tile(coder, tile[n].tx, tile[n].ty, (const tc_decoded_tile *)tile[n].block->bytes, to);
        tc_block_release(&p->store->blocks, tile[n].block);
    }
    return status;
}

/* Details and the coarser level make heights, which may then be corrected. */
static tc_status synthesise_lifting(packed_field *p, int l, const tc_plane *to, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    tc_rect need = tc_lifting_needs(&coder->level, to->rect);
    tile_planes planes = {0};
    tc_plane coarse = {0};
    tc_status status = TC_OK;
    for (int b = 0; b < TC_BANDS && !status; b++)
        status = tc_scratch_plane(s, need, &planes.band[b]);
    if (!status && coder->correction)
        status = tc_scratch_plane(s, to->rect, &planes.correction);
    if (!status)
        status = gather(p, l, need, need, &planes, &coarse, s);
    int32_t *work = NULL;
    if (!status && !(work = tc_scratch_take(s, tc_lifting_synthesise_scratch(&coder->level, to->rect) * sizeof *work)))
        status = TC_ERR_MEMORY;
    if (status)
        return status;
    tc_lifting_synthesise(&coder->level, &coarse, planes.band, to, work, TC_SIMD_AUTO);
    for (int64_t y = to->rect.y0; y < to->rect.y1 && coder->correction; y++)
        tc_level_coder_correct(coder, tc_plane_at(to, to->rect.x0, y), tc_plane_at(&planes.correction, to->rect.x0, y),
                               to->rect.x1 - to->rect.x0);
    return TC_OK;
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

static tc_status synthesise(packed_field *p, int l, const tc_plane *to, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    mark m = tc_scratch_here(s);
    tc_status status = TC_OK;
    if (coder->codec) {
        status = synthesise_lifting(p, l, to, s);
    } else {
        tc_plane coarse = {0};
        status = gather(p, l, tc_packed_positions(coder, to->rect), tc_packed_coarse(coder, to->rect),
                        &(tile_planes){.sample = *to}, &coarse, s);
        if (!status && coder->lh04)
            tc_lh04_assemble(&coder->level, &coarse, to, to);
    }
    tc_scratch_return(s, m);
    return status;
}

/* Makes a level's decoder and, for a small one, its heights. */
static tc_status prepare(packed_field *p, int l, scratch *s)
{
    level_state *level = &p->level[l - 1];
    if (level->ready)
        return level->status;
    if (s->only_ready) {
        s->missed = true;
        return TC_ERR_IO;
    }
    s->waited = true;
    pthread_mutex_lock(&level->mutex);
    if (!level->ready) {
        const tc_level *size = &p->head.level[l - 1];
        const tc_container *c = &p->file.container;
        tc_lifting_level lifting = l > c->base ? tc_container_lifting(c, l) : (tc_lifting_level){0};
        tc_status status = l > c->base ? tc_level_coder_init(&level->coder, &lifting, &c->record[l - 1]) : TC_OK;
        if (!status && l > c->base && tc_packed_is_whole(p, l)) {
            tc_plane whole = {malloc((size_t)(size->width * size->height) * sizeof(int32_t)),
                              size->width,
                              {0, 0, size->width, size->height}};
            status = whole.z ? synthesise(p, l, &whole, s) : TC_ERR_MEMORY;
            level->whole = whole.z;
        }
        level->status = status;
        if (status == TC_OK || status == TC_ERR_FORMAT) {
            level->ready = true;
        } else { /* another time */
            tc_level_coder_free(&level->coder);
            free(level->whole);
            level->whole = NULL;
        }
    }
    tc_status status = level->status;
    pthread_mutex_unlock(&level->mutex);
    return status;
}

tc_status tc_packed_units(packed_field *p, int l, const tc_plane *to, scratch *s)
{
    if (tc_rect_empty(to->rect))
        return TC_OK;
    tc_status status = prepare(p, l, s);
    const level_state *level = &p->level[l - 1];
    tc_rect r = to->rect;
    int64_t width = p->head.level[l - 1].width;
    if (status)
        return status;
    if (level->whole) {
        copy_round(level->whole, width, (tc_rect){0, 0, width, p->head.level[l - 1].height}, width, to);
        return TC_OK;
    }
    if (level->coder.level.wrap_x || (r.x0 >= 0 && r.x1 <= width))
        return synthesise(p, l, to, s);
    /* The last level that goes round: what it is made of does not. */
    for (int64_t x = r.x0, x1; x < r.x1 && !status; x = x1) {
        int64_t turn = tc_turn(x, width);
        x1 = tc_min64(r.x1, turn + width);
        tc_plane part = {tc_plane_at(to, x, r.y0), to->stride, {x - turn, r.y0, x1 - turn, r.y1}};
        status = synthesise(p, l, &part, s);
    }
    return status;
}

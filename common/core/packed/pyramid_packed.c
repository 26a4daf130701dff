/* pyramid_packed.c - a pyramid read from a packed file.
 *
 * Heights of a rectangle come from the coarser level around half of it and from the tiles that it touches; the coarser
 * level's heights likewise, down to a level small enough to be held whole. What is kept between calls is decoded tiles,
 * which the thin strips of a moving clipmap ask for again and again; heights are made anew each time, which costs less
 * than keeping them. A damaged tile counts as one without details. */
#include <math.h>
#include <stdatomic.h>

#include "common/core/base/rect.h"
#include "common/core/base/status.h"
#include "level_coder.h"
#include "packed_file.h"
#include "prefetch.h"

enum {
    WHOLE_SIZE = 256, /* levels of at most so many samples along a side are held whole */
    CACHE_BYTES = 32 << 20,
    MASK_SIDE = 2 * TC_TILE,
    MASK_BYTES = 8 << 20,
    /* Samples that are read at once: what they take fits into the second cache. */
    BLOCK_WIDTH = 256,
    BLOCK_HEIGHT = 256,
    CHUNK_BYTES = 1 << 20,
    AT_ONCE = 2 /* tiles that are decoded */
};

/* ---- Scratch memory: a stack of chunks, kept from call to call ------------------------------------------------- */

typedef struct chunk {
    struct chunk *before;
    size_t size, used;
    _Alignas(64) unsigned char bytes[];
} chunk;

typedef struct scratch {
    struct scratch *next;
    chunk *top, *spare; /* spare: chunks let go of, largest last */
    void *work[AT_ONCE];
    uint8_t *stream[AT_ONCE]; /* bytes of a tile */
} scratch;

typedef struct mark {
    chunk *top;
    size_t used;
} mark;

static mark scratch_mark(const scratch *s)
{
    return (mark){s->top, s->top ? s->top->used : 0};
}

static void *scratch_take(scratch *s, size_t bytes)
{
    bytes = (bytes + 63) / 64 * 64;
    if (!s->top || s->top->size - s->top->used < bytes) {
        chunk *c = s->spare;
        if (c && c->size >= bytes) {
            s->spare = c->before;
        } else {
            size_t size = bytes > CHUNK_BYTES ? bytes : CHUNK_BYTES;
            c = aligned_alloc(64, (sizeof *c + size + 63) / 64 * 64);
            if (!c)
                return NULL;
            c->size = size;
        }
        c->used = 0, c->before = s->top, s->top = c;
    }
    s->top->used += bytes;
    return s->top->bytes + s->top->used - bytes;
}

static void scratch_return(scratch *s, mark m)
{
    while (s->top != m.top) {
        chunk *c = s->top;
        s->top = c->before;
        c->before = s->spare, s->spare = c;
    }
    if (s->top)
        s->top->used = m.used;
}

static void scratch_free(scratch *s)
{
    scratch_return(s, (mark){NULL, 0});
    while (s->spare) {
        chunk *c = s->spare;
        s->spare = c->before;
        free(c);
    }
    for (int n = 0; n < AT_ONCE; n++)
        free(s->work[n]), free(s->stream[n]);
    free(s);
}

/* ---- The pyramid ------------------------------------------------------------------------------------------------ */

/* What is made of a level when it is first needed. */
typedef struct level_state {
    pthread_mutex_t mutex;
    _Atomic bool ready;
    tc_status status;
    tc_level_coder coder;
    int32_t *whole; /* heights in height units, [j * width + i]; NULL for large levels */
} level_state;

typedef struct packed_pyramid {
    tc_pyramid head;
    tc_packed_file file;
    tc_block_cache tiles, masks; /* masks: as bytes, [j][i] over 128 x 128 samples */
    level_state level[TC_MAX_PYRAMID_LEVELS];
    pthread_mutex_t mutex;
    scratch *idle;
    tc_prefetch prefetch;
    tc_void_policy voids;
    float void_height; /* metres above z_base */
    _Atomic int64_t damaged, decoded;
} packed_pyramid;

static scratch *borrow(packed_pyramid *p)
{
    pthread_mutex_lock(&p->mutex);
    scratch *s = p->idle;
    if (s)
        p->idle = s->next;
    pthread_mutex_unlock(&p->mutex);
    if (s || !(s = calloc(1, sizeof *s)))
        return s;
    bool enough = true;
    for (int n = 0; n < AT_ONCE; n++) {
        s->work[n] = malloc(tc_level_coder_work_bytes());
        s->stream[n] = malloc(tc_level_coder_bound());
        enough &= s->work[n] && s->stream[n];
    }
    if (enough)
        return s;
    scratch_free(s);
    return NULL;
}

static void give_back(packed_pyramid *p, scratch *s)
{
    pthread_mutex_lock(&p->mutex);
    s->next = p->idle, p->idle = s;
    pthread_mutex_unlock(&p->mutex);
}

/* ---- Heights in height units ------------------------------------------------------------------------------------ */

static tc_status read_units(packed_pyramid *p, int l, const tc_plane *to, scratch *s);

static bool is_whole(const packed_pyramid *p, int l)
{
    const tc_level *level = &p->head.level[l - 1];
    return l <= p->file.container.base || (level->width <= WHOLE_SIZE && level->height <= WHOLE_SIZE);
}

static tc_status take_plane(scratch *s, tc_rect rect, tc_plane *plane_ret)
{
    *plane_ret = (tc_plane){scratch_take(s, (size_t)tc_rect_area(rect) * sizeof(int32_t)), rect.x1 - rect.x0, rect};
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

static void copy_tile(const tc_level_coder *c, int64_t tx, int64_t ty, const tc_decoded_tile *tile,
                      const tile_planes *to)
{
    tc_rect samples = tc_level_coder_samples(c, tx, ty), positions = tc_level_coder_positions(c, tx, ty);
    if (c->codec)
        for (int b = 0; b < TC_BANDS; b++)
            copy_rect(tile->band[b][0], TC_TILE, positions, &to->band[b]);
    else
        copy_rect(tile->sample[0], TC_TILE_SIDE, samples, &to->sample);
    if (c->correction)
        copy_rect(tile->correction[0], TC_TILE_SIDE, samples, &to->correction);
}

/* The least rectangle that holds both. */
static tc_rect rect_around(tc_rect a, tc_rect b)
{
    if (tc_rect_empty(a) || tc_rect_empty(b))
        return tc_rect_empty(a) ? b : a;
    return (tc_rect){tc_min64(a.x0, b.x0), tc_min64(a.y0, b.y0), tc_max64(a.x1, b.x1), tc_max64(a.y1, b.y1)};
}

/* A tile of a gathering. */
typedef struct wanted_tile {
    int64_t tx, ty;
    tc_block *block; /* NULL: another thread is making it */
} wanted_tile;

static uint64_t tile_key(int l, int64_t across, const wanted_tile *t)
{
    return (uint64_t)l << 56 | (uint64_t)(t->ty * across + t->tx);
}

/* Reads the part of the coarser level that `need` and making the tiles take. */
static tc_status read_coarse(packed_pyramid *p, int l, tc_rect need, const wanted_tile *tile, int count,
                             tc_plane *coarse, scratch *s)
{
    for (int n = 0; n < count; n++)
        if (tile[n].block && !tile[n].block->made)
            need = rect_around(need, tc_level_coder_needs(&p->level[l - 1].coder, tile[n].tx, tile[n].ty));
    tc_status status = take_plane(s, need, coarse);
    return status ? status : read_units(p, l - 1, coarse, s);
}

/* Tiles read and decoded, one or two. What is wrong with them is counted, and they count as empty. */
static tc_status make_few(packed_pyramid *p, int l, const wanted_tile *const *tile, int count, const tc_plane *coarse,
                          scratch *s)
{
    tc_level_tile job[AT_ONCE];
    for (int n = 0; n < count; n++) {
        tc_level_tile *t = &job[n];
        *t = (tc_level_tile){
            .tx = tile[n]->tx, .ty = tile[n]->ty, .to = (tc_decoded_tile *)tile[n]->block->bytes, .work = s->work[n]};
        tc_status status = tc_packed_file_entry(&p->file, l, t->tx, t->ty, &t->entry);
        if (!status)
            status = tc_packed_file_tile(&p->file, &t->entry, s->stream[n], tc_level_coder_bound());
        if (status && status != TC_ERR_FORMAT) /* no damage: it may come another time */
            return status;
        t->bytes = status ? NULL : s->stream[n];
    }
    tc_level_coder_decode(&p->level[l - 1].coder, job, count, coarse);
    for (int n = 0; n < count; n++)
        if (job[n].status)
            p->damaged++;
        else
            p->decoded += tc_tile_bytes(&job[n].entry);
    return TC_OK;
}

/* Makes those tiles that nobody else has made or is making; where the coarser level could not be had (NULL), or bytes
 * cannot, they fail. */
static tc_status make_tiles(packed_pyramid *p, int l, const wanted_tile *tile, int count, const tc_plane *coarse,
                            scratch *s)
{
    const wanted_tile *few[AT_ONCE];
    int held = 0;
    tc_status status = TC_OK;
    for (int n = 0; n < count; n++) {
        if (tile[n].block && !tile[n].block->made)
            few[held++] = &tile[n];
        if (held == 0 || (held < AT_ONCE && n < count - 1))
            continue;
        if (coarse && !status)
            status = make_few(p, l, few, held, coarse, s);
        for (; held > 0; held--)
            tc_block_made(&p->tiles, few[held - 1]->block, coarse && !status);
    }
    return status;
}

/* A tile that another thread was making. */
static tc_status await_tile(packed_pyramid *p, int l, uint64_t key, wanted_tile *t, scratch *s)
{
    if (!(t->block = tc_block_pin(&p->tiles, key)))
        return TC_ERR_MEMORY;
    if (t->block->made)
        return TC_OK;
    mark m = scratch_mark(s);
    tc_plane coarse = {0};
    tc_status status = read_coarse(p, l, (tc_rect){0, 0, 0, 0}, t, 1, &coarse, s);
    tc_status made = make_tiles(p, l, t, 1, status ? NULL : &coarse, s);
    scratch_return(s, m);
    return status ? status : made;
}

/* Reads at least `need` of the coarser level, and copies from all tiles that touch the positions. First it takes the
 * tiles that nobody is making, makes what is missing of them from one reading of the coarser level, and only then waits
 * for others: who waits for a tile holds no unmade one of its level or a coarser one, so that somebody always goes
 * on. */
static tc_status gather(packed_pyramid *p, int l, tc_rect positions, tc_rect need, const tile_planes *to,
                        tc_plane *coarse, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    int64_t across = (coder->level.width + TC_TILE_SIDE - 1) / TC_TILE_SIDE;
    tc_rect t = {positions.x0 / TC_TILE, positions.y0 / TC_TILE, (positions.x1 - 1) / TC_TILE + 1,
                 (positions.y1 - 1) / TC_TILE + 1};
    wanted_tile *tile = scratch_take(s, (size_t)tc_rect_area(t) * sizeof *tile);
    if (!tile)
        return TC_ERR_MEMORY;
    int count = 0;
    tc_status status = TC_OK;
    for (int64_t k = 0; k < tc_rect_area(t) && !status; k++) {
        wanted_tile *w = &tile[count];
        bool busy;
        w->tx = t.x0 + k % (t.x1 - t.x0), w->ty = t.y0 + k / (t.x1 - t.x0);
        w->block = tc_block_try(&p->tiles, tile_key(l, across, w), &busy);
        if (w->block || busy)
            count++;
        else
            status = TC_ERR_MEMORY;
    }
    if (!status)
        status = read_coarse(p, l, need, tile, count, coarse, s);
    tc_status made = make_tiles(p, l, tile, count, status ? NULL : coarse, s);
    status = status ? status : made;
    for (int n = 0; n < count; n++) {
        if (!tile[n].block && !status)
            status = await_tile(p, l, tile_key(l, across, &tile[n]), &tile[n], s);
        if (!tile[n].block)
            continue;
        if (!status)
            copy_tile(coder, tile[n].tx, tile[n].ty, (const tc_decoded_tile *)tile[n].block->bytes, to);
        tc_block_release(&p->tiles, tile[n].block);
    }
    return status;
}

/* Details and the coarser level make heights, which may then be corrected. */
static tc_status synthesise_lifting(packed_pyramid *p, int l, const tc_plane *to, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    tc_rect need = tc_lifting_needs(&coder->level, to->rect);
    tile_planes planes = {0};
    tc_plane coarse = {0};
    tc_status status = TC_OK;
    for (int b = 0; b < TC_BANDS && !status; b++)
        status = take_plane(s, need, &planes.band[b]);
    if (!status && coder->correction)
        status = take_plane(s, to->rect, &planes.correction);
    if (!status)
        status = gather(p, l, need, need, &planes, &coarse, s);
    int32_t *work = NULL;
    if (!status && !(work = scratch_take(s, tc_lifting_synthesise_scratch(&coder->level, to->rect) * sizeof *work)))
        status = TC_ERR_MEMORY;
    if (status)
        return status;
    tc_lifting_synthesise(&coder->level, &coarse, planes.band, to, work, TC_SIMD_AUTO);
    for (int64_t y = to->rect.y0; y < to->rect.y1 && coder->correction; y++) {
        int32_t *z = tc_plane_at(to, to->rect.x0, y);
        const int32_t *k = tc_plane_at(&planes.correction, to->rect.x0, y);
        for (int64_t i = 0; i < to->rect.x1 - to->rect.x0; i++)
            z[i] = tc_corrected(coder, z[i], k[i]);
    }
    return TC_OK;
}

/* Positions whose tiles reading rect takes, and the part of the coarser level. */
static tc_rect positions_of(const tc_level_coder *c, tc_rect rect)
{
    return c->codec ? tc_lifting_needs(&c->level, rect)
                    : (tc_rect){rect.x0 / 2, rect.y0 / 2, (rect.x1 + 1) / 2, (rect.y1 + 1) / 2};
}

static tc_rect coarse_of(const tc_level_coder *c, tc_rect rect)
{
    return c->codec  ? tc_lifting_needs(&c->level, rect)
           : c->lh04 ? tc_lh04_needs(&c->level, rect)
                     : (tc_rect){0, 0, 0, 0};
}

static tc_status synthesise(packed_pyramid *p, int l, const tc_plane *to, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    mark m = scratch_mark(s);
    tc_status status = TC_OK;
    if (coder->codec) {
        status = synthesise_lifting(p, l, to, s);
    } else {
        tc_plane coarse = {0};
        status = gather(p, l, positions_of(coder, to->rect), coarse_of(coder, to->rect), &(tile_planes){.sample = *to},
                        &coarse, s);
        if (!status && coder->lh04)
            tc_lh04_assemble(&coder->level, &coarse, to, to);
    }
    scratch_return(s, m);
    return status;
}

/* Makes a level's decoder and, for a small one, its heights. */
static tc_status prepare(packed_pyramid *p, int l, scratch *s)
{
    level_state *level = &p->level[l - 1];
    if (level->ready)
        return level->status;
    pthread_mutex_lock(&level->mutex);
    if (!level->ready) {
        const tc_level *size = &p->head.level[l - 1];
        const tc_container *c = &p->file.container;
        tc_status status = l > c->base ? tc_level_coder_init(&level->coder, size, &c->record[l - 1], c->wrap_x) : TC_OK;
        if (!status && l > c->base && is_whole(p, l)) {
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

static tc_status read_units(packed_pyramid *p, int l, const tc_plane *to, scratch *s)
{
    if (tc_rect_empty(to->rect))
        return TC_OK;
    tc_status status = prepare(p, l, s);
    const level_state *level = &p->level[l - 1];
    if (status || !level->whole)
        return status ? status : synthesise(p, l, to, s);
    for (int64_t y = to->rect.y0; y < to->rect.y1; y++)
        memcpy(tc_plane_at(to, to->rect.x0, y), level->whole + y * p->head.level[l - 1].width + to->rect.x0,
               (size_t)(to->rect.x1 - to->rect.x0) * sizeof(int32_t));
    return TC_OK;
}

/* ---- Masks of voids ---------------------------------------------------------------------------------------------- */

static tc_status read_mask(packed_pyramid *p, int l, const tc_mask_plane *to, scratch *s);

/* The level's tile of the mask. Where it is damaged, each sample is as the coarser one beside it; that the tile is
 * damaged is counted where its heights are read. */
static tc_status make_mask(packed_pyramid *p, int l, int64_t tx, int64_t ty, uint8_t *v, scratch *s)
{
    const tc_lifting_level *level = &p->level[l - 1].coder.level;
    tc_rect rect = tc_mask_tile_rect(level, tx, ty, 0), need = tc_mask_tile_needs(level, rect);
    tc_tile_entry entry = {{0}, 0, 0, 0, 0, 0};
    mark m = scratch_mark(s);
    tc_mask_plane coarse = {scratch_take(s, (size_t)tc_rect_area(need)), need.x1 - need.x0, need};
    tc_mask_plane fine = {v, MASK_SIDE, rect};
    tc_status below = coarse.v ? read_mask(p, l - 1, &coarse, s) : TC_ERR_MEMORY;
    tc_status status = tc_packed_file_entry(&p->file, l, tx, ty, &entry);
    if (!below && !status && entry.mask_class == TC_MASK_CODED)
        status = tc_packed_file_tile(&p->file, &entry, s->stream[0], tc_level_coder_bound());
    if (!below && !status)
        status = tc_mask_decode(level, rect, (tc_mask_class)entry.mask_class, &coarse,
                                s->stream[0] + entry.size[TC_STREAM_HEIGHTS] + entry.size[TC_STREAM_CORRECTIONS],
                                entry.size[TC_STREAM_MASK], &fine);
    if (!below && status && status != TC_ERR_FORMAT)
        below = status;
    for (int64_t y = rect.y0; y < rect.y1 && status && !below; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++)
            v[(y - rect.y0) * MASK_SIDE + x - rect.x0] = coarse.v[(y / 2 - need.y0) * coarse.stride + x / 2 - need.x0];
    scratch_return(s, m);
    return below;
}

static tc_status read_mask(packed_pyramid *p, int l, const tc_mask_plane *to, scratch *s)
{
    const tc_container *c = &p->file.container;
    tc_rect r = to->rect;
    tc_status status = TC_OK;
    if (l <= c->base || !c->record[l - 1].mask) {
        int k = c->base - l; /* coarser masks are finer ones on the same spots */
        for (int64_t y = r.y0; y < r.y1; y++)
            for (int64_t x = r.x0; x < r.x1; x++)
                to->v[(y - r.y0) * to->stride + x - r.x0] =
                    l <= c->base ? c->base_void[(y << k) * c->level[c->base - 1].width + (x << k)] : 0;
        return TC_OK;
    }
    int64_t across = tc_level_pages(&c->level[l - 1]).tiles_x;
    for (int64_t ty = r.y0 / MASK_SIDE; ty * MASK_SIDE < r.y1 && !status; ty++)
        for (int64_t tx = r.x0 / MASK_SIDE; tx * MASK_SIDE < r.x1 && !status; tx++) {
            tc_block *block = tc_block_pin(&p->masks, (uint64_t)l << 56 | (uint64_t)(ty * across + tx));
            if (!block)
                return TC_ERR_MEMORY;
            if (!block->made) {
                status = make_mask(p, l, tx, ty, block->bytes, s);
                tc_block_made(&p->masks, block, status == TC_OK);
            }
            tc_rect tile = tc_mask_tile_rect(&p->level[l - 1].coder.level, tx, ty, 0), cut = tc_rect_intersect(tile, r);
            for (int64_t y = cut.y0; y < cut.y1 && !status; y++)
                memcpy(to->v + (y - r.y0) * to->stride + cut.x0 - r.x0,
                       block->bytes + (y - tile.y0) * MASK_SIDE + cut.x0 - tile.x0, (size_t)(cut.x1 - cut.x0));
            tc_block_release(&p->masks, block);
        }
    return status;
}

/* ---- Interface --------------------------------------------------------------------------------------------------- */

static inline __attribute__((always_inline)) void metres(double origin, double unit, const int32_t *restrict k,
                                                         int64_t count, float *restrict z)
{
    for (int64_t i = 0; i < count; i++)
        z[i] = (float)(origin + unit * k[i]);
}

#if defined __x86_64__ && defined __GNUC__
__attribute__((target("avx2"))) static void metres_avx2(double origin, double unit, const int32_t *k, int64_t count,
                                                        float *z)
{
    metres(origin, unit, k, count, z);
}
#endif

static void to_metres_row(double origin, double unit, const int32_t *k, int64_t count, float *z)
{
#if defined __x86_64__ && defined __GNUC__
    if (__builtin_cpu_supports("avx2")) {
        metres_avx2(origin, unit, k, count, z);
        return;
    }
#endif
    metres(origin, unit, k, count, z);
}

static tc_status read_block(packed_pyramid *p, int l, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                            scratch *s)
{
    const tc_container *c = &p->file.container;
    tc_plane units;
    mark m = scratch_mark(s);
    tc_status status = take_plane(s, rect, &units);
    if (!status)
        status = read_units(p, l, &units, s);
    for (int64_t j = 0; j < rect.y1 - rect.y0 && !status; j++)
        to_metres_row(c->z_origin, c->z_unit, units.z + j * units.stride, rect.x1 - rect.x0, z + j * stride);
    bool flat = p->voids == TC_VOIDS_CONSTANT;
    if (!status && c->voids > 0 && (voids || flat)) {
        tc_mask_plane mask = {voids, stride, rect};
        if (!voids)
            mask = (tc_mask_plane){scratch_take(s, (size_t)tc_rect_area(rect)), rect.x1 - rect.x0, rect};
        status = mask.v ? read_mask(p, l, &mask, s) : TC_ERR_MEMORY;
        for (int64_t j = 0; j < rect.y1 - rect.y0 && flat && !status; j++)
            for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
                if (mask.v[j * mask.stride + i])
                    z[j * stride + i] = p->void_height;
    }
    scratch_return(s, m);
    return status;
}

/* Where a block from x on ends: at a multiple of `most`, but what is not longer stays whole. */
static int64_t next_cut(int64_t x, int64_t end, int64_t most)
{
    return end - x <= most ? end : (x + most) / most * most;
}

static tc_status packed_read(const tc_pyramid *pyramid, int l, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride)
{
    packed_pyramid *p = (packed_pyramid *)pyramid;
    scratch *s = borrow(p);
    if (!s)
        return TC_ERR_MEMORY;
    tc_status status = TC_OK;
    for (int64_t y = rect.y0, y1; y < rect.y1 && !status; y = y1) {
        y1 = next_cut(y, rect.y1, BLOCK_HEIGHT);
        for (int64_t x = rect.x0, x1; x < rect.x1 && !status; x = x1) {
            x1 = next_cut(x, rect.x1, BLOCK_WIDTH);
            tc_rect part = {x, y, x1, y1};
            ptrdiff_t at = (ptrdiff_t)(y - rect.y0) * stride + (x - rect.x0);
            status = read_block(p, l, part, z + at, voids ? voids + at : NULL, stride, s);
            for (int64_t j = 0; j < part.y1 - part.y0 && voids && p->file.container.voids == 0; j++)
                memset(voids + at + j * stride, 0, (size_t)(part.x1 - part.x0));
        }
    }
    give_back(p, s);
    return status;
}

static float to_metres(const tc_container *c, int32_t k)
{
    return (float)(c->z_origin + c->z_unit * k);
}

static void packed_bounds(const tc_pyramid *pyramid, int l, tc_rect rect, float *z_min_ret, float *z_max_ret)
{
    enum { FINE = 2 * TC_TILE, MOST_TILES = 64 };
    packed_pyramid *p = (packed_pyramid *)pyramid;
    const tc_container *c = &p->file.container;
    int32_t low = INT32_MAX, high = INT32_MIN;
    if (l <= c->base) {
        int64_t w = pyramid->level[l - 1].width;
        for (int64_t y = rect.y0; y < rect.y1; y++)
            for (int64_t x = rect.x0; x < rect.x1; x++) {
                int32_t k = p->level[l - 1].whole[y * w + x];
                low = k < low ? k : low, high = k > high ? k : high;
            }
    } else {
        tc_rect t = {rect.x0 / FINE, rect.y0 / FINE, (rect.x1 - 1) / FINE + 1, (rect.y1 - 1) / FINE + 1};
        tc_tile_entry entry;
        bool known = tc_rect_area(t) <= MOST_TILES;
        for (int64_t ty = t.y0; ty < t.y1 && known; ty++)
            for (int64_t tx = t.x0; tx < t.x1 && known; tx++) {
                known = tc_packed_file_entry(&p->file, l, tx, ty, &entry) == TC_OK;
                if (known)
                    low = entry.low < low ? entry.low : low, high = entry.high > high ? entry.high : high;
            }
        if (!known)
            low = c->record[l - 1].lowest, high = c->record[l - 1].highest;
        if (p->damaged > 0) { /* what stands in for damaged tiles lies about within the terrain's range */
            double margin = 0.1 * (c->z_max - c->z_min);
            *z_min_ret = (float)(c->z_min - margin), *z_max_ret = (float)(c->z_max + margin);
            return;
        }
    }
    *z_min_ret = to_metres(c, low), *z_max_ret = to_metres(c, high);
    if (c->voids > 0 && p->voids == TC_VOIDS_CONSTANT) {
        *z_min_ret = fminf(*z_min_ret, p->void_height);
        *z_max_ret = fmaxf(*z_max_ret, p->void_height);
    }
}

/* Reads ahead: what it decodes stays in the caches. */
static void read_ahead(void *context, int l, tc_rect rect)
{
    packed_pyramid *p = context;
    size_t samples = (size_t)tc_rect_area(rect);
    float *z = malloc(samples * sizeof *z);
    uint8_t *voids = p->file.container.voids > 0 ? malloc(samples) : NULL;
    if (z)
        (void)packed_read(&p->head, l, rect, z, voids, rect.x1 - rect.x0); /* who reads it next learns of failures */
    free(z), free(voids);
}

/* Whether all tiles are decoded from level l down to one that is held whole; or so many that the cache could not keep
 * them until they are asked for. */
static bool is_decoded(packed_pyramid *p, int l, tc_rect rect)
{
    for (; !is_whole(p, l) && !tc_rect_empty(rect); l--) {
        if (!p->level[l - 1].ready || p->level[l - 1].status)
            return p->level[l - 1].ready; /* nothing to wait for where it cannot be had */
        const tc_level_coder *coder = &p->level[l - 1].coder;
        tc_rect r = positions_of(coder, rect);
        tc_rect t = {r.x0 / TC_TILE, r.y0 / TC_TILE, (r.x1 - 1) / TC_TILE + 1, (r.y1 - 1) / TC_TILE + 1};
        if (tc_rect_area(t) > p->tiles.most / 4)
            return true;
        int64_t across = (coder->level.width + TC_TILE_SIDE - 1) / TC_TILE_SIDE;
        for (int64_t ty = t.y0; ty < t.y1; ty++)
            for (int64_t tx = t.x0; tx < t.x1; tx++)
                if (!tc_block_has(&p->tiles, tile_key(l, across, &(wanted_tile){tx, ty, NULL})))
                    return false;
        rect = coarse_of(coder, rect);
    }
    return tc_rect_empty(rect) || p->level[l - 1].ready;
}

static bool packed_ready(const tc_pyramid *pyramid, int l, tc_rect rect)
{
    packed_pyramid *p = (packed_pyramid *)pyramid;
    return is_decoded(p, l, rect) || !tc_prefetch_ask(&p->prefetch, l, rect);
}

static size_t packed_bytes(const tc_pyramid *pyramid)
{
    packed_pyramid *p = (packed_pyramid *)pyramid;
    size_t bytes = sizeof *p + tc_block_cache_bytes(&p->tiles) + tc_block_cache_bytes(&p->masks) +
                   tc_block_cache_bytes(&p->file.pages);
    for (int l = 0; l < pyramid->info.levels; l++) {
        const level_state *level = &p->level[l];
        if (!level->ready)
            continue;
        bytes += tc_level_coder_bytes(&level->coder);
        if (level->whole)
            bytes += (size_t)(pyramid->level[l].width * pyramid->level[l].height) * sizeof(int32_t);
    }
    return bytes;
}

static void packed_destroy(tc_pyramid *pyramid)
{
    packed_pyramid *p = (packed_pyramid *)pyramid;
    tc_prefetch_free(&p->prefetch);
    for (int l = 0; l < TC_MAX_PYRAMID_LEVELS; l++) {
        tc_level_coder_free(&p->level[l].coder);
        free(p->level[l].whole);
        pthread_mutex_destroy(&p->level[l].mutex);
    }
    while (p->idle) {
        scratch *s = p->idle;
        p->idle = s->next;
        scratch_free(s);
    }
    pthread_mutex_destroy(&p->mutex);
    tc_block_cache_free(&p->tiles), tc_block_cache_free(&p->masks);
    tc_packed_file_close(&p->file);
    free(p);
}

static const tc_pyramid_class packed_class = {packed_read, packed_bounds, packed_ready, packed_bytes, packed_destroy};

/* ---- Opening ------------------------------------------------------------------------------------------------------
 */

/* Bytes that the file's coders need for a decoded tile. */
static size_t largest_tile(const tc_container *c)
{
    size_t most = 0;
    for (int l = c->base; l < c->levels; l++)
        most = tc_decoded_tile_bytes(c->record[l].coder) > most ? tc_decoded_tile_bytes(c->record[l].coder) : most;
    return most ? most : tc_decoded_tile_bytes(TC_CODER_LIFTING); /* one byte each would make for a huge table */
}

/* Heights of the base level from the head, of coarser ones by the transform's low band. */
static tc_status make_base(packed_pyramid *p)
{
    const tc_container *c = &p->file.container;
    for (int l = c->base; l >= 1; l--) {
        level_state *state = &p->level[l - 1];
        const tc_level *size = &c->level[l - 1];
        size_t samples = (size_t)(size->width * size->height);
        if (!(state->whole = malloc(samples * sizeof(int32_t))))
            return TC_ERR_MEMORY;
        state->ready = true;
        if (l == c->base) {
            memcpy(state->whole, c->base_z, samples * sizeof(int32_t));
            continue;
        }
        int32_t memory[TC_BANDS][TC_BASE_SIZE * TC_BASE_SIZE];
        tc_lifting_level fine = {c->level[l].width, c->level[l].height, c->wrap_x};
        tc_rect rect = {0, 0, size->width, size->height};
        tc_plane from = {p->level[l].whole, fine.width, {0, 0, fine.width, fine.height}}, band[TC_BANDS];
        tc_plane low = {state->whole, size->width, rect};
        for (int b = 0; b < TC_BANDS; b++)
            band[b] = (tc_plane){memory[b], size->width, rect};
        int32_t *work = malloc(tc_lifting_analyse_scratch(&fine, size->height) * sizeof *work);
        if (!work)
            return TC_ERR_MEMORY;
        tc_lifting_analyse(&fine, &from, 0, size->height, &low, band, work);
        free(work);
    }
    return TC_OK;
}

static void set_info(packed_pyramid *p, const tc_open_options *o)
{
    const tc_container *c = &p->file.container;
    const tc_pack_terrain *t = &c->info.terrain;
    tc_terrain_info *info = &p->head.info;
    p->head.class = &packed_class;
    memcpy(p->head.level, c->level, sizeof c->level);
    info->levels = c->levels;
    info->z_base = t->z_base;
    info->z_min = (float)c->z_min, info->z_max = (float)c->z_max;
    info->void_count = c->voids;
    info->other_body = t->georef.semi_major > 0 && (t->georef.semi_major < 6.3e6 || t->georef.semi_major > 6.45e6);
    p->voids = o->has_policy ? o->voids : t->voids;
    p->void_height = (float)((o->has_policy ? o->void_constant : t->void_constant) - t->z_base);
    if (p->voids == TC_VOIDS_CONSTANT && c->voids > 0) {
        info->z_min = fminf(info->z_min, p->void_height);
        info->z_max = fmaxf(info->z_max, p->void_height);
    }
}

/* Makes the pyramid p whose file was opened with `opened`; p is freed where anything has failed. */
static tc_status make_pyramid(packed_pyramid *p, tc_status opened, const tc_open_options *options,
                              tc_pyramid **pyramid_ret, tc_error *error)
{
    static const tc_open_options none = {0};
    options = options ? options : &none;
    if (opened) {
        free(p);
        return opened;
    }
    pthread_mutex_init(&p->mutex, NULL);
    for (int l = 0; l < TC_MAX_PYRAMID_LEVELS; l++)
        pthread_mutex_init(&p->level[l].mutex, NULL);
    tc_status status = tc_block_cache_init(&p->tiles, largest_tile(&p->file.container),
                                           options->cache_bytes ? options->cache_bytes : CACHE_BYTES);
    tc_status masks = tc_block_cache_init(&p->masks, MASK_SIDE * MASK_SIDE, MASK_BYTES);
    status = status ? status : masks;
    tc_prefetch_init(&p->prefetch, read_ahead, p);
    set_info(p, options);
    if (!status)
        status = make_base(p);
    if (status) {
        tc_fail(error, status, "%s: not enough memory", p->file.path);
        packed_destroy(&p->head);
        return status;
    }
    *pyramid_ret = &p->head;
    return TC_OK;
}

tc_status tc_pyramid_open(const char *path, const tc_open_options *options, tc_pyramid **pyramid_ret, tc_error *error)
{
    packed_pyramid *p = calloc(1, sizeof *p);
    if (!p)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    return make_pyramid(p, tc_packed_file_open(path, &p->file, error), options, pyramid_ret, error);
}

tc_status tc_pyramid_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                                tc_pyramid **pyramid_ret, tc_error *error)
{
    packed_pyramid *p = calloc(1, sizeof *p);
    if (!p) {
        if (source->close)
            source->close(source->context);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    return make_pyramid(p, tc_packed_file_open_bytes(name, source, &p->file, error), options, pyramid_ret, error);
}

/* ---- What a packed pyramid tells beside -----------------------------------------------------------------------------
 */

static packed_pyramid *as_packed(const tc_pyramid *pyramid)
{
    return pyramid->class == &packed_class ? (packed_pyramid *)pyramid : NULL;
}

const tc_packed_info *tc_pyramid_packed_info(const tc_pyramid *pyramid)
{
    packed_pyramid *p = as_packed(pyramid);
    return p ? &p->file.container.info : NULL;
}

tc_packed_level tc_pyramid_packed_level(const tc_pyramid *pyramid, int level)
{
    packed_pyramid *p = as_packed(pyramid);
    if (!p || level < 1 || level > p->file.container.levels)
        return (tc_packed_level){0};
    const tc_container *c = &p->file.container;
    const tc_level_record *r = &c->record[level - 1];
    if (level <= c->base) { /* rounding to height units, which keep a lossless source's own values */
        bool exact = c->info.mode == TC_PACK_LOSSLESS && level == c->levels && c->levels == c->base;
        return (tc_packed_level){0, exact ? 0 : 0.5 * c->z_unit, exact ? 0 : 0.5 * c->z_unit, 0};
    }
    return (tc_packed_level){r->end - r->begin, r->rms, r->max_error, r->residual_variance};
}

int64_t tc_pyramid_damaged(const tc_pyramid *pyramid)
{
    packed_pyramid *p = as_packed(pyramid);
    return p ? p->damaged : 0;
}

int64_t tc_pyramid_bytes_decoded(const tc_pyramid *pyramid)
{
    packed_pyramid *p = as_packed(pyramid);
    return p ? p->decoded : 0;
}

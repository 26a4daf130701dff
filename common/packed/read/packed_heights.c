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

/* Details and the coarser level make heights, which may then be corrected. */
typedef struct assembling {
    gathering tiles;
    tile_planes to;
    const packed_target *metres;
} assembling;

static tc_status put_details(void *context, int64_t ty, const tc_plane band[TC_BANDS])
{
    assembling *a = context;
    memcpy(a->to.band, band, sizeof a->to.band);
    return tc_gather_row(&a->tiles, ty, &a->to);
}

static void correct(const assembling *a, const tc_plane *part)
{
    const tc_level_coder *coder = &a->tiles.field->level[a->tiles.level - 1].coder;
    tc_rect r = part->rect;
    for (int64_t y = r.y0; y < r.y1 && coder->correction; y++)
        tc_level_coder_correct(coder, tc_plane_at(part, r.x0, y), tc_plane_at(&a->to.correction, r.x0, y), r.x1 - r.x0);
}

static void take_rows(void *context, const tc_plane *part)
{
    const assembling *a = context;
    correct(a, part);
    tc_packed_metres(a->tiles.field, part, a->metres);
}

/* As units to to->rect, or as metres, and `to` is memory for a strip. */
static tc_status synthesise_lifting(packed_field *p, int l, const tc_plane *to, const packed_target *metres, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    tc_rect need = tc_lifting_needs(&coder->level, to->rect);
    assembling a = {.metres = metres};
    tc_status status = coder->correction ? tc_scratch_plane(s, to->rect, &a.to.correction) : TC_OK;
    void *work = status ? NULL : tc_scratch_take(s, tc_codec_assemble_scratch(coder->codec, to->rect));
    if (!work)
        return TC_ERR_MEMORY;
    status = tc_gather_begin(p, l, need, need, s, &a.tiles);
    const tc_assembly from = {put_details, metres ? take_rows : NULL, &a};
    if (!status)
        status = tc_codec_assemble(coder->codec, &a.tiles.coarse, &from, to, work, TC_SIMD_AUTO);
    tc_gather_end(&a.tiles);
    if (!status && !metres)
        correct(&a, to);
    return status;
}

static tc_status synthesise_samples(packed_field *p, int l, const tc_plane *to, scratch *s)
{
    const tc_level_coder *coder = &p->level[l - 1].coder;
    tc_rect positions = tc_packed_positions(coder, to->rect);
    gathering tiles;
    tc_status status = tc_gather_begin(p, l, positions, tc_packed_coarse(coder, to->rect), s, &tiles);
    if (!status)
        status = tc_gather_row(&tiles, (positions.y1 - 1) / TC_TILE, &(tile_planes){.sample = *to});
    tc_gather_end(&tiles);
    if (!status && coder->lh04)
        tc_lh04_assemble(&coder->level, &tiles.coarse, to, to);
    return status;
}

static tc_status synthesise(packed_field *p, int l, const tc_plane *to, scratch *s)
{
    mark m = tc_scratch_here(s);
    bool lifting = p->level[l - 1].coder.codec;
    tc_status status = lifting ? synthesise_lifting(p, l, to, NULL, s) : synthesise_samples(p, l, to, s);
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
        tc_packed_copy_round(level->whole, width, (tc_rect){0, 0, width, p->head.level[l - 1].height}, width, to);
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

tc_status tc_packed_heights(packed_field *p, int l, const packed_target *to, scratch *s)
{
    tc_status status = prepare(p, l, s);
    const level_state *level = &p->level[l - 1];
    tc_rect r = to->rect;
    if (status)
        return status;
    bool strips = level->coder.codec && !level->whole &&
                  (level->coder.level.wrap_x || (r.x0 >= 0 && r.x1 <= p->head.level[l - 1].width));
    tc_plane units;
    mark m = tc_scratch_here(s);
    int64_t rows = strips ? tc_codec_made_rows(r) : r.y1 - r.y0;
    status = tc_scratch_plane(s, (tc_rect){r.x0, r.y0, r.x1, r.y0 + rows}, &units);
    units.rect = r;
    if (!status && strips)
        status = synthesise_lifting(p, l, &units, to, s);
    else if (!status && !(status = tc_packed_units(p, l, &units, s)))
        tc_packed_metres(p, &units, to);
    tc_scratch_return(s, m);
    return status;
}

/* packed_masks.c - masks of voids, from the coarser level's and from tiles. */
#include "common/base/rect.h"
#include "packed_internal.h"

/* The level's tile of the mask. Where it is damaged, each sample is as the coarser one beside it; that the tile is
 * damaged is counted where its heights are read. */
static tc_status make_mask(packed_field *p, int l, int64_t tx, int64_t ty, uint8_t *v, scratch *s)
{
    const tc_lifting_level lifting = tc_container_lifting(&p->file.container, l), *level = &lifting;
    tc_rect rect = tc_mask_tile_rect(level, tx, ty, 0), need = tc_mask_tile_needs(level, rect);
    tc_tile_entry entry = {0};
    mark m = tc_scratch_here(s);
    s->waited = true;
    tc_mask_plane coarse = {tc_scratch_take(s, (size_t)tc_rect_area(need)), need.x1 - need.x0, need};
    tc_mask_plane fine = {v, MASK_SIDE, rect};
    tc_status below = coarse.v ? tc_packed_mask(p, l - 1, &coarse, s) : TC_ERR_MEMORY;
    tc_status status = tc_packed_file_entry(&p->file, l, tx, ty, &entry);
    if (!below && !status && entry.mask_class == TC_MASK_CODED)
        status = tc_packed_file_tile(&p->file, &entry, s->stream[0], tc_level_coder_bound());
    if (!below && !status)
        status = tc_mask_decode(level, rect, (tc_mask_class)entry.mask_class, &coarse,
                                s->stream[0] + entry.size[TC_STREAM_HEIGHTS] + entry.size[TC_STREAM_CORRECTIONS],
                                entry.size[TC_STREAM_MASK], &fine);
    int64_t across = tc_level_pages(&p->head.level[l - 1]).tiles_x;
    uint64_t key = tc_packed_key(p, l, true, ty * across + tx);
    if (!below && status && status != TC_ERR_FORMAT && status != TC_ERR_MEMORY)
        tc_faults_add(&p->store->faults, key);
    else if (!below && !status)
        tc_faults_remove(&p->store->faults, key);
    if (!below && status && status != TC_ERR_FORMAT)
        below = status;
    for (int64_t y = rect.y0; y < rect.y1 && status && !below; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++)
            v[(y - rect.y0) * MASK_SIDE + x - rect.x0] = coarse.v[(y / 2 - need.y0) * coarse.stride + x / 2 - need.x0];
    tc_scratch_return(s, m);
    return below;
}

tc_status tc_packed_mask(packed_field *p, int l, const tc_mask_plane *to, scratch *s)
{
    const tc_container *c = &p->file.container;
    tc_rect r = to->rect;
    tc_status status = TC_OK;
    int64_t width = c->level[l - 1].width;
    if (r.x0 < 0 || r.x1 > width) { /* each turn for itself */
        for (int64_t x = r.x0, x1; x < r.x1 && !status; x = x1) {
            int64_t turn = tc_turn(x, width);
            x1 = tc_min64(r.x1, turn + width);
            tc_mask_plane part = {to->v + (x - r.x0), to->stride, {x - turn, r.y0, x1 - turn, r.y1}};
            status = tc_packed_mask(p, l, &part, s);
        }
        return status;
    }
    if (l <= c->base || !c->record[l - 1].mask) {
        int k = c->base - l; /* coarser masks are finer ones on the same spots */
        for (int64_t y = r.y0; y < r.y1; y++)
            for (int64_t x = r.x0; x < r.x1; x++)
                to->v[(y - r.y0) * to->stride + x - r.x0] =
                    l <= c->base ? c->base_void[(y << k) * c->level[c->base - 1].width + (x << k)] : 0;
        return TC_OK;
    }
    int64_t across = tc_level_pages(&c->level[l - 1]).tiles_x;
    const tc_lifting_level level = tc_container_lifting(c, l);
    for (int64_t ty = r.y0 / MASK_SIDE; ty * MASK_SIDE < r.y1 && !status; ty++)
        for (int64_t tx = r.x0 / MASK_SIDE; tx * MASK_SIDE < r.x1 && !status; tx++) {
            uint64_t key = tc_packed_key(p, l, true, ty * across + tx);
            tc_block *block = tc_block_find(&p->store->blocks, key);
            if (!block && s->only_ready) {
                s->missed = true;
                return TC_ERR_IO;
            }
            if (!block) {
                s->waited = true;
                block = tc_block_pin(&p->store->blocks, key, MASK_SIDE * MASK_SIDE);
            }
            if (!block)
                return TC_ERR_MEMORY;
            if (!block->made) {
                status = make_mask(p, l, tx, ty, block->bytes, s);
                tc_block_made(&p->store->blocks, block, status == TC_OK);
            }
            tc_rect tile = tc_mask_tile_rect(&level, tx, ty, 0), cut = tc_rect_intersect(tile, r);
            for (int64_t y = cut.y0; y < cut.y1 && !status; y++)
                memcpy(to->v + (y - r.y0) * to->stride + cut.x0 - r.x0,
                       block->bytes + (y - tile.y0) * MASK_SIDE + cut.x0 - tile.x0, (size_t)(cut.x1 - cut.x0));
            tc_block_release(&p->store->blocks, block);
        }
    return status;
}

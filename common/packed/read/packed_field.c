/* packed_field.c - a pyramid read from a packed file.
 *
 * Heights of a rectangle come from the coarser level around half of it and from the tiles that it touches; the coarser
 * level's heights likewise, down to a level small enough to be held whole. What is kept between calls is decoded tiles,
 * which the thin strips of a moving clipmap ask for again and again; heights are made anew each time, which costs less
 * than keeping them. A damaged tile counts as one without details. */
#include <math.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "packed_internal.h"

/* ---- Interface --------------------------------------------------------------------------------------------------- */

tc_status tc_packed_read_block(packed_field *p, int l, tc_rect rect, const packed_target *to, scratch *s)
{
    const tc_container *c = &p->file.container;
    ptrdiff_t stride = to->stride, at = (ptrdiff_t)(rect.y0 - to->rect.y0) * stride + (rect.x0 - to->rect.x0);
    float *z = to->z ? to->z + at : NULL;
    uint8_t *voids = to->voids ? to->voids + at : NULL;
    mark m = tc_scratch_here(s);
    s->large = tc_rect_area(rect) >= LARGE && l == p->head.info.levels ? l : 0;
    tc_status status = z ? tc_packed_heights(p, l, &(packed_target){rect, z, NULL, stride}, s) : TC_OK;
    bool flat = z && p->voids == TC_VOIDS_CONSTANT;
    if (!status && c->voids > 0 && (voids || flat)) {
        tc_mask_plane mask = {voids, stride, rect};
        if (!voids)
            mask = (tc_mask_plane){tc_scratch_take(s, (size_t)tc_rect_area(rect)), rect.x1 - rect.x0, rect};
        status = mask.v ? tc_packed_mask(p, l, &mask, s) : TC_ERR_MEMORY;
        for (int64_t j = 0; j < rect.y1 - rect.y0 && flat && !status; j++)
            for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
                if (mask.v[j * mask.stride + i])
                    z[j * stride + i] = p->void_height;
    }
    for (int64_t j = 0; j < rect.y1 - rect.y0 && voids && c->voids == 0; j++)
        memset(voids + j * stride, 0, (size_t)(rect.x1 - rect.x0));
    tc_scratch_return(s, m);
    return status;
}

/* Where a block from x on ends: where the details that it depends on end with a tile, or the next one's would be begun
 * for it, and the coarser level be made around that; but what is little longer stays whole, and none is narrow. */
static int64_t next_cut(int64_t x, int64_t end, int64_t most)
{
    enum { BEFORE = 2 * TC_LIFTING_REACH };
    if (end - x <= most + most / 4)
        return end;
    int64_t cut = (x + BEFORE + most) / most * most - BEFORE;
    return cut - x < most / 4 ? cut + most : cut;
}

tc_rect tc_packed_next_block(tc_rect rect, block_size most, tc_rect *rest)
{
    tc_rect block = {rest->x0, rest->y0, next_cut(rest->x0, rect.x1, most.width),
                     next_cut(rest->y0, rect.y1, most.height)};
    if (block.x1 < rect.x1)
        rest->x0 = block.x1;
    else
        *rest = (tc_rect){rect.x0, block.y1, rect.x1, rect.y1};
    return block;
}

/* Block by block. */
static tc_status read_blocks(packed_field *p, int l, const packed_target *to, scratch *s)
{
    tc_status status = TC_OK;
    for (tc_rect rest = to->rect; !tc_rect_empty(rest) && !status;)
        status = tc_packed_read_block(p, l, tc_packed_next_block(to->rect, block_waited, &rest), to, s);
    return status;
}

static tc_status packed_read(const tc_field *field, int l, tc_rect rect, void *samples, uint8_t *voids,
                             ptrdiff_t stride)
{
    packed_field *p = (packed_field *)field;
    scratch *s = tc_packed_borrow(p);
    if (!s)
        return TC_ERR_MEMORY;
    tc_status status = read_blocks(p, l, &(packed_target){rect, samples, voids, stride}, s);
    p->waits += s->waited;
    tc_packed_give_back(p, s);
    return status;
}

static bool packed_read_ready(const tc_field *field, int l, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    packed_field *p = (packed_field *)field;
    scratch *s = tc_packed_borrow(p);
    if (!s)
        return false;
    s->only_ready = true;
    tc_status status = read_blocks(p, l, &(packed_target){rect, samples, voids, stride}, s);
    p->waits += s->waited;
    tc_packed_give_back(p, s);
    return status == TC_OK;
}

static void packed_tell(const tc_field *field, tc_field_stats *stats)
{
    packed_field *p = (packed_field *)field;
    size_t cached = tc_block_cache_owned(&p->store->blocks, p->owner);
    stats->bytes += sizeof *p + tc_packed_file_memory(&p->file) + tc_tile_set_bytes(&p->damage) + cached;
    if (p->owner == 0)
        stats->bytes += sizeof *p->store + (size_t)p->store->blocks.buckets * sizeof(tc_block *);
    stats->cache_bytes += cached;
    for (int l = 0; l < field->info.levels; l++) {
        const level_state *level = &p->level[l];
        if (!level->ready)
            continue;
        stats->bytes += tc_level_coder_bytes(&level->coder);
        if (level->whole)
            stats->bytes += (size_t)(field->level[l].width * field->level[l].height) * sizeof(int32_t);
        stats->unreadable += level->status != TC_OK; /* its model is damaged */
    }
    stats->unreadable += tc_faults_count(&p->store->faults, p->owner);
    stats->damaged += p->damaged, stats->decoded += p->decoded, stats->waits += p->waits;
    stats->ranges += p->ranges, stats->range_reads += p->range_reads;
    stats->cancelled += p->cancelled;
}

static const tc_container *packed_container(const tc_field *field)
{
    return &((const packed_field *)field)->file.container;
}

static void packed_destroy(tc_field *field)
{
    packed_field *p = (packed_field *)field;
    tc_prefetch_forget(&p->store->prefetch, p);
    tc_block_cache_forget(&p->store->blocks, p->owner);
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++) {
        tc_level_coder_free(&p->level[l].coder);
        free(p->level[l].whole);
        free(p->base[l].node);
        free(p->error[l].node);
        pthread_mutex_destroy(&p->level[l].mutex);
    }
    while (p->idle) {
        scratch *s = p->idle;
        p->idle = s->next;
        tc_scratch_free(s);
    }
    pthread_mutex_destroy(&p->mutex);
    pthread_mutex_destroy(&p->errors_mutex);
    tc_tile_set_free(&p->damage);
    tc_packed_file_close(&p->file);
    tc_tile_store_release(p->store);
    free(p);
}

const tc_field_class tc_packed_class = {.sample = TC_FIELD_HEIGHTS,
                                        .read = packed_read,
                                        .read_ready = packed_read_ready,
                                        .ready = tc_packed_ready,
                                        .overtaken = tc_packed_overtaken,
                                        .range = tc_packed_range,
                                        .know_errors = tc_packed_know_errors,
                                        .tell = packed_tell,
                                        .container = packed_container,
                                        .destroy = packed_destroy};

/* ---- What the file's head tells beside --------------------------------------------------------------------------- */

const tc_packed_info *tc_field_packed_info(const tc_field *field)
{
    const tc_container *c = tc_field_container(field);
    return c ? &c->info : NULL;
}

/* Bytes of a coded level, without the errors that lie behind the file's last one. */
static int64_t level_bytes(const tc_container *c, int l)
{
    const tc_level_record *r = &c->record[l - 1];
    return r->end - r->begin - (l == c->levels + c->info.levels_missing ? c->error_bytes : 0);
}

int64_t tc_packed_chart_bytes(const tc_field *field)
{
    const tc_container *c = tc_field_container(field);
    int64_t bytes = 0;
    if (c && c->info.version < TC_ENVELOPE_VERSION)
        return tc_container_cap_begin(c, 0);
    for (int l = c ? c->base + 1 : 1; c && l <= c->levels; l++)
        bytes += level_bytes(c, l);
    return bytes;
}

tc_packed_level tc_field_packed_level(const tc_field *field, int level)
{
    const tc_container *c = tc_field_container(field);
    if (!c || level < 1 || level > c->levels)
        return (tc_packed_level){0};
    const tc_level_record *r = &c->record[level - 1];
    if (level <= c->base) { /* rounding to height units, which keep a lossless source's own values */
        bool exact = c->info.mode == TC_PACK_LOSSLESS && level == c->levels && c->levels == c->base;
        double rounding = exact ? 0 : 0.5 * c->z_unit;
        return (tc_packed_level){.rms = rounding, .max_error = rounding};
    }
    bool corrects = tc_coder_corrects(r->coder);
    return (tc_packed_level){
        .bytes = level_bytes(c, level),
        .rms = r->rms,
        .max_error = r->max_error,
        .bound = corrects && r->correction_step > r->correction_snap
                     ? 0.5 * c->z_unit * (r->correction_step - r->correction_snap)
                     : 0,
        .residual_variance = r->residual_variance,
    };
}

/* packed_open.c - opening a packed file: its head, and the levels that stand in it. */
#include <math.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "packed_internal.h"

/* Heights of the base level from the head, of coarser ones by the transform's low band. */
static tc_status make_base(packed_field *p)
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
        tc_lifting_level fine = tc_container_lifting(c, l + 1);
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

static void set_info(packed_field *p, const tc_open_options *o)
{
    const tc_container *c = &p->file.container;
    const tc_pack_terrain *t = &c->info.terrain;
    tc_terrain_info *info = &p->head.info;
    p->head.class = &tc_packed_class;
    memcpy(p->head.level, c->level, sizeof c->level);
    info->levels = c->levels;
    info->z_base = t->z_base;
    info->z_min = (float)c->z_min, info->z_max = (float)c->z_max;
    info->void_count = c->voids;
    info->wraps_x = c->levels >= c->wraps_from;
    info->other_body = tc_is_other_body(&t->georef);
    info->semi_major = t->georef.semi_major;
    info->rms = c->levels > c->base ? (double)c->record[c->levels - 1].rms : 0;
    p->head.georef = t->georef;
    p->voids = o->has_policy ? o->voids : t->voids;
    p->void_height = (float)((o->has_policy ? o->void_constant : t->void_constant) - t->z_base);
    if (p->voids == TC_VOIDS_CONSTANT && c->voids > 0) {
        info->z_min = fminf(info->z_min, p->void_height);
        info->z_max = fmaxf(info->z_max, p->void_height);
    }
}

/* Bounds of the levels that stand in the head, sample by sample. */
static tc_status make_base_ranges(packed_field *p)
{
    const tc_container *c = &p->file.container;
    for (int l = c->base; l >= 1; l--) {
        tc_range_pyramid *r = &p->base[l - 1];
        *r = (tc_range_pyramid){c->level[l - 1].width, c->level[l - 1].height, NULL};
        if (!(r->node = malloc((size_t)tc_range_nodes(r->nx, r->ny) * sizeof *r->node)))
            return TC_ERR_MEMORY;
        for (int64_t n = 0; n < r->nx * r->ny; n++) {
            float z = (float)(c->z_origin + c->z_unit * p->level[l - 1].whole[n]);
            r->node[n] = (tc_range){z, z, INFINITY, INFINITY};
        }
        tc_range_build(r);
    }
    return TC_OK;
}

/* Makes the field p whose file was opened with `opened`; p is freed where anything has failed. */
static tc_status make_field(packed_field *p, tc_status opened, const tc_open_options *options, tc_tile_store *store,
                            tc_field **field_ret, tc_error *error)
{
    static const tc_open_options none = {0};
    options = options ? options : &none;
    if (opened) {
        free(p);
        return opened;
    }
    if (store)
        store->users++;
    p->store = store ? store : tc_tile_store_create(options->cache_bytes);
    if (!p->store) {
        tc_status status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->file.path);
        tc_packed_file_close(&p->file);
        free(p);
        return status;
    }
    p->owner = p->store->owners++;
    pthread_mutex_init(&p->mutex, NULL);
    pthread_mutex_init(&p->errors_mutex, NULL);
    tc_tile_set_init(&p->damage);
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        pthread_mutex_init(&p->level[l].mutex, NULL);
    set_info(p, options);
    tc_status status = make_base(p);
    if (!status)
        status = make_base_ranges(p);
    if (status) {
        tc_fail(error, status, "%s: not enough memory", p->file.path);
        p->head.class->destroy(&p->head);
        return status;
    }
    *field_ret = &p->head;
    return TC_OK;
}

tc_status tc_field_open(const char *path, const tc_open_options *options, tc_field **field_ret, tc_error *error)
{
    packed_field *p = calloc(1, sizeof *p);
    if (!p)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    return make_field(p, tc_packed_file_open(path, &p->file, error), options, NULL, field_ret, error);
}

tc_status tc_packed_open_chart(const char *name, const tc_byte_source *source, int chart,
                               const tc_open_options *options, tc_tile_store *store, tc_field **field_ret,
                               tc_error *error)
{
    packed_field *p = calloc(1, sizeof *p);
    if (!p) {
        if (source->close)
            source->close(source->context);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    return make_field(p, tc_packed_file_open_bytes(name, source, chart, &p->file, error), options, store, field_ret,
                      error);
}

tc_status tc_field_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                              tc_field **field_ret, tc_error *error)
{
    return tc_packed_open_chart(name, source, 0, options, NULL, field_ret, error);
}

/* pack_sample.c - tiles to learn from. */
#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_internal.h"

void tc_sample_free(tc_sample *s)
{
    for (int i = 0; s && i < s->count; i++) {
        free(s->tile[i].coarse.z), free(s->fine[i].z);
        for (int b = 0; b < TC_BANDS; b++)
            free(s->tile[i].band[b].z);
    }
    free(s);
}

static bool give_memory(tc_plane *plane)
{
    plane->stride = plane->rect.x1 - plane->rect.x0;
    plane->z = malloc((size_t)tc_rect_area(plane->rect) * sizeof *plane->z);
    return plane->z != NULL;
}

static tc_status load_tile(const tc_packer *p, int l, const tc_spool *coarse, tc_sample *s, int i, int32_t *scratch,
                           tc_error *error)
{
    tc_training_tile *t = &s->tile[i];
    tc_plane *fine = &s->fine[i];
    fine->rect = tc_pack_details_need(&s->level, t->band[0].rect);
    bool good = give_memory(fine);
    good &= give_memory(&t->coarse);
    for (int b = 0; b < TC_BANDS; b++)
        good &= give_memory(&t->band[b]);
    if (!good)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    tc_status status = tc_pack_truth(p, l, fine->rect, fine->z, fine->stride, error);
    if (!status)
        status = tc_spool_read_round(coarse, t->coarse.rect, t->coarse.z, t->coarse.stride, error);
    if (!status)
        tc_pack_details(&s->level, t->band[0].rect, fine, t->band, scratch);
    return status;
}

tc_status tc_pack_sample(const tc_packer *p, int l, const tc_spool *coarse, int wanted, tc_sample **sample_ret,
                         tc_error *error)
{
    int32_t *scratch = malloc(tc_pack_details_scratch() * sizeof *scratch);
    tc_sample *s = *sample_ret = calloc(1, sizeof *s);
    tc_status status = s && scratch ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    if (!status) {
        s->level = tc_container_lifting(&p->container, l);
        s->count = tc_codec_sample(&s->level, wanted, s->tile);
    }
    for (int i = 0; !status && i < s->count; i++)
        status = load_tile(p, l, coarse, s, i, scratch, error);
    free(scratch);
    return status;
}

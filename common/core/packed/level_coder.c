/* level_coder.c - one switch over the coders. */
#include "level_coder.h"

tc_status tc_level_coder_init(tc_level_coder *c, const tc_level *size, const tc_level_record *record, bool wrap_x)
{
    *c = (tc_level_coder){record->coder, {size->width, size->height, wrap_x}, NULL};
    tc_detail_model model;
    tc_detail_parts parts;
    if (record->coder != TC_CODER_LIFTING)
        return TC_ERR_UNSUPPORTED;
    if (tc_detail_model_read(record->model, record->model_size, &model, &parts))
        return TC_ERR_FORMAT;
    if (!(c->codec = malloc(sizeof *c->codec)))
        return TC_ERR_MEMORY;
    tc_codec_init(c->codec, &c->level, &model);
    return TC_OK;
}

void tc_level_coder_free(tc_level_coder *c)
{
    free(c->codec);
    *c = (tc_level_coder){0};
}

size_t tc_level_coder_bytes(const tc_level_coder *c)
{
    return c->codec ? sizeof *c->codec : 0;
}

size_t tc_level_coder_work_bytes(void)
{
    return tc_tile_work_bytes();
}

tc_rect tc_level_coder_needs(const tc_level_coder *c, int64_t tx, int64_t ty)
{
    return tc_codec_tile_needs(c->codec, tc_codec_tile_rect(c->codec, tx, ty, 0));
}

tc_status tc_level_coder_decode(const tc_level_coder *c, int64_t tx, int64_t ty, const tc_tile_entry *entry,
                                const uint8_t *bytes, const tc_plane *coarse, tc_decoded_tile *tile, void *work)
{
    tc_rect rect = tc_codec_tile_rect(c->codec, tx, ty, 0);
    tc_plane band[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        band[b] = (tc_plane){tile->band[b][0], TC_TILE, rect};
    return tc_codec_decode_tile(c->codec, tx, ty, 0, bytes, entry->size[TC_STREAM_HEIGHTS], coarse, band, work,
                                TC_SIMD_AUTO);
}

/* codec.c - setting up a level's codec, and where its tiles lie. */
#include <math.h>

#include "codec_tile.h"

size_t tc_tile_work_bytes(void)
{
    return sizeof(tc_tile_work);
}

void tc_codec_init(tc_codec *codec, const tc_lifting_level *level, const tc_detail_model *model)
{
    codec->level = *level;
    codec->cw = tc_coarse_size(level->width), codec->ch = tc_coarse_size(level->height);
    codec->tiles_x = (codec->cw + TC_TILE - 1) / TC_TILE, codec->tiles_y = (codec->ch + TC_TILE - 1) / TC_TILE;
    codec->model = *model;
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++)
            for (int k = 0; k < TC_SCALE; k++)
                if (codec->model.scale[b][p][k] > TC_SCALE_MOST)
                    codec->model.scale[b][p][k] = TC_SCALE_MOST;
    /* Curvatures keep 6 to 7 bits of the step. */
    codec->coarse_shift = 0;
    while (model->step[TC_HL] >> codec->coarse_shift >= 128)
        codec->coarse_shift++;
    for (int b = 0; b < TC_BANDS; b++)
        codec->coarse_scale[b] =
            (int32_t)tc_clamp64(((int64_t)1 << (20 + codec->coarse_shift)) / model->step[b], 128, 1 << 20);
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++) {
            enum { KNOWN = TC_SCALE_OWN + TC_SCALE_CROSS };
            const uint16_t *weight = codec->model.scale[b][p];
            for (int k = 0; k < 7; k++) {
                int first = k < 4 ? 2 * k : KNOWN + 2 * (k - 4), end = k < 4 ? KNOWN : KNOWN + TC_SCALE_COARSE;
                codec->pair[b][p][k] =
                    (int32_t)(weight[first] | (first + 1 < end ? (uint32_t)weight[first + 1] << 16 : 0));
            }
        }
    for (int mask = 0; mask < 256; mask++)
        for (int lane = 0, before = 0; lane < 8; before += mask >> lane++ & 1)
            codec->spread[mask][lane] = (uint8_t)before;
    for (int n = 0, bin = 0; n < TC_BIN_SPANS; n++) {
        int first = n < 2 ? 0 : (2 + n % 2) << n / 2 >> 1;
        while (bin < TC_BINS - 1 && tc_bin_threshold[bin] <= first)
            bin++;
        int last = bin < TC_BINS - 1 ? tc_bin_threshold[bin] - 1 : INT16_MAX;
        codec->span_bin[n] = (uint8_t)bin;
        codec->span_last[0][n] = (uint8_t)last, codec->span_last[1][n] = (uint8_t)(last >> 8);
    }
    for (int b = 0; b < TC_BINS; b++) {
        codec->shift[b] = tc_bin_shift[b];
        tc_rans_table_build(&model->symbols[b], &codec->table[b]);
        tc_rans_symbols_build(&model->symbols[b], &codec->put[b * TC_RANS_SYMBOLS]);
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            codec->bits[b * TC_RANS_SYMBOLS + s] = (float)(TC_RANS_BITS - log2(model->symbols[b].of[s]));
    }
}

tc_rect tc_codec_tile_rect(const tc_codec *c, int64_t tx, int64_t ty, int64_t shift)
{
    return (tc_rect){tx * TC_TILE + shift, ty * TC_TILE, tc_min64((tx + 1) * TC_TILE, c->cw) + shift,
                     tc_min64((ty + 1) * TC_TILE, c->ch)};
}

tc_rect tc_codec_tile_needs(const tc_codec *c, tc_rect r)
{
    r.x0 -= TC_TILE_MARGIN, r.y0 = tc_max64(r.y0 - TC_TILE_MARGIN, 0);
    r.x1 += TC_TILE_MARGIN, r.y1 = tc_min64(r.y1 + TC_TILE_MARGIN, c->ch);
    if (!c->level.wrap_x)
        r.x0 = tc_max64(r.x0, 0), r.x1 = tc_min64(r.x1, c->cw);
    return r;
}

/* exact_model.c - the header of an exact level: its step and trained numbers, in the codes of binary_coder.h. */
#include <string.h>

#include "common/codec/entropy/binary_coder.h"
#include "exact_tile.h"

enum { SCALE_SUM = 32000 };

/* Whether sums of 1/1024 weighted errors fit their 32 bits. */
static bool scale_fits(const uint16_t scale[TC_EXACT_SCALES])
{
    uint32_t sum = 3u * scale[6];
    for (int k = 0; k < TC_EXACT_SCALES - 1; k++)
        sum += scale[k];
    return sum <= SCALE_SUM;
}

size_t tc_exact_model_bound(void)
{
    return 8 * (2 + TC_EXACT_PHASES * (TC_EXACT_TERMS + TC_EXACT_SCALES)) + 8 * TC_EXACT_CONTEXTS1 * TC_EXACT_NODES;
}

size_t tc_exact_model_write(const tc_exact_model *model, uint8_t *bytes)
{
    tc_number_model step, predict[2], scale;
    tc_bit_encoder e;
    tc_number_reset(&step), tc_number_reset(&predict[0]), tc_number_reset(&predict[1]), tc_number_reset(&scale);
    tc_bit_encode_begin(&e, bytes, tc_exact_model_bound());
    tc_number_encode(&e, &step, (uint32_t)model->step - 1);
    for (int p = 0; p < TC_EXACT_PHASES; p++)
        for (int k = 0; k < TC_EXACT_TERMS; k++)
            tc_number_encode(&e, &predict[k >= TC_EXACT_COARSE], tc_zigzag(model->predict[p][k]));
    for (int p = 0; p < TC_EXACT_PHASES; p++)
        for (int k = 0; k < TC_EXACT_SCALES; k++)
            tc_number_encode(&e, &scale, model->scale[p][k]);
    tc_number_model correction[2];
    tc_bit_model any = TC_BIT_EVEN;
    tc_number_reset(&correction[0]), tc_number_reset(&correction[1]);
    for (int n = 0; n < TC_EXACT_CONTEXTS1; n++) {
        static const int8_t none[TC_EXACT_NODES] = {0};
        int some = memcmp(model->start[n], none, sizeof none) != 0;
        tc_bit_encode(&e, &any, some);
        for (int k = 0; k < TC_EXACT_NODES && some; k++)
            tc_number_encode(&e, &correction[k >= TC_EXACT_TOWARDS], tc_zigzag(model->start[n][k]));
    }
    return tc_bit_encode_end(&e);
}

tc_status tc_exact_model_read(const uint8_t *bytes, size_t size, tc_exact_model *model)
{
    tc_number_model step, predict[2], scale;
    tc_bit_decoder d;
    tc_exact_model m = {0};
    tc_number_reset(&step), tc_number_reset(&predict[0]), tc_number_reset(&predict[1]), tc_number_reset(&scale);
    tc_bit_decode_begin(&d, bytes, size);
    uint32_t v = tc_number_decode(&d, &step);
    if (v >= TC_MAX_STEP)
        return TC_ERR_FORMAT;
    m.step = (int32_t)v + 1;
    for (int p = 0; p < TC_EXACT_PHASES; p++)
        for (int k = 0; k < TC_EXACT_TERMS; k++) {
            int32_t w = tc_unzigzag(tc_number_decode(&d, &predict[k >= TC_EXACT_COARSE]));
            if (w < INT16_MIN || w > INT16_MAX)
                return TC_ERR_FORMAT;
            m.predict[p][k] = (int16_t)w;
        }
    for (int p = 0; p < TC_EXACT_PHASES; p++) {
        for (int k = 0; k < TC_EXACT_SCALES; k++) {
            v = tc_number_decode(&d, &scale);
            if (v > UINT16_MAX)
                return TC_ERR_FORMAT;
            m.scale[p][k] = (uint16_t)v;
        }
        if (!scale_fits(m.scale[p]))
            return TC_ERR_FORMAT;
    }
    tc_number_model correction[2];
    tc_bit_model any = TC_BIT_EVEN;
    tc_number_reset(&correction[0]), tc_number_reset(&correction[1]);
    for (int n = 0; n < TC_EXACT_CONTEXTS1; n++) {
        int some = tc_bit_decode(&d, &any);
        for (int k = 0; k < TC_EXACT_NODES && some; k++) {
            int32_t by = tc_unzigzag(tc_number_decode(&d, &correction[k >= TC_EXACT_TOWARDS]));
            if (by < INT8_MIN || by > INT8_MAX)
                return TC_ERR_FORMAT;
            m.start[n][k] = (int8_t)by;
        }
    }
    if (!tc_bit_decode_end(&d))
        return TC_ERR_FORMAT;
    *model = m;
    return TC_OK;
}

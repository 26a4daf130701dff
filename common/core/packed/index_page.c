/* index_page.c - index pages, compressed by the adaptive coder (docs/format.md, "Index pages"). */
#include "index_page.h"

#include <string.h>

#include "common/core/base/rect.h"
#include "common/core/codec/binary_coder.h"

typedef struct page_models {
    tc_bit_model coded[2]; /* by whether the tile before was */
    tc_bit_model mask_class[TC_MASK_CLASSES][2];
    tc_number_model size[TC_STREAMS], low, span;
    tc_tile_entry before;
} page_models;

static void reset(page_models *m)
{
    memset(m, 0, sizeof *m);
    tc_bit_models_reset(m->coded, 2);
    tc_bit_models_reset(m->mask_class[0], sizeof m->mask_class / sizeof(tc_bit_model));
    for (int s = 0; s < TC_STREAMS; s++)
        tc_number_reset(&m->size[s]);
    tc_number_reset(&m->low), tc_number_reset(&m->span);
}

size_t tc_page_bound(void)
{
    return (size_t)TC_PAGE_TILES * 128;
}

size_t tc_page_write(tc_page_form form, const tc_tile_entry *entries, int count, uint8_t *bytes)
{
    page_models m;
    tc_bit_encoder e;
    reset(&m);
    tc_bit_encode_begin(&e, bytes, tc_page_bound());
    for (int i = 0; i < count; i++) {
        const tc_tile_entry *t = &entries[i];
        tc_bit_model *class = m.mask_class[m.before.mask_class];
        tc_bit_encode(&e, &m.coded[m.before.size[0] > 0], t->size[0] > 0);
        if (t->size[0] > 0)
            tc_number_encode(&e, &m.size[0], t->size[0]);
        if (form.corrections)
            tc_number_encode(&e, &m.size[1], t->size[1]);
        if (form.mask) {
            tc_bit_encode(&e, &class[0], t->mask_class == TC_MASK_CLASS_VALID);
            if (t->mask_class != TC_MASK_CLASS_VALID)
                tc_bit_encode(&e, &class[1], t->mask_class == TC_MASK_CLASS_VOID);
            if (t->mask_class == TC_MASK_CLASS_CODED)
                tc_number_encode(&e, &m.size[2], t->size[2]);
        }
        if (tc_tile_bytes(t) > 0)
            tc_bit_encode_raw(&e, t->crc, 32);
        tc_number_encode(&e, &m.low, tc_zigzag(t->low - m.before.low));
        tc_number_encode(&e, &m.span, (uint32_t)(t->high - t->low));
        m.before = *t;
    }
    return tc_bit_encode_end(&e);
}

/* More than any tile takes: keeps sums of sizes far from overflow. */
static const uint32_t MOST_BYTES = 1 << 20;

static uint32_t read_size(tc_bit_decoder *d, tc_number_model *model, bool *bad)
{
    uint32_t size = tc_number_decode(d, model);
    *bad |= size > MOST_BYTES;
    return size;
}

tc_status tc_page_read(tc_page_form form, const uint8_t *bytes, size_t size, tc_tile_entry *entries, int count)
{
    page_models m;
    tc_bit_decoder d;
    bool bad = false;
    reset(&m);
    tc_bit_decode_begin(&d, bytes, size);
    for (int i = 0; i < count && !bad; i++) {
        tc_tile_entry t = {{0}, 0, TC_MASK_CLASS_VALID, 0, 0, 0};
        tc_bit_model *class = m.mask_class[m.before.mask_class];
        if (tc_bit_decode(&d, &m.coded[m.before.size[0] > 0]))
            t.size[0] = read_size(&d, &m.size[0], &bad);
        if (form.corrections)
            t.size[1] = read_size(&d, &m.size[1], &bad);
        if (form.mask && !tc_bit_decode(&d, &class[0]))
            t.mask_class = tc_bit_decode(&d, &class[1]) ? TC_MASK_CLASS_VOID : TC_MASK_CLASS_CODED;
        if (t.mask_class == TC_MASK_CLASS_CODED)
            t.size[2] = read_size(&d, &m.size[2], &bad);
        if (tc_tile_bytes(&t) > 0)
            t.crc = tc_bit_decode_raw(&d, 32);
        int64_t low = (int64_t)m.before.low + tc_unzigzag(tc_number_decode(&d, &m.low));
        int64_t high = low + tc_number_decode(&d, &m.span);
        bad |= low < 0 || high >= TC_BOUND_STEPS;
        t.low = (uint16_t)low, t.high = (uint16_t)high;
        m.before = entries[i] = t;
    }
    return bad || !tc_bit_decode_end(&d) ? TC_ERR_FORMAT : TC_OK;
}

/* Height units that a step stands for. */
static int64_t step_size(int32_t lowest, int32_t highest)
{
    return ((int64_t)highest - lowest) / TC_BOUND_STEPS + 1;
}

uint16_t tc_bound_step(int32_t height, int32_t lowest, int32_t highest)
{
    return (uint16_t)(((int64_t)height - lowest) / step_size(lowest, highest));
}

int32_t tc_bound_low(uint16_t step, int32_t lowest, int32_t highest)
{
    return (int32_t)tc_min64(lowest + step * step_size(lowest, highest), highest);
}

int32_t tc_bound_high(uint16_t step, int32_t lowest, int32_t highest)
{
    return (int32_t)tc_min64(lowest + (step + 1) * step_size(lowest, highest) - 1, highest);
}

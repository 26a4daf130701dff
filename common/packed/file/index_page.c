/* index_page.c - index pages, compressed by the adaptive coder (docs/format.md, "Index pages"). */
#include "index_page.h"

#include <string.h>

#include "common/base/rect.h"
#include "common/codec/entropy/binary_coder.h"

typedef struct page_models {
    tc_bit_model coded[2]; /* whether a size is told, by whether the tile before has one */
    tc_bit_model mask_class[TC_MASK_CODED + 1][2];
    tc_number_model size[TC_STREAMS], low, span, step;
    tc_tile_entry before;
    int64_t low_before; /* in steps */
    int step_before;    /* class */
} page_models;

static void reset(page_models *m)
{
    memset(m, 0, sizeof *m);
    tc_bit_models_reset(m->coded, 2);
    tc_bit_models_reset(m->mask_class[0], sizeof m->mask_class / sizeof(tc_bit_model));
    for (int s = 0; s < TC_STREAMS; s++)
        tc_number_reset(&m->size[s]);
    tc_number_reset(&m->low), tc_number_reset(&m->span), tc_number_reset(&m->step);
}

/* Height units that a step stands for. */
static int64_t step_size(int64_t lowest, int64_t highest)
{
    return (highest - lowest) / TC_BOUND_STEPS + 1;
}

/* Largest steps are told in classes: 0 to 7 as they are, then four an octave, of which a class stands for its end. */
static uint32_t class_end(int class)
{
    int octave = class / 4 - 1, quarter = class % 4;
    return class < 8 ? (uint32_t) class : (uint32_t)(((uint64_t)(5 + quarter) << octave) - 1);
}

enum { STEP_CLASSES = 8 + 4 * 29 };

static int class_of(uint32_t step)
{
    int class = 0;
    while (class < STEP_CLASSES - 1 && class_end(class) < step)
        class ++;
    return class;
}

size_t tc_page_bound(void)
{
    return (size_t)TC_PAGE_TILES * 128;
}

size_t tc_page_write(tc_page_form form, const tc_tile_entry *entries, int count, uint8_t *bytes)
{
    page_models m;
    tc_bit_encoder e;
    int32_t lowest = entries[0].low, highest = entries[0].high;
    for (int i = 1; i < count; i++) {
        lowest = entries[i].low < lowest ? entries[i].low : lowest;
        highest = entries[i].high > highest ? entries[i].high : highest;
    }
    int64_t size = step_size(lowest, highest);
    reset(&m);
    tc_bit_encode_begin(&e, bytes, tc_page_bound());
    tc_bit_encode_raw(&e, (uint32_t)lowest, 32), tc_bit_encode_raw(&e, (uint32_t)highest, 32);
    for (int i = 0; i < count; i++) {
        const tc_tile_entry *t = &entries[i];
        tc_bit_model *class = m.mask_class[m.before.mask_class];
        bool told = t->size[0] != (form.repeats ? m.before.size[0] : 0);
        tc_bit_encode(&e, &m.coded[m.before.size[0] > 0], told);
        if (told)
            tc_number_encode(&e, &m.size[0], t->size[0]);
        if (form.corrections)
            tc_number_encode(&e, &m.size[1], t->size[1]);
        if (form.mask) {
            tc_bit_encode(&e, &class[0], t -> mask_class == TC_MASK_VALID);
            if (t->mask_class != TC_MASK_VALID)
                tc_bit_encode(&e, &class[1], t -> mask_class == TC_MASK_VOID);
            if (t->mask_class == TC_MASK_CODED)
                tc_number_encode(&e, &m.size[2], t->size[2]);
        }
        if (tc_tile_bytes(t) > 0)
            tc_bit_encode_raw(&e, t->crc, 32);
        int64_t low = ((int64_t)t->low - lowest) / size, high = ((int64_t)t->high - lowest) / size;
        tc_number_encode(&e, &m.low, tc_zigzag((int32_t)(low - m.low_before)));
        tc_number_encode(&e, &m.span, (uint32_t)(high - low));
        if (form.step) {
            int end = class_of(t->step);
            tc_number_encode(&e, &m.step, tc_zigzag(end - m.step_before));
            m.step_before = end;
        }
        m.before = *t, m.low_before = low;
    }
    return tc_bit_encode_end(&e);
}

/* More than any tile takes: keeps sums of sizes far from overflow. */
static const uint32_t MOST_BYTES = 1 << 21;

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
    int64_t lowest = (int32_t)tc_bit_decode_raw(&d, 32), highest = (int32_t)tc_bit_decode_raw(&d, 32);
    if (lowest > highest)
        return TC_ERR_FORMAT;
    int64_t step = step_size(lowest, highest);
    for (int i = 0; i < count && !bad; i++) {
        tc_tile_entry t = {.mask_class = TC_MASK_VALID, .step = TC_STEP_UNKNOWN};
        tc_bit_model *class = m.mask_class[m.before.mask_class];
        if (tc_bit_decode(&d, &m.coded[m.before.size[0] > 0]))
            t.size[0] = read_size(&d, &m.size[0], &bad);
        else if (form.repeats)
            t.size[0] = m.before.size[0];
        if (form.corrections)
            t.size[1] = read_size(&d, &m.size[1], &bad);
        if (form.mask && !tc_bit_decode(&d, &class[0]))
            t.mask_class = tc_bit_decode(&d, &class[1]) ? TC_MASK_VOID : TC_MASK_CODED;
        if (t.mask_class == TC_MASK_CODED)
            t.size[2] = read_size(&d, &m.size[2], &bad);
        if (tc_tile_bytes(&t) > 0)
            t.crc = tc_bit_decode_raw(&d, 32);
        int64_t low = m.low_before + tc_unzigzag(tc_number_decode(&d, &m.low));
        int64_t high = low + tc_number_decode(&d, &m.span);
        if (low < 0 || high >= TC_BOUND_STEPS || lowest + low * step > highest)
            return TC_ERR_FORMAT;
        t.low = (int32_t)(lowest + low * step);
        t.high = (int32_t)tc_min64(lowest + (high + 1) * step - 1, highest);
        if (form.step) {
            int64_t end = (int64_t)m.step_before + tc_unzigzag(tc_number_decode(&d, &m.step));
            if (end < 0 || end >= STEP_CLASSES)
                return TC_ERR_FORMAT;
            t.step = class_end(m.step_before = (int)end);
        }
        m.before = entries[i] = t, m.low_before = low;
    }
    return bad || !tc_bit_decode_end(&d) ? TC_ERR_FORMAT : TC_OK;
}

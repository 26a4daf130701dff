/* error_store.c - codes of errors: a logarithmic scale, guessed from their neighbours, by the adaptive coder. */
#include "error_store.h"

#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/codec/entropy/binary_coder.h"

enum { OCTAVE = 16, CONTEXTS = 5 };

float tc_error_metres(float most, int code)
{
    /* 4096 2^(n / 16) */
    static const int root[OCTAVE] = {4096, 4277, 4467, 4664, 4871, 5087, 5312, 5547,
                                     5793, 6049, 6317, 6597, 6889, 7194, 7512, 7845};
    const int below = TC_ERROR_CODES - 1 - code;
    if (code == 0)
        return 0;
    const double exact =
        ldexp((double)most * root[(OCTAVE - below % OCTAVE) % OCTAVE], -12 - (below + OCTAVE - 1) / OCTAVE);
    const float z = (float)exact;
    return (double)z < exact ? nextafterf(z, INFINITY) : z;
}

uint8_t tc_error_code(float most, float error)
{
    int below = 0, end = TC_ERROR_CODES - 1; /* the code is within below .. end */
    while (below < end) {
        const int middle = (below + end) / 2;
        if (tc_error_metres(most, middle) >= error)
            end = middle;
        else
            below = middle + 1;
    }
    return (uint8_t)end;
}

tc_rect tc_error_page_leaves(const tc_level *level, int shift, int64_t px, int64_t py)
{
    const int64_t across = TC_ERROR_PAGE_WIDTH >> shift, up = TC_ERROR_PAGE_HEIGHT >> shift;
    return (tc_rect){px * across, py * up, tc_min64((px + 1) * across, tc_ceil_shift(level->width, shift)),
                     tc_min64((py + 1) * up, tc_ceil_shift(level->height, shift))};
}

/* ---- Pages ------------------------------------------------------------------------------------------------------ */

/* The codes to the west and south, as 0 outside: a guess, and how sure it is. */
typedef struct around {
    int guess, context;
} around;

static around look(const uint8_t *codes, int64_t w, int64_t x, int64_t y)
{
    const uint8_t *c = codes + y * w + x;
    if (y == 0)
        return (around){x > 0 ? c[-1] : 0, CONTEXTS - 1};
    if (x == 0)
        return (around){c[-w], CONTEXTS - 1};
    /* On a slope, or along an edge (the median of west, south and the plane through the three). */
    const int west = c[-1], south = c[-w], corner = c[-w - 1];
    const int low = west < south ? west : south, high = west < south ? south : west;
    const int apart = abs(west - corner) + abs(south - corner);
    return (around){corner >= high  ? low
                    : corner <= low ? high
                                    : west + south - corner,
                    apart < 3    ? 0
                    : apart < 8  ? 1
                    : apart < 20 ? 2
                                 : 3};
}

size_t tc_error_page_bound(void)
{
    return (size_t)TC_ERROR_PAGE_LEAVES * 4;
}

static void reset(tc_number_model model[CONTEXTS])
{
    for (int k = 0; k < CONTEXTS; k++)
        tc_number_reset(&model[k]);
}

size_t tc_error_page_write(const uint8_t *codes, int64_t w, int64_t h, uint8_t *bytes)
{
    tc_bit_encoder e;
    tc_number_model model[CONTEXTS];
    reset(model);
    tc_bit_encode_begin(&e, bytes, tc_error_page_bound());
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++) {
            const around a = look(codes, w, x, y);
            tc_number_encode(&e, &model[a.context], tc_zigzag(codes[y * w + x] - a.guess));
        }
    return tc_bit_encode_end(&e);
}

tc_status tc_error_page_read(const uint8_t *bytes, size_t size, int64_t w, int64_t h, uint8_t *codes)
{
    tc_bit_decoder d;
    tc_number_model model[CONTEXTS];
    reset(model);
    tc_bit_decode_begin(&d, bytes, size);
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++) {
            const around a = look(codes, w, x, y);
            const int64_t code = (int64_t)a.guess + tc_unzigzag(tc_number_decode(&d, &model[a.context]));
            if (code < 0 || code >= TC_ERROR_CODES)
                return TC_ERR_FORMAT;
            codes[y * w + x] = (uint8_t)code;
        }
    return tc_bit_decode_end(&d) ? TC_OK : TC_ERR_FORMAT;
}

/* ---- Head ------------------------------------------------------------------------------------------------------- */

size_t tc_error_places_bytes(const tc_container *c)
{
    return 8 + 4 * (size_t)(c->levels - 1) + 9 * (size_t)(c->levels - c->base);
}

void tc_error_places_put(const tc_container *c, tc_byte_writer *w)
{
    tc_put(w, (uint64_t)c->error[c->base].begin, 8); /* none of a chart that stands in its head: then it is 0 */
    for (int l = 2; l <= c->levels; l++) {
        tc_put_f32(w, c->error[l - 1].most);
        if (l > c->base)
            tc_put(w, (uint64_t)c->error[l - 1].shift, 1), tc_put(w, (uint64_t)c->error[l - 1].bytes, 8);
    }
}

bool tc_error_places_get(tc_container *c, int64_t file_bytes, tc_byte_reader *r)
{
    const uint64_t begin = tc_get(r, 8);
    bool good = begin <= (uint64_t)file_bytes && (begin == 0) == (c->levels == c->base);
    int64_t at = good ? (int64_t)begin : 0;
    for (int l = 2; l <= c->levels; l++) {
        tc_error_place *e = &c->error[l - 1];
        e->most = tc_get_f32(r);
        good &= isfinite(e->most) && e->most >= 0;
        if (l <= c->base)
            continue;
        const tc_pages pages = tc_level_pages(&c->level[l - 1]);
        e->shift = (int)tc_get(r, 1);
        const uint64_t bytes = tc_get(r, 8);
        good &= e->shift >= TC_ERROR_TILE_SHIFT && e->shift <= TC_ERROR_COARSEST;
        good &= bytes <= (uint64_t)(file_bytes - at) && bytes >= (uint64_t)tc_directory_bytes(&pages);
        e->begin = at, e->bytes = good ? (int64_t)bytes : 0;
        at += e->bytes;
    }
    c->errors = good && !r->failed;
    return c->errors;
}

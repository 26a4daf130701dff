/* codec_correction.c - coding the corrections of a tile (codec_correction.h). */
#include "codec_correction.h"

#include <string.h>

#include "common/base/rect.h"

enum {
    SIDE = 2 * TC_TILE,
    ROW = SIDE + 4, /* two columns of zeros either side */
    DETAILS = 8,    /* classes of a detail's size */
    AROUND = 12,
    LENGTHS = 25,
    SQUARE = 8, /* samples */
    SQUARES = SIDE / SQUARE
};

typedef struct state {
    tc_mix_state around[AROUND][DETAILS], pattern[1 << 6][4], detail[DETAILS][DETAILS][4];
    tc_mix_state sign[9][9], sign_detail[27], sign_place[3][4];
    tc_mix_state length[LENGTHS];
    int32_t weight[3][TC_MIX_INPUTS], sign_weight[TC_MIX_INPUTS];
    tc_mix_state dense, square_pattern[1 << 4], square_detail[DETAILS][DETAILS], square_near[3];
    int32_t square_weight[3][TC_MIX_INPUTS];
    bool some[SQUARES + 1][SQUARES + 2];    /* squares whose samples are coded, none around them */
    int32_t k[3][ROW];                      /* rows y - 2, y - 1 and y, in turn */
    uint8_t size[TC_TILE + 2][TC_TILE + 2]; /* classes of the sum of a position's details, zero around them */
    uint8_t sum[TC_TILE][TC_TILE];
} state;

void tc_correction_init(tc_correction *c, bool by_squares)
{
    tc_mix_tables_init(&c->tables);
    c->by_squares = by_squares;
}

size_t tc_correction_bound(void)
{
    return (size_t)SIDE * SIDE * 12 + 64;
}

static void fill(tc_mix_state *s, size_t count, uint32_t p, uint32_t weight)
{
    for (size_t i = 0; i < count; i++)
        s[i] = tc_mix_state_of(p, weight);
}

static uint8_t class_of(uint64_t quarters)
{
    static const uint16_t least[DETAILS - 1] = {1, 3, 5, 9, 15, 27, 50};
    uint8_t n = 0;
    while (n < DETAILS - 1 && quarters >= least[n])
        n++;
    return n;
}

static void start(state *s, const tc_plane band[TC_BANDS], const int32_t step[TC_BANDS], tc_rect r)
{
    memset(s, 0, sizeof *s);
    for (int a = 0; a < AROUND; a++)
        fill(s->around[a], DETAILS, a == 0 ? 900 : a < 4 ? 4000 : 9000, 6);
    fill(s->pattern[0], sizeof s->pattern / sizeof **s->pattern, 4000, 3);
    fill(s->pattern[0], 4, 900, 6);
    fill(s->detail[0][0], sizeof s->detail / sizeof ***s->detail, 1500, 3);
    fill(s->sign[0], 81, 32768, 4), fill(s->sign_detail, 27, 32768, 4), fill(s->sign_place[0], 12, 32768, 4);
    fill(s->length, LENGTHS, 2000, 3);
    fill(&s->dense, 1, 6000, 3), fill(s->square_pattern, 1, 3000, 3), fill(s->square_pattern + 1, 15, 30000, 3);
    fill(s->square_detail[0], DETAILS * DETAILS, 10000, 2), fill(s->square_near, 3, 10000, 2);
    for (int i = 0; i < TC_MIX_INPUTS; i++) {
        s->sign_weight[i] = TC_MIX_ONE / 3;
        for (int n = 0; n < 3; n++)
            s->weight[n][i] = s->square_weight[n][i] = TC_MIX_ONE * 2 / 5;
    }
    int64_t x0 = r.x0 >> 1, y0 = r.y0 >> 1, x1 = (r.x1 + 1) >> 1, y1 = (r.y1 + 1) >> 1;
    for (int64_t j = 0; j < y1 - y0; j++)
        for (int64_t i = 0; i < x1 - x0; i++) {
            uint64_t sum = 0;
            for (int b = 0; b < TC_BANDS; b++) {
                int64_t v = *tc_plane_at(&band[b], x0 + i, y0 + j);
                if (v != 0)
                    sum += (uint64_t)(v < 0 ? -v : v) * 4 / (uint64_t)step[b];
            }
            s->size[j + 1][i + 1] = class_of(sum);
        }
    for (int64_t j = 0; j < y1 - y0; j++)
        for (int64_t i = 0; i < x1 - x0; i++)
            s->sum[j][i] =
                (uint8_t)((s->size[j][i + 1] + s->size[j + 2][i + 1] + s->size[j + 1][i] + s->size[j + 1][i + 2] + 2) /
                          4);
}

static inline int sign_of(int32_t v)
{
    return (v > 0) - (v < 0);
}

static inline int size_of(int32_t v)
{
    return v == 0 ? 0 : v == 1 || v == -1 ? 1 : 2;
}

/* Which squares have a correction. *dense_ret: so many that it is not worth telling. */
static void find_squares(const tc_plane *plane, state *s, bool *dense_ret)
{
    tc_rect r = plane->rect;
    int64_t w = r.x1 - r.x0, h = r.y1 - r.y0, all = 0, some = 0;
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++)
            s->some[y / SQUARE + 1][x / SQUARE + 1] |= *tc_plane_at(plane, r.x0 + x, r.y0 + y) != 0;
    for (int64_t y = 0; y < h; y += SQUARE)
        for (int64_t x = 0; x < w; x += SQUARE)
            all++, some += s->some[y / SQUARE + 1][x / SQUARE + 1];
    *dense_ret = 2 * some > all;
}

/* Codes which squares of a tile of w x h samples have a correction; in a dense tile all are taken to. */
static void code_squares(const tc_mix_tables *t, tc_mix_coder *coder, int64_t w, int64_t h, bool dense, state *s,
                         bool encode)
{
    enum { HALF = SQUARE / 2 }; /* positions */
    dense = tc_mix_plain(t, coder, &s->dense, dense, encode);
    for (int64_t y = 0; y * SQUARE < h; y++) {
        bool *a = s->some[y + 1] + 1, *before = s->some[y] + 1;
        for (int64_t x = 0; x * SQUARE < w; x++) {
            if (dense) {
                a[x] = true;
                continue;
            }
            int64_t i1 = tc_min64((x + 1) * HALF, (w + 1) / 2), j1 = tc_min64((y + 1) * HALF, (h + 1) / 2);
            int most = 0, sum = 0, count = 0;
            for (int64_t j = y * HALF; j < j1; j++)
                for (int64_t i = x * HALF; i < i1; i++) {
                    int size = s->size[j + 1][i + 1];
                    most = size > most ? size : most, sum += size, count++;
                }
            int pattern = a[x - 1] | before[x] << 1 | before[x - 1] << 2 | before[x + 1] << 3;
            int near = a[x - 1] + before[x];
            a[x] = tc_mix_bit(t, coder, &s->square_pattern[pattern], &s->square_detail[most][sum / count],
                              &s->square_near[near], s->square_weight[near], a[x], encode);
        }
    }
}

/* One correction that is not 0, of which the signs around it tell something. k, n: its row and the one before, at it.
 * 0: beyond TC_CORRECTION_MOST. */
static inline int32_t code_value(const tc_mix_tables *t, tc_mix_coder *coder, state *s, const int32_t *k,
                                 const int32_t *n, int detail_sign, int phase, int32_t v, bool encode)
{
    int around_sign = (sign_of(k[-1]) + 1) * 3 + sign_of(n[0]) + 1;
    int wide_sign = (sign_of(n[-1]) + 1) * 3 + sign_of(n[1]) + 1;
    int minus = tc_mix_bit(t, coder, &s->sign[around_sign][wide_sign], &s->sign_detail[detail_sign],
                           &s->sign_place[sign_of(k[-1]) + 1][phase], s->sign_weight, encode && v < 0, encode);
    uint32_t size = encode ? (uint32_t)(v < 0 ? -v : v) : 1;
    int length = 0, bits = 31 - __builtin_clz(size);
    while (length < LENGTHS - 1 && tc_mix_plain(t, coder, &s->length[length], bits > length, encode))
        length++;
    size = (uint32_t)1 << length | tc_mix_raw(coder, size, length, encode);
    return size > TC_CORRECTION_MOST ? 0 : minus ? -(int32_t)size : (int32_t)size;
}

/* Codes the samples x0 ... x1 - 1 of row y, k in the state and, decoding, in `out`. */
static inline tc_status code_run(const tc_mix_tables *t, tc_mix_coder *coder, const tc_plane band[TC_BANDS],
                                 const tc_plane *plane, state *s, int64_t y, int64_t x0, int64_t x1, int32_t *out,
                                 bool encode)
{
    const int32_t *n = s->k[y % 3] + 2, *nn = s->k[(y + 2) % 3] + 2;
    int32_t *k = s->k[(y + 1) % 3] + 2;
    for (int64_t x = x0; x < x1; x++) {
        int64_t i = x >> 1, j = y >> 1;
        int phase = (int)((y & 1) * 2 + (x & 1)), here = s->size[j + 1][i + 1], about = s->sum[j][i];
        int near = size_of(k[x - 1]) + size_of(n[x]), wide = size_of(n[x - 1]) + size_of(n[x + 1]);
        int around = (near > 3 ? 3 : near) * 3 + (wide > 2 ? 2 : wide);
        int pattern = (k[x - 1] != 0) | (n[x] != 0) << 1 | (n[x - 1] != 0) << 2 | (n[x + 1] != 0) << 3 |
                      (k[x - 2] != 0) << 4 | (nn[x] != 0) << 5;
        int some =
            tc_mix_bit(t, coder, &s->around[around][about], &s->pattern[pattern][phase], &s->detail[here][about][phase],
                       s->weight[near > 2 ? 2 : near], encode && out[x] != 0, encode);
        int32_t v = 0;
        if (some) {
            int64_t px = (plane->rect.x0 >> 1) + i, py = (plane->rect.y0 >> 1) + j;
            int sign = 0;
            for (int b = 0; b < TC_BANDS; b++)
                sign = sign * 3 + sign_of(*tc_plane_at(&band[b], px, py)) + 1;
            v = code_value(t, coder, s, k + x, n + x, sign, phase, encode ? out[x] : 0, encode);
            if (v == 0)
                return TC_ERR_FORMAT;
        }
        k[x] = v;
        if (!encode)
            out[x] = v;
    }
    return TC_OK;
}

static inline tc_status code(const tc_correction *c, tc_mix_coder *coder, const tc_plane band[TC_BANDS],
                             const tc_plane *plane, state *s, bool encode)
{
    const tc_mix_tables *t = &c->tables;
    tc_rect r = plane->rect;
    int64_t w = r.x1 - r.x0, h = r.y1 - r.y0;
    bool dense = false;
    if (c->by_squares && encode)
        find_squares(plane, s, &dense);
    if (c->by_squares)
        code_squares(t, coder, w, h, dense, s, encode);
    for (int64_t y = 0; y < h; y++) {
        int32_t *out = tc_plane_at(plane, r.x0, r.y0 + y), *k = s->k[(y + 1) % 3];
        const bool *some = s->some[y / SQUARE + 1] + 1;
        memset(k, 0, ROW * sizeof *k);
        if (!encode)
            memset(out, 0, (size_t)w * sizeof *out);
        for (int64_t x = 0, next; x < w; x = next) {
            next = c->by_squares ? tc_min64(x + SQUARE, w) : w;
            tc_status status = c->by_squares && !some[x / SQUARE]
                                   ? TC_OK
                                   : code_run(t, coder, band, plane, s, y, x, next, out, encode);
            if (status)
                return status;
        }
    }
    return TC_OK;
}

tc_status tc_correction_encode(const tc_correction *c, const tc_plane band[TC_BANDS], const int32_t step[TC_BANDS],
                               const tc_plane *k, uint8_t *bytes, size_t room, size_t *size_ret)
{
    bool any = false;
    for (int64_t y = k->rect.y0; y < k->rect.y1; y++)
        for (int64_t x = k->rect.x0; x < k->rect.x1; x++) {
            int32_t v = *tc_plane_at(k, x, y);
            if (v < -TC_CORRECTION_MOST || v > TC_CORRECTION_MOST)
                return TC_ERR_USAGE;
            any |= v != 0;
        }
    size_t size = 0;
    if (any) {
        state s;
        tc_mix_coder coder;
        start(&s, band, step, k->rect);
        tc_mix_encode_begin(&coder, bytes, room);
        code(c, &coder, band, k, &s, true);
        size = tc_mix_encode_end(&coder, bytes);
        if (coder.missing)
            return TC_ERR_USAGE;
        /* A stream of zeros only would be the tile without corrections. */
        if (size == 0 && room > 0)
            bytes[0] = 0, size = 1;
    }
    *size_ret = size;
    return TC_OK;
}

tc_status tc_correction_decode(const tc_correction *c, const tc_plane band[TC_BANDS], const int32_t step[TC_BANDS],
                               const uint8_t *bytes, size_t size, const tc_plane *k)
{
    tc_status status = TC_OK;
    if (size > 0) {
        state s;
        tc_mix_coder coder;
        start(&s, band, step, k->rect);
        tc_mix_decode_begin(&coder, bytes, size);
        status = code(c, &coder, band, k, &s, false);
        if (!status && !tc_mix_decode_end(&coder))
            status = TC_ERR_FORMAT;
    }
    if (size == 0 || status)
        for (int64_t y = k->rect.y0; y < k->rect.y1; y++)
            memset(tc_plane_at(k, k->rect.x0, y), 0, (size_t)(k->rect.x1 - k->rect.x0) * sizeof(int32_t));
    return status;
}

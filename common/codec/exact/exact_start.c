/* exact_start.c - the probabilities that every tile of an exact level starts from.
 *
 * From the shape of a distribution of errors, the same everywhere, come the probabilities of all decisions, given the
 * expected error and the fraction of a step that rounding took from the prediction; the level's header corrects them.
 */
#include <string.h>

#include "exact_tile.h"

enum {
    START_COUNT = 40,    /* bits that a probability to start from is worth */
    START_WEIGHT = 24000 /* of TC_MIX_ONE */
};

/* Share (1/65536) of errors above 2^((n - 24) / 4) of the expected one, measured on radar terrain. */
static uint32_t tail(int64_t distance, int64_t scale)
{
    static const uint16_t share[48] = {
        64845, 64717, 64561, 64374, 64156, 63892, 63580, 63204, 62758, 62235, 61607, 60867, 59990, 58946, 57703, 56241,
        54519, 52477, 50078, 47274, 44020, 40297, 36086, 31408, 26369, 21128, 15965, 11217, 7220,  4199,  2207,  1045,
        455,   189,   79,    34,    16,    8,     4,     2,     1,     1,     1,     1,     1,     1,     1,     1};
    int64_t ratio = (distance << 24) / scale; /* 1/4096 */
    if (ratio < 64)
        return 65536 - (uint32_t)(ratio * (65536 - 64845) / 64);
    int octave = 63 - __builtin_clzll((uint64_t)ratio), n = 4 * (octave - 12) + 24;
    int64_t part = ((ratio << 8) >> octave) - 256; /* 0 .. 255 of the octave */
    n += (int)(part >> 6), part &= 63;
    if (n >= 47)
        return 1;
    return share[n] - (uint32_t)((share[n] - share[n + 1]) * part / 64);
}

static tc_mix_state start_state(uint64_t part, uint64_t whole)
{
    uint64_t p = whole ? part * 65536 / whole : 32768;
    return tc_mix_state_of((uint32_t)(p < 48 ? 48 : p > 65488 ? 65488 : p), START_COUNT);
}

/* Expected error in the middle of a bin, and how many bits go raw there. */
static int64_t bin_scale(int bin)
{
    return ((int64_t)(2 * (4 + bin % 4) + 1) << (TC_EXACT_SCALE_OCTAVE + bin / 4)) / 8;
}

void tc_exact_start_nodes(int bin, int fraction, tc_mix_state node[TC_EXACT_NODES])
{
    static const int64_t middle[TC_EXACT_FRACTIONS] = {1, 4, 6, 9, 12, 15}; /* 1/32 of a step */
    int64_t scale = 2 * bin_scale(bin);
    int shift = tc_exact_shift((uint32_t)bin_scale(bin));
    int64_t f = shift ? 8 : middle[fraction], unit = (int64_t)2 * TC_EXACT_PART << shift;
    uint32_t towards[TC_EXACT_UNARY + 1], away[TC_EXACT_UNARY + 1];
    for (int n = 0; n <= TC_EXACT_UNARY; n++) {
        towards[n] = tail(n * unit + unit / 2 - f, scale);
        away[n] = tail(n * unit + unit / 2 + f, scale);
    }
    node[0] = start_state(towards[0] + away[0], 2 * 65536);
    node[1] = start_state(away[0], towards[0] + away[0]);
    for (int n = 0; n < TC_EXACT_UNARY; n++) {
        node[TC_EXACT_TOWARDS + n] = start_state(towards[n + 1], towards[n]);
        node[TC_EXACT_AWAY + n] = start_state(away[n + 1], away[n]);
    }
}

/* The nodes of the pattern contexts share what lies beyond the third decision of a side. */
const uint8_t tc_exact_pattern_node[TC_EXACT_NODES] = {0, 1, 2, 3, 4, 4, 4, 4, 4, 5, 6, 7, 7, 7, 7, 7};

/* The same with the header's corrections. */
static void corrected(const tc_exact *c, int bin, int fraction, tc_mix_state node[TC_EXACT_NODES])
{
    const int8_t *by = c->model.start[bin * TC_EXACT_FRACTIONS + fraction];
    tc_exact_start_nodes(bin, fraction, node);
    for (int k = 0; k < TC_EXACT_NODES; k++) {
        int32_t logit = tc_exact_clamp(c->tables.stretch[node[k] >> 20] + 16 * by[k], TC_LOGIT_LIMIT);
        if (by[k])
            node[k] = tc_mix_state_of(c->tables.squash[logit + TC_LOGIT_LIMIT], START_COUNT);
    }
}

void tc_exact_init(tc_exact *c, const tc_lifting_level *level, const tc_exact_model *model)
{
    memset(c, 0, sizeof *c);
    c->level = *level, c->model = *model;
    c->cw = (level->width + 1) / 2, c->ch = (level->height + 1) / 2;
    c->tiles_x = (c->cw + TC_TILE - 1) / TC_TILE, c->tiles_y = (c->ch + TC_TILE - 1) / TC_TILE;
    tc_mix_tables_init(&c->tables);
    tc_exact_state *s = &c->start;
    for (int n = 0; n < TC_EXACT_CONTEXTS1; n++)
        corrected(c, n / TC_EXACT_FRACTIONS, n % TC_EXACT_FRACTIONS, s->scale[n]);
    for (int n = 0; n < TC_EXACT_CONTEXTS2; n++) {
        int bin = n / TC_EXACT_FRACTIONS / TC_EXACT_PHASES * 3 + 1;
        corrected(c, bin < TC_EXACT_BINS ? bin : TC_EXACT_BINS - 1, n % TC_EXACT_FRACTIONS, s->phase[n]);
    }
    for (int n = 0; n < TC_EXACT_CONTEXTS3; n++) {
        tc_mix_state node[TC_EXACT_NODES];
        corrected(c, (n / 3 % TC_EXACT_LEVELS3 * 8 + 4) / 3, n % 3 * 2, node);
        for (int k = TC_EXACT_NODES - 1; k >= 0; k--)
            s->pattern[n][tc_exact_pattern_node[k]] = node[k];
    }
    for (int n = 0; n < TC_EXACT_LENGTHS; n++)
        s->length[n] = tc_mix_state_of(32768, 6);
    for (int n = 0; n < TC_EXACT_WEIGHTS; n++)
        for (int k = 0; k < TC_EXACT_NODES; k++)
            for (int i = 0; i < TC_MIX_INPUTS; i++)
                s->weight[n][k][i] = START_WEIGHT;
}

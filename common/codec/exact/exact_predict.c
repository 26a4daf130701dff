/* exact_predict.c - what of a tile is known from the coarser level (exact_tile.h). */
#include <stdlib.h>
#include <string.h>

#include "exact_tile.h"

const int8_t tc_exact_coarse_at[TC_EXACT_COARSE][2] = {{-1, -2}, {0, -2}, {1, -2}, {-2, -1}, {-1, -1}, {0, -1}, {1, -1},
                                                       {2, -1},  {-2, 0}, {-1, 0}, {1, 0},   {2, 0},   {-2, 1}, {-1, 1},
                                                       {0, 1},   {1, 1},  {2, 1},  {-1, 2},  {0, 2},   {1, 2}};
const int8_t tc_exact_causal_at[TC_EXACT_CAUSAL][2] = {{-1, 0},  {0, -1},  {-1, -1}, {1, -1}, {-2, 0}, {0, -2},
                                                       {-2, -1}, {-1, -2}, {1, -2},  {2, -1}, {2, -2}, {-2, -2},
                                                       {-3, 0},  {0, -3},  {-3, -1}, {3, -1}};

enum { M = TC_EXACT_MARGIN, BLOCK = 16 };

/* The coarser level in parts above the base; beyond the terrain its border goes on. */
static void gather(const tc_exact *c, tc_rect tile, tc_rect needs, const tc_plane *coarse, tc_exact_work *w)
{
    int64_t step = c->model.step;
    int32_t middle = *tc_plane_at(coarse, (tile.x0 + tile.x1) / 2, (tile.y0 + tile.y1) / 2);
    middle = tc_exact_clamp(middle, 2 * TC_LIFTING_LIMIT);
    w->base = middle / step;
    int64_t base = w->base * step;
    for (int j = 0; j < TC_EXACT_COARSE_SIDE; j++) {
        int64_t y = tc_clamp64(tile.y0 + j - M, needs.y0, needs.y1 - 1);
        for (int i = 0; i < TC_EXACT_COARSE_SIDE; i++) {
            int64_t x = tc_clamp64(tile.x0 + i - M, needs.x0, needs.x1 - 1);
            int64_t z = (*tc_plane_at(coarse, x, y) - base) * TC_EXACT_PART;
            w->coarse[j][i] = tc_exact_clamp((z >= 0 ? z + step / 2 : z - step / 2) / step, TC_EXACT_RELIEF);
        }
    }
}

/* Four-point upsampling, (-1, 9, 9, -1) / 16 either way. */
static void upsample(tc_exact_work *w)
{
    for (int j = 0; j < TC_EXACT_COARSE_SIDE; j++) {
        const int32_t *c = w->coarse[j] + M;
        for (int i = 0; i < TC_TILE; i++) {
            w->across[j][2 * i] = 16 * c[i];
            w->across[j][2 * i + 1] = 9 * (c[i] + c[i + 1]) - c[i - 1] - c[i + 2];
        }
    }
    for (int j = 0; j < TC_TILE; j++) {
        const int32_t *a = w->across[j + M - 1], *b = w->across[j + M], *d = w->across[j + M + 1],
                      *e = w->across[j + M + 2];
        for (int x = 0; x < TC_EXACT_SIDE; x++) {
            w->up[2 * j][x] = (b[x] + 8) >> 4;
            w->up[2 * j + 1][x] = (9 * (b[x] + d[x]) - a[x] - e[x] + 128) >> 8;
        }
    }
}

/* Whether the filter's sums fit 32 bits, and heights less the first one half of that. */
static bool is_narrow(const tc_exact *c, const tc_exact_work *w)
{
    int32_t least = w->coarse[0][0], most = least, sum[TC_EXACT_PHASES] = {0};
    for (int j = 0; j < TC_EXACT_COARSE_SIDE; j++)
        for (int i = 0; i < TC_EXACT_COARSE_SIDE; i++) {
            int32_t z = w->coarse[j][i];
            least = z < least ? z : least, most = z > most ? z : most;
        }
    bool narrow = most - least < 1 << 15;
    for (int p = 0; p < TC_EXACT_PHASES; p++) {
        for (int k = 0; k < TC_EXACT_COARSE; k++)
            sum[p] += abs(c->model.predict[p][k]);
        narrow = narrow && sum[p] < 1 << 16;
    }
    return narrow;
}

/* What the prediction says without any sample: the upsampled coarser level and a trained filter of it. */
static void guess_narrow(const tc_exact *c, tc_exact_work *w)
{
    int16_t z[TC_EXACT_COARSE_SIDE][TC_EXACT_COARSE_SIDE];
    for (int j = 0; j < TC_EXACT_COARSE_SIDE; j++)
        for (int i = 0; i < TC_EXACT_COARSE_SIDE; i++)
            z[j][i] = (int16_t)(w->coarse[j][i] - w->coarse[0][0]);
    for (int y = 0; y < TC_EXACT_SIDE; y++)
        for (int px = 0; px < 2; px++) {
            const int16_t *weight = c->model.predict[(y & 1) * 2 + px], *here = &z[(y >> 1) + M][M];
            for (int first = 0; first < TC_TILE; first += BLOCK) {
                int32_t sum[BLOCK] = {0}, *out = &w->guess[y][2 * first + px];
                const int32_t *up = &w->up[y][2 * first + px];
                for (int k = 0; k < TC_EXACT_COARSE; k++) {
                    const int16_t *there =
                        here + first + tc_exact_coarse_at[k][1] * TC_EXACT_COARSE_SIDE + tc_exact_coarse_at[k][0];
                    for (int i = 0; i < BLOCK; i++)
                        sum[i] += weight[k] * (int16_t)(there[i] - here[first + i]);
                }
                for (int i = 0; i < BLOCK; i++) {
                    int32_t v = up[2 * i] * 16 + (sum[i] >> 8);
                    v = v < 16 * TC_EXACT_RELIEF ? v : 16 * TC_EXACT_RELIEF;
                    out[2 * i] = v > -16 * TC_EXACT_RELIEF ? v : -16 * TC_EXACT_RELIEF;
                }
            }
        }
}

/* The same for any heights. */
static void guess_wide(const tc_exact *c, tc_exact_work *w)
{
    for (int y = 0; y < TC_EXACT_SIDE; y++)
        for (int px = 0; px < 2; px++) {
            const int16_t *weight = c->model.predict[(y & 1) * 2 + px];
            int64_t sum[TC_TILE] = {0};
            const int32_t *here = &w->coarse[(y >> 1) + M][M];
            for (int k = 0; k < TC_EXACT_COARSE; k++) {
                const int32_t *there =
                    here + tc_exact_coarse_at[k][1] * TC_EXACT_COARSE_SIDE + tc_exact_coarse_at[k][0];
                for (int i = 0; i < TC_TILE; i++)
                    sum[i] += (int64_t)weight[k] * (there[i] - here[i]);
            }
            for (int i = 0; i < TC_TILE; i++)
                w->guess[y][2 * i + px] =
                    tc_exact_clamp((int64_t)w->up[y][2 * i + px] * 16 + (sum[i] >> 8), 16 * TC_EXACT_RELIEF);
        }
}

static void curvature(tc_exact_work *w)
{
    enum { ROW = TC_EXACT_COARSE_SIDE };
#define BEND(p, d)                                                                                                     \
    (uint32_t)((p)[d] + (p)[-(d)] - 2 * (p)[0] < 0 ? 2 * (p)[0] - (p)[d] - (p)[-(d)] : (p)[d] + (p)[-(d)] - 2 * (p)[0])
    for (int j = 0; j < TC_TILE; j++)
        for (int i = 0; i < TC_TILE; i++) {
            const int32_t *c = &w->coarse[j + M][i + M];
            uint32_t sum = BEND(c, 1) + BEND(c, ROW) + BEND(c + 1, ROW) + BEND(c + ROW, 1);
            w->curvature[j][i] = sum < TC_EXACT_ERROR ? sum : TC_EXACT_ERROR;
        }
#undef BEND
}

void tc_exact_prepare(const tc_exact *c, int64_t tx, int64_t ty, const tc_plane *coarse, tc_exact_work *w)
{
    tc_rect tile = {tx * TC_TILE, ty * TC_TILE, tc_min64((tx + 1) * TC_TILE, c->cw),
                    tc_min64((ty + 1) * TC_TILE, c->ch)};
    gather(c, tile, tc_exact_tile_needs(c, tx, ty), coarse, w);
    upsample(w);
    if (is_narrow(c, w))
        guess_narrow(c, w);
    else
        guess_wide(c, w);
    curvature(w);
    memset(w->signal, 0, sizeof w->signal);
    memset(w->error, 0, sizeof w->error);
}

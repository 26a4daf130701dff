/* erosion.c - rivers and slopes that shape a grid of heights.
 *
 * Incision is the stream power law dz/dt = U - K A^m |grad z| with m = 1/2, solved implicitly in O(n) along the tree of
 * flow (Braun, Willett, "A very efficient O(n), implicit and parallel method to solve the stream power equation",
 * Geomorphology 2013). Hollows are filled by Priority-Flood (Barnes et al., Computers & Geosciences 2014), and no slope
 * grows steeper than its ground stands at, as in Cordonnier et al., "Large scale terrain generation from tectonic
 * uplift and fluvial erosion", Eurographics 2016. Where we differ:
 *   - the flood's queue is 65,536 buckets of height instead of a heap: linear, and a filled surface need only descend,
 *     not be the lowest that does. It rises by chance amounts, or plains would drain along straight lines;
 *   - a cell flows to the axial or the diagonal neighbour that enclose its gradient, by chance, so that the mean
 *     direction is the gradient's (Fairfield, Leymarie, "Drainage networks from grid digital elevation models", WRR
 *     1991); steepest descent would comb every slope along eight directions;
 *   - landslides bound the gradient (the eikonal equation's upwind step) instead of the slope along the flow, which
 *     would make pyramids of eight faces;
 *   - big rivers cut faster than m = 1/2 says, or main valleys would lie too high among their mountains.
 * m = 1/2 because a square root is rounded alike everywhere, and pow() is not. */
#include "erosion.h"

#include "common/base/parallel.h"
#include "noise.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { PIT = TC_FLOW_OUTLET + 1, SEEN = 0x80, BUCKETS = 1 << 16, BAND = 16 };

static const int step_x[8] = {1, 1, 0, -1, -1, -1, 0, 1};
static const int step_y[8] = {0, 1, 1, 1, 0, -1, -1, -1};
/* Cells to the neighbour, and the reciprocal. */
static const float distance[8] = {1, 1.41421356f, 1, 1.41421356f, 1, 1.41421356f, 1, 1.41421356f};
static const float nearness[8] = {1, 0.70710678f, 1, 0.70710678f, 1, 0.70710678f, 1, 0.70710678f};

/* A cell by number, and whether all eight neighbours exist. */
struct cell {
    uint32_t x, y;
    bool inner;
};

static inline struct cell locate(int64_t n, int32_t i)
{
    uint32_t side = (uint32_t)n, y = (uint32_t)i / side, x = (uint32_t)i - y * side;
    return (struct cell){x, y, x - 1 < side - 2 && y - 1 < side - 2};
}

static inline bool has_neighbour(int64_t n, struct cell c, int k)
{
    return c.inner || ((int64_t)c.x + step_x[k] >= 0 && (int64_t)c.x + step_x[k] < n && (int64_t)c.y + step_y[k] >= 0 &&
                       (int64_t)c.y + step_y[k] < n);
}

static inline int64_t neighbour(int64_t n, int64_t i, int k)
{
    return i + step_y[k] * n + step_x[k];
}

/* ---- Filling ------------------------------------------------------------------------------------------------- */

void tc_erosion_fill(tc_erosion *e)
{
    int64_t n = e->n, cells = n * n;
    float *z = e->z, low = z[0], high = z[0];
    for (int64_t i = 1; i < cells; i++) {
        low = z[i] < low ? z[i] : low;
        high = z[i] > high ? z[i] : high;
    }
    float scale = high > low ? (BUCKETS - 1) / (high - low) : 0;
    float rise = e->least * (float)e->dx;

    /* A bucket is a list of cells, linked through next. */
    int32_t head[BUCKETS], *next = e->order;
    memset(head, -1, sizeof head);
    for (int64_t i = 0; i < cells; i++)
        if (e->flow[i] == TC_FLOW_OUTLET) {
            int b = (int)((z[i] - low) * scale);
            e->flow[i] |= SEEN;
            next[i] = head[b];
            head[b] = (int32_t)i;
        }
    for (int b = 0; b < BUCKETS; b++)
        while (head[b] >= 0) {
            int32_t i = head[b];
            head[b] = next[i];
            struct cell c = locate(n, i);
            for (int k = 0; k < 8; k++) {
                if (!has_neighbour(n, c, k))
                    continue;
                int64_t j = neighbour(n, i, k);
                if (e->flow[j] & SEEN)
                    continue;
                e->flow[j] |= SEEN;
                float chance = 0.2f + (float)(tc_hash_point(e->seed, (int32_t)j, k) >> 8) * (2.0f / 16777216);
                float least = z[i] + rise * chance * distance[k];
                if (z[j] < least)
                    z[j] = least;
                float above = (z[j] - low) * scale;
                int to = above < BUCKETS - 1 ? (int)above : BUCKETS - 1;
                to = to < b ? b : to;
                next[j] = head[to];
                head[to] = (int32_t)j;
            }
        }
    for (int64_t i = 0; i < cells; i++)
        e->flow[i] &= (uint8_t)~SEEN;
}

/* ---- Routing ------------------------------------------------------------------------------------------------- */

/* The neighbour that an inner cell flows to by chance, where the steepest one descends by `best` a cell; -1 where the
 * chosen one lies too high, as across the bed of a narrow river. */
static inline int flow_by_chance(const float *z, int64_t n, uint32_t hash, float best)
{
    static const int direction[3][3] = {{5, 6, 7}, {4, -1, 0}, {3, 2, 1}};
    float gx = z[-1] - z[1], gy = z[-n] - z[n];
    float ax = gx < 0 ? -gx : gx, ay = gy < 0 ? -gy : gy;
    float chance = (float)(hash >> 8) * (1.0f / 16777216);
    int sx = gx > 0 ? 1 : -1, sy = gy > 0 ? 1 : -1;
    if (ax >= ay) {
        if (chance * ax >= ay)
            sy = 0;
    } else if (chance * ay >= ax)
        sx = 0;
    int k = direction[sy + 1][sx + 1];
    float drop = (z[0] - z[sy * n + sx]) * nearness[k];
    return drop > 0.5f * best ? k : -1;
}

static void route_band(void *context, int64_t band)
{
    tc_erosion *e = context;
    int64_t n = e->n, y1 = (band + 1) * BAND < n ? (band + 1) * BAND : n;
    for (int64_t y = band * BAND; y < y1; y++)
        for (int64_t x = 0; x < n; x++) {
            int64_t i = y * n + x;
            e->area[i] = 1;
            if (e->flow[i] == TC_FLOW_OUTLET)
                continue;
            struct cell c = {(uint32_t)x, (uint32_t)y, x > 0 && y > 0 && x < n - 1 && y < n - 1};
            float best = 0;
            int way = PIT;
            for (int k = 0; k < 8; k++) {
                if (!has_neighbour(n, c, k))
                    continue;
                float drop = (e->z[i] - e->z[neighbour(n, i, k)]) * nearness[k];
                if (drop > best) {
                    best = drop;
                    way = k;
                }
            }
            if (c.inner && way != PIT) {
                int k = flow_by_chance(e->z + i, n, tc_hash_point(e->seed, (int32_t)x, (int32_t)y), best);
                way = k >= 0 ? k : way;
            }
            e->flow[i] = (uint8_t)way;
        }
}

void tc_erosion_route(tc_erosion *e)
{
    int64_t n = e->n, cells = n * n, tail = 0;
    tc_parallel_for(e->threads, (n + BAND - 1) / BAND, route_band, e);
    /* Breadth first from one outlet after the other: what is near in the order is then mostly near in memory. */
    for (int64_t outlet = 0; outlet < cells; outlet++) {
        if (e->flow[outlet] < TC_FLOW_OUTLET)
            continue;
        int64_t front = tail;
        e->order[tail++] = (int32_t)outlet;
        for (; front < tail; front++) {
            int32_t i = e->order[front];
            struct cell c = locate(n, i);
            for (int k = 0; k < 8; k++) {
                if (!has_neighbour(n, c, k))
                    continue;
                int64_t j = neighbour(n, i, k);
                if (e->flow[j] == (k ^ 4)) /* the opposite direction */
                    e->order[tail++] = (int32_t)j;
            }
        }
    }
    for (int64_t q = cells; q-- > 0;) {
        int32_t i = e->order[q];
        int k = e->flow[i];
        if (k < TC_FLOW_OUTLET)
            e->area[neighbour(n, i, k)] += e->area[i];
    }
}

/* ---- Incision ------------------------------------------------------------------------------------------------ */

/* The height at which the gradient of an inner cell is `rise` a cell, given its lower neighbours. */
static inline float highest(const float *z, int64_t n, float rise)
{
    float a = z[-1] < z[1] ? z[-1] : z[1], b = z[-n] < z[n] ? z[-n] : z[n], d = a - b;
    return d >= rise ? b + rise : d <= -rise ? a + rise : 0.5f * (a + b + sqrtf(2 * rise * rise - d * d));
}

void tc_erosion_incise(tc_erosion *e, float dt)
{
    int64_t n = e->n, cells = n * n;
    float talus = e->talus * (float)e->dx, least = e->least * (float)e->dx, per_broad = (float)(e->dx / e->broad);
    for (int64_t q = 0; q < cells; q++) {
        int32_t i = e->order[q];
        int k = e->flow[i];
        if (k >= TC_FLOW_OUTLET)
            continue;
        float below = e->z[neighbour(n, i, k)];
        float width = sqrtf(e->area[i]);
        float f = dt * width * (1 + width * per_broad) * nearness[k];
        float s = e->steepness[i], rise = talus * (0.3f + s / (s + e->firm));
        float up = dt * s, most = e->gully * f * rise * distance[k];
        /* below + a part, not a weighted mean: f reaches 10^5, and a mean's rounding would dam the rivers. */
        float z = below + (e->z[i] - below + (up < most ? up : most)) / (1 + f);
        float top = locate(n, i).inner ? highest(e->z + i, n, rise) : below + rise * distance[k];
        float bed = below + least * distance[k];
        z = z < top ? z : top;
        e->z[i] = z > bed ? z : bed;
    }
}

/* ---- Deposition ---------------------------------------------------------------------------------------------- */

/* Lowers cells, to no less than their ground, until none lies more than rise a cell above the neighbours behind it in
 * the direction of the sweep. */
static void sweep(float *z, const float *ground, int64_t n, float rise, bool back)
{
    int64_t cells = n * n, sign = back ? -1 : 1;
    for (int64_t q = 0; q < cells; q++) {
        int64_t i = back ? cells - 1 - q : q;
        struct cell c = locate(n, (int32_t)i);
        if (!c.inner)
            continue;
        float a = z[i - sign], b = z[i - sign * n], d = z[i - sign * (n + 1)], f = z[i - sign * (n - 1)];
        float axial = (a < b ? a : b) + rise, diagonal = (d < f ? d : f) + 1.41421356f * rise;
        float most = axial < diagonal ? axial : diagonal;
        if (z[i] > most)
            z[i] = ground[i] > most ? ground[i] : most;
    }
}

void tc_erosion_deposit(tc_erosion *e, float depth, float reach, float slope)
{
    int64_t n = e->n, cells = n * n;
    float rise = slope * (float)e->dx;
    /* Level of the river that a cell drains to, which slopes stand out of; and the height before. */
    float *level = e->steepness, *ground = e->area;
    for (int64_t q = 0; q < cells; q++) {
        int32_t i = e->order[q];
        int k = e->flow[i];
        float load = (sqrtf(e->area[i] / reach) - 0.15f) * (1 / 0.85f);
        load = load < 0 ? 0 : load > 1 ? 1 : load;
        level[i] = ground[i] = e->z[i];
        if (k >= TC_FLOW_OUTLET)
            continue;
        float below = level[neighbour(n, i, k)] + rise * distance[k];
        level[i] += depth * load;
        level[i] = level[i] > below ? level[i] : below;
        e->z[i] = level[i] > e->z[i] ? level[i] : e->z[i];
    }
    /* Where a plain's rivers part, the floors of two meet at different levels: a fan instead of a step. */
    for (int round = 0; round < 2; round++) {
        sweep(e->z, ground, n, 8 * rise, false);
        sweep(e->z, ground, n, 8 * rise, true);
    }
}

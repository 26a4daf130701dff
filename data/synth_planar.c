/* synth_planar.c - a landscape out of a seed.
 *
 * Domain-warped noise says where land rises and how fast, and where the sea is; rivers do the rest (erosion.c). As in
 * Cordonnier et al., "Large scale terrain generation from tectonic uplift and fluvial erosion" (Eurographics 2016) the
 * relief is that of a balance between uplift and incision. Where we differ: it is found on a grid of some 150 samples
 * and refined level by level, each of half the spacing: interpolated, warped and roughened a little, so that no line of
 * a coarse grid survives, then eroded again in fewer and gentler steps. Gullies are thus cut into slopes, slopes into
 * mountains. The finest level is only interpolated and roughened: eroding it would triple the time and change little.
 * On the way rivers fill their valleys, and in the end the sea rises a little and drowns the lowest ones.
 *
 * Positions are whole numbers of finest spacings from the south-west sample; grids reach beyond the map on all sides,
 * since rivers near a grid's border run along it. Everything is + - * / and sqrt on IEEE numbers, in an order that does
 * not depend on threads. */
#include "synth_planar.h"

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "erosion.h"
#include "noise.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double landscape = 123000;   /* metres: largest width of one landscape */
static const double highest_peaks = 3600; /* metres, there; about */

enum { COARSEST = 190, BAND = 16, BLOCK = 256 };

/* What each random number is for. Numbers stay what they are, or a seed's terrain would change. */
enum purpose {
    TILT = 1,
    TURN,
    OFFSET_X,
    OFFSET_Y,
    WARP_X,
    WARP_Y,
    LAND,
    SEA,
    BELT,
    MASSIF,
    HILLS,
    FLOW = 100,
    LEVEL = 200
};

/* A square grid of samples; the south-west one is at (origin, origin). */
struct field {
    int64_t n, origin, step;
    float *v;
};

/* How a level is eroded, by its octaves below that of 1/190 to 1/95 of a landscape. */
static const struct stage {
    int steps;
    float dt, rough, warp, gully;
} stages[] = {
    {60, 0.5f, 0.5f, 2.1f, 10},   {40, 0.5f, 0.5f, 2.1f, 10},  {16, 0.3f, 0.5f, 2.1f, 10},
    {10, 0.1f, 1.0f, 1.8f, 0.4f}, {8, 0.1f, 1.0f, 1.2f, 0.4f},
};
static const struct stage first_stage = {200, 1, 0.5f, 0, 10};
enum { SCALE_AT_STEP = 150 }; /* of the first stage */

struct planar {
    int64_t size;
    uint64_t seed;
    int threads;
    double spacing;
    double width;             /* metres: of one landscape here */
    double part;              /* of the largest landscape's width */
    double relief;            /* metres: highest peaks, about */
    float uplift;             /* U/K where the land rises fastest, metres */
    int top, last, reference; /* levels have 2^k finest spacings: coarsest, finest eroded, that of stages[0] */
    struct field rise;        /* 0..1, about: how fast land rises */
    struct field inland;      /* below 0 in the sea */
};

static uint32_t part_seed(const struct planar *p, int purpose)
{
    return (uint32_t)tc_hash64(p->seed, (uint64_t)purpose);
}

static float chance(const struct planar *p, int purpose)
{
    return (float)(part_seed(p, purpose) >> 8) * (1.0f / 16777216);
}

/* ---- Reading fields ------------------------------------------------------------------------------------------- */

static inline int64_t floor_of(double x)
{
    int64_t i = (int64_t)x;
    return i - (x < (double)i);
}

static inline float at(const struct field *f, int64_t x, int64_t y)
{
    return f->v[tc_clamp64(y, 0, f->n - 1) * f->n + tc_clamp64(x, 0, f->n - 1)];
}

static float bilinear(const struct field *f, double x, double y)
{
    x = (x - (double)f->origin) / (double)f->step;
    y = (y - (double)f->origin) / (double)f->step;
    int64_t ix = floor_of(x), iy = floor_of(y);
    float u = (float)(x - (double)ix), v = (float)(y - (double)iy);
    float south = at(f, ix, iy), north = at(f, ix, iy + 1);
    south += u * (at(f, ix + 1, iy) - south);
    north += u * (at(f, ix + 1, iy + 1) - north);
    return south + v * (north - south);
}

/* Catmull-Rom weights and their derivatives. */
static inline void cubic(float t, float w[4], float d[4])
{
    w[0] = t * (-0.5f + t * (1 - 0.5f * t));
    w[1] = 1 + t * t * (-2.5f + 1.5f * t);
    w[2] = t * (0.5f + t * (2 - 1.5f * t));
    w[3] = t * t * (-0.5f + 0.5f * t);
    d[0] = -0.5f + t * (2 - 1.5f * t);
    d[1] = t * (-5 + 4.5f * t);
    d[2] = 0.5f + t * (4 - 4.5f * t);
    d[3] = t * (-1 + 1.5f * t);
}

/* Bicubic value, and the length of the gradient per sample of f. */
static inline float bicubic(const struct field *f, double x, double y, float *gradient_ret)
{
    x = (x - (double)f->origin) / (double)f->step;
    y = (y - (double)f->origin) / (double)f->step;
    int64_t ix = floor_of(x), iy = floor_of(y);
    float u[4], du[4], v[4], dv[4], border[16], z = 0, dx = 0, dy = 0;
    cubic((float)(x - (double)ix), u, du);
    cubic((float)(y - (double)iy), v, dv);
    const float *s = f->v + (iy - 1) * f->n + ix - 1;
    int64_t stride = f->n;
    if (ix < 1 || iy < 1 || ix + 2 >= f->n || iy + 2 >= f->n) {
        for (int k = 0; k < 16; k++)
            border[k] = at(f, ix - 1 + (k & 3), iy - 1 + (k >> 2));
        s = border;
        stride = 4;
    }
    for (int j = 0; j < 4; j++, s += stride) {
        float row = u[0] * s[0] + u[1] * s[1] + u[2] * s[2] + u[3] * s[3];
        z += v[j] * row;
        dy += dv[j] * row;
        dx += v[j] * (du[0] * s[0] + du[1] * s[1] + du[2] * s[2] + du[3] * s[3]);
    }
    *gradient_ret = sqrtf(dx * dx + dy * dy);
    return z;
}

static int by_value(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The value that a part q of all are below. scratch: as many as there are values. */
static float quantile(const float *v, int64_t count, double q, float *scratch)
{
    memcpy(scratch, v, (size_t)count * sizeof *v);
    qsort(scratch, (size_t)count, sizeof *v, by_value);
    return scratch[(int64_t)(q * (double)(count - 1))];
}

/* ---- The plan of the land --------------------------------------------------------------------------------------- */

/* Sets p->rise and p->inland, whose grids are laid out. */
static void plan(struct planar *p, float *scratch)
{
    int64_t n = p->rise.n;
    /* A direction towards the sea: a rational point of the circle's eighth, turned. */
    float t = 0.82843f * (chance(p, TILT) - 0.5f);
    float tilt_x = (1 - t * t) / (1 + t * t), tilt_y = 2 * t / (1 + t * t);
    uint32_t turn = part_seed(p, TURN);
    if (turn & 1) {
        float swap = tilt_x;
        tilt_x = tilt_y;
        tilt_y = swap;
    }
    if (turn & 2) {
        tilt_x = -tilt_x;
        tilt_y = -tilt_y;
    }
    double offset_x = 1000 * chance(p, OFFSET_X), offset_y = 1000 * chance(p, OFFSET_Y);
    for (int64_t j = 0; j < n; j++)
        for (int64_t i = 0; i < n; i++) {
            double x = (double)(p->rise.origin + i * p->rise.step) * p->spacing / p->width;
            double y = (double)(p->rise.origin + j * p->rise.step) * p->spacing / p->width;
            /* One slope down to one coast; far from a small map's middle it is level, and noise rules. */
            double away_x = x < -1 ? -1.5 : x > 2 ? 1.5 : x - 0.5, away_y = y < -1 ? -1.5 : y > 2 ? 1.5 : y - 0.5;
            float tilt = tilt_x * (float)away_x + tilt_y * (float)away_y;
            x += offset_x;
            y += offset_y;
            float warp_x = tc_fbm(part_seed(p, WARP_X), 1.7 * x, 1.7 * y, 4, 0.5f);
            float warp_y = tc_fbm(part_seed(p, WARP_Y), 1.7 * x, 1.7 * y, 4, 0.5f);
            double lx = x + 0.35 * warp_x, ly = y + 0.35 * warp_y, wx = x + 0.3 * warp_x, wy = y + 0.3 * warp_y;
            p->inland.v[j * n + i] = 0.8f * tilt + 0.9f * tc_fbm(part_seed(p, LAND), 1.2 * lx, 1.2 * ly, 5, 0.5f);

            /* Mountain belts along the zero lines of noise, in massifs; hills in part of the rest; plains between. */
            float line = tc_noise(part_seed(p, BELT), 1.1 * wx + 0.5, 1.1 * wy);
            float belt = tc_smoothstep(0, 1, 1 - 2.2f * (line < 0 ? -line : line));
            float massif = 0.65f + 1.1f * tc_fbm(part_seed(p, MASSIF), 5 * wx, 5 * wy, 3, 0.6f);
            massif = massif < 0.15f ? 0.15f : massif;
            float hills = tc_smoothstep(-0.25f, 0.35f, tc_fbm(part_seed(p, HILLS), 2.2 * wx, 2.2 * wy, 3, 0.5f));
            p->rise.v[j * n + i] = 0.03f + 0.1f * hills * hills + belt * massif;
        }
    float coast = quantile(p->inland.v, n * n, 0.10 + 0.12 * chance(p, SEA), scratch);
    for (int64_t i = 0; i < n * n; i++) {
        p->inland.v[i] -= coast;
        p->rise.v[i] *= 0.15f + 0.85f * tc_smoothstep(0, 0.3f, p->inland.v[i]);
    }
}

/* ---- From level to level ---------------------------------------------------------------------------------------- */

struct refinement {
    const struct planar *p;
    const struct field *from;
    struct field to;
    float *steepness; /* NULL with flow: heights only */
    uint8_t *flow;
    float rough, warp;
    uint32_t seed;
};

static void refine_block(const struct refinement *r, int64_t j, int64_t i0, int64_t count)
{
    const struct planar *p = r->p;
    float wander_x[BLOCK] = {0}, wander_y[BLOCK] = {0}, grain[BLOCK] = {0}, rock[BLOCK] = {0};
    double x0 = (double)(r->to.origin + i0 * r->to.step), y = (double)(r->to.origin + j * r->to.step);
    double step = (double)r->to.step, coarse = (double)r->from->step;
    double a = 1 / (6.5 * coarse), b = 1 / (2.5 * step), c = b * 0.43, d = b * 0.5, e = b * 0.11;
    tc_noise_row(r->seed, x0 * a, step * a, y * a, count, r->warp * (float)coarse, wander_x);
    tc_noise_row(r->seed + 1, x0 * a, step * a, y * a, count, r->warp * (float)coarse, wander_y);
    tc_noise_row(r->seed + 2, x0 * b, step * b, y * b, count, 1, grain);
    tc_noise_row(r->seed + 3, x0 * c, step * c, y * c, count, 0.5f, grain);
    if (r->steepness) {
        tc_noise_row(r->seed + 4, x0 * d, step * d, y * d, count, 1, rock);
        tc_noise_row(r->seed + 5, x0 * e, step * e, y * e, count, 1, rock);
    }
    float rough = r->rough * (float)(step * p->spacing), per_metre = (float)(1 / (coarse * p->spacing));
    for (int64_t i = 0; i < count; i++) {
        double x = x0 + (double)i * step;
        float gradient, z = bicubic(r->from, x + wander_x[i], y + wander_y[i], &gradient);
        int64_t k = j * r->to.n + i0 + i;
        /* Steep ground is rough ground. */
        r->to.v[k] = z + rough * grain[i] * (gradient * per_metre + 0.01f);
        if (r->steepness) {
            float hard = 1 + rock[i] < 0.3f ? 0.3f : 1 + rock[i];
            r->steepness[k] = p->uplift * hard * bilinear(&p->rise, x, y);
            r->flow[k] = bilinear(&p->inland, x, y) < 0 ? TC_FLOW_OUTLET : 0;
        }
    }
}

static void refine_band(void *context, int64_t band)
{
    const struct refinement *r = context;
    int64_t n = r->to.n;
    for (int64_t j = band * BAND; j < tc_min64(n, (band + 1) * BAND); j++)
        for (int64_t i = 0; i < n; i += BLOCK)
            refine_block(r, j, i, tc_min64(BLOCK, n - i));
}

static void refine(struct refinement *r)
{
    tc_parallel_for(r->p->threads, (r->to.n + BAND - 1) / BAND, refine_band, r);
}

/* Rivers leave the grid where its border is lowest within some way around. */
static void open_border(tc_erosion *e)
{
    int64_t n = e->n, side = n - 1, ring = 4 * side, reach = tc_max64(4, n / 12);
    for (int64_t a = 0; a < ring; a++) {
        int64_t here = 0;
        float least = 0;
        for (int64_t d = -reach; d <= reach; d++) {
            int64_t b = ((a + d) % ring + ring) % ring, t = b % side, edge = b / side;
            int64_t i = edge == 0 ? t : edge == 1 ? t * n + side : edge == 2 ? n * n - 1 - t : (side - t) * n;
            least = d == -reach || e->z[i] < least ? e->z[i] : least;
            here = d == 0 ? i : here;
        }
        if (e->z[here] <= least)
            e->flow[here] = TC_FLOW_OUTLET;
    }
}

/* ---- A level ---------------------------------------------------------------------------------------------------- */

/* The grid of the level of 2^k spacings. Coarse ones reach a twelfth of a landscape beyond the map, fine ones, whose
 * rivers have long found their way, a few samples. */
static struct field layout(const struct planar *p, int k)
{
    int64_t beyond = ((((p->size - 1) >> p->top) + 1) / 12 + 4) << (p->top - k);
    if (p->reference - k > 3)
        beyond = tc_min64(beyond, 24);
    int64_t step = (int64_t)1 << k;
    return (struct field){.n = ((p->size + step - 2) >> k) + 1 + 2 * beyond, .origin = -(beyond << k), .step = step};
}

static const struct stage *stage_of(const struct planar *p, int k)
{
    int last = (int)(sizeof stages / sizeof *stages) - 1, s = p->reference - k;
    return k == p->top ? &first_stage : &stages[s < 0 ? 0 : s > last ? last : s];
}

/* Work of a level, in cells, for progress. */
static double level_work(const struct planar *p, int k)
{
    double n = (double)layout(p, k).n;
    return n * n * (3 + stage_of(p, k)->steps);
}

struct report {
    const tc_synth_planar_options *options;
    double work, total;
};

static void tell(struct report *report, double work)
{
    report->work += work;
    if (report->options->progress)
        report->options->progress(report->options->progress_context, report->work / report->total);
}

/* On the coarsest level: scales uplift and heights so that the peaks will be p->relief high. */
static void scale_relief(struct planar *p, tc_erosion *e)
{
    float high = quantile(e->z, e->n * e->n, 0.99, e->area);
    if (!(high > 0))
        return;
    float scale = (float)(0.8 * p->relief) / high;
    scale = scale < 0.01f ? 0.01f : scale > 100 ? 100 : scale;
    p->uplift *= scale;
    for (int64_t i = 0; i < e->n * e->n; i++) {
        e->z[i] *= e->z[i] > 0 ? scale : 1;
        e->steepness[i] *= scale;
    }
}

/* Replaces *land (level k + 1; on the coarsest level the raw plan) by the eroded level k. */
static bool erode_level(struct planar *p, int k, struct field *land, struct report *report)
{
    const struct stage *stage = stage_of(p, k);
    struct field to = layout(p, k);
    size_t cells = (size_t)(to.n * to.n);
    tc_erosion e = {
        .n = to.n,
        .dx = p->spacing * (double)to.step,
        .seed = part_seed(p, FLOW + k),
        .threads = p->threads,
        .talus = 0.8f,
        .firm = (float)(500 * p->relief / highest_peaks),
        .broad = (float)(8000 * p->part),
        .gully = stage->gully,
        .least = 0.0008f,
        .z = to.v = malloc(cells * sizeof *e.z),
        .steepness = malloc(cells * sizeof *e.steepness),
        .area = malloc(cells * sizeof *e.area),
        .flow = malloc(cells * sizeof *e.flow),
        .order = malloc(cells * sizeof *e.order),
    };
    bool ok = e.z && e.steepness && e.area && e.flow && e.order;
    if (ok) {
        struct refinement r = {.p = p,
                               .from = land,
                               .to = to,
                               .steepness = e.steepness,
                               .flow = e.flow,
                               .rough = stage->rough,
                               .warp = stage->warp,
                               .seed = part_seed(p, LEVEL + k)};
        refine(&r);
        open_border(&e);
        tell(report, 3 * (double)cells);
        for (int i = 0; i < stage->steps; i++) {
            /* Landslides leave a hollow here and there. */
            if (i % 8 == 0)
                tc_erosion_fill(&e);
            e.seed += 0x9E3779B1u;
            tc_erosion_route(&e);
            tc_erosion_incise(&e, stage->dt);
            if (k == p->top && i == SCALE_AT_STEP)
                scale_relief(p, &e);
            tell(report, (double)cells);
        }
        if (k == p->last) {
            double reach = 10000 * p->part / e.dx;
            tc_erosion_deposit(&e, (float)(0.014 * p->relief), (float)(reach * reach), 0.002f);
        }
        free(land->v);
        *land = to;
    } else
        free(e.z);
    free(e.steepness);
    free(e.area);
    free(e.flow);
    free(e.order);
    return ok;
}

/* ---- The whole -------------------------------------------------------------------------------------------------- */

static struct planar prepare(int64_t size, double spacing)
{
    struct planar p = {.size = size, .spacing = spacing, .uplift = 100};
    double extent = (double)(size - 1) * spacing;
    p.width = extent < landscape ? extent : landscape;
    p.part = p.width / landscape;
    p.relief = highest_peaks * sqrt(p.part) * sqrt(sqrt(sqrt(p.part))); /* part^0.625: small mountains are steeper */
    while (((size - 1) >> p.top) > COARSEST)
        p.top++;
    while (p.width / spacing / (double)((int64_t)1 << p.reference) > COARSEST)
        p.reference++;
    p.last = p.top > 0 ? 1 : 0;
    return p;
}

size_t tc_synth_planar_bytes(int64_t size, double spacing)
{
    struct planar p = prepare(size, spacing > 0 ? spacing : TC_SYNTH_SPACING);
    size_t n = (size_t)layout(&p, p.last).n;
    return n * n * (TC_EROSION_CELL_BYTES + 2);
}

/* The coarsest level before erosion, and the plan. */
static bool begin(struct planar *p, struct field *land)
{
    *land = p->rise = p->inland = layout(p, p->top);
    size_t cells = (size_t)(land->n * land->n);
    land->v = malloc(cells * sizeof *land->v);
    p->rise.v = malloc(cells * sizeof *land->v);
    p->inland.v = malloc(cells * sizeof *land->v);
    if (!land->v || !p->rise.v || !p->inland.v)
        return false;
    plan(p, land->v);
    for (size_t i = 0; i < cells; i++) {
        float c = p->inland.v[i];
        land->v[i] = (float)p->relief * (c < 0 ? 0.11f * c : 0.02f * c + 0.03f * p->rise.v[i]);
    }
    return true;
}

tc_status tc_synth_planar(int64_t size, const tc_synth_planar_options *options, float *z, tc_error *error)
{
    if (size < TC_SYNTH_SIZE_MIN || size > TC_SYNTH_SIZE_MAX)
        return tc_fail(error, TC_ERR_USAGE, "size: expected %d..%d samples, found %lld", TC_SYNTH_SIZE_MIN,
                       TC_SYNTH_SIZE_MAX, (long long)size);
    double spacing = options->spacing != 0 ? options->spacing : TC_SYNTH_SPACING;
    if (!(spacing >= TC_SYNTH_SPACING_MIN && spacing <= TC_SYNTH_SPACING_MAX))
        return tc_fail(error, TC_ERR_USAGE, "spacing: expected %g..%g metres, found %g", TC_SYNTH_SPACING_MIN,
                       TC_SYNTH_SPACING_MAX, spacing);
    struct planar p = prepare(size, spacing);
    p.seed = options->seed;
    p.threads = options->threads;
    struct report report = {options, 0, 3 * (double)size * (double)size};
    for (int k = p.top; k >= p.last; k--)
        report.total += level_work(&p, k);

    struct field land;
    bool ok = begin(&p, &land);
    for (int k = p.top; ok && k >= p.last; k--)
        ok = erode_level(&p, k, &land, &report);
    if (ok) {
        /* Where gullies are too fine to have been cut, roughness stands in for them. */
        float rough = p.reference > 3 ? 0.7f : 1.2f;
        struct refinement r = {.p = &p,
                               .from = &land,
                               .to = {.n = size, .step = 1, .v = z},
                               .rough = rough,
                               .warp = 0.6f,
                               .seed = part_seed(&p, LEVEL)};
        refine(&r);
        float sea = (float)(0.012 * p.relief);
        for (int64_t i = 0; i < size * size; i++)
            z[i] -= sea;
        tell(&report, 3 * (double)size * (double)size);
    }
    free(land.v);
    free(p.rise.v);
    free(p.inland.v);
    return ok ? TC_OK
              : tc_fail(error, TC_ERR_MEMORY, "terrain of %lld x %lld: expected %.1f GB of memory, found less",
                        (long long)size, (long long)size, (double)tc_synth_planar_bytes(size, spacing) * 1e-9);
}

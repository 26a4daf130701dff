/* resample.c - heights at the samples of a face from those of a grid of longitude and latitude and its caps.
 *
 * Where two of these charts share a place both answer, by their shares. A chart's answer is a sum over its samples
 * around, along x and along y each with Keys' cubic, stretched by s = (how far apart the face's samples are) / (the
 * chart's own), 1 at least: so rows, whose samples crowd towards a pole, are filtered to what the face can hold, and
 * nothing is lost where it can hold all. A stretched kernel's weights are set right for their sum and their first
 * moment, so that what is level or slopes evenly stays so. */
#include "resample.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "joined.h"

enum { BLOCK = 32, MOST_TAPS = 128, MOST_SOURCES = 3, MOST_READ = 1 << 20 };

static int finest(const tc_field *field)
{
    return tc_field_info(field)->levels;
}

/* ---- The kernel -------------------------------------------------------------------------------------------------- */

typedef struct taps {
    int64_t first, nearest;
    int count;
    double w[MOST_TAPS];
} taps;

/* Keys' cubic: through its samples, exact for parabolas. */
static double keys(double x)
{
    x = fabs(x);
    return x < 1 ? (1.5 * x - 2.5) * x * x + 1 : x < 2 ? ((-0.5 * x + 2.5) * x - 4) * x + 2 : 0;
}

static void find_taps(double at, double s, taps *t)
{
    s = fmin(fmax(s, 1), (MOST_TAPS - 2) / 4);
    t->first = (int64_t)ceil(at - 2 * s);
    t->count = (int)((int64_t)floor(at + 2 * s) - t->first) + 1;
    t->nearest = (int64_t)floor(at + 0.5);
    double sum = 0, moment = 0, square = 0;
    for (int k = 0; k < t->count; k++) {
        double d = (double)(t->first + k) - at, w = t->w[k] = keys(d / s);
        moment += w * d, square += fabs(w) * d * d;
    }
    for (int k = 0; k < t->count; k++) {
        double d = (double)(t->first + k) - at;
        t->w[k] -= square > 0 ? moment / square * fabs(t->w[k]) * d : 0;
        sum += t->w[k];
    }
    for (int k = 0; k < t->count; k++)
        t->w[k] /= sum;
}

/* ---- Where samples are on the source's charts -------------------------------------------------------------------- */

/* Of one sample on one of the source's charts. */
typedef struct spot {
    double share; /* 0: none */
    double u, v;  /* in its samples, on the first turn of one that goes round */
    double sx, sy;
} spot;

static void find_spot(const tc_chart *c, double longitude, double latitude, double apart, spot *s)
{
    double x, y, along_x, along_y, area;
    c->class->from_place(c, longitude, latitude, &x, &y);
    c->class->spread(c, x, y, &along_x, &along_y, &area);
    tc_chart_samples(c, finest(c->field), x, y, &s->u, &s->v);
    if (c->wraps) {
        double turn = (double)tc_field_level(c->field, finest(c->field)).width;
        s->u -= turn * floor(s->u / turn);
    }
    s->sx = apart / (along_x * c->dx), s->sy = apart / (along_y * c->dy);
}

/* Of a block of a face: where it lies on all of the source's charts. */
typedef struct block {
    const tc_resample_source *from;
    spot spot[BLOCK * BLOCK][MOST_SOURCES];
} block;

static void find_sample(const tc_resample_source *from, const tc_chart_class *class, int face, int64_t cells, int64_t i,
                        int64_t j, spot s[MOST_SOURCES])
{
    double longitude, latitude, along_x, along_y, area, share[MOST_SOURCES];
    tc_joined_owner(class, cells, &face, &i, &j);
    const tc_chart c = {.class = class, .face = face};
    double x = (double)i / (double)cells, y = (double)j / (double)cells;
    class->to_place(&c, x, y, &longitude, &latitude);
    class->spread(&c, x, y, &along_x, &along_y, &area);
    const double normal[3] = {cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)};
    tc_chart_shares(from->chart, from->charts, normal, share);
    for (int k = 0; k < from->charts; k++) {
        s[k].share = share[k];
        if (share[k] > 0)
            find_spot(&from->chart[k], longitude, latitude, sqrt(area) / (double)cells, &s[k]);
    }
}

/* ---- A block ----------------------------------------------------------------------------------------------------- */

/* What a block reads of a chart. */
typedef struct piece {
    tc_rect rect; /* columns of a chart that goes round count on */
    float *z;
    uint8_t *voids;
} piece;

/* Columns by which a place is counted, on a chart that goes round: the next to those of the block's first place. */
static int64_t turned(const tc_chart *c, double u, double first)
{
    if (!c->wraps)
        return 0;
    int64_t turn = tc_field_level(c->field, finest(c->field)).width;
    return -turn * (int64_t)rint((u - first) / (double)turn);
}

static tc_rect reach(const tc_chart *c, const spot *s, double first)
{
    int64_t by = turned(c, s->u, first), rx = (int64_t)ceil(2 * fmax(s->sx, 1)) + 1,
            ry = (int64_t)ceil(2 * fmax(s->sy, 1)) + 1, i = (int64_t)floor(s->u) + by, j = (int64_t)floor(s->v);
    return (tc_rect){i - rx, j - ry, i + rx + 2, j + ry + 2};
}

/* Of one sample on one chart; the sample of the chart next to it in *near_ret. */
static double answer(const block *b, int chart, const spot *s, double first, const piece *p, bool *void_ret)
{
    const tc_chart *c = &b->from->chart[chart];
    taps x, y;
    find_taps(s->u, s->sx, &x), find_taps(s->v, s->sy, &y);
    const tc_rect r = p->rect;
    int64_t by = turned(c, s->u, first) - r.x0, width = r.x1 - r.x0;
    int64_t at = (tc_clamp64(y.nearest, r.y0, r.y1 - 1) - r.y0) * width + tc_clamp64(x.nearest + by, 0, width - 1);
    double near = (double)p->z[at], sum = 0;
    *void_ret = p->voids[at];
    for (int l = 0; l < y.count; l++) {
        int64_t row = (tc_clamp64(y.first + l, r.y0, r.y1 - 1) - r.y0) * width;
        double part = 0;
        for (int k = 0; k < x.count; k++) {
            int64_t n = row + tc_clamp64(x.first + k + by, 0, width - 1);
            if (!b->from->flat || !p->voids[n])
                part += x.w[k] * ((double)p->z[n] - near);
        }
        sum += y.w[l] * part;
    }
    return b->from->flat && *void_ret ? near : near + sum;
}

/* What a block reads of one chart; nothing where that is too much. */
static tc_status read_piece(const tc_resample_source *from, int chart, int64_t count, spot (*spots)[MOST_SOURCES],
                            double *first, piece *p, bool *much)
{
    const tc_chart *c = &from->chart[chart];
    const tc_level size = tc_field_level(c->field, finest(c->field));
    bool begun = false;
    for (int64_t n = 0; n < count; n++) {
        if (!(spots[n][chart].share > 0))
            continue;
        *first = begun ? *first : spots[n][chart].u;
        begun = true;
        p->rect = tc_rect_around(p->rect, reach(c, &spots[n][chart], *first));
    }
    if (!c->wraps)
        p->rect.x0 = tc_max64(p->rect.x0, 0), p->rect.x1 = tc_min64(p->rect.x1, size.width);
    p->rect.y0 = tc_max64(p->rect.y0, 0), p->rect.y1 = tc_min64(p->rect.y1, size.height);
    int64_t area = tc_rect_area(p->rect);
    *much = area > MOST_READ && count > 1;
    if (area == 0 || *much)
        return TC_OK;
    p->z = malloc((size_t)area * sizeof *p->z);
    p->voids = malloc((size_t)area);
    return p->z && p->voids
               ? tc_field_read(c->field, finest(c->field), p->rect, p->z, p->voids, p->rect.x1 - p->rect.x0)
               : TC_ERR_MEMORY;
}

static tc_status resample_block(block *b, const tc_chart_class *class, int face, int64_t cells, tc_rect rect, float *z,
                                uint8_t *voids, ptrdiff_t stride)
{
    int64_t width = rect.x1 - rect.x0, count = tc_rect_area(rect);
    for (int64_t n = 0; n < count; n++)
        find_sample(b->from, class, face, cells, rect.x0 + n % width, rect.y0 + n / width, b->spot[n]);
    piece p[MOST_SOURCES] = {{.z = NULL}};
    double first[MOST_SOURCES] = {0};
    bool much = false;
    tc_status status = TC_OK;
    for (int k = 0; k < b->from->charts && !status && !much; k++)
        status = read_piece(b->from, k, count, b->spot, &first[k], &p[k], &much);
    for (int64_t n = 0; n < count && !status && !much; n++) {
        double height = 0, base = 0, most = 0;
        for (int k = 0; k < b->from->charts; k++) {
            const spot *s = &b->spot[n][k];
            bool hole;
            if (!(s->share > 0))
                continue;
            double one = answer(b, k, s, first[k], &p[k], &hole);
            if (most == 0)
                base = one;
            height += s->share * (one - base);
            if (voids && s->share > most)
                voids[n / width * stride + n % width] = hole;
            most = fmax(most, s->share);
        }
        z[n / width * stride + n % width] = (float)(base + height);
    }
    for (int k = 0; k < MOST_SOURCES; k++)
        free(p[k].z), free(p[k].voids);
    if (status || !much)
        return status;
    tc_rect low = rect, high = rect; /* in two parts */
    if (width > 1)
        low.x1 = high.x0 = (rect.x0 + rect.x1) / 2;
    else
        low.y1 = high.y0 = (rect.y0 + rect.y1) / 2;
    ptrdiff_t by = (high.y0 - rect.y0) * stride + high.x0 - rect.x0;
    status = resample_block(b, class, face, cells, low, z, voids, stride);
    return status ? status : resample_block(b, class, face, cells, high, z + by, voids ? voids + by : NULL, stride);
}

tc_status tc_resample(const tc_resample_source *from, const tc_chart_class *class, int face, int64_t cells,
                      tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride)
{
    block *b = malloc(sizeof *b);
    if (!b)
        return TC_ERR_MEMORY;
    b->from = from;
    tc_status status = TC_OK;
    for (int64_t y = rect.y0; y < rect.y1 && !status; y += BLOCK)
        for (int64_t x = rect.x0; x < rect.x1 && !status; x += BLOCK) {
            ptrdiff_t at = (y - rect.y0) * stride + x - rect.x0;
            status = resample_block(b, class, face, cells,
                                    (tc_rect){x, y, tc_min64(x + BLOCK, rect.x1), tc_min64(y + BLOCK, rect.y1)}, z + at,
                                    voids ? voids + at : NULL, stride);
        }
    free(b);
    return status;
}

int64_t tc_resample_cells(int64_t columns)
{
    return tc_chart_cells((columns + 3) / 4);
}

/* ---- There and back ---------------------------------------------------------------------------------------------- */

typedef struct trip {
    const tc_chart *from, *face;
    int faces;
    int64_t width, step; /* rows looked at */
    double *sum, *weight, *max;
    int64_t *samples;
    _Atomic int status;
} trip;

static void look_at_row(void *context, int64_t n)
{
    trip *t = context;
    const tc_chart *c = t->from;
    int64_t row = n * t->step, width = t->width;
    double *place = malloc(2 * (size_t)width * sizeof *place), y = c->y0 + (double)row * c->dy;
    float *z = malloc(2 * (size_t)width * sizeof *z);
    uint8_t *voids = malloc(2 * (size_t)width);
    tc_status status = place && z && voids ? TC_OK : TC_ERR_MEMORY;
    for (int64_t i = 0; i < width && !status; i++)
        c->class->to_place(c, c->x0 + (double)i * c->dx, fmin(fmax(y, -M_PI / 2), M_PI / 2), &place[i],
                           &place[width + i]);
    if (!status)
        status = tc_field_read(c->field, finest(c->field), (tc_rect){0, row, width, row + 1}, z, voids, width);
    if (!status)
        status = tc_joined_heights(t->face, t->faces, finest(t->face->field), width, place, place + width, z + width,
                                   voids + width);
    for (int64_t i = 0; i < width && !status; i++) {
        double off = fabs((double)z[i] - (double)z[width + i]), weight = fmax(cos(y), 0);
        if (voids[i] || voids[width + i])
            continue;
        t->sum[n] += weight * off * off, t->weight[n] += weight, t->samples[n]++;
        t->max[n] = fmax(t->max[n], off);
    }
    if (status)
        t->status = (int)status;
    free(place), free(z), free(voids);
}

tc_status tc_resample_round_trip(const tc_resample_source *from, const tc_chart *face, int faces, int threads,
                                 tc_round_trip *result_ret)
{
    const int64_t most = 1 << 22; /* samples */
    const tc_level size = tc_field_level(from->chart[0].field, finest(from->chart[0].field));
    int64_t step = tc_max64(1, size.width * size.height / most), rows = (size.height + step - 1) / step;
    double *sums = calloc(3 * (size_t)rows, sizeof *sums);
    int64_t *samples = calloc((size_t)rows, sizeof *samples);
    trip t = {from->chart, face, faces, size.width, step, sums, sums + rows, sums + 2 * rows, samples, 0};
    if (sums && samples)
        tc_parallel_for(threads, rows, look_at_row, &t);
    else
        t.status = TC_ERR_MEMORY;
    double sum = 0, weight = 0;
    tc_round_trip r = {0, 0, 0};
    for (int64_t n = 0; n < rows && !t.status; n++) {
        sum += t.sum[n], weight += t.weight[n], r.samples += t.samples[n];
        r.max = fmax(r.max, t.max[n]);
    }
    r.rms = sqrt(sum / fmax(weight, 1e-300));
    free(sums), free(samples);
    if (!t.status)
        *result_ret = r;
    return (tc_status)t.status;
}

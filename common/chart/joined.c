/* joined.c - reading charts across their seams. */
#include "joined.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/field/memory_field.h"
#include "common/field/range_pyramid.h"

enum { TAPS = 4, BLOCK = 16, MOST_READ = 64 * 64, LINE = 256, MOST_CHARTS = 6, AT_A_TIME = BLOCK * BLOCK };

/* A question to the charts' own fields: for samples, waiting or not, or whether they are ready. */
typedef struct question {
    const tc_chart *chart;
    int charts, level;
    enum { WAITING, AT_ONCE, ASKING } how;
    tc_urgency urgency;
    tc_ready ready; /* of all that was asked */
} question;

/* Where samples go: the first of them, rows `stride` apart; NULL: not wanted. */
typedef struct target {
    float *z;
    uint8_t *voids;
    ptrdiff_t stride;
} target;

static target shifted(target t, int64_t x, int64_t y)
{
    ptrdiff_t by = y * t.stride + x;
    return (target){t.z ? t.z + by : NULL, t.voids ? t.voids + by : NULL, t.stride};
}

/* From a chart's own field. TC_ERR_IO where samples are wanted at once and are not ready. */
static tc_status ask(question *q, int face, tc_rect rect, target to)
{
    const tc_field *field = q->chart[face].field;
    if (q->how == WAITING)
        return tc_field_read(field, q->level, rect, to.z, to.voids, to.stride);
    tc_ready ready = q->how == ASKING
                         ? tc_field_ready(field, q->level, rect, q->urgency)
                         : tc_field_read_ready(field, q->level, rect, to.z, to.voids, to.stride, TC_ONLY_ASK);
    if (ready > q->ready)
        q->ready = ready;
    return q->how == AT_ONCE && ready != TC_READY ? TC_ERR_IO : TC_OK;
}

/* ---- On the sides ------------------------------------------------------------------------------------------------ */

/* Cells a side of a level whose samples lie on all sides; 0: they do not. */
static int64_t cells_of(const tc_chart *chart, int level)
{
    int levels = tc_field_info(chart->field)->levels, coarser = levels - level;
    int64_t cells = tc_field_level(chart->field, levels).width - 1;
    return (cells >> coarser) << coarser == cells ? cells >> coarser : 0;
}

typedef struct spot {
    int face;
    int64_t i, j;
} spot;

static spot beyond(const tc_seam *seam, int64_t i, int64_t j)
{
    return (spot){seam->chart, seam->m[0] * i + seam->m[1] * j + seam->dx, seam->m[2] * i + seam->m[3] * j + seam->dy};
}

static bool on_side(int side, int64_t cells, int64_t i, int64_t j)
{
    return side == TC_WEST ? i == 0 : side == TC_EAST ? i == cells : side == TC_SOUTH ? j == 0 : j == cells;
}

/* The sample that all charts take for this one: of the chart of the lowest number, from neighbour to neighbour. */
static spot owner(const tc_chart_class *class, int64_t cells, spot at)
{
    for (bool moved = true; moved;) {
        spot best = at;
        for (int side = 0; side < TC_SIDES; side++) {
            if (!on_side(side, cells, at.i, at.j))
                continue;
            const tc_seam seam = class->seam(at.face, side, cells);
            if (seam.chart >= 0 && seam.chart < best.face)
                best = beyond(&seam, at.i, at.j);
        }
        moved = best.face != at.face;
        at = best;
    }
    return at;
}

/* Samples from..to of a side, corners not among them, from the chart beyond it. */
static tc_status take_line(question *q, int side, const tc_seam *seam, int64_t cells, int64_t from, int64_t to,
                           tc_rect rect, target out)
{
    bool along_y = side == TC_WEST || side == TC_EAST;
    int64_t at = side == TC_EAST || side == TC_NORTH ? cells : 0;
    tc_status status = TC_OK;
    for (int64_t start = from; start < to && !status; start += LINE) {
        float z[LINE];
        uint8_t voids[LINE];
        int64_t count = tc_min64(LINE, to - start), last = start + count - 1;
        spot a = along_y ? beyond(seam, at, start) : beyond(seam, start, at);
        spot b = along_y ? beyond(seam, at, last) : beyond(seam, last, at);
        tc_rect line = {tc_min64(a.i, b.i), tc_min64(a.j, b.j), tc_max64(a.i, b.i) + 1, tc_max64(a.j, b.j) + 1};
        status = ask(q, seam->chart, line,
                     (target){out.z ? z : NULL, out.voids ? voids : NULL, tc_max64(line.x1 - line.x0, 1)});
        bool reversed = b.i < a.i || b.j < a.j;
        for (int64_t k = 0; k < count && !status && q->how != ASKING; k++) {
            int64_t p = start + k, x = (along_y ? at : p) - rect.x0, y = (along_y ? p : at) - rect.y0;
            int64_t n = reversed ? count - 1 - k : k;
            target one = shifted(out, x, y);
            if (out.z)
                *one.z = z[n];
            if (out.voids)
                *one.voids = voids[n];
        }
    }
    return status;
}

/* Puts the owners' samples on the sides of rect, which lies within the level. */
static tc_status settle_sides(question *q, int face, tc_rect rect, target to)
{
    const tc_chart_class *class = q->chart[face].class;
    int64_t cells = cells_of(&q->chart[face], q->level);
    tc_status status = TC_OK;
    for (int side = 0; side < TC_SIDES && cells > 0 && !status; side++) {
        bool along_y = side == TC_WEST || side == TC_EAST;
        int64_t at = side == TC_EAST || side == TC_NORTH ? cells : 0;
        if (along_y ? rect.x0 > at || rect.x1 <= at : rect.y0 > at || rect.y1 <= at)
            continue;
        const tc_seam seam = class->seam(face, side, cells);
        int64_t from = along_y ? rect.y0 : rect.x0, end = along_y ? rect.y1 : rect.x1;
        if (seam.chart < face)
            status = take_line(q, side, &seam, cells, tc_max64(from, 1), tc_min64(end, cells), rect, to);
    }
    for (int corner = 0; corner < 4 && cells > 0 && !status; corner++) {
        spot at = {face, corner & 1 ? cells : 0, corner & 2 ? cells : 0};
        if (!tc_rect_contains(rect, at.i, at.j))
            continue;
        spot its = owner(class, cells, at);
        if (its.face != face)
            status = ask(q, its.face, (tc_rect){its.i, its.j, its.i + 1, its.j + 1},
                         shifted(to, at.i - rect.x0, at.j - rect.y0));
    }
    return status;
}

static tc_status read_inside(question *q, int face, tc_rect rect, target to)
{
    tc_status status = ask(q, face, rect, to);
    return status ? status : settle_sides(q, face, rect, to);
}

/* ---- Beyond the sides -------------------------------------------------------------------------------------------- */

/* Where four samples begin, and their weights. */
typedef struct taps {
    int64_t first, nearest;
    double w[TAPS];
} taps;

static taps taps_at(double u, int64_t size)
{
    const double near = 1e-6; /* of a sample: what a sample's own place may be off by */
    taps t = {.nearest = tc_clamp64((int64_t)floor(u + 0.5), 0, size - 1)};
    t.first = tc_clamp64((int64_t)floor(u) - 1, 0, tc_max64(size - TAPS, 0));
    if (size < TAPS || fabs(u - (double)t.nearest) < near) {
        t.first = tc_min64(t.first, t.nearest), t.w[t.nearest - t.first] = 1;
        return t;
    }
    double a = u - (double)t.first, b = a - 1, c = a - 2, d = a - 3;
    t.w[0] = -b * c * d / 6, t.w[1] = a * c * d / 2, t.w[2] = -a * b * d / 2, t.w[3] = a * b * c / 6;
    return t;
}

/* A place on the chart that has it, in samples of the level. */
typedef struct place {
    int face;
    taps x, y;
} place;

static int64_t level_size(const question *q)
{
    return tc_field_level(q->chart->field, q->level).width;
}

static place place_of(const question *q, double longitude, double latitude)
{
    const tc_chart_class *class = q->chart->class;
    int64_t size = level_size(q);
    int levels = tc_field_info(q->chart->field)->levels;
    double cells = ldexp((double)(tc_field_level(q->chart->field, levels).width - 1), q->level - levels), x, y;
    const double normal[3] = {cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)};
    place p = {.face = 0};
    while (p.face < q->charts - 1 && !(class->share(&q->chart[p.face], normal) > 0))
        p.face++;
    class->from_place(&q->chart[p.face], longitude, latitude, &x, &y);
    p.x = taps_at(x * cells, size), p.y = taps_at(y * cells, size);
    return p;
}

/* Relative to the first sample, so that what is level stays so. */
static float interpolate(const place *p, const float *z, ptrdiff_t stride)
{
    double first = (double)z[0], sum = 0;
    for (int b = 0; b < TAPS; b++)
        for (int a = 0; a < TAPS; a++)
            if (p->x.w[a] != 0 && p->y.w[b] != 0)
                sum += p->y.w[b] * p->x.w[a] * ((double)z[b * stride + a] - first);
    return (float)fmin(fmax(first + sum, -FLT_MAX), FLT_MAX); /* it may go beyond the samples */
}

/* Heights at places, AT_A_TIME at most: what they need of each chart at once, where that is not much. */
static tc_status gather(question *q, int count, const place *places, float *z_ret, uint8_t *voids_ret)
{
    int64_t wide = tc_min64(TAPS, level_size(q));
    tc_rect needs[MOST_CHARTS] = {{0}};
    for (int n = 0; n < count; n++) {
        const place *p = &places[n];
        const tc_rect one = {p->x.first, p->y.first, p->x.first + wide, p->y.first + wide};
        needs[p->face] = tc_rect_around(needs[p->face], one);
    }
    for (int k = 0; k < q->charts; k++)
        if (tc_rect_area(needs[k]) > MOST_READ) {
            tc_status status = gather(q, count / 2, places, z_ret, voids_ret);
            return status ? status
                          : gather(q, count - count / 2, places + count / 2, z_ret + count / 2, voids_ret + count / 2);
        }
    float z[MOST_READ];
    uint8_t voids[MOST_READ];
    for (int k = 0; k < q->charts; k++) {
        const tc_rect need = needs[k];
        if (tc_rect_empty(need))
            continue;
        ptrdiff_t stride = need.x1 - need.x0;
        tc_status status = read_inside(q, k, need, (target){z, voids, stride});
        if (status)
            return status;
        for (int n = 0; n < count && q->how != ASKING; n++) {
            const place *p = &places[n];
            if (p->face != k)
                continue;
            z_ret[n] = interpolate(p, z + (p->y.first - need.y0) * stride + p->x.first - need.x0, stride);
            voids_ret[n] = voids[(p->y.nearest - need.y0) * stride + p->x.nearest - need.x0];
        }
    }
    return TC_OK;
}

/* Of a block of at most AT_A_TIME samples that lies all beyond the sides. */
static tc_status read_across(question *q, int face, tc_rect rect, target to)
{
    const tc_chart *c = &q->chart[face];
    int levels = tc_field_info(c->field)->levels, count = (int)tc_rect_area(rect);
    int64_t step = (int64_t)1 << (levels - q->level), width = rect.x1 - rect.x0;
    double cells = (double)(tc_field_level(c->field, levels).width - 1);
    place places[AT_A_TIME];
    float z[AT_A_TIME];
    uint8_t voids[AT_A_TIME];
    for (int n = 0; n < count; n++) {
        int64_t i = rect.x0 + n % width, j = rect.y0 + n / width;
        double longitude, latitude;
        c->class->to_place(c, (double)(i * step) / cells, (double)(j * step) / cells, &longitude, &latitude);
        places[n] = place_of(q, longitude, latitude);
    }
    tc_status status = gather(q, count, places, z, voids);
    for (int n = 0; n < count && !status && q->how != ASKING; n++) {
        target one = shifted(to, n % width, n / width);
        if (to.z)
            *one.z = z[n];
        if (to.voids)
            *one.voids = voids[n];
    }
    return status;
}

/* What sticks out of the level in strips around what does not. */
static tc_status read_all(question *q, int face, tc_rect rect, target to)
{
    int64_t size = level_size(q);
    tc_rect in = tc_rect_intersect(rect, (tc_rect){0, 0, size, size});
    tc_status status = TC_OK;
    if (!tc_rect_empty(in))
        status = read_inside(q, face, in, shifted(to, in.x0 - rect.x0, in.y0 - rect.y0));
    else
        in = (tc_rect){rect.x0, rect.y1, rect.x1, rect.y1};
    const tc_rect strips[] = {{rect.x0, rect.y0, rect.x1, in.y0},
                              {rect.x0, in.y0, in.x0, in.y1},
                              {in.x1, in.y0, rect.x1, in.y1},
                              {rect.x0, in.y1, rect.x1, rect.y1}};
    for (int s = 0; s < 4 && !status; s++)
        for (int64_t y = strips[s].y0; y < strips[s].y1 && !status; y += BLOCK)
            for (int64_t x = strips[s].x0; x < strips[s].x1 && !status; x += BLOCK) {
                tc_rect block = {x, y, tc_min64(x + BLOCK, strips[s].x1), tc_min64(y + BLOCK, strips[s].y1)};
                status = read_across(q, face, block, shifted(to, x - rect.x0, y - rect.y0));
            }
    return status;
}

/* ---- The field --------------------------------------------------------------------------------------------------- */

/* What the charts of a map have in common; gone with the last of their fields. */
typedef struct group {
    _Atomic int users;
    int charts;
    float apart[TC_MAX_FIELD_LEVELS]; /* of samples on sides from their owners': [l - 1] */
    tc_chart chart[];                 /* over their own fields */
} group;

typedef struct joined {
    tc_field head;
    group *group;
    int face;
} joined;

static const tc_field *own(const tc_field *field)
{
    const joined *p = (const joined *)field;
    return p->group->chart[p->face].field;
}

static question question_of(const tc_field *field, int level, int how)
{
    const joined *p = (const joined *)field;
    return (question){.chart = p->group->chart, .charts = p->group->charts, .level = level, .how = how};
}

static tc_status joined_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                             ptrdiff_t stride)
{
    question q = question_of(field, level, WAITING);
    return read_all(&q, ((const joined *)field)->face, rect, (target){samples, voids, stride});
}

static bool joined_read_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    question q = question_of(field, level, AT_ONCE);
    return read_all(&q, ((const joined *)field)->face, rect, (target){samples, voids, stride}) == TC_OK;
}

static tc_ready joined_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    question q = question_of(field, level, ASKING);
    q.urgency = urgency;
    return read_all(&q, ((const joined *)field)->face, rect, (target){NULL, NULL, 0}) ? TC_FAILED : q.ready;
}

/* The range of what a chart's samples on its sides may be, of those that rect has, is next to or whose cells it is in:
 * another chart's. *found_ret: there are some. */
static tc_range range_beside(const joined *p, int level, tc_rect rect, bool *found_ret)
{
    const tc_chart_class *class = p->group->chart[0].class;
    int64_t cells = cells_of(&p->group->chart[p->face], level);
    tc_range all = TC_NO_RANGE;
    rect = tc_rect_intersect(tc_rect_grown(rect, 2), (tc_rect){0, 0, cells + 1, cells + 1});
    for (int side = 0; side < TC_SIDES && cells > 0 && !tc_rect_empty(rect); side++) {
        bool along_y = side == TC_WEST || side == TC_EAST;
        int64_t at = side == TC_EAST || side == TC_NORTH ? cells : 0;
        const tc_seam seam = class->seam(p->face, side, cells);
        if (seam.chart >= p->face || (along_y ? rect.x0 > at || rect.x1 <= at : rect.y0 > at || rect.y1 <= at))
            continue;
        spot a = along_y ? beyond(&seam, at, rect.y0) : beyond(&seam, rect.x0, at);
        spot b = along_y ? beyond(&seam, at, rect.y1 - 1) : beyond(&seam, rect.x1 - 1, at);
        tc_rect line = {tc_min64(a.i, b.i), tc_min64(a.j, b.j), tc_max64(a.i, b.i) + 1, tc_max64(a.j, b.j) + 1};
        all = tc_range_both(all, tc_field_range(p->group->chart[seam.chart].field, level, line));
        *found_ret = true;
    }
    for (int corner = 0; corner < 4 && cells > 0; corner++) {
        spot at = {p->face, corner & 1 ? cells : 0, corner & 2 ? cells : 0}, its = owner(class, cells, at);
        if (its.face == p->face || !tc_rect_contains(rect, at.i, at.j))
            continue;
        const tc_rect one = {its.i, its.j, its.i + 1, its.j + 1};
        all = tc_range_both(all, tc_field_range(p->group->chart[its.face].field, level, one));
        *found_ret = true;
    }
    return all;
}

/* Whether a rectangle has samples on a side that are another chart's, is next to some, or in the coarser cells beside.
 */
static bool is_beside(const joined *p, int64_t cells, tc_rect rect)
{
    for (int side = 0; side < TC_SIDES && cells > 0; side++) {
        bool along_y = side == TC_WEST || side == TC_EAST;
        int64_t at = side == TC_EAST || side == TC_NORTH ? cells : 0;
        if ((along_y ? rect.x0 <= at + 2 && rect.x1 > at - 2 : rect.y0 <= at + 2 && rect.y1 > at - 2) &&
            p->group->chart[0].class->seam(p->face, side, cells).chart < p->face)
            return true;
    }
    return false;
}

/* Next to a side another chart's samples count as well: those on it, and those of the coarser mesh. */
static tc_range joined_range(const tc_field *field, int level, tc_rect rect)
{
    const joined *p = (const joined *)field;
    const group *g = p->group;
    tc_range r = tc_field_range(own(field), level, rect), all = r;
    float fine = g->apart[level - 1], coarse = level > 1 ? g->apart[level - 2] : 0,
          finest = g->apart[field->info.levels - 1];
    if (!is_beside(p, cells_of(&g->chart[p->face], level), rect))
        return r;
    if (isfinite(fine + coarse + finest))
        return (tc_range){r.lo - fine, r.hi + fine, r.step + fine + coarse, r.error + coarse + finest};
    /* How far apart they are is not known, but for that all are within their ranges. */
    bool found = false;
    all = tc_range_both(all, range_beside(p, level, rect, &found));
    r.lo = all.lo, r.hi = all.hi;
    if (level > 1) {
        const tc_rect around = {rect.x0 / 2, rect.y0 / 2, rect.x1 / 2 + 1, rect.y1 / 2 + 1};
        all = tc_range_both(all, tc_field_range(own(field), level - 1, around));
        all = tc_range_both(all, range_beside(p, level - 1, around, &found));
    }
    r.step += all.hi - all.lo;
    r.error = INFINITY;
    return r;
}

/* Of fields whose samples on the sides are those of the owners already. */
static tc_range settled_range(const tc_field *field, int level, tc_rect rect)
{
    return tc_field_range(own(field), level, rect);
}

static void joined_know_errors(const tc_field *field)
{
    const group *g = ((const joined *)field)->group;
    for (int k = 0; k < g->charts; k++)
        tc_field_know_errors(g->chart[k].field);
}

/* What its sides and corners ask of other charts is left. */
static void joined_overtaken(const tc_field *field, int level, tc_rect rect)
{
    const tc_level size = tc_field_level(own(field), level);
    tc_field_overtaken(own(field), level, tc_rect_intersect(rect, (tc_rect){0, 0, size.width, size.height}));
}

static bool joined_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    return tc_field_changed(own(field), since, finest_ret);
}

static void joined_tell(const tc_field *field, tc_field_stats *stats)
{
    own(field)->class->tell(own(field), stats);
    stats->bytes += sizeof(joined);
}

static const struct tc_container *joined_container(const tc_field *field)
{
    return tc_field_container(own(field));
}

static void joined_destroy(tc_field *field)
{
    joined *p = (joined *)field;
    group *g = p->group;
    free(p);
    if (atomic_fetch_sub(&g->users, 1) > 1)
        return;
    for (int k = 0; k < g->charts; k++)
        tc_field_destroy(g->chart[k].field);
    free(g);
}

#define CLASS(its_range, its_changed)                                                                                  \
    {                                                                                                                  \
        .sample = TC_FIELD_HEIGHTS, .read = joined_read, .read_ready = joined_read_ready, .ready = joined_ready,       \
        .range = its_range, .know_errors = joined_know_errors, .overtaken = joined_overtaken, .changed = its_changed,  \
        .tell = joined_tell, .container = joined_container, .destroy = joined_destroy                                  \
    }
static const tc_field_class joined_class = CLASS(joined_range, NULL),
                            joined_changing_class = CLASS(joined_range, joined_changed),
                            settled_class = CLASS(settled_range, NULL);

/* Of all together. */
static tc_terrain_info info_of(const tc_chart *chart, int charts)
{
    tc_terrain_info all = *tc_field_info(chart[0].field);
    int64_t area = 0;
    all.void_count = 0;
    for (int k = 0; k < charts; k++) {
        const tc_terrain_info *info = tc_field_info(chart[k].field);
        const tc_level size = tc_field_level(chart[k].field, info->levels);
        bool first = all.void_count == area; /* all void so far, which has no extremes */
        if (info->void_count < size.width * size.height || first) {
            all.z_min = first ? info->z_min : fminf(all.z_min, info->z_min);
            all.z_max = first ? info->z_max : fmaxf(all.z_max, info->z_max);
        }
        area += size.width * size.height, all.void_count += info->void_count;
    }
    return all;
}

bool tc_charts_join(tc_chart *chart, int charts, const float *apart)
{
    group *g = malloc(sizeof *g + (size_t)charts * sizeof *g->chart);
    joined **field = calloc((size_t)charts, sizeof *field);
    bool enough = g && field;
    for (int k = 0; k < charts && enough; k++)
        enough = (field[k] = malloc(sizeof **field)) != NULL;
    if (enough) {
        g->charts = charts;
        g->users = charts;
        for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
            g->apart[l] = apart && l < tc_field_info(chart[0].field)->levels ? apart[l] : 0;
    }
    const tc_terrain_info all = info_of(chart, charts);
    for (int k = 0; k < charts && enough; k++) {
        g->chart[k] = chart[k];
        *field[k] = (joined){.head = *chart[k].field, .group = g, .face = k};
        field[k]->head.class = chart[k].field->class->changed ? &joined_changing_class
                               : !apart                       ? &settled_class
                                                              : &joined_class;
        field[k]->head.info = all;
        field[k]->head.beyond = TC_BEYOND;
        chart[k].field = &field[k]->head;
    }
    for (int k = 0; k < charts && field && !enough; k++)
        free(field[k]);
    free(field);
    if (!enough)
        free(g);
    return enough;
}

/* ---- While fields are made ----------------------------------------------------------------------------------------
 */

tc_status tc_joined_read(const tc_chart *chart, int charts, int face, int level, tc_rect rect, float *z, uint8_t *voids,
                         ptrdiff_t stride)
{
    question q = {.chart = chart, .charts = charts, .level = level, .how = WAITING};
    return read_all(&q, face, rect, (target){z, voids, stride});
}

tc_status tc_joined_settle(const tc_chart *chart, int charts, int level)
{
    question q = {.chart = chart, .charts = charts, .level = level, .how = WAITING};
    int64_t size = level_size(&q);
    tc_status status = TC_OK;
    for (int face = 1; face < charts && !status; face++) { /* each owner's number is lower, and its sample its own */
        target to = {.stride = size};
        tc_memory_field_level(chart[face].field, level, &to.z, &to.voids);
        status = settle_sides(&q, face, (tc_rect){0, 0, size, size}, to);
    }
    return status;
}

tc_status tc_joined_heights(const tc_chart *chart, int charts, int level, int64_t count, const double *longitude,
                            const double *latitude, float *z_ret, uint8_t *voids_ret)
{
    question q = {.chart = chart, .charts = charts, .level = level, .how = WAITING};
    tc_status status = TC_OK;
    for (int64_t at = 0; at < count && !status; at += AT_A_TIME) {
        place places[AT_A_TIME];
        int some = (int)tc_min64(AT_A_TIME, count - at);
        for (int n = 0; n < some; n++)
            places[n] = place_of(&q, longitude[at + n], latitude[at + n]);
        status = gather(&q, some, places, z_ret + at, voids_ret + at);
    }
    return status;
}

void tc_joined_owner(const tc_chart_class *class, int64_t cells, int *face, int64_t *i, int64_t *j)
{
    const spot at = owner(class, cells, (spot){*face, *i, *j});
    *face = at.face, *i = at.i, *j = at.j;
}

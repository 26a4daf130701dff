/* faces_error.c - surfaces over faces: what a tolerance on the screen makes of blocks (common/blocks/block_errors.h).
 *
 * Beside what samples say, a level is off by what its flat triangles cut off a globe. */
#include <math.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "faces_internal.h"

/* Bounds of a level's samples; what lies on the mesh of the data's finest level has no error but for being flat. */
static tc_range range_of(void *context, int chart, int level, tc_rect samples)
{
    const faces_view *v = context;
    const faces_surface *s = tc_faces_of(v);
    const tc_clipmap *clipmap = v->head.windows->clipmap[chart];
    const double cell = ldexp(1, s->lattice.levels - level);
    double n[3];
    tc_rect held = samples;
    const int own = s->cut ? level : tc_faces_window(s, level, &held);
    tc_range r = tc_field_range(tc_clipmap_field(clipmap), tc_clipmap_field_level(clipmap, 1) + own - 1, held);
    tc_faces_normal(s, chart, 0.5 * (double)(samples.x0 + samples.x1) * cell,
                    0.5 * (double)(samples.y0 + samples.y1) * cell, n);
    const double across = s->diagonal * s->cell * cell * (double)(samples.x1 - samples.x0);
    const double from_pole = hypot(n[0], n[1]) - 0.5 * across, edge = ldexp(v->edge, s->own + 1 - level);
    r.error = (own < level ? 0 : r.error) + (float)(v->radius * tc_faces_sag(v, edge, fmax(from_pole, 0)));
    return r;
}

static void distance_of(void *context, int chart, int level, double x, double y, double lo, double hi, double *across,
                        double *apart)
{
    const faces_view *v = context;
    const double cell = ldexp(1, tc_faces_of(v)->lattice.levels - level), z = fmin(fmax(v->z_eye, lo), hi);
    double d[3];
    tc_faces_roughly(v, chart, x * cell, y * cell, d);
    *across = sqrt(-2 * d[2] * (v->radius + v->z_eye) * (v->radius + z));
    *apart = fabs(v->z_eye - z);
}

void tc_faces_begin_errors(faces_view *v)
{
    const faces_surface *s = tc_faces_of(v);
    tc_block_ground ground = {.lattice = &s->lattice,
                              .data = s->lattice.levels + s->cut,
                              .range = range_of,
                              .distance = distance_of,
                              .context = v};
    for (int level = 1; level <= s->lattice.levels; level++)
        ground.diagonal[level - 1] = s->diagonal * s->cell *
                                     ldexp(s->lattice.side[level - 1], s->lattice.levels - level) *
                                     (v->radius + fmax(s->z_hi, 0));
    tc_block_errors_begin(v->error, &ground,
                          v->head.options.error * exp2(fmax(v->head.options.throttle, 0)) /
                              tc_camera_pixel_scale(&v->head.camera));
}

bool tc_faces_by_error(const faces_view *v)
{
    return v->error && v->error->tolerance > 0;
}

/* What lies on the mesh of the windows' finest level has to have passed over, by distance, before that begins to
 * (tc_faces_alpha()), or it would go on beyond it: so much of it has. Each level's range ends as much within the
 * coarser one's passage as a block of that is wide, where there is room for it: ranges go by halves, as blocks do. */
static double passed(const faces_view *v, int chart, int level, int32_t x, int32_t y)
{
    const faces_surface *s = tc_faces_of(v);
    const double block = ldexp(s->lattice.side[level - 1], s->lattice.levels - level),
                 wide = s->diagonal * s->cell * ldexp(s->lattice.side[s->own - 1], s->lattice.levels - s->own),
                 begins = FACES_PASSED * (1 - FACES_PASSAGE) * tc_faces_range(v, s->own),
                 range = ldexp(begins - wide, s->own + 1 - level);
    double d[3];
    if (range <= 0)
        return 1;
    tc_faces_roughly(v, chart, x * block, y * block, d);
    return fmin(fmax((s->kind->distance(d, v->height) / range - (1 - FACES_PASSAGE)) / FACES_PASSAGE, 0), 1);
}

/* alpha of a corner, whatever blocks touch it; in 2^-16: what a shader interpolates of it along an edge is exact. */
static double corner_alpha(const faces_view *v, int chart, int level, int32_t x, int32_t y)
{
    double alpha = tc_faces_by_error(v) ? tc_block_errors_alpha(v->error, chart, level, x, y) : 0;
    if (level > tc_faces_of(v)->own && alpha < 1) {
        tc_block_settle(&tc_faces_of(v)->lattice, level, &chart, &x, &y); /* the same number, however it is rounded */
        alpha = fmax(alpha, passed(v, chart, level, x, y));
    }
    return floor(alpha * 65536) / 65536;
}

bool tc_faces_want_by_error(const faces_view *v, tc_block b)
{
    for (int k = 0; k < 4; k++)
        if (corner_alpha(v, b.chart, b.level, b.x + (k & 1), b.y + (k >> 1)) < 1)
            return true;
    return false;
}

/* Where a leaf meets other meshes its vertices know (tc_leaf_alpha()): of the whole block that would be a leap, and
 * blocks that have an edge in common would not all be told. */
float tc_faces_corner(const faces_view *v, const tc_leaf *leaf, int k)
{
    const tc_block b = leaf->block;
    const int level = b.level - leaf->coarse;
    if (level == 1 || !v->error || (!tc_faces_by_error(v) && level <= tc_faces_of(v)->own))
        return 0;
    if (!leaf->coarse)
        return (float)corner_alpha(v, b.chart, b.level, b.x + (k & 1), b.y + (k >> 1));
    /* Of the block above, whose mesh it is drawn by: there, of a half, or a whole one. */
    const tc_block above = tc_block_leaf_above(&tc_faces_of(v)->lattice, leaf).block;
    const int parts = tc_block_parts(&tc_faces_of(v)->lattice, above.level);
    const double x = (double)(b.x + (k & 1)) / parts - above.x, y = (double)(b.y + (k >> 1)) / parts - above.y;
    double alpha = 0;
    for (int c = 0; c < 4; c++) {
        const double share = (c & 1 ? x : 1 - x) * (c & 2 ? y : 1 - y);
        alpha += share > 0 ? share * corner_alpha(v, b.chart, above.level, above.x + (c & 1), above.y + (c >> 1)) : 0;
    }
    return (float)alpha;
}

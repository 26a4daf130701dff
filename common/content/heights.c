/* heights.c - the pair (z, z_c) of a vertex: its level's height, and that of the coarser level's mesh, the target of
 * the morph.
 *
 * z_c is the height of the coarser level's MESH below a fine vertex (LH04 section 6.2): that of the coarse vertex where
 * there is one on the spot, copied bit for bit, else that of the middle of a coarse edge. Where the terrain ends
 * between two coarse samples the last cells are narrower than the others, so weights come from positions. */
#include "common/base/mesh.h"
#include "beyond.h"
#include "ground.h"
#include "torus.h"

enum { MARGIN = 8 };

static size_t scratch_bytes(int n)
{
    size_t side = (size_t)(n + MARGIN); /* heights, and a row of pairs */
    return (side * side + 2 * side) * sizeof(float);
}

/* ---- Morph targets ---------------------------------------------------------------------------------------------- */

/* Place of fine vertex i between its coarse neighbours a and b: 0 .. 1, exact. */
typedef struct between {
    int64_t a, b;
    float t;
} between;

static between coarse_neighbours(int64_t i, int shift, int64_t edge)
{
    if ((i & 1) == 0)
        return (between){i / 2, i / 2, 0};
    int64_t g = (int64_t)1 << shift;
    int64_t pa = tc_min64((i - 1) * g, edge), p = tc_min64(i * g, edge), pb = tc_min64((i + 1) * g, edge);
    return (between){(i - 1) / 2, (i + 1) / 2, pb > pa ? (float)(p - pa) / (float)(pb - pa) : 0.0f};
}

/* z_c of fine vertex (i, j), wherever it lies. */
static float morph_target(between u, between v, const float (*c0)[2], const float (*c1)[2], int64_t mask)
{
    int64_t a = u.a & mask, b = u.b & mask;
    if (u.t == 0 && v.t == 0)
        return c0[a][0];
    if (u.t == 0.5f && v.t == 0) /* the common cases, without the general one's rounding */
        return 0.5f * (c0[a][0] + c0[b][0]);
    if (u.t == 0 && v.t == 0.5f)
        return 0.5f * (c0[a][0] + c1[a][0]);
    if (u.t == 0.5f && v.t == 0.5f)
        return 0.5f * (c0[b][0] + c1[a][0]);
    return (float)tc_triangle_height(c0[a][0], c0[b][0], c1[a][0], c1[b][0], u.t, v.t);
}

/* `count` heights of a toroidal row from column x on, one after the other. */
static void unwrap(const float (*row)[2], int64_t x, int64_t mask, int64_t count, float *z)
{
    for (int64_t k = 0; k < count;) {
        int64_t at = (x + k) & mask, run = tc_min64(count - k, mask + 1 - at);
        for (int64_t i = 0; i < run; i++)
            z[k + i] = row[at + i][0];
        k += run;
    }
}

/* z_c of vertices x0, x0 + 1, ..., both x0 and count even, in cells that are all as wide; v is on a coarse sample or in
 * the middle between two. In loops without conditions, unlike morph_target(), whose values these are. */
static void even_targets(between v, const float (*c0)[2], const float (*c1)[2], int64_t mask, int64_t x0, int64_t count,
                         float (*row)[2])
{
    float z0[TC_CLIPMAP_MAX_N / 2 + 2], z1[TC_CLIPMAP_MAX_N / 2 + 2];
    unwrap(c0, x0 / 2, mask, count / 2 + 1, z0);
    if (v.t == 0) {
        for (int64_t k = 0; k < count / 2; k++)
            row[2 * k][1] = z0[k], row[2 * k + 1][1] = 0.5f * (z0[k] + z0[k + 1]);
    } else {
        unwrap(c1, x0 / 2, mask, count / 2 + 1, z1);
        for (int64_t k = 0; k < count / 2; k++)
            row[2 * k][1] = 0.5f * (z0[k] + z1[k]), row[2 * k + 1][1] = 0.5f * (z0[k + 1] + z1[k]);
    }
}

/* z_c of row j for columns x0 .. x1 - 1 into row[..][1]. */
static void morph_targets(const tc_clip_level *l, const float (*coarse)[2], int64_t mask, int64_t j, int64_t x0,
                          int64_t x1, float (*row)[2])
{
    between v = coarse_neighbours(j, l->shift, l->edge_y);
    const float(*c0)[2] = coarse + (v.a & mask) * (mask + 1);
    const float(*c1)[2] = coarse + (v.b & mask) * (mask + 1);
    int64_t first = x0 + (x0 & 1); /* to `even`, both even, cells are whole */
    int64_t even = tc_min64(x1, tc_floor_shift(l->edge_x, l->shift)) & ~(int64_t)1;
    if (even <= first || (v.t != 0 && v.t != 0.5f))
        first = even = x0; /* none */
    for (int64_t i = x0; i < first; i++)
        row[i - x0][1] = morph_target(coarse_neighbours(i, l->shift, l->edge_x), v, c0, c1, mask);
    if (even > first)
        even_targets(v, c0, c1, mask, first, even - first, row + (first - x0));
    for (int64_t i = even; i < x1; i++)
        row[i - x0][1] = morph_target(coarse_neighbours(i, l->shift, l->edge_x), v, c0, c1, mask);
}

/* ---- Filling ---------------------------------------------------------------------------------------------------- */

static tc_status fill(const tc_fill *f)
{
    const tc_clip_level *l = tc_clipmap_level(f->clipmap, f->level);
    int field_level = tc_clipmap_field_level(f->clipmap, f->level);
    const tc_field *field = tc_clipmap_field(f->clipmap);
    tc_level size = tc_field_level(field, field_level);
    double g = ldexp(1, l->shift);
    tc_beyond edge = {l->wraps, false, (float)((double)l->edge_x / g - (double)(size.width - 1)),
                      (float)((double)l->edge_y / g - (double)(size.height - 1))};
    size_t side = (size_t)(tc_clipmap_n(f->clipmap) + MARGIN);
    float *buffer = f->scratch;
    float(*row)[2] = (float(*)[2])(buffer + side * side);
    float *z;
    ptrdiff_t stride;
    tc_status status = tc_read_beyond(f, field_level, f->rect, edge, buffer, &z, &stride);
    if (status)
        return status;
    int64_t mask = f->size - 1, w = f->rect.x1 - f->rect.x0;
    for (int64_t j = f->rect.y0; j < f->rect.y1; j++) {
        const float *in = z + (j - f->rect.y0) * stride;
        for (int64_t i = 0; i < w; i++)
            row[i][0] = row[i][1] = in[i];
        if (f->coarse)
            morph_targets(l, f->coarse, mask, j, f->rect.x0, f->rect.x1, row);
        tc_torus_store((float(*)[2])f->texels + (j & mask) * f->size, f->rect.x0, mask, row, w, sizeof *row);
    }
    return TC_OK;
}

const tc_content_class tc_heights_content = {.name = "heights",
                                             .format = TC_TEXEL_RG32F,
                                             .scale = 1,
                                             .reach = 2,
                                             .reach_finer = -1,
                                             .scratch_bytes = scratch_bytes,
                                             .fill = fill};

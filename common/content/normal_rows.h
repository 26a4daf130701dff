/* normal_rows.h - rows of normals in texels of one type. Included by normals.c, once for each: TEXEL, of which ONE
 * stands for 1; SUM, which holds the sum of four; NAME(x), the name that x has for this type. */

#define ROW NAME(normal_row)

/* A normal's components with slopes times `by`. */
static void NAME(steepen)(SUM *nx, SUM *ny, float by)
{
    float x = (float)*nx / ONE, y = (float)*ny / ONE, z2 = 1 - x * x - y * y;
    float scale = ONE * by / sqrtf((z2 > 1e-4f ? z2 : 1e-4f) + by * by * (x * x + y * y));
    *nx = (SUM)lrintf(x * scale);
    *ny = (SUM)lrintf(y * scale);
}

/* A row of normals, texels in a line: components next to each other, so that loops over them need no conditions. */
typedef struct ROW {
    SUM xy[2][2 * (TC_CLIPMAP_MAX_N + 1)];
} ROW;

/* Sums of two toroidal rows of texels, from column x on. */
static void NAME(unwrap_sums)(const TEXEL (*r0)[4], const TEXEL (*r1)[4], int64_t x, int64_t mask, int64_t count,
                              ROW *sums)
{
    for (int64_t k = 0; k < count;) {
        int64_t at = (x + k) & mask, run = tc_min64(count - k, mask + 1 - at);
        for (int64_t i = 0; i < run; i++) {
            sums->xy[0][k + i] = (SUM)(r0[at + i][0] + r1[at + i][0]);
            sums->xy[1][k + i] = (SUM)(r0[at + i][1] + r1[at + i][1]);
        }
        k += run;
    }
}

static inline SUM NAME(quarter)(int sum)
{
    return (SUM)((sum + (sum < 0 ? -2 : 2)) / 4);
}

/* The coarser level's normals below row b from texel a on, a odd: its texels are twice as far apart; what the bilinear
 * filter would give there. */
static void NAME(coarse_normals)(const TEXEL (*coarse)[4], float by, int64_t mask, int64_t a, int64_t b, int64_t count,
                                 ROW *out)
{
    const TEXEL(*r0)[4] = coarse + (tc_floor_shift(b, 1) & mask) * (mask + 1);
    const TEXEL(*r1)[4] = coarse + (tc_floor_shift(b + 1, 1) & mask) * (mask + 1);
    ROW sums;
    NAME(unwrap_sums)(r0, r1, tc_floor_shift(a, 1), mask, count / 2 + 2, &sums);
    for (int k = 0; k < 2; k++) {
        const SUM *v = sums.xy[k];
        SUM *to = out->xy[k];
        for (int64_t i = 0; i < count / 2; i++)
            to[2 * i] = NAME(quarter)(v[i] + v[i + 1]), to[2 * i + 1] = NAME(quarter)(2 * v[i + 1]);
        if (count % 2)
            to[count - 1] = NAME(quarter)(v[count / 2] + v[count / 2 + 1]);
    }
    for (int64_t i = 0; i < count && by != 1; i++)
        NAME(steepen)(&out->xy[0][i], &out->xy[1][i], by);
}

/* A level's own normals, by central differences of the heights c, rows `stride` apart. */
static void NAME(own_normals)(const float *c, ptrdiff_t stride, float ix, float iy, int64_t count, ROW *out)
{
    for (int64_t i = 0; i < count; i++) {
        float dx = (c[i + 1] - c[i - 1]) * ix, dy = (c[i + stride] - c[i - stride]) * iy;
        float scale = -ONE / sqrtf(1 + dx * dx + dy * dy);
        out->xy[0][i] = (SUM)(int)(dx * scale + (dx < 0 ? 0.5f : -0.5f));
        out->xy[1][i] = (SUM)(int)(dy * scale + (dy < 0 ? 0.5f : -0.5f));
    }
}

/* The same where axes are sheared: by the difference across, along the diagonal of a cell, and that along what is
 * neither across nor along seams. */
static void NAME(sheared_normals)(const float *c, ptrdiff_t stride, float ix, float iy, const float *turn,
                                  int64_t count, ROW *out)
{
    for (int64_t i = 0; i < count; i++) {
        float across = (c[i - 1 + stride] - c[i + 1 - stride]) * 0.5f * (ix + iy), share = turn[i];
        float along = (1 - share) * (c[i + 1] - c[i - 1]) * ix + share * (c[i + stride] - c[i - stride]) * iy;
        float dx = along - share * across, dy = along + (1 - share) * across;
        float scale = -ONE / sqrtf(1 + dx * dx + dy * dy);
        out->xy[0][i] = (SUM)(int)(dx * scale + (dx < 0 ? 0.5f : -0.5f));
        out->xy[1][i] = (SUM)(int)(dy * scale + (dy < 0 ? 0.5f : -0.5f));
    }
}

static inline void NAME(make_normals)(const normal_source *from, int64_t count, TEXEL (*row)[4])
{
    ROW own, coarse;
    if (from->turn)
        NAME(sheared_normals)(from->z, from->stride, from->ix, from->iy, from->turn, count, &own);
    else
        NAME(own_normals)(from->z, from->stride, from->ix, from->iy, count, &own);
    const ROW *beside = &own;
    if (from->coarse) {
        beside = &coarse;
        NAME(coarse_normals)(from->coarse, from->steeper, from->mask, from->x, from->y, count, &coarse);
    }
    for (int64_t i = 0; i < count; i++) {
        row[i][0] = (TEXEL)own.xy[0][i], row[i][1] = (TEXEL)own.xy[1][i];
        row[i][2] = (TEXEL)beside->xy[0][i], row[i][3] = (TEXEL)beside->xy[1][i];
    }
}

#undef ROW
#undef TEXEL
#undef ONE
#undef SUM
#undef NAME

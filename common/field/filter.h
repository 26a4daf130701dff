/* filter.h - the pyramid's filters: D (fine to coarse) and U (coarse to fine), separable, in float.
 *
 * U is LH04's four-point interpolatory subdivision (-1, 9, 9, -1)/16; D is the low band of the lifting whose
 * prediction is U and whose update is (19/64, -3/64), as of packed terrains (lifting.h), which is the filter that makes
 * U(D(T)) the best L2 approximation of T to within a few thousandths of its rms (tests/bench/bench_filter.c measures
 * it). */
#ifndef TC_FILTER_H
#define TC_FILTER_H

#include "common/terraclip.h"

/* Samples of the next coarser level along an axis of `fine` samples. */
static inline int64_t tc_coarse_size(int64_t fine)
{
    return (fine + 1) / 2;
}

/* What U says of the sample between b and c, and the update's two weights. */
static inline float tc_predict(float a, float b, float c, float d)
{
    return 0.5625f * (b + c) - 0.0625f * (a + d);
}
#define TC_UPDATE_NEAR (19.f / 64)
#define TC_UPDATE_FAR (-3.f / 64)

/* Writes rows j0 <= j < j1 of D(fine): coarse[(j - j0) * tc_coarse_size(width) + i]. Rows are independent of how the
 * range is cut. wrap_x: column 0 follows the last one; only for even widths. scratch: tc_downsample_scratch floats. */
size_t tc_downsample_scratch(int64_t width, int64_t rows);
void tc_downsample(const float *fine, int64_t width, int64_t height, bool wrap_x, int64_t j0, int64_t j1, float *coarse,
                   float *scratch);

/* Upsamples along one axis: count + 3 coarse samples at c[-1 * stride] ... c[(count + 1) * stride] give the
 * 2 * count fine samples f[0], f[stride_f], ... the even ones being c[0], c[1], ... */
void tc_upsample_1d(const float *c, ptrdiff_t stride, int64_t count, float *f, ptrdiff_t stride_f);

/* Upsamples a block: cw x ch coarse samples with a border of one before and two after on both axes, c pointing at
 * the first inner one (row stride `stride`), give 2cw x 2ch fine samples (row stride 2cw). scratch: 2 * cw * (ch + 3)
 * floats. */
void tc_upsample(const float *c, ptrdiff_t stride, int64_t cw, int64_t ch, float *fine, float *scratch);

#endif

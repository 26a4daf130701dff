/* packed_metres.c - heights in metres from height units. */
#include "common/base/rect.h"
#include "common/base/simd.h"
#include "packed_internal.h"

#if TC_AVX2
#include <immintrin.h>
#endif

static inline __attribute__((always_inline)) void metres_any(double origin, double unit, const int32_t *restrict k,
                                                             int64_t count, float *restrict z)
{
    for (int64_t i = 0; i < count; i++)
        z[i] = (float)(origin + unit * k[i]);
}

static void metres(double origin, double unit, const int32_t *k, int64_t count, float *z)
{
    metres_any(origin, unit, k, count, z);
}

#if TC_AVX2
TC_TARGET_AVX2 static __attribute__((noinline)) void metres_avx2(double origin, double unit, const int32_t *k,
                                                                 int64_t count, float *z)
{
    metres_any(origin, unit, k, count, z);
}

TC_TARGET_AVX2 static inline __m128 metres_4_avx2(__m256d origin, __m256d unit, const int32_t *k)
{
    __m256d v = _mm256_cvtepi32_pd(_mm_loadu_si128((const __m128i *)k));
    return _mm256_cvtpd_ps(_mm256_add_pd(origin, _mm256_mul_pd(unit, v)));
}

/* Past the caches: memory that is written as a whole need not be read before. */
TC_TARGET_AVX2 static __attribute__((noinline)) void metres_far_avx2(double origin, double unit, const int32_t *k,
                                                                     int64_t count, float *z)
{
    const __m256d o = _mm256_set1_pd(origin), u = _mm256_set1_pd(unit);
    int64_t i = tc_min64((int64_t)(-(uintptr_t)z / sizeof *z % 16), count);
    metres_any(origin, unit, k, i, z);
    for (; i + 16 <= count; i += 16) /* a line of the cache */
        for (int64_t n = i; n < i + 16; n += 8)
            _mm256_stream_ps(z + n, _mm256_set_m128(metres_4_avx2(o, u, k + n + 4), metres_4_avx2(o, u, k + n)));
    metres_any(origin, unit, k + i, count - i, z + i);
    _mm_sfence();
}
#endif

void tc_packed_metres(const packed_field *p, const tc_plane *units, const packed_target *to)
{
    const tc_container *c = &p->file.container;
    tc_rect r = units->rect;
    void (*make)(double, double, const int32_t *, int64_t, float *) = metres;
#if TC_AVX2
    if (tc_have_avx2())
        make = tc_rect_area(to->rect) >= LARGE ? metres_far_avx2 : metres_avx2;
#endif
    for (int64_t y = r.y0; y < r.y1; y++)
        make(c->z_origin, c->z_unit, tc_plane_at(units, r.x0, y), r.x1 - r.x0,
             to->z + (y - to->rect.y0) * to->stride + (r.x0 - to->rect.x0));
}

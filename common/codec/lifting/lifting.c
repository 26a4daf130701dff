/* lifting.c - four-point lifting with update in wrapping integers, separable: rows first, then columns.
 *
 * Deslauriers, Dubuc 1989 (four-point interpolation); Sweldens 1996 and Calderbank, Daubechies, Sweldens, Yeo 1998
 * (lifting that maps integers to integers). One axis splits x into evens e and odds:
 *     d[i] = x[2i+1] - (9 (e[i] + e[i+1]) - (e[i-1] + e[i+2]) + 8) / 16
 *     s[i] = e[i] + (19 (d[i-1] + d[i]) - 3 (d[i-2] + d[i+1]) + 32) / 64
 * with divisions that round down. The update's 19/64 and -3/64 stand for 0.30 and -0.05 (filter.c): the small
 * denominator keeps products of large details within 32 bits. Borders as in filter.c: evens go on in a straight line
 * (taken from evens that the inverse has restored by then), details beyond are zero. Where the level wraps, both go
 * on from the other side. */
#include "lifting.h"

#include <math.h>
#include <string.h>

#include "common/base/rect.h"

#if defined __x86_64__ && defined __GNUC__
#include <immintrin.h>
#endif

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* Sums that wrap. */
ALWAYS_INLINE uint32_t u(int32_t a)
{
    return (uint32_t)a;
}

ALWAYS_INLINE int32_t predict(int32_t a, int32_t b, int32_t c, int32_t d)
{
    uint32_t near = u(b) + u(c);
    return (int32_t)(8 * near + (near - (u(a) + u(d))) + 8) >> 4;
}

ALWAYS_INLINE int32_t update(int32_t a, int32_t b, int32_t c, int32_t d)
{
    uint32_t near = u(b) + u(c), more = near - (u(a) + u(d)); /* 19 near - 3 far */
    return (int32_t)(16 * near + (2 * more + more) + 32) >> 6;
}

ALWAYS_INLINE int32_t plus(int32_t a, int32_t b)
{
    return (int32_t)(u(a) + u(b));
}

ALWAYS_INLINE int32_t minus(int32_t a, int32_t b)
{
    return (int32_t)(u(a) - u(b));
}

/* edge + steps * (edge - inner): the straight line beyond a border. */
ALWAYS_INLINE int32_t beyond(int32_t edge, int32_t inner, int steps)
{
    return (int32_t)(u(edge) + (uint32_t)steps * (u(edge) - u(inner)));
}

tc_rect tc_lifting_support(const tc_lifting_level *level, int64_t j0, int64_t j1)
{
    return (tc_rect){0, tc_max64(0, 2 * (j0 - TC_LIFTING_REACH)), level->width,
                     tc_min64(level->height, 2 * (j1 + TC_LIFTING_REACH))};
}

tc_rect tc_lifting_needs(const tc_lifting_level *level, tc_rect rect)
{
    if (tc_rect_empty(rect))
        return (tc_rect){0, 0, 0, 0};
    int64_t cw = tc_coarse_size(level->width), ch = tc_coarse_size(level->height);
    tc_rect r = {tc_floor_shift(rect.x0, 1) - TC_LIFTING_REACH, tc_floor_shift(rect.y0, 1) - TC_LIFTING_REACH,
                 tc_ceil_shift(rect.x1, 1) + TC_LIFTING_REACH, tc_ceil_shift(rect.y1, 1) + TC_LIFTING_REACH};
    if (!level->wrap_x)
        r.x0 = tc_max64(r.x0, 0), r.x1 = tc_min64(r.x1, cw);
    r.y0 = tc_max64(r.y0, 0), r.y1 = tc_min64(r.y1, ch);
    return r;
}

/* ---- Analysis ------------------------------------------------------------------------------------------------ */

/* One row into cw low and cw high samples. e and d: room for cw + 3 samples behind two in front. */
static void analyse_row(const int32_t *restrict x, const tc_lifting_level *level, int32_t *restrict e,
                        int32_t *restrict d, int32_t *restrict low, int32_t *restrict high)
{
    int64_t cw = tc_coarse_size(level->width), odds = level->width / 2;
    for (int64_t i = 0; i < cw; i++)
        e[i] = x[2 * i];
    if (level->wrap_x) {
        e[-1] = e[cw - 1], e[cw] = e[0], e[cw + 1] = e[1 % cw];
    } else {
        int64_t inner = cw > 1;
        e[-1] = beyond(e[0], e[inner], 1);
        e[cw] = beyond(e[cw - 1], e[cw - 1 - inner], 1), e[cw + 1] = beyond(e[cw - 1], e[cw - 1 - inner], 2);
    }
    for (int64_t i = 0; i < odds; i++)
        d[i] = minus(x[2 * i + 1], predict(e[i - 1], e[i], e[i + 1], e[i + 2]));
    for (int64_t i = odds; i < cw + 1; i++)
        d[i] = 0;
    d[-2] = d[-1] = 0;
    if (level->wrap_x)
        d[-1] = d[cw - 1], d[-2] = cw > 1 ? d[cw - 2] : d[cw - 1], d[cw] = d[0];
    for (int64_t i = 0; i < cw; i++)
        low[i] = plus(e[i], update(d[i - 2], d[i - 1], d[i], d[i + 1]));
    memcpy(high, d, (size_t)cw * sizeof *high);
}

/* Rows `first` ... of horizontally transformed samples, and the rows beyond a border. */
typedef struct row_band {
    const int32_t *rows;
    int64_t first, cw, evens;
    int32_t *line[3]; /* evens -1, evens, evens + 1 */
} row_band;

static const int32_t *even_row(const row_band *b, int64_t i)
{
    if (i < 0)
        return b->line[0];
    if (i >= b->evens)
        return b->line[1 + (i - b->evens)];
    return b->rows + (2 * i - b->first) * b->cw;
}

static void extend_rows(const row_band *b, int64_t j0, int64_t j1)
{
    int64_t inner = b->evens > 1;
    if (j0 <= TC_LIFTING_REACH) {
        const int32_t *r0 = even_row(b, 0), *r1 = even_row(b, inner);
        for (int64_t i = 0; i < b->cw; i++)
            b->line[0][i] = beyond(r0[i], r1[i], 1);
    }
    if (j1 + TC_LIFTING_REACH >= b->evens) {
        const int32_t *r0 = even_row(b, b->evens - 1), *r1 = even_row(b, b->evens - 1 - inner);
        for (int64_t i = 0; i < b->cw; i++) {
            b->line[1][i] = beyond(r0[i], r1[i], 1);
            b->line[2][i] = beyond(r0[i], r1[i], 2);
        }
    }
}

/* Columns: rows j0 .. j1 - 1 of low and high. detail: j1 - j0 + 3 rows. */
static void analyse_columns(const row_band *b, int64_t odds, int64_t j0, int64_t j1, int32_t *detail,
                            const tc_plane *low, const tc_plane *high)
{
    int64_t cw = b->cw;
    extend_rows(b, j0, j1);
    for (int64_t k = j0 - 2; k < j1 + 1; k++) {
        int32_t *restrict d = detail + (k - (j0 - 2)) * cw;
        if (k < 0 || k >= odds) {
            memset(d, 0, (size_t)cw * sizeof *d);
            continue;
        }
        const int32_t *restrict x = b->rows + (2 * k + 1 - b->first) * cw;
        const int32_t *p = even_row(b, k - 1), *q = even_row(b, k), *r = even_row(b, k + 1), *s = even_row(b, k + 2);
        for (int64_t i = 0; i < cw; i++)
            d[i] = minus(x[i], predict(p[i], q[i], r[i], s[i]));
    }
    for (int64_t j = j0; j < j1; j++) {
        const int32_t *restrict d = detail + (j - j0) * cw; /* of row j - 2 */
        const int32_t *restrict e = even_row(b, j);
        int32_t *restrict out = tc_plane_at(low, 0, j);
        for (int64_t i = 0; i < cw; i++)
            out[i] = plus(e[i], update(d[i], d[cw + i], d[2 * cw + i], d[3 * cw + i]));
        memcpy(tc_plane_at(high, 0, j), d + 2 * cw, (size_t)cw * sizeof *d);
    }
}

static int64_t most_support(int64_t rows)
{
    return 2 * (rows + 2 * TC_LIFTING_REACH);
}

size_t tc_lifting_analyse_scratch(const tc_lifting_level *level, int64_t rows)
{
    int64_t cw = tc_coarse_size(level->width);
    return (size_t)(cw * (2 * most_support(rows) + rows + 3 + 3) + 2 * (cw + 8));
}

void tc_lifting_analyse(const tc_lifting_level *level, const tc_plane *fine, int64_t j0, int64_t j1, const tc_plane *ll,
                        const tc_plane bands[TC_BANDS], int32_t *scratch)
{
    int64_t cw = tc_coarse_size(level->width), evens = tc_coarse_size(level->height), odds = level->height / 2;
    tc_rect support = tc_lifting_support(level, j0, j1);
    int32_t *e = scratch + 2, *d = e + cw + 8;
    int32_t *low = scratch + 2 * (cw + 8), *high = low + cw * most_support(j1 - j0);
    int32_t *line = high + cw * most_support(j1 - j0), *detail = line + 3 * cw;
    for (int64_t y = support.y0; y < support.y1; y++)
        analyse_row(tc_plane_at(fine, 0, y), level, e, d, low + (y - support.y0) * cw, high + (y - support.y0) * cw);
    row_band b = {low, support.y0, cw, evens, {line, line + cw, line + 2 * cw}};
    analyse_columns(&b, odds, j0, j1, detail, ll, &bands[TC_LH]);
    b.rows = high;
    analyse_columns(&b, odds, j0, j1, detail, &bands[TC_HL], &bands[TC_HH]);
}

/* ---- Synthesis ----------------------------------------------------------------------------------------------- */

/* Columns of the evens of either half: of rows j - 1 .. j + 2 those last made, row j in even[j & 3]. Rows of details
 * that are nothing but zeros, as those of HH where tiles are empty, change no even: where they are, the low rows stand
 * in for evens. */
typedef struct even_rows {
    const tc_plane *low, *high;
    int64_t x0, count, evens, odds;
    const int32_t *zero;
    const int32_t *even[4];
    int32_t *memory[4];
    int64_t known[4]; /* [j & 3]: row of details, whose pointer is detail[j & 3] */
    const int32_t *detail[4];
} even_rows;

/* Whether a row is known to be zeros; of short ones it takes longer to find out than it saves. */
ALWAYS_INLINE bool is_zero(const int32_t *row, int64_t count)
{
    enum { SOME = 64 };
    int32_t any = count < SOME;
    for (int64_t i = 0; i < count && !any; i += SOME) {
        const int32_t *from = row + tc_min64(i, count - SOME);
        for (int k = 0; k < SOME; k++)
            any |= from[k];
    }
    return !any;
}

/* Details of row j, r->zero where they are zeros. */
ALWAYS_INLINE const int32_t *detail_row(even_rows *r, int64_t j)
{
    if (j < 0 || j >= r->odds)
        return r->zero;
    if (r->known[j & 3] != j) {
        const int32_t *d = tc_plane_at(r->high, r->x0, j);
        r->known[j & 3] = j, r->detail[j & 3] = is_zero(d, r->count) ? r->zero : d;
    }
    return r->detail[j & 3];
}

/* Evens of row j, which lies within the level. */
ALWAYS_INLINE void restore_inner(even_rows *r, int64_t j)
{
    const int32_t *d[4];
    bool none = true;
    for (int k = 0; k < 4; k++)
        none &= (d[k] = detail_row(r, j - 2 + k)) == r->zero;
    const int32_t *restrict s = tc_plane_at(r->low, r->x0, j);
    int32_t *restrict e = r->memory[j & 3];
    r->even[j & 3] = none ? s : e;
    if (none)
        return;
    for (int64_t i = 0; i < r->count; i++)
        e[i] = minus(s[i], update(d[0][i], d[1][i], d[2][i], d[3][i]));
}

/* Evens of row j; beyond a border from the two rows on its inner side, which must be there. */
ALWAYS_INLINE void restore_even(even_rows *r, int64_t j)
{
    if (j >= 0 && j < r->evens) {
        restore_inner(r, j);
        return;
    }
    int64_t edge = j < 0 ? 0 : r->evens - 1, inner = j < 0 ? r->evens > 1 : edge - (r->evens > 1);
    int steps = (int)(j < 0 ? -j : j - edge);
    const int32_t *r0 = r->even[edge & 3], *r1 = r->even[inner & 3];
    int32_t *e = r->memory[j & 3];
    r->even[j & 3] = e;
    for (int64_t i = 0; i < r->count; i++)
        e[i] = beyond(r0[i], r1[i], steps);
}

/* Rows j0 - 1 .. j0 + 1. */
ALWAYS_INLINE void restore_first(even_rows *r, int64_t j0)
{
    if (j0 > 0)
        restore_even(r, j0 - 1);
    restore_even(r, j0);
    restore_even(r, j0 + 1);
    if (j0 == 0)
        restore_even(r, -1);
}

/* Row 2 j + odd of the columns: an even itself, or its prediction plus the detail. */
ALWAYS_INLINE const int32_t *restore_row(even_rows *r, int64_t j, int odd, int32_t *restrict row)
{
    if (!odd)
        return r->even[j & 3];
    const int32_t *a = r->even[(j - 1) & 3], *b = r->even[j & 3], *c = r->even[(j + 1) & 3], *e = r->even[(j + 2) & 3];
    const int32_t *restrict d = detail_row(r, j);
    for (int64_t i = 0; i < r->count; i++)
        row[i] = plus(d[i], predict(a[i], b[i], c[i], e[i]));
    return row;
}

#if defined __x86_64__ && defined __GNUC__
/* Pairs of an even and the odd behind it: out[2 k], out[2 k + 1] of e[k + 1] and d[k]. Eight at a time, and returns how
 * many are done. */
__attribute__((target("avx2"))) static inline int64_t interleave_avx2(const int32_t *e, const int32_t *d, int64_t count,
                                                                      int32_t *out)
{
    int64_t k = 0;
    for (; k + 8 <= count; k += 8) {
        __m256i e0 = _mm256_loadu_si256((const __m256i *)(e + k)),
                e1 = _mm256_loadu_si256((const __m256i *)(e + k + 1));
        __m256i e2 = _mm256_loadu_si256((const __m256i *)(e + k + 2)),
                e3 = _mm256_loadu_si256((const __m256i *)(e + k + 3));
        __m256i near = _mm256_add_epi32(e1, e2), far = _mm256_add_epi32(e0, e3);
        __m256i sum = _mm256_add_epi32(_mm256_slli_epi32(near, 3), _mm256_sub_epi32(near, far));
        sum = _mm256_srai_epi32(_mm256_add_epi32(sum, _mm256_set1_epi32(8)), 4);
        __m256i odd = _mm256_add_epi32(sum, _mm256_loadu_si256((const __m256i *)(d + k)));
        __m256i low = _mm256_unpacklo_epi32(e1, odd), high = _mm256_unpackhi_epi32(e1, odd);
        _mm256_storeu_si256((__m256i *)(out + 2 * k), _mm256_permute2x128_si256(low, high, 0x20));
        _mm256_storeu_si256((__m256i *)(out + 2 * k + 8), _mm256_permute2x128_si256(low, high, 0x31));
    }
    return k;
}
#endif

/* Fine samples 2 i0 .. 2 i1 - 1 of a row from low and high samples, low[0] and high[0] being those of column x0. simd:
 * a constant, whether there is AVX2. */
ALWAYS_INLINE void restore_samples(const int32_t *restrict low, const int32_t *restrict high, int64_t x0, int64_t x1,
                                   int64_t i0, int64_t i1, const tc_lifting_level *level, int32_t *restrict e,
                                   int32_t *restrict padded, int32_t *restrict out, bool simd)
{
    int64_t evens = level->wrap_x ? INT64_MAX : tc_coarse_size(level->width);
    int64_t odds = level->wrap_x ? INT64_MAX : level->width / 2, start = level->wrap_x ? INT64_MIN : 0;
    /* d[k] is the detail of column i0 - 3 + k, e[k] the even of column i0 - 1 + k. */
    int64_t need = i1 + TC_LIFTING_REACH - (i0 - TC_LIFTING_REACH);
    int64_t d0 = tc_max64(i0 - TC_LIFTING_REACH, x0), d1 = tc_min64(tc_min64(i1 + TC_LIFTING_REACH, x1), odds);
    int64_t before = d0 - (i0 - TC_LIFTING_REACH), have = tc_max64(d1 - d0, 0);
    const int32_t *d = high + (d0 - x0);
    if (have < need) {
        for (int64_t k = 0; k < before; k++)
            padded[k] = 0;
        memcpy(padded + before, d, (size_t)have * sizeof *d);
        for (int64_t k = before + have; k < need; k++)
            padded[k] = 0;
        d = padded;
    }
    int64_t first = tc_max64(i0 - 1, start), last = tc_min64(i1 + 2, evens);
    const int32_t *s = low + (i0 - 1 - x0);
    for (int64_t k = first - (i0 - 1); k < last - (i0 - 1); k++)
        e[k] = minus(s[k], update(d[k], d[k + 1], d[k + 2], d[k + 3]));
    for (int64_t i = i0 - 1; i < i1 + 2; i++) {
        if (i == first && last > i)
            i = last;
        if (i >= i1 + 2)
            break;
        int64_t edge = i < 0 ? 0 : evens - 1, inner = i < 0 ? evens > 1 : evens - 1 - (evens > 1);
        e[i - (i0 - 1)] = beyond(e[edge - (i0 - 1)], e[inner - (i0 - 1)], (int)(i < 0 ? -i : i - edge));
    }
    int64_t k = 0;
#if defined __x86_64__ && defined __GNUC__
    if (simd)
        k = interleave_avx2(e, d + TC_LIFTING_REACH, i1 - i0, out);
#endif
    (void)simd;
    for (; k < i1 - i0; k++) {
        out[2 * k] = e[k + 1];
        out[2 * k + 1] = plus(d[k + TC_LIFTING_REACH], predict(e[k], e[k + 1], e[k + 2], e[k + 3]));
    }
}

size_t tc_lifting_synthesise_scratch(const tc_lifting_level *level, tc_rect rect)
{
    (void)level;
    size_t columns = (size_t)((rect.x1 - rect.x0) / 2 + 2 + 2 * TC_LIFTING_REACH);
    return 15 * columns + 32;
}

ALWAYS_INLINE void synthesise(const tc_lifting_level *level, const tc_plane *ll, const tc_plane bands[TC_BANDS],
                              const tc_plane *fine, int32_t *scratch, bool simd)
{
    tc_rect r = fine->rect;
    if (tc_rect_empty(r))
        return;
    tc_rect need = tc_lifting_needs(level, r);
    int64_t count = need.x1 - need.x0, evens = tc_coarse_size(level->height), odds = level->height / 2;
    int64_t i0 = tc_floor_shift(r.x0, 1), i1 = tc_ceil_shift(r.x1, 1), j0 = tc_floor_shift(r.y0, 1);
    int64_t columns = (r.x1 - r.x0) / 2 + 2 + 2 * TC_LIFTING_REACH;
    int32_t *zero = scratch, *row_low = zero + columns, *row_high = row_low + columns, *e = row_high + columns + 4;
    int32_t *d = e + columns + 4, *out = d + columns + 4, *ring = out + 2 * columns;
    memset(zero, 0, (size_t)count * sizeof *zero);
    even_rows of_low = {
        .low = ll, .high = &bands[TC_LH], .x0 = need.x0, .count = count, .evens = evens, .odds = odds, .zero = zero};
    even_rows of_high = of_low;
    of_high.low = &bands[TC_HL], of_high.high = &bands[TC_HH];
    for (int k = 0; k < 4; k++, ring += 2 * columns) {
        of_low.memory[k] = ring, of_high.memory[k] = ring + columns;
        of_low.known[k] = of_high.known[k] = -1;
    }
    restore_first(&of_low, j0);
    restore_first(&of_high, j0);
    for (int64_t y = r.y0; y < r.y1; y++) {
        int64_t j = y >> 1;
        int odd = (int)(y & 1);
        if (odd) {
            restore_even(&of_low, j + 2);
            restore_even(&of_high, j + 2);
        }
        const int32_t *low = restore_row(&of_low, j, odd, row_low), *high = restore_row(&of_high, j, odd, row_high);
        int32_t *z = tc_plane_at(fine, r.x0, y);
        if (r.x0 % 2 == 0 && r.x1 % 2 == 0) {
            restore_samples(low, high, need.x0, need.x1, i0, i1, level, e, d, z, simd);
        } else {
            restore_samples(low, high, need.x0, need.x1, i0, i1, level, e, d, out, simd);
            memcpy(z, out + (r.x0 - 2 * i0), (size_t)(r.x1 - r.x0) * sizeof *z);
        }
    }
}

/* The same code for processors with AVX2 and without. */
#if defined __x86_64__ && defined __GNUC__
__attribute__((target("avx2"), noinline)) static void synthesise_avx2(const tc_lifting_level *level, const tc_plane *ll,
                                                                      const tc_plane bands[TC_BANDS],
                                                                      const tc_plane *fine, int32_t *scratch)
{
    synthesise(level, ll, bands, fine, scratch, true);
}
#endif

void tc_lifting_synthesise(const tc_lifting_level *level, const tc_plane *ll, const tc_plane bands[TC_BANDS],
                           const tc_plane *fine, int32_t *scratch, tc_simd simd)
{
#if defined __x86_64__ && defined __GNUC__
    if (simd == TC_SIMD_AUTO && __builtin_cpu_supports("avx2")) {
        synthesise_avx2(level, ll, bands, fine, scratch);
        return;
    }
#endif
    (void)simd;
    synthesise(level, ll, bands, fine, scratch, false);
}

double tc_lifting_norm(int band, int depth)
{
    /* tests/fast/test_lifting.c measures and checks them; from depth 3 on a norm doubles with every level. */
    static const double norm[TC_BANDS][4] = {{1.032928, 1.720981, 3.368024, 6.724590},
                                             {1.032928, 1.720981, 3.368024, 6.724590},
                                             {0.650326, 0.922735, 1.770065, 3.528518}};
    return depth < 4 ? norm[band][depth] : ldexp(norm[band][3], depth - 3);
}

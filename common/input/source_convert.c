/* source_convert.c - stored samples to heights and voids.
 *
 * One tight loop a sample type, which the compiler vectorises; a row of samples stays in the cache between the passes.
 * Voids are: nodata values, masked samples, and of floating-point samples NaN, the infinities and fill values. */
#include "source_internal.h"

#include <math.h>
#include <string.h>

size_t tc_sample_size(tc_sample_type type)
{
    static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

/* Stored 1:1, the common case, takes no detour over double. */
#define DEFINE_CONVERT(TYPE, NAME)                                                                                     \
    static void convert_##NAME(const tc_conversion *c, const TYPE *restrict s, int64_t n, float *restrict z)           \
    {                                                                                                                  \
        if (c->scale == 1 && c->offset == 0)                                                                           \
            for (int64_t i = 0; i < n; i++)                                                                            \
                z[i] = (float)s[i];                                                                                    \
        else                                                                                                           \
            for (int64_t i = 0; i < n; i++)                                                                            \
                z[i] = (float)((double)s[i] * c->scale + c->offset);                                                   \
    }                                                                                                                  \
    static void match_##NAME(const TYPE *restrict s, int64_t n, double nodata, uint8_t *restrict voids)                \
    {                                                                                                                  \
        TYPE value = (TYPE)nodata;                                                                                     \
        for (int64_t i = 0; i < n; i++)                                                                                \
            voids[i] |= s[i] == value;                                                                                 \
    }

DEFINE_CONVERT(uint8_t, uint8)
DEFINE_CONVERT(int8_t, int8)
DEFINE_CONVERT(uint16_t, uint16)
DEFINE_CONVERT(int16_t, int16)
DEFINE_CONVERT(uint32_t, uint32)
DEFINE_CONVERT(int32_t, int32)
DEFINE_CONVERT(float, float32)
DEFINE_CONVERT(double, float64)

/* Whether a sample of this type can have the value at all. A nodata tag is text: that of float32 data may be its value
 * written with too many or too few digits, so it is rounded to float. */
static bool representable(tc_sample_type type, double value)
{
    static const double limits[][2] = {{0, 255},        {-128, 127},      {0, 65535},
                                       {-32768, 32767}, {0, 4294967295.}, {-2147483648., 2147483647.}};
    if (!isfinite(value))
        return false; /* NaN and infinities are void anyway */
    if (type == TC_SAMPLE_FLOAT64)
        return true;
    if (type == TC_SAMPLE_FLOAT32)
        return fabs(value) < 0x1.ffffffp127; /* rounds to a finite float */
    return value >= limits[type][0] && value <= limits[type][1] && value == floor(value);
}

static void match(const tc_conversion *c, const void *s, int64_t n, double nodata, uint8_t *voids)
{
    if (!representable(c->type, nodata))
        return;
    switch (c->type) {
    case TC_SAMPLE_UINT8: match_uint8(s, n, nodata, voids); break;
    case TC_SAMPLE_INT8: match_int8(s, n, nodata, voids); break;
    case TC_SAMPLE_UINT16: match_uint16(s, n, nodata, voids); break;
    case TC_SAMPLE_INT16: match_int16(s, n, nodata, voids); break;
    case TC_SAMPLE_UINT32: match_uint32(s, n, nodata, voids); break;
    case TC_SAMPLE_INT32: match_int32(s, n, nodata, voids); break;
    case TC_SAMPLE_FLOAT32: match_float32(s, n, nodata, voids); break;
    case TC_SAMPLE_FLOAT64: match_float64(s, n, nodata, voids); break;
    }
}

static double stored(tc_sample_type type, const void *s, int64_t i)
{
    switch (type) {
    case TC_SAMPLE_UINT8: return ((const uint8_t *)s)[i];
    case TC_SAMPLE_INT8: return ((const int8_t *)s)[i];
    case TC_SAMPLE_UINT16: return ((const uint16_t *)s)[i];
    case TC_SAMPLE_INT16: return ((const int16_t *)s)[i];
    case TC_SAMPLE_UINT32: return ((const uint32_t *)s)[i];
    case TC_SAMPLE_INT32: return ((const int32_t *)s)[i];
    case TC_SAMPLE_FLOAT32: return ((const float *)s)[i];
    case TC_SAMPLE_FLOAT64: return ((const double *)s)[i];
    }
    return NAN;
}

/* Marks what is no finite height: !(|v| <= limit) catches NaN as well. */
static void match_wild(const tc_conversion *c, const void *s, int64_t n, uint8_t *voids)
{
    if (c->type == TC_SAMPLE_FLOAT32) {
        const float *v = s;
        for (int64_t i = 0; i < n; i++)
            voids[i] |= !(fabsf(v[i]) <= (float)TC_FILL_VALUE);
    } else if (c->type == TC_SAMPLE_FLOAT64) {
        const double *v = s;
        for (int64_t i = 0; i < n; i++)
            voids[i] |= !(fabs(v[i]) <= TC_FILL_VALUE);
    }
}

static int64_t count_voids(const uint8_t *voids, int64_t n)
{
    int64_t count = 0;
    for (int64_t i = 0; i < n; i++)
        count += voids[i];
    return count;
}

/* Extremes of a row, in lanes, since the compiler may not reorder a float reduction by itself. */
static void extremes(const float *z, int64_t n, float *low, float *high)
{
    enum { LANES = 8 };
    float lo[LANES], hi[LANES];
    for (int k = 0; k < LANES; k++) {
        lo[k] = *low;
        hi[k] = *high;
    }
    int64_t i = 0;
    for (; i + LANES <= n; i += LANES) {
        for (int k = 0; k < LANES; k++) {
            lo[k] = z[i + k] < lo[k] ? z[i + k] : lo[k];
            hi[k] = z[i + k] > hi[k] ? z[i + k] : hi[k];
        }
    }
    for (; i < n; i++) {
        lo[0] = fminf(lo[0], z[i]);
        hi[0] = fmaxf(hi[0], z[i]);
    }
    for (int k = 0; k < LANES; k++) {
        *low = fminf(*low, lo[k]);
        *high = fmaxf(*high, hi[k]);
    }
}

void tc_convert_row(const tc_conversion *c, const void *samples, const uint8_t *mask, int64_t width, float *z,
                    uint8_t *voids, tc_statistics *statistics)
{
    if (width < 1)
        return;
    switch (c->type) {
    case TC_SAMPLE_UINT8: convert_uint8(c, samples, width, z); break;
    case TC_SAMPLE_INT8: convert_int8(c, samples, width, z); break;
    case TC_SAMPLE_UINT16: convert_uint16(c, samples, width, z); break;
    case TC_SAMPLE_INT16: convert_int16(c, samples, width, z); break;
    case TC_SAMPLE_UINT32: convert_uint32(c, samples, width, z); break;
    case TC_SAMPLE_INT32: convert_int32(c, samples, width, z); break;
    case TC_SAMPLE_FLOAT32: convert_float32(c, samples, width, z); break;
    case TC_SAMPLE_FLOAT64: convert_float64(c, samples, width, z); break;
    }

    memset(voids, 0, (size_t)width);
    if (mask)
        for (int64_t i = 0; i < width; i++)
            voids[i] = mask[i] == 0;
    for (int k = 0; k < c->nodata_count; k++)
        match(c, samples, width, c->nodata[k], voids);
    if (c->type == TC_SAMPLE_FLOAT32 || c->type == TC_SAMPLE_FLOAT64) {
        int64_t announced = count_voids(voids, width);
        match_wild(c, samples, width, voids);
        if (count_voids(voids, width) > announced) {
            /* Rare: which of them are fill values, to be warned of? Those that only match_wild saw. */
            for (int64_t i = 0; i < width; i++) {
                double v = stored(c->type, samples, i);
                bool known = mask && mask[i] == 0;
                for (int k = 0; k < c->nodata_count; k++)
                    known |= c->type == TC_SAMPLE_FLOAT32 ? (float)v == (float)c->nodata[k] : v == c->nodata[k];
                statistics->fills += isfinite(v) && fabs(v) > TC_FILL_VALUE && !known;
            }
        }
    }

    int64_t count = count_voids(voids, width);
    statistics->voids += count;
    if (count == 0) {
        extremes(z, width, &statistics->low, &statistics->high);
        return;
    }
    for (int64_t i = 0; i < width; i++) {
        if (voids[i]) {
            z[i] = 0;
        } else {
            statistics->low = z[i] < statistics->low ? z[i] : statistics->low;
            statistics->high = z[i] > statistics->high ? z[i] : statistics->high;
        }
    }
}

int64_t tc_find_inexact(const tc_conversion *c, const void *samples, const uint8_t *voids, int64_t width,
                        const float *z)
{
    bool narrow = c->type <= TC_SAMPLE_INT16 || c->type == TC_SAMPLE_FLOAT32;
    if (narrow && c->scale == 1 && c->offset == 0)
        return -1;
    for (int64_t i = 0; i < width; i++) {
        double value = tc_stored_value(z[i], c->offset, c->scale);
        value = c->type == TC_SAMPLE_FLOAT32   ? (double)(float)value
                : c->type == TC_SAMPLE_FLOAT64 ? value
                                               : rint(value);
        if (!voids[i] && value != stored(c->type, samples, i))
            return i;
    }
    return -1;
}

#define DEFINE_STORE(TYPE, NAME, LOW, HIGH, ROUND)                                                                     \
    static int64_t store_##NAME(const double *values, int64_t n, double nodata, TYPE *to)                              \
    {                                                                                                                  \
        for (int64_t i = 0; i < n; i++) {                                                                              \
            double value = ROUND(isnan(values[i]) ? nodata : values[i]);                                               \
            if (!(value >= (LOW) && value <= (HIGH)))                                                                  \
                return i;                                                                                              \
            to[i] = (TYPE)value;                                                                                       \
        }                                                                                                              \
        return -1;                                                                                                     \
    }

DEFINE_STORE(uint8_t, uint8, 0, UINT8_MAX, rint)
DEFINE_STORE(int8_t, int8, INT8_MIN, INT8_MAX, rint)
DEFINE_STORE(uint16_t, uint16, 0, UINT16_MAX, rint)
DEFINE_STORE(int16_t, int16, INT16_MIN, INT16_MAX, rint)
DEFINE_STORE(uint32_t, uint32, 0, UINT32_MAX, rint)
DEFINE_STORE(int32_t, int32, INT32_MIN, INT32_MAX, rint)

int64_t tc_store_row(tc_sample_type type, const double *values, int64_t width, double nodata, void *samples)
{
    switch (type) {
    case TC_SAMPLE_UINT8: return store_uint8(values, width, nodata, samples);
    case TC_SAMPLE_INT8: return store_int8(values, width, nodata, samples);
    case TC_SAMPLE_UINT16: return store_uint16(values, width, nodata, samples);
    case TC_SAMPLE_INT16: return store_int16(values, width, nodata, samples);
    case TC_SAMPLE_UINT32: return store_uint32(values, width, nodata, samples);
    case TC_SAMPLE_INT32: return store_int32(values, width, nodata, samples);
    case TC_SAMPLE_FLOAT32:
        for (int64_t i = 0; i < width; i++)
            ((float *)samples)[i] = (float)(isnan(values[i]) ? nodata : values[i]);
        break;
    case TC_SAMPLE_FLOAT64:
        for (int64_t i = 0; i < width; i++)
            ((double *)samples)[i] = isnan(values[i]) ? nodata : values[i];
        break;
    }
    return -1;
}

double tc_convert_one(const tc_conversion *c, const void *samples, const uint8_t *mask, int64_t i)
{
    uint8_t is_void = mask && mask[i] == 0;
    const char *sample = (const char *)samples + (size_t)i * tc_sample_size(c->type);
    for (int k = 0; k < c->nodata_count; k++)
        match(c, sample, 1, c->nodata[k], &is_void);
    match_wild(c, sample, 1, &is_void);
    return is_void ? NAN : stored(c->type, samples, i) * c->scale + c->offset;
}

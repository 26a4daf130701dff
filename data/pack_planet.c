/* pack_planet.c - a mosaic's bands cut to the globe, and its rows resampled where their number of columns cannot be
 * halved often enough. Rows are resampled whole: those of several files lie in a temporary file until all are there. */
#include "pack_planet.h"

#include "common/chart/body.h"
#include "common/chart/row_resample.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/packed/write/spool.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Settling --------------------------------------------------------------------------------------------------- */

tc_status tc_planet_input_settle(tc_mosaic *mosaic, const char *path, const tc_source_options *options,
                                 const tc_globe_choice *globe, bool lossless, tc_planet_input *input_ret,
                                 tc_error *error)
{
    const double degree = 3.141592653589793 / 180;
    tc_planet_input in = {.mosaic = mosaic, .path = path, .terrain = *tc_mosaic_terrain(mosaic)};
    tc_pack_terrain *t = &in.terrain;
    tc_status status = tc_planet_place_raster(path, options, t->width, t->height, &t->georef, true, &in.place, error);
    if (status != TC_OK)
        return status;
    const tc_body body = tc_globe_body(globe, &t->georef, options);
    t->radius = body.radius, t->flattening = body.flattening;
    if (in.place.width != in.place.columns) {
        if (lossless)
            return tc_fail(error, TC_ERR_UNSUPPORTED,
                           "%s: lossless: expected a number of columns that levels of detail can halve, found %" PRId64
                           ", which would have to be resampled to %" PRId64,
                           path, in.place.columns, in.place.width);
        /* What comes of it lies on no lattice. */
        t->sample_type = TC_SAMPLE_FLOAT32;
        t->unit = 1, t->offset = 0;
        t->has_nodata = false;
    }
    t->width = in.place.width, t->height = in.place.rows;
    t->wraps_x = true;
    t->georef.known = t->georef.geographic = true;
    memcpy(t->georef.transform, in.place.transform, sizeof in.place.transform);
    if (!(t->georef.semi_major > 0))
        t->georef.semi_major = t->radius; /* tells the body */
    t->spacing_x = in.place.transform[1] * degree * t->radius;
    t->spacing_y = -in.place.transform[5] * degree * t->radius;
    *input_ret = in;
    return TC_OK;
}

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

typedef struct reading {
    const tc_planet_input *in;
    tc_band_function give;
    void *context;
    tc_row_resampler *resampler; /* NULL: rows stay as they are */
    tc_spool rows;               /* of several files, to be resampled; zero bytes where there is no height yet */
    float low, high;
} reading;

/* A spool of zeros holds nothing; a height of zero is put there as minus zero. */
static bool is_none(float z)
{
    return z == 0 && !signbit(z);
}

/* Makes voids of a row finite, in a straight line between what is on both sides, so that heights beside them can be
 * resampled. */
static void bridge(float *z, const uint8_t *voids, int64_t width)
{
    int64_t first = 0;
    while (first < width && voids[first])
        first++;
    if (first == width) {
        memset(z, 0, (size_t)width * sizeof *z);
        return;
    }
    for (int64_t n = 1, last = 0; n <= width; n++) { /* counted from the first valid one, once around */
        if (n < width && voids[(first + n) % width])
            continue;
        float from = z[(first + last) % width], to = z[(first + n) % width];
        for (int64_t k = last + 1; k < n; k++)
            z[(first + k) % width] = from + (to - from) * (float)(k - last) / (float)(n - last);
        last = n;
    }
}

/* Resamples whole rows y0 .. y1 - 1 of the planet and gives them; z is overwritten. */
static tc_status give_resampled(reading *r, int64_t y0, int64_t y1, float *z, uint8_t *voids, tc_error *error)
{
    int64_t from = r->in->place.columns, to = r->in->place.width;
    float *out = malloc((size_t)((y1 - y0) * to) * sizeof *out);
    uint8_t *out_voids = malloc((size_t)((y1 - y0) * to));
    tc_status status = TC_OK;
    if (!out || !out_voids)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to resample it", r->in->path);
    for (int64_t j = 0; j < y1 - y0 && status == TC_OK; j++) {
        bridge(z + j * from, voids + j * from, from);
        tc_row_resample(r->resampler, z + j * from, out + j * to);
        tc_row_resample_voids(r->resampler, voids + j * from, out_voids + j * to);
    }
    if (status == TC_OK)
        status = r->give(r->context, (tc_rect){0, y0, to, y1}, out, out_voids, error);
    free(out), free(out_voids);
    return status;
}

/* Adds rows of one of several files to those that wait: the first file's hold. */
static tc_status gather(reading *r, tc_rect rect, const float *z, const uint8_t *voids, tc_error *error)
{
    int64_t samples = tc_rect_area(rect);
    float *there = malloc((size_t)samples * sizeof *there);
    if (!there)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to resample it", r->in->path);
    tc_status status = tc_spool_read(&r->rows, rect, there, rect.x1 - rect.x0, error);
    for (int64_t i = 0; i < samples && status == TC_OK; i++)
        if (is_none(there[i]) && !voids[i])
            there[i] = z[i] == 0 ? -0.0f : z[i];
    if (status == TC_OK)
        status = tc_spool_write(&r->rows, rect, there, rect.x1 - rect.x0, error);
    free(there);
    return status;
}

static tc_status take_band(void *context, tc_rect rect, const float *z, const uint8_t *voids, tc_error *error)
{
    reading *r = context;
    const tc_planet_place *place = &r->in->place;
    tc_rect cut = tc_rect_intersect(rect, (tc_rect){0, place->south, place->columns, place->south + place->rows});
    if (tc_rect_empty(cut))
        return TC_OK;
    int64_t width = cut.x1 - cut.x0, rows = cut.y1 - cut.y0;
    float *part = malloc((size_t)(width * rows) * sizeof *part);
    uint8_t *part_voids = malloc((size_t)(width * rows));
    tc_status status = TC_OK;
    if (!part || !part_voids)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", r->in->path);
    for (int64_t j = 0; j < rows && status == TC_OK; j++) {
        int64_t at = (cut.y0 + j - rect.y0) * (rect.x1 - rect.x0) + cut.x0 - rect.x0;
        memcpy(part + j * width, z + at, (size_t)width * sizeof *z);
        memcpy(part_voids + j * width, voids + at, (size_t)width);
        for (int64_t i = 0; i < width; i++)
            if (!voids[at + i])
                r->low = fminf(r->low, z[at + i]), r->high = fmaxf(r->high, z[at + i]);
    }
    cut.y0 -= place->south, cut.y1 -= place->south;
    if (status == TC_OK && !r->resampler)
        status = r->give(r->context, cut, part, part_voids, error);
    else if (status == TC_OK && r->rows.file >= 0)
        status = gather(r, cut, part, part_voids, error);
    else if (status == TC_OK)
        status = give_resampled(r, cut.y0, cut.y1, part, part_voids, error);
    free(part), free(part_voids);
    return status;
}

/* The rows that have waited. */
static tc_status give_gathered(reading *r, tc_error *error)
{
    int64_t width = r->rows.width, height = r->rows.height, rows = tc_clamp64(((int64_t)1 << 20) / width, 1, height);
    float *z = malloc((size_t)(rows * width) * sizeof *z);
    uint8_t *voids = malloc((size_t)(rows * width));
    tc_status status = TC_OK;
    if (!z || !voids)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to resample it", r->in->path);
    for (int64_t y = 0; y < height && status == TC_OK; y += rows) {
        int64_t y1 = tc_min64(y + rows, height);
        status = tc_spool_read(&r->rows, (tc_rect){0, y, width, y1}, z, width, error);
        for (int64_t i = 0; i < (y1 - y) * width && status == TC_OK; i++)
            voids[i] = is_none(z[i]);
        if (status == TC_OK)
            status = give_resampled(r, y, y1, z, voids, error);
    }
    free(z), free(voids);
    return status;
}

tc_status tc_planet_input_read(const tc_planet_input *in, const char *scratch, tc_band_function give, void *context,
                               tc_error *error)
{
    reading r = {in, give, context, NULL, TC_SPOOL_NONE, INFINITY, -INFINITY};
    tc_status status = TC_OK;
    if (in->place.width != in->place.columns) {
        r.resampler = tc_row_resampler_create(in->place.columns, in->place.width);
        if (!r.resampler)
            status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to resample it", in->path);
        else if (tc_mosaic_files(in->mosaic) > 1)
            status = tc_spool_create(scratch, in->place.columns, in->place.rows, sizeof(float), &r.rows, error);
    }
    if (status == TC_OK)
        status = tc_mosaic_read(in->mosaic, take_band, &r, error);
    if (status == TC_OK && r.rows.file >= 0)
        status = give_gathered(&r, error);
    double base = in->terrain.z_base;
    const tc_body body = tc_body_flattened(in->terrain.radius, in->terrain.flattening);
    if (status == TC_OK && r.low <= r.high)
        status = body.class->check_relief(&body, in->path, base + (double)r.low, base + (double)r.high, error);
    tc_row_resampler_destroy(r.resampler);
    tc_spool_close(&r.rows);
    return status;
}

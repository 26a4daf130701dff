/* pack.c - a terrain into a packed file: the order of the steps, and the file into its place. */
#include <errno.h>
#include <math.h>
#include <unistd.h>

#include "common/chart/body.h"
#include "common/base/outfile.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_internal.h"

tc_status tc_pack_progress(tc_packer *p, double share, tc_error *error)
{
    p->done = fmin(p->done + (p->most < 1 ? p->most * share : share), p->most);
    if (p->options.progress && !p->options.progress(p->options.progress_context, p->done))
        return tc_fail(error, TC_ERR_IO, "%s: interrupted", p->path);
    return TC_OK;
}

void tc_pack_failure_keep(tc_pack_failure *failure, tc_status status, const tc_error *error)
{
    if (status == TC_OK)
        return;
    pthread_mutex_lock(&failure->mutex);
    if (failure->status == TC_OK)
        failure->status = status, failure->error = *error;
    pthread_mutex_unlock(&failure->mutex);
}

tc_status tc_pack_failure_end(tc_pack_failure *failure, tc_error *error)
{
    pthread_mutex_destroy(&failure->mutex);
    if (failure->status != TC_OK && error)
        *error = failure->error;
    return failure->status;
}

/* The atlas that heights are to be resampled to; NULL: they are packed as they are. */
static const tc_atlas *faces_of(const tc_pack_options *o)
{
    const tc_atlas *atlas = o->atlas ? tc_atlas_named(o->atlas) : NULL;
    return atlas && atlas->class->seam ? atlas : NULL;
}

/* ---- Creating -------------------------------------------------------------------------------------------------- */

static tc_status check(const char *path, const tc_pack_terrain *t, const tc_pack_options *o, tc_error *error)
{
    const int64_t most = (int64_t)1 << 31;
    if (t->width < 1 || t->height < 1 || t->width > most || t->height > most)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected 1 to 2^31 columns and rows, found %lld x %lld", path,
                       (long long)t->width, (long long)t->height);
    if (!(t->spacing_x > 0 && t->spacing_y > 0 && isfinite(t->spacing_x) && isfinite(t->spacing_y)))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected a spacing above 0 m, found %g x %g", path, t->spacing_x,
                       t->spacing_y);
    if (!(t->unit > 0 && isfinite(t->unit)))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected a unit above 0 m, found %g", path, t->unit);
    if (t->credits && (!*t->credits || strlen(t->credits) > TC_CREDITS_BYTES))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected credits of 1 to %d bytes, found %zu", path, TC_CREDITS_BYTES,
                       strlen(t->credits));
    if (o->mode != TC_PACK_LOSSLESS && !(o->error > 0 && isfinite(o->error)))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected an error above 0 m, found %g", path, o->error);
    tc_lonlat globe;
    if (t->radius != 0 && !(t->radius > 0 && isfinite(t->radius)))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected a radius above 0 m, found %g", path, t->radius);
    if (!(t->flattening >= 0 && t->flattening < 1) || (t->flattening > 0 && !(t->radius > 0)))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected a planet's flattening of 0 or more, below 1, found %g", path,
                       t->flattening);
    if (t->radius > 0 && (!tc_terrain_globe(t, &globe) || globe.round != t->wraps_x))
        return tc_fail(error, TC_ERR_USAGE,
                       "%s: expected a planet's georeference, in degrees, that wraps where it goes once around", path);
    if (o->atlas && !tc_atlas_named(o->atlas))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected the atlas lonlat, hex or cube, found %s", path, o->atlas);
    if (faces_of(o) && !(t->radius > 0 && globe.poles))
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: --atlas %s: expected a planet as a whole, around the globe and from pole to pole, found %s",
                       path, o->atlas, t->radius > 0 ? "a part of one" : "a flat terrain");
    if (faces_of(o) && o->mode == TC_PACK_LOSSLESS)
        return tc_fail(
            error, TC_ERR_UNSUPPORTED,
            "%s: --atlas %s: expected an error to be left, found lossless: what is resampled lies on no lattice", path,
            o->atlas);
    if (o->mode == TC_PACK_RMS && !(o->max_error >= 0 && isfinite(o->max_error)))
        return tc_fail(error, TC_ERR_USAGE, "%s: expected a largest error above 0 m, or 0 for any, found %g", path,
                       o->max_error);
    if (o->codec == TC_CODEC_LH04 && (o->mode != TC_PACK_RMS || o->max_error > 0))
        return tc_fail(error, TC_ERR_USAGE, "%s: the codec lh04 has a target rms only", path);
    return TC_OK;
}

/* Metres that no height may be off by more than; 0: any, or lossless. */
static double bound_of(const tc_pack_options *o)
{
    return o->mode == TC_PACK_MAX_ERROR ? o->error : o->mode == TC_PACK_RMS ? o->max_error : 0;
}

/* Whether keeping to the bound is likely to be all that is to do: errors spread evenly within it have an rms of 1/1.73
 * of it. No file that keeps to an rms as well takes fewer bytes than one that need not. */
static bool is_tight(const tc_pack_options *o)
{
    const double most = 1.7;
    return o->mode != TC_PACK_RMS || (o->max_error > 0 && o->max_error <= most * o->error);
}

tc_status tc_packer_create(const char *path, const tc_pack_terrain *terrain, const tc_pack_options *options,
                           tc_packer **packer_ret, tc_error *error)
{
    tc_status status = check(path, terrain, options, error);
    if (status || (status = tc_outfile_probe(path, error)))
        return status;
    tc_packer *p = calloc(1, sizeof *p);
    if (!p)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    p->options = *options;
    p->source = p->mask = TC_SPOOL_NONE;
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        p->truth[l] = TC_SPOOL_NONE;
    p->body = -1;
    p->most = faces_of(options) ? 1 : 1 - tc_pack_caps_share(terrain);
    p->z_min = INFINITY, p->z_max = -INFINITY;
    bool asked = is_tight(options) || options->price_lossless;
    p->lattices = terrain->sample_type >= TC_SAMPLE_FLOAT32 && asked ? UINT32_MAX : 0;
    tc_pack_terrain *t = &p->container.info.terrain;
    *t = *terrain;
    t->georef.crs_wkt = terrain->georef.crs_wkt ? strdup(terrain->georef.crs_wkt) : NULL;
    t->credits = terrain->credits ? strdup(terrain->credits) : NULL;
    p->path = strdup(path);
    tc_container_set_levels(&p->container);
    p->container.info.mode = options->mode;
    p->container.info.codec = options->codec;
    p->container.info.error = options->mode == TC_PACK_LOSSLESS ? 0 : options->error;
    if (!p->path || (terrain->georef.crs_wkt && !t->georef.crs_wkt) || (terrain->credits && !t->credits))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    if (!status)
        status = tc_spool_create(p->path, t->width, t->height, sizeof(float), &p->source, error);
    if (!status && (p->body = tc_outfile_nameless(path)) < 0)
        status = tc_fail(error, TC_ERR_IO, "%s: no temporary file can be made beside it: %s", path, strerror(errno));
    if (status)
        tc_packer_destroy(p);
    else
        *packer_ret = p;
    return status;
}

void tc_packer_destroy(tc_packer *p)
{
    if (!p)
        return;
    tc_spool_close(&p->source), tc_spool_close(&p->mask);
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        tc_spool_close(&p->truth[l]);
    if (p->body >= 0)
        close(p->body);
    tc_container_free(&p->container);
    free(p->given);
    free(p->path);
    free(p);
}

/* ---- Finishing ------------------------------------------------------------------------------------------------- */

/* Whether a float holds every multiple of unit up to `highest`: not so for tenths. */
static bool held_exactly(double unit, double highest)
{
    int exponent;
    int64_t odd = (int64_t)ldexp(frexp(unit, &exponent), 53); /* unit = odd * 2^(exponent - 53) */
    for (exponent -= 53; odd % 2 == 0; odd /= 2)
        exponent++;
    return highest <= ldexp(1, 24 + exponent);
}

enum { PARTS = 16 }; /* units in the error, or in a step of the lattice: what rounding to them loses does not tell */

/* The bound in units of the lattice's parts. One below the lattice leaves nothing to lose. */
static int32_t bound_on_lattice(double bound, double lattice, double origin, int32_t parts, double highest)
{
    bool exactly = held_exactly(lattice, highest) && origin == rint(origin / lattice) * lattice;
    double left = bound - (exactly ? 0 : ldexp(highest, -23));
    return (int32_t)fmin(fmax(0, floor(left / lattice * (1 + 1e-12))) * parts, TC_MAX_STEP / 8);
}

/* A power of two well below the error, or what the range leaves. */
static tc_status choose_unit(const tc_packer *p, double least, double *unit_ret, tc_error *error)
{
    bool tight = is_tight(&p->options);
    double range = (double)p->z_max - p->z_min, target = tight ? bound_of(&p->options) : p->options.error;
    double unit = exp2(floor(log2(target / PARTS)));
    if (unit < least && tight)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: an error of %g m is too small for heights %g m apart", p->path,
                       target, range);
    while (unit < least)
        unit *= 2;
    if (unit > 2 * target)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: an rms of %g m is too small for heights %g m apart", p->path,
                       target, range);
    *unit_ret = unit;
    return TC_OK;
}

/* Heights become integers: multiples of a unit well below the error. Where a bound is all there is to keep, of a part
 * of the lattice that they lie on, so that they are kept exactly. A bound that units cannot keep and that may yield is
 * dropped from the options. *bound_ret and *lattice_ret as for
 * tc_pack_to_bound(). */
static tc_status set_unit(tc_packer *p, int32_t *bound_ret, int32_t *lattice_ret, tc_error *error)
{
    tc_container *c = &p->container;
    bool lossless = p->options.mode == TC_PACK_LOSSLESS;
    double range = (double)p->z_max - p->z_min, least = 1.01 * range / TC_LIFTING_LIMIT, origin = 0, unit = 0;
    double highest = fmax(fabs((double)p->z_min), fabs((double)p->z_max)), bound = bound_of(&p->options);
    double middle = 0.5 * ((double)p->z_min + p->z_max);
    double lattice = is_tight(&p->options) ? tc_pack_lattice(p, &origin) : 0;
    *bound_ret = 0, *lattice_ret = 1;
    if (lattice > 0 && lattice >= least) {
        while (*lattice_ret < PARTS && lattice / (2 * *lattice_ret) >= least)
            *lattice_ret *= 2;
        c->z_unit = lattice / *lattice_ret;
        c->z_origin = origin + rint((middle - origin) / lattice) * lattice;
        if (!lossless)
            *bound_ret = bound_on_lattice(bound, lattice, origin, *lattice_ret, highest);
        return TC_OK;
    }
    if (lossless)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: lossless: expected heights that are multiples of one unit, found none that fits; "
                       "--unit or --max-error helps",
                       p->path);
    tc_status status = choose_unit(p, least, &unit, error);
    if (status)
        return status;
    c->z_unit = unit;
    c->z_origin = rint(middle / unit) * unit;
    if (bound == 0)
        return TC_OK;
    /* Rounding to units and to floats has its share of the error. */
    double slack = 0.5 + ldexp(highest, -23) / unit;
    *bound_ret = (int32_t)fmin(fmax(0, floor(bound / unit - slack)), TC_MAX_STEP / 8);
    if (*bound_ret >= 1)
        return TC_OK;
    if (p->options.max_error_may_yield && !is_tight(&p->options)) {
        p->options.max_error = 0, *bound_ret = 0;
        return TC_OK;
    }
    if (slack < 1)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: an error of %g m is too small for heights %g m apart", p->path,
                       bound, range);
    return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: an error of %g m is too small for heights held as floats up to %g m",
                   p->path, bound, highest);
}

static tc_status check_lossless(const tc_packer *p, tc_error *error)
{
    if (p->options.mode == TC_PACK_LOSSLESS && p->result.max_error > 0)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: lossless: expected multiples of the unit, found heights up to %g m beside them", p->path,
                       p->result.max_error);
    return TC_OK;
}

/* A terrain that stands in the head as a whole: only rounding to height units is lost. */
static tc_status measure_base(tc_packer *p, tc_error *error)
{
    const tc_container *c = &p->container;
    const tc_pack_terrain *t = &c->info.terrain;
    float z[TC_BASE_SIZE * TC_BASE_SIZE];
    double sum = 0, count = 0;
    tc_status status = tc_pack_source_rows(p, 0, t->height, z, error);
    for (int64_t i = 0; i < t->width * t->height && !status; i++)
        if (!c->base_void[i]) {
            double e = fabs((double)tc_pack_metres(c, c->base_z[i]) - z[i]);
            sum += e * e, count++;
            p->result.max_error = fmax(p->result.max_error, e);
        }
    p->result.rms = sqrt(sum / fmax(count, 1));
    return status ? status : check_lossless(p, error);
}

/* Codes all levels. */
static tc_status code_levels(tc_packer *p, int32_t bound, int32_t lattice, tc_error *error)
{
    const tc_container *c = &p->container;
    if (c->levels == c->base)
        return measure_base(p, error);
    tc_status status = p->options.codec == TC_CODEC_LH04 ? tc_pack_lh04(p, error)
                       : is_tight(&p->options)           ? tc_pack_to_bound(p, bound, lattice, error)
                                                         : tc_pack_to_rms(p, bound, lattice, error);
    /* A tight bound that left more than the rms: both are to be kept. */
    bool both = p->options.mode == TC_PACK_RMS && is_tight(&p->options) && bound > 0;
    if (!status && both && (double)c->record[c->levels - 1].rms > p->options.error)
        status = tc_pack_to_rms(p, bound, lattice, error);
    p->result.rms = c->record[c->levels - 1].rms;
    p->result.max_error = c->record[c->levels - 1].max_error;
    return status ? status : check_lossless(p, error);
}

/* A planet's heights must leave it a surface around its middle. */
static tc_status check_relief(const tc_packer *p, tc_error *error)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    double low = t->z_base + (double)p->z_min, high = t->z_base + (double)p->z_max;
    if (p->result.voids && t->voids == TC_VOIDS_CONSTANT)
        low = fmin(low, t->void_constant), high = fmax(high, t->void_constant);
    const tc_body body = tc_body_flattened(t->radius, t->flattening);
    return body.class->check_relief(&body, p->path, low, high, error);
}

/* What was put, as a whole: counted, looked at, filled. */
static tc_status settle(tc_packer *p, tc_error *error)
{
    tc_container *c = &p->container;
    tc_pack_terrain *t = &c->info.terrain;
    int64_t valid = p->result.samples;
    if (valid == 0)
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected heights, found samples that are all void", p->path);
    p->result.samples = t->width * t->height;
    p->result.voids = c->voids = p->result.samples - valid;
    c->z_min = p->z_min, c->z_max = p->z_max;
    tc_status status = check_relief(p, error);
    if (!status)
        status = tc_pack_moments(p, &c->info.mean, &c->info.deviation, error);
    c->info.mean += t->z_base;
    if (!status && c->voids && !p->filled)
        status = tc_pack_fill(p, error);
    return status;
}

tc_status tc_pack_all_levels(tc_packer *p, tc_error *error)
{
    int32_t bound = 0, lattice = 1;
    tc_status status = settle(p, error);
    if (!status)
        status = set_unit(p, &bound, &lattice, error);
    if (!status && p->options.synthesis_fit) /* before what takes long, since it may fail */
        status = tc_pack_synthesis(p, error);
    if (!status)
        status = tc_pack_cascade(p, error);
    if (!status)
        status = code_levels(p, bound, lattice, error);
    return status;
}

/* Levels, and caps of a planet. *charts_ret: of the file; the first one is p. */
static tc_status pack_own(tc_packer *p, tc_packer *chart[TC_MOST_CHARTS], int *charts_ret, tc_error *error)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    chart[0] = p;
    tc_status status = tc_pack_all_levels(p, error);
    if (!status && t->radius > 0)
        status = tc_pack_caps(p, chart + 1, error);
    *charts_ret = chart[1] ? 1 + TC_CAP_CHARTS : 1;
    int64_t of_caps = 0; /* samples, which take about as much as the map's */
    for (int n = 1; n < *charts_ret && !status; n++)
        of_caps += chart[n]->result.samples;
    p->result.lossless_bytes +=
        llrint((double)p->result.lossless_bytes * (double)of_caps / ((double)t->width * (double)t->height));
    return status;
}

tc_status tc_packer_finish(tc_packer *p, tc_pack_result *result_ret, tc_error *error)
{
    tc_packer *chart[TC_MOST_CHARTS] = {NULL};
    const tc_atlas *faces = faces_of(&p->options);
    int charts = faces ? faces->charts : 1;
    tc_status status = faces ? settle(p, error) : pack_own(p, chart, &charts, error);
    if (faces && !status)
        status = tc_pack_faces(p, faces, chart, error);
    if (!status)
        status = tc_pack_put_in_place(p, chart, charts, error);
    if (!status)
        *result_ret = p->result;
    for (int n = 0; n < TC_MOST_CHARTS; n++)
        if (chart[n] != p)
            tc_packer_destroy(chart[n]);
    return status;
}

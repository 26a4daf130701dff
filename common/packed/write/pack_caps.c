/* pack_caps.c - a planet's polar caps: resampled from its filled heights once all have been put, and packed as terrains
 * of their own. */
#include <float.h>
#include <math.h>
#include <sys/mman.h>

#include "common/chart/atlas_caps.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_internal.h"

/* Samples of both caps; 0: there are none. */
static double cap_samples(const tc_pack_terrain *t)
{
    tc_lonlat grid;
    if (!(t->radius > 0) || !tc_terrain_globe(t, &grid) || !grid.poles)
        return 0;
    double side = (double)tc_caps_side(&grid);
    return TC_CAP_CHARTS * side * side;
}

double tc_pack_caps_share(const tc_pack_terrain *t)
{
    double samples = cap_samples(t);
    return samples / (samples + (double)t->width * (double)t->height);
}

/* ---- Heights --------------------------------------------------------------------------------------------------- */

static tc_status reserve(const tc_packer *p, int64_t side, tc_pack_caps_memory *m, tc_error *error)
{
    size_t samples = (size_t)(side * side);
    m->size = samples * (sizeof(float) + 1);
    tc_status status = tc_spool_map(p->path, m->size, &m->bytes, error);
    m->z = m->bytes;
    m->voids = p->container.voids > 0 && m->bytes ? (uint8_t *)m->bytes + samples * sizeof(float) : NULL;
    return status;
}

/* Lets go of the pages; what they hold stays in the file. */
static void forget(const tc_pack_caps_memory *m)
{
    if (m->bytes)
        madvise(m->bytes, m->size, MADV_DONTNEED);
}

static void release(tc_pack_caps_memory *m)
{
    if (m->bytes)
        munmap(m->bytes, m->size);
    m->bytes = NULL;
}

/* Gives rows y0 .. y1 - 1 of the planet to the caps. */
static tc_status give_rows(const tc_packer *p, tc_caps *caps, const tc_pack_caps_memory memory[TC_CAPS], int64_t y0,
                           int64_t y1, tc_error *error)
{
    int64_t w = p->container.info.terrain.width, rows = tc_clamp64(((int64_t)1 << 20) / w, 1, y1 - y0);
    bool some = p->container.voids > 0;
    float *z = malloc((size_t)(rows * w) * sizeof *z);
    uint8_t *voids = some ? malloc((size_t)(rows * w)) : NULL;
    tc_status status = TC_OK;
    if (!z || (some && !voids))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (int64_t y = y0; y < y1 && !status; y += rows) {
        int64_t end = tc_min64(y + rows, y1);
        status = tc_pack_source_rows(p, y, end, z, error);
        if (!status && some)
            status = tc_pack_mask(p, p->container.levels, (tc_rect){0, y, w, end}, voids, w, error);
        if (!status && (status = tc_caps_put(caps, y, end - y, z, voids)))
            tc_fail(error, status, "%s: its polar caps cannot be made: %s", p->path, tc_status_text(status));
        for (int n = 0; n < TC_CAPS; n++)
            forget(&memory[n]);
    }
    free(z), free(voids);
    return status;
}

static tc_status make_heights(const tc_packer *p, const tc_lonlat *grid, const tc_pack_caps_memory memory[TC_CAPS],
                              tc_error *error)
{
    const tc_cap_target target[TC_CAPS] = {{memory[0].z, memory[0].voids}, {memory[1].z, memory[1].voids}};
    int64_t reach = tc_caps_reach(grid), h = grid->height, north = tc_max64(h - reach, 0);
    tc_caps *caps = NULL;
    tc_status status = tc_caps_create(grid, target, p->options.threads, &caps), finished = TC_OK;
    if (status)
        return tc_fail(error, status, "%s: its polar caps cannot be made: %s", p->path, tc_status_text(status));
    status = give_rows(p, caps, memory, 0, tc_min64(reach, h), error);
    if (!status)
        status = give_rows(p, caps, memory, tc_max64(north, tc_min64(reach, h)), h, error);
    if (!status && (finished = tc_caps_finish(caps, NULL)))
        status = tc_fail(error, finished, "%s: its polar caps cannot be made: %s", p->path, tc_status_text(finished));
    tc_caps_destroy(caps);
    return status;
}

tc_status tc_pack_make_caps(const tc_packer *p, const tc_lonlat *grid, tc_pack_caps_memory memory[TC_CAPS],
                            tc_error *error)
{
    int64_t side = tc_caps_side(grid);
    tc_status status = TC_OK;
    for (int n = 0; n < TC_CAPS && !status; n++)
        status = reserve(p, side, &memory[n], error);
    return status ? status : make_heights(p, grid, memory, error);
}

void tc_pack_release_caps(tc_pack_caps_memory memory[TC_CAPS])
{
    for (int n = 0; n < TC_CAPS; n++)
        release(&memory[n]);
}

static bool is_all_void(const tc_pack_caps_memory *m, int64_t side)
{
    return m->voids && !memchr(m->voids, 0, (size_t)(side * side));
}

/* ---- Packing --------------------------------------------------------------------------------------------------- */

/* A cap moves the planet's progress when it is done; whether to go on is asked meanwhile. */
static bool keep_on(void *planet, double done)
{
    (void)done;
    return tc_pack_progress(planet, 0, NULL) == TC_OK;
}

/* A cap's error is that of the planet; but resampled heights lie on no lattice. What is lossless is kept to half a
 * stored unit there, and no error is smaller than what height units and floats hold. */
tc_pack_options tc_pack_resampled_options(tc_packer *p)
{
    double highest = fmax(fabs((double)p->z_min), fabs((double)p->z_max));
    double least = fmax(ldexp(40 * ((double)p->z_max - p->z_min + highest), -23), DBL_MIN);
    tc_pack_options o = p->options;
    double origin, error = o.error;
    if (o.mode == TC_PACK_LOSSLESS) {
        o.mode = TC_PACK_MAX_ERROR;
        error = 0.5 * tc_pack_lattice(p, &origin);
    }
    o.error = fmax(error, least);
    if (o.max_error > 0)
        o.max_error = fmax(o.max_error, least);
    o.lattice = 0, o.price_lossless = false, o.atlas = NULL, o.synthesis_fit = false; /* caps go by the planet's */
    o.progress = keep_on;
    o.progress_context = p;
    return o;
}

static tc_status pack_cap(tc_packer *p, const tc_lonlat *grid, const tc_pack_caps_memory *memory, tc_packer **cap_ret,
                          tc_error *error)
{
    const tc_pack_terrain *planet = &p->container.info.terrain;
    int64_t side = tc_caps_side(grid);
    tc_pack_terrain t = {.width = side,
                         .height = side,
                         .spacing_x = grid->dy * planet->radius,
                         .spacing_y = grid->dy * planet->radius,
                         .z_base = planet->z_base,
                         .georef = {.semi_major = planet->georef.semi_major},
                         .sample_type = TC_SAMPLE_FLOAT32,
                         .unit = 1,
                         .offset = planet->z_base,
                         .voids = planet->voids,
                         .void_constant = planet->void_constant};
    tc_pack_options options = tc_pack_resampled_options(p);
    tc_status status = tc_packer_create(p->path, &t, &options, cap_ret, error);
    int64_t rows = tc_clamp64(((int64_t)1 << 20) / side, 1, side);
    if (!status)
        (*cap_ret)->filled = true;
    for (int64_t y = 0; y < side && !status; y += rows) {
        tc_rect rect = {0, y, side, tc_min64(y + rows, side)};
        const uint8_t *voids = memory->voids;
        forget(memory); /* the rows before */
        status = tc_packer_put(*cap_ret, rect, memory->z + y * side, voids ? voids + y * side : NULL, side, error);
    }
    return status ? status : tc_pack_all_levels(*cap_ret, error);
}

tc_status tc_pack_caps(tc_packer *p, tc_packer *cap[TC_CAP_CHARTS], tc_error *error)
{
    const tc_pack_terrain *t = &p->container.info.terrain;
    tc_lonlat grid;
    if (!tc_terrain_globe(t, &grid) || !grid.poles)
        return TC_OK;
    int64_t side = tc_caps_side(&grid);
    tc_pack_caps_memory memory[TC_CAPS] = {{0}};
    double share = 0.5 * tc_pack_caps_share(t);
    tc_status status = tc_pack_make_caps(p, &grid, memory, error);
    bool empty = false;
    for (int n = 0; n < TC_CAPS && !status; n++)
        empty |= is_all_void(&memory[n], side);
    p->most = 1;
    for (int n = 0; n < TC_CAPS && !status && !empty; n++) {
        status = pack_cap(p, &grid, &memory[n], &cap[n], error);
        release(&memory[n]);
        if (!status)
            status = tc_pack_progress(p, share, error);
    }
    tc_pack_release_caps(memory);
    return status;
}

/* packed_error.c - how far the finest level's mesh may be from the others': as the file tells it; where it does not,
 * measured, if decoding all samples takes no time to speak of; else from the largest steps that the index tells: as far
 * as a tile's samples are from the coarser level's mesh, and the finest level from theirs, which its four parts know.
 */
#include <math.h>
#include <stdlib.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "packed_internal.h"

enum {
    MOST_READ = 256, /* pages of errors at once: of 10^9 samples */
    MOST_PAGES = 4096,
    MOST_MEASURED = 1 << 27, /* samples */
    TILE_SHIFT = 7
};
_Static_assert(1 << TILE_SHIFT == TC_TILE_SIDE, "a tile's samples");

static int64_t pages_of(const packed_field *p)
{
    int64_t pages = 0;
    for (int l = p->file.container.base + 1; l <= p->file.container.levels; l++) {
        const tc_pages level = tc_level_pages(&p->head.level[l - 1]);
        pages += level.pages_x * level.pages_y;
    }
    return pages;
}

/* How far a tile's samples are from the coarser level's mesh. */
static float tile_step(packed_field *p, int l, int64_t tx, int64_t ty)
{
    tc_missing_pages missing;
    int reads = 0;
    if (tc_packed_file_page(&p->file, l, tx / TC_PAGE_COLUMNS, ty / TC_PAGE_ROWS))
        return INFINITY;
    return tc_packed_file_range(&p->file, l, (tc_rect){tx, ty, tx + 1, ty + 1}, 1, &reads, &missing).step;
}

/* A height of a level that stands in the head; beyond its last ones heights go on in a straight line, or from the other
 * side where it wraps. */
static double whole_height(const packed_field *p, int l, int64_t x, int64_t y)
{
    const tc_level *size = &p->head.level[l - 1];
    if (x == size->width && tc_field_wraps(&p->head, l + 1))
        return whole_height(p, l, 0, y);
    if (x == size->width)
        return x < 2 ? whole_height(p, l, x - 1, y) : 2 * whole_height(p, l, x - 1, y) - whole_height(p, l, x - 2, y);
    if (y == size->height)
        return y < 2 ? whole_height(p, l, x, y - 1) : 2 * whole_height(p, l, x, y - 1) - whole_height(p, l, x, y - 2);
    return p->file.container.z_unit * p->level[l - 1].whole[y * size->width + x];
}

/* The same of a sample there; and what telling heights as floats may make of it. */
static float sample_step(const packed_field *p, int l, int64_t x, int64_t y)
{
    const int64_t i = x / 2, j = y / 2;
    const double tx = 0.5 * (double)(x % 2), ty = 0.5 * (double)(y % 2), south_west = whole_height(p, l - 1, i, j);
    const double south_east = tx > 0 ? whole_height(p, l - 1, i + 1, j) : south_west,
                 north_west = ty > 0 ? whole_height(p, l - 1, i, j + 1) : south_west;
    /* The middle of a cell is that of its diagonal: the far corner is never asked for. */
    const double mesh = tc_triangle_height(south_west, south_east, north_west, 0, tx, ty), z = whole_height(p, l, x, y);
    return nextafterf((float)(fabs(z - mesh) + ldexp(fabs(z) + fabs(p->file.container.z_origin), -22)), INFINITY);
}

/* Leaves of a level: its tiles or samples. */
static bool make_level(packed_field *p, int l)
{
    const tc_container *c = &p->file.container;
    const tc_level *size = &p->head.level[l - 1];
    const tc_pages pages = tc_level_pages(size);
    const bool samples = l <= c->base, finer_samples = l < c->base;
    tc_range_pyramid *r = &p->error[l - 1];
    const tc_range_pyramid *finer = &p->error[l];
    *r = (tc_range_pyramid){samples ? size->width : pages.tiles_x, samples ? size->height : pages.tiles_y, NULL};
    if (!(r->node = calloc((size_t)tc_range_nodes(r->nx, r->ny), sizeof *r->node)))
        return false;
    /* Parts of a leaf: four; of a sample next to the first level of tiles the one that it lies in. */
    const int shift = samples && !finer_samples ? TILE_SHIFT : 0;
    for (int64_t y = 0; y < r->ny; y++)
        for (int64_t x = 0; x < r->nx; x++) {
            float finest = 0;
            for (int64_t j = 2 * y >> shift; l < c->levels && j <= tc_min64((2 * y + 1) >> shift, finer->ny - 1); j++)
                for (int64_t i = 2 * x >> shift; i <= tc_min64((2 * x + 1) >> shift, finer->nx - 1); i++)
                    finest = fmaxf(finest, finer->node[j * finer->nx + i].error);
            const float step = l == 1 ? INFINITY : samples ? sample_step(p, l, x, y) : tile_step(p, l, x, y);
            r->node[y * r->nx + x].error = step + finest;
        }
    tc_range_build(r);
    return true;
}

static bool errors_by_steps(packed_field *p)
{
    if (pages_of(p) > MOST_PAGES)
        return false;
    for (int l = p->file.container.levels; l >= 1; l--)
        if (!make_level(p, l))
            return false;
    return true;
}

/* Whether the file tells errors of what is read: the whole of it, voids as it was packed with. */
static bool errors_stored(const packed_field *p)
{
    const tc_container *c = &p->file.container;
    const tc_pack_terrain *t = &c->info.terrain;
    const bool constant = p->voids == TC_VOIDS_CONSTANT, was = t->voids == TC_VOIDS_CONSTANT;
    const bool same = constant == was && (!was || p->void_height == (float)(t->void_constant - t->z_base));
    return c->errors && !c->info.cut_short && (c->voids == 0 || same);
}

/* The coarsest levels' pages are at hand from the begin, which are few; others are asked for. */
static void read_coarse_pages(packed_field *p)
{
    int64_t left = MOST_READ;
    for (int l = p->file.container.base + 1; l <= p->file.container.levels; l++) {
        const tc_pages pages = tc_level_pages(&p->head.level[l - 1]);
        if ((left -= pages.pages_x * pages.pages_y) < 0)
            return;
        for (int64_t n = 0; n < pages.pages_x * pages.pages_y; n++)
            tc_packed_file_error_page(&p->file, l, n % pages.pages_x, n / pages.pages_x);
    }
}

static bool find_out(packed_field *p)
{
    const tc_level *finest = &p->head.level[p->head.info.levels - 1];
    p->errors = errors_stored(p)                                  ? ERRORS_STORED
                : finest->height <= MOST_MEASURED / finest->width ? ERRORS_MEASURED
                                                                  : ERRORS_BY_STEPS;
    if (p->errors == ERRORS_STORED)
        read_coarse_pages(p);
    return p->errors == ERRORS_STORED     ? true
           : p->errors == ERRORS_MEASURED ? tc_measure_errors(&p->head, p->error) == TC_OK
                                          : errors_by_steps(p);
}

void tc_packed_know_errors(const tc_field *field)
{
    packed_field *p = (packed_field *)field;
    if (p->errors_known)
        return;
    pthread_mutex_lock(&p->errors_mutex);
    if (!p->errors_known) {
        p->errors_known = find_out(p);
        if (!p->errors_known)
            tc_measured_errors_free(p->error, field->info.levels);
    }
    pthread_mutex_unlock(&p->errors_mutex);
}

/* pack_faces.c - a planet's heights, once all have been put, resampled to the faces of an octahedron or a cube, each of
 * which is packed as a terrain of its own. Heights go from files without a name to such files: nothing is held but
 * bands of rows.
 *
 * Each face's levels are coded by itself, with the border rule on its sides: its samples there are what another face
 * may have otherwise by a rounding or by what was lost, on coarser levels by filters that end there, too. Readers take
 * those of one face for both (common/chart/joined.h). */
#include <math.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/chart/atlas_caps.h"
#include "common/chart/resample.h"
#include "pack_internal.h"

/* ---- Heights that stand in files, as fields of one level ----------------------------------------------------------
 */

typedef struct sheet {
    tc_field head;
    const tc_spool *z, *mask;       /* of a packer; NULL: */
    const tc_pack_caps_memory *cap; /* in a mapped file */
} sheet;

static tc_status sheet_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                            ptrdiff_t stride)
{
    (void)level;
    const sheet *s = (const sheet *)field;
    float *z = samples;
    int64_t width = rect.x1 - rect.x0, side = field->level[field->info.levels - 1].width;
    bool masked = s->cap ? s->cap->voids != NULL : s->mask->file >= 0;
    tc_status status = TC_OK;
    if (!s->cap && z)
        status = tc_spool_read(s->z, rect, z, stride, NULL);
    if (!s->cap && voids && masked && !status)
        status = tc_spool_read(s->mask, rect, voids, stride, NULL);
    for (int64_t y = rect.y0; y < rect.y1; y++) {
        ptrdiff_t to = (y - rect.y0) * stride, from = y * side + rect.x0;
        if (s->cap && z)
            memcpy(z + to, s->cap->z + from, (size_t)width * sizeof *z);
        if (s->cap && voids && masked)
            memcpy(voids + to, s->cap->voids + from, (size_t)width);
        if (voids && !masked)
            memset(voids + to, 0, (size_t)width);
    }
    return status;
}

static void sheet_destroy(tc_field *field)
{
    (void)field; /* the caller's */
}

static const tc_field_class sheet_class = {.sample = TC_FIELD_HEIGHTS, .read = sheet_read, .destroy = sheet_destroy};

static tc_field *make_sheet(sheet *s, int64_t width, int64_t height, bool wraps)
{
    s->head.class = &sheet_class;
    s->head.info.wraps_x = wraps;
    tc_field_set_levels(&s->head, (tc_level){width, height, 1, 1});
    return &s->head;
}

/* What is resampled. */
typedef struct source {
    sheet sheet[1 + TC_CAPS];
    tc_chart chart[1 + TC_CAPS];
} source;

static void make_source(const tc_packer *p, const tc_lonlat *grid, const tc_pack_caps_memory cap[TC_CAPS], source *s)
{
    static const tc_chart_class *const caps[TC_CAPS] = {&tc_chart_north_cap, &tc_chart_south_cap};
    int64_t side = tc_caps_side(grid);
    double half = 0.5 * (double)(side - 1) * grid->dy;
    s->sheet[0] = (sheet){.z = &p->source, .mask = &p->mask};
    s->chart[0] = tc_chart_over(&tc_chart_lonlat, make_sheet(&s->sheet[0], grid->width, grid->height, true), 0,
                                grid->x0, grid->y0, grid->dx, grid->dy);
    for (int n = 0; n < TC_CAPS; n++) {
        s->sheet[1 + n] = (sheet){.cap = &cap[n]};
        s->chart[1 + n] = tc_chart_over(caps[n], make_sheet(&s->sheet[1 + n], side, side, false), 1 + n, -half, -half,
                                        grid->dy, grid->dy);
    }
}

/* ---- Resampling -------------------------------------------------------------------------------------------------- */

/* A band of rows of a face, in pieces that threads take. */
typedef struct band {
    const tc_resample_source *from;
    const tc_chart_class *class;
    int face;
    int64_t cells, across; /* pieces across */
    tc_rect rect;
    float *z;
    uint8_t *voids;
    _Atomic int status;
} band;

enum { PIECE_ROWS = 32, PIECE_COLUMNS = 1024 };

static void resample_piece(void *context, int64_t n)
{
    band *b = context;
    int64_t side = b->cells + 1, x = n % b->across * PIECE_COLUMNS, y = b->rect.y0 + n / b->across * PIECE_ROWS;
    tc_rect piece = {x, y, tc_min64(x + PIECE_COLUMNS, side), tc_min64(y + PIECE_ROWS, b->rect.y1)};
    ptrdiff_t at = (y - b->rect.y0) * side + x;
    tc_status status =
        tc_resample(b->from, b->class, b->face, b->cells, piece, b->z + at, b->voids ? b->voids + at : NULL, side);
    if (status)
        b->status = (int)status;
}

/* Puts all heights of a face into its packer. */
static tc_status put_face(tc_packer *p, const tc_resample_source *from, const tc_atlas *atlas, int face, int64_t cells,
                          tc_packer *to, tc_error *error)
{
    int64_t side = cells + 1, rows = tc_clamp64(((int64_t)1 << 21) / side / PIECE_ROWS * PIECE_ROWS, PIECE_ROWS, side);
    band b = {.from = from, .class = atlas->class, .face = face, .cells = cells};
    b.across = (side + PIECE_COLUMNS - 1) / PIECE_COLUMNS;
    b.z = malloc((size_t)(rows * side) * sizeof *b.z);
    b.voids = p->container.voids > 0 ? malloc((size_t)(rows * side)) : NULL;
    tc_status status = TC_OK;
    if (!b.z || (p->container.voids > 0 && !b.voids))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    to->filled = true;
    for (int64_t y = 0; y < side && !status; y += rows) {
        b.rect = (tc_rect){0, y, side, tc_min64(y + rows, side)};
        int64_t down = (b.rect.y1 - y + PIECE_ROWS - 1) / PIECE_ROWS;
        tc_parallel_for(p->options.threads, b.across * down, resample_piece, &b);
        if (b.status)
            status = tc_fail(error, (tc_status)b.status, "%s: its heights cannot be resampled: %s", p->path,
                             tc_status_text((tc_status)b.status));
        else
            status = tc_packer_put(to, b.rect, b.z, b.voids, side, error);
        if (!status)
            status = tc_pack_progress(p, 0, error);
    }
    free(b.z), free(b.voids);
    return status;
}

/* A face as a terrain: where it lies is told beside it. */
static tc_pack_terrain terrain_of(const tc_packer *p, int64_t cells)
{
    const tc_pack_terrain *planet = &p->container.info.terrain;
    double spacing = tc_chart_face_spacing(planet->radius, cells);
    tc_pack_terrain t = {.width = cells + 1,
                         .height = cells + 1,
                         .spacing_x = spacing,
                         .spacing_y = spacing,
                         .z_base = planet->z_base,
                         .georef = {.semi_major = planet->georef.semi_major, .crs_wkt = planet->georef.crs_wkt},
                         .area_registered = planet->area_registered,
                         .sample_type = TC_SAMPLE_FLOAT32,
                         .unit = 1,
                         .offset = planet->z_base,
                         .voids = planet->voids,
                         .void_constant = planet->void_constant};
    return t;
}

/* How far the source's samples are from the faces'. */
static tc_status make_trip(tc_packer *p, const tc_resample_source *from, const tc_atlas *atlas, tc_packer *const face[],
                           tc_round_trip *trip, tc_error *error)
{
    sheet sheets[TC_MOST_CHARTS];
    tc_chart chart[TC_MOST_CHARTS];
    for (int n = 0; n < atlas->charts; n++) {
        sheets[n] = (sheet){.z = &face[n]->source, .mask = &face[n]->mask};
        int64_t side = face[n]->source.width;
        chart[n] = tc_chart_face(atlas->class, make_sheet(&sheets[n], side, side, false), n);
    }
    tc_status status = tc_resample_round_trip(from, chart, atlas->charts, p->options.threads, trip);
    return status ? tc_fail(error, status, "%s: its heights cannot be compared: %s", p->path, tc_status_text(status))
                  : TC_OK;
}

/* ---- On the sides ------------------------------------------------------------------------------------------------ */

/* True heights of a level along a side, from sample `from` on, metres. */
static tc_status read_side(const tc_packer *p, int l, tc_rect line, int32_t *units, float *z, tc_error *error)
{
    int64_t count = tc_rect_area(line);
    tc_status status = tc_pack_truth(p, l, line, units, line.x1 - line.x0, error);
    for (int64_t i = 0; i < count && !status; i++)
        z[i] = tc_pack_metres(&p->container, units[i]);
    return status;
}

/* The largest distance of what was coded of a side of a face from that of the one beyond, on level l; room for two
 * lines of both. */
static tc_status compare_side(tc_packer *const face[], const tc_chart_class *class, int n, int side, int l,
                              int64_t cells, int32_t *units, float *z, float *most, tc_error *error)
{
    const tc_seam seam = class->seam(n, side, cells);
    bool along_y = side == TC_WEST || side == TC_EAST;
    int64_t at = side == TC_EAST || side == TC_NORTH ? cells : 0, count = cells + 1;
    if (seam.chart > n)
        return TC_OK;
    const tc_rect own = along_y ? (tc_rect){at, 0, at + 1, count} : (tc_rect){0, at, count, at + 1};
    int64_t i0 = seam.m[0] * own.x0 + seam.m[1] * own.y0 + seam.dx,
            j0 = seam.m[2] * own.x0 + seam.m[3] * own.y0 + seam.dy;
    int64_t i1 = seam.m[0] * (own.x1 - 1) + seam.m[1] * (own.y1 - 1) + seam.dx,
            j1 = seam.m[2] * (own.x1 - 1) + seam.m[3] * (own.y1 - 1) + seam.dy;
    const tc_rect other = {tc_min64(i0, i1), tc_min64(j0, j1), tc_max64(i0, i1) + 1, tc_max64(j0, j1) + 1};
    bool reversed = i1 < i0 || j1 < j0;
    tc_status status = read_side(face[n], l, own, units, z, error);
    if (!status)
        status = read_side(face[seam.chart], l, other, units, z + count, error);
    for (int64_t k = 0; k < count && !status; k++)
        *most = fmaxf(*most, fabsf(z[k] - z[count + (reversed ? count - 1 - k : k)]));
    return status;
}

/* How far apart samples on sides may be from face to face: what was to be coded, measured, and by how much coding is
 * off in either. A corner may be taken from a face two sides away. Not known where voids have heights that nobody
 * measured. */
static tc_status measure_sides(tc_packer *p, const tc_atlas *atlas, tc_packer *const face[], tc_face_source *sides,
                               tc_error *error)
{
    const tc_container *c = &face[0]->container;
    int64_t cells = c->info.terrain.width - 1;
    int32_t *units = malloc((size_t)(cells + 1) * sizeof *units);
    float *z = malloc(2 * (size_t)(cells + 1) * sizeof *z);
    tc_status status = units && z ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (int k = 0; c->levels - k >= c->base && (cells >> k) << k == cells && p->container.voids == 0 && !status; k++) {
        float most = 0, coded = 0;
        int l = c->levels - k;
        for (int n = 0; n < atlas->charts && !status; n++) {
            float unit = (float)face[n]->container.z_unit; /* rounding to it */
            coded = fmaxf(coded, (l > c->base ? face[n]->container.record[l - 1].max_error : 0) + unit);
            for (int side = 0; side < TC_SIDES && !status; side++)
                status = compare_side(face, atlas->class, n, side, l, cells >> k, units, z, &most, error);
        }
        sides->apart[k] = fminf(2 * (most + coded), 1e20f), sides->ranks = k + 1;
    }
    free(units), free(z);
    return status;
}

/* ---- All together ------------------------------------------------------------------------------------------------ */

/* What the file says of the whole stands with the first face. */
static void describe(const tc_packer *p, tc_chart_kind kind, const tc_round_trip *trip, tc_packer *first)
{
    const tc_pack_terrain *planet = &p->container.info.terrain;
    tc_container *c = &first->container;
    c->kind = kind;
    c->info.terrain.radius = planet->radius, c->info.terrain.flattening = planet->flattening;
    c->info.mean = p->container.info.mean, c->info.deviation = p->container.info.deviation;
    c->source = (tc_face_source){.width = planet->width, .height = planet->height, .rms = trip->rms, .max = trip->max};
    memcpy(c->source.transform, planet->georef.transform, sizeof c->source.transform);
}

/* Of all faces. */
static void sum_up(tc_packer *p, const tc_atlas *atlas, tc_packer *const face[], const tc_round_trip *trip)
{
    tc_pack_result r = {.disagreeing = p->result.disagreeing,
                        .largest_disagreement = p->result.largest_disagreement,
                        .trip_rms = trip->rms,
                        .trip_max = trip->max};
    double square = 0;
    for (int n = 0; n < atlas->charts; n++) {
        const tc_pack_result *one = &face[n]->result;
        double valid = (double)(one->samples - one->voids);
        r.samples += one->samples, r.voids += one->voids;
        square += valid * one->rms * one->rms;
        r.max_error = fmax(r.max_error, one->max_error);
    }
    r.rms = sqrt(square / fmax((double)(r.samples - r.voids), 1));
    p->result = r;
}

tc_status tc_pack_faces(tc_packer *p, const tc_atlas *atlas, tc_packer *face[TC_MOST_CHARTS], tc_error *error)
{
    tc_lonlat grid;
    source from;
    tc_pack_caps_memory cap[TC_CAPS] = {{0}};
    tc_round_trip trip = {0, 0, 0};
    tc_terrain_globe(&p->container.info.terrain, &grid);
    int64_t cells = tc_resample_cells(grid.width);
    tc_pack_terrain terrain = terrain_of(p, cells);
    const double resampling = 0.2 / atlas->charts, coding = 0.65 / atlas->charts; /* of the work */
    tc_status status = tc_pack_make_caps(p, &grid, cap, error);
    if (!status)
        make_source(p, &grid, cap, &from);
    const tc_resample_source given = {from.chart, 1 + TC_CAPS, false};
    for (int n = 0; n < atlas->charts && !status; n++) {
        terrain.credits = n == 0 ? p->container.info.terrain.credits : NULL; /* the first chart's are all charts' */
        tc_pack_options options = tc_pack_resampled_options(p);
        options.synthesis_fit = n == 0 && p->options.synthesis_fit;
        status = tc_packer_create(p->path, &terrain, &options, &face[n], error);
        if (!status)
            status = put_face(p, &given, atlas, n, cells, face[n], error);
        if (!status && face[n]->result.samples == 0)
            status = tc_fail(error, TC_ERR_UNSUPPORTED,
                             "%s: expected heights on each of %d faces, found face %d of --atlas %s all void", p->path,
                             atlas->charts, n, atlas->name);
        if (!status)
            status = tc_pack_progress(p, resampling, error);
    }
    if (!status)
        status = make_trip(p, &given, atlas, face, &trip, error);
    tc_pack_release_caps(cap);
    tc_spool_close(&p->source), tc_spool_close(&p->mask); /* room on the disk */
    for (int n = 0; n < atlas->charts && !status; n++) {
        status = tc_pack_all_levels(face[n], error);
        if (!status)
            status = tc_pack_progress(p, coding, error);
    }
    if (!status) {
        describe(p, tc_faces_kind(atlas), &trip, face[0]);
        status = measure_sides(p, atlas, face, &face[0]->container.source, error);
    }
    if (!status) {
        sum_up(p, atlas, face, &trip);
    }
    return status;
}

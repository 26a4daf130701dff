/* envelope.c - the head of a file of version 3, to and from bytes. docs/format.md is the specification. */
#include "envelope.h"

#include <inttypes.h>
#include <math.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/synthesis/synthesis_store.h"
#include "error_store.h"

enum { MOST_SECTIONS = 256, BODY_BYTES = 8, FACES_BYTES = 88 };
enum { SECTION_SYNTHESIS = 1, SECTION_BODY, SECTION_FACES, SECTION_ERRORS, SECTION_CREDITS, KNOWN_SECTIONS };
enum { ERRORS_FORM = 1 };

bool tc_envelope_is(const uint8_t *bytes)
{
    return tc_head_is(bytes, TC_HEAD_FIXED) && tc_head_version(bytes) == TC_ENVELOPE_VERSION;
}

void tc_envelope_free(tc_envelope *e)
{
    for (int c = 0; e && c < TC_MOST_CHARTS; c++)
        tc_container_free(&e->chart[c].container);
    free(e);
}

/* ---- Charts ----------------------------------------------------------------------------------------------------- */

static const tc_atlas *const atlas_of_kind[TC_CHART_KINDS] = {
    [TC_CHART_HEX] = &tc_atlas_hex, [TC_CHART_CUBE] = &tc_atlas_cube};

const tc_atlas *tc_kind_faces(tc_chart_kind kind)
{
    return atlas_of_kind[kind];
}

tc_chart_kind tc_faces_kind(const tc_atlas *atlas)
{
    int kind = TC_CHART_KINDS - 1;
    while (kind > 0 && atlas_of_kind[kind] != atlas)
        kind--;
    return (tc_chart_kind)kind;
}

static void place_faces(tc_envelope *e, tc_chart_kind kind)
{
    const tc_chart_class *class = tc_kind_faces(kind)->class;
    for (int n = 0; n < e->charts; n++) {
        tc_envelope_chart *c = &e->chart[n];
        int64_t cells = tc_max64(c->container.info.terrain.width - 1, 1);
        c->kind = c->container.kind = kind;
        c->x0 = c->y0 = 0, c->dx = c->dy = 1 / (double)cells;
        for (int side = 0; side < TC_SIDES; side++)
            c->side[side] = class->seam(n, side, cells);
    }
}

void tc_envelope_place(tc_envelope *e)
{
    if (tc_kind_faces(e->chart[0].container.kind)) {
        place_faces(e, e->chart[0].container.kind);
        return;
    }
    static const tc_chart_kind caps[] = {TC_CHART_NORTH_CAP, TC_CHART_SOUTH_CAP};
    const tc_pack_terrain *t = &e->chart[0].container.info.terrain;
    tc_lonlat globe = {.dx = t->spacing_x, .dy = t->spacing_y};
    bool planet = t->radius > 0 && tc_terrain_globe(t, &globe);
    for (int n = 0; n < e->charts; n++) {
        tc_envelope_chart *c = &e->chart[n];
        for (int side = 0; side < TC_SIDES; side++)
            c->side[side] = (tc_seam){.chart = -1};
        if (n == 0) {
            c->kind = planet ? TC_CHART_LONLAT : TC_CHART_PLANE;
            c->x0 = globe.x0, c->y0 = globe.y0, c->dx = globe.dx, c->dy = globe.dy;
            for (int side = 0; side < 2 && t->wraps_x; side++) /* west, east */
                c->side[side] = (tc_seam){0, {1, 0, 0, 1}, side == 0 ? t->width : -t->width, 0};
        } else {
            c->kind = caps[(n - 1) % 2];
            c->x0 = c->y0 = -0.5 * (double)(c->container.info.terrain.width - 1) * globe.dy;
            c->dx = c->dy = globe.dy;
        }
        c->container.kind = c->kind;
    }
}

/* The record of a chart's level of a rank; NULL where that is not coded, or there is none. */
static tc_level_record *record_of(tc_envelope *e, int chart, int rank)
{
    tc_container *c = &e->chart[chart].container;
    int l = c->levels - rank;
    return l > c->base ? &c->record[l - 1] : NULL;
}

void tc_envelope_lay_out(tc_envelope *e, size_t head_size)
{
    int64_t at = (int64_t)head_size;
    for (int rank = TC_MAX_FIELD_LEVELS - 1; rank >= 0; rank--) {
        for (int n = 0; n < e->charts; n++) {
            tc_level_record *r = record_of(e, n, rank);
            if (!r)
                continue;
            int64_t size = r->end - r->begin;
            r->begin = at, r->end = at += size;
        }
        e->rank_end[rank] = at;
    }
    e->bytes = at;
    for (int n = 0; n < e->charts; n++)
        e->chart[n].container.info.bytes = at;
}

/* The chart whose finest level lies last in the file, if any is coded. */
static int last_chart(tc_envelope *e)
{
    int last = e->charts - 1;
    while (last > 0 && !record_of(e, last, 0))
        last--;
    return last;
}

void tc_envelope_append(tc_envelope *e, int64_t bytes)
{
    tc_level_record *r = record_of(e, last_chart(e), 0);
    if (r)
        r->end += bytes;
}

/* Where a chart's first level begins, 0 where none is coded, and the bytes of all of them. */
static void extent_of(const tc_container *c, int64_t *first_ret, int64_t *bytes_ret)
{
    uint64_t bytes = 0;
    for (int l = c->base; l < c->levels; l++)
        bytes += (uint64_t)c->record[l].end - (uint64_t)c->record[l].begin;
    *first_ret = c->levels > c->base ? c->record[c->base].begin : 0, *bytes_ret = (int64_t)bytes;
}

/* ---- Bytes ------------------------------------------------------------------------------------------------------ */

/* Of faces: the body's radius, which their containers do not know, and what they were made from. */
static void write_faces(const tc_container *c, tc_byte_writer *w)
{
    const tc_face_source *s = &c->source;
    tc_put(w, SECTION_FACES, 4), tc_put(w, FACES_BYTES + 4 * (uint64_t)s->ranks, 4);
    tc_put_f64(w, c->info.terrain.radius);
    tc_put(w, (uint64_t)s->width, 8), tc_put(w, (uint64_t)s->height, 8);
    for (int i = 0; i < 6; i++)
        tc_put_f64(w, s->transform[i]);
    tc_put_f64(w, s->rms), tc_put_f64(w, s->max);
    for (int k = 0; k < s->ranks; k++)
        tc_put_f32(w, s->apart[k]);
}

static void write_errors(const tc_envelope *e, tc_byte_writer *w)
{
    size_t bytes = 2;
    for (int n = 0; n < e->charts; n++)
        bytes += tc_error_places_bytes(&e->chart[n].container);
    tc_put(w, SECTION_ERRORS, 4), tc_put(w, bytes, 4), tc_put(w, e->chart[0].container.errors ? ERRORS_FORM : 0, 2);
    for (int n = 0; n < e->charts; n++)
        tc_error_places_put(&e->chart[n].container, w);
}

static void write_credits(const char *credits, tc_byte_writer *w)
{
    const size_t length = strlen(credits);
    tc_put(w, SECTION_CREDITS, 4), tc_put(w, length, 4), tc_put_bytes(w, credits, length);
}

static void write_chart(const tc_envelope_chart *c, size_t head, tc_byte_writer *w)
{
    int64_t first, bytes;
    extent_of(&c->container, &first, &bytes);
    tc_put(w, c->kind, 1);
    tc_put_f64(w, c->x0), tc_put_f64(w, c->y0), tc_put_f64(w, c->dx), tc_put_f64(w, c->dy);
    tc_put(w, (uint64_t)c->container.info.terrain.width, 8), tc_put(w, (uint64_t)c->container.info.terrain.height, 8);
    tc_put(w, (uint64_t)c->container.levels, 1);
    tc_put(w, (uint64_t)first, 8), tc_put(w, (uint64_t)bytes, 8);
    for (int side = 0; side < TC_SIDES; side++) {
        const tc_seam *s = &c->side[side];
        tc_put(w, (uint8_t)s->chart, 1);
        for (int k = 0; k < 4; k++)
            tc_put(w, (uint8_t)s->m[k], 1);
        tc_put(w, (uint64_t)s->dx, 8), tc_put(w, (uint64_t)s->dy, 8);
    }
    tc_put(w, head, 4);
}

tc_status tc_envelope_write(const tc_envelope *e, tc_byte_writer *w)
{
    tc_byte_writer heads = {0};
    size_t size[TC_MOST_CHARTS], start = w->size;
    const bool faces = tc_kind_faces(e->chart[0].kind) != NULL;
    tc_status status = TC_OK;
    for (int n = 0; n < e->charts && !status; n++) {
        tc_container alone = e->chart[n].container; /* as it stands in the file, where it knows of no other */
        alone.info.charts = 1;
        if (faces)
            alone.info.terrain.radius = 0;
        size_t before = heads.size;
        status = tc_container_write(&alone, &heads);
        size[n] = heads.size - before;
    }
    tc_head_begin(w, TC_ENVELOPE_VERSION);
    tc_put(w, (uint64_t)e->bytes, 8);
    const tc_container *first = &e->chart[0].container;
    const double flattening = first->info.terrain.flattening;
    const char *credits = first->info.terrain.credits;
    tc_put(w, (uint64_t)e->charts, 1);
    tc_put(w, (first->synthesis ? 1 : 0) + (flattening > 0 ? 1 : 0) + faces + e->errors + (credits ? 1 : 0), 2);
    for (int n = 0; n < e->charts && !status; n++)
        write_chart(&e->chart[n], size[n], w);
    if (first->synthesis) {
        tc_put(w, SECTION_SYNTHESIS, 4), tc_put(w, TC_SYNTHESIS_BYTES, 4);
        tc_synthesis_put(first->synthesis, w);
    }
    if (flattening > 0)
        tc_put(w, SECTION_BODY, 4), tc_put(w, BODY_BYTES, 4), tc_put_f64(w, flattening);
    if (faces)
        write_faces(first, w);
    if (e->errors)
        write_errors(e, w);
    if (credits)
        write_credits(credits, w);
    tc_put_bytes(w, heads.bytes, heads.size);
    free(heads.bytes);
    return status || heads.failed ? TC_ERR_MEMORY : tc_head_seal(w, start);
}

/* What the table says of a chart, beside its container. */
typedef struct table_row {
    int64_t width, height, first, bytes;
    int levels;
    size_t head;
} table_row;

static bool read_chart(tc_envelope_chart *c, table_row *row, int charts, tc_byte_reader *r)
{
    bool bad = false;
    unsigned kind = (unsigned)tc_get(r, 1);
    bad |= kind >= TC_CHART_KINDS;
    c->kind = bad ? TC_CHART_PLANE : (tc_chart_kind)kind;
    c->x0 = tc_get_f64(r), c->y0 = tc_get_f64(r), c->dx = tc_get_f64(r), c->dy = tc_get_f64(r);
    row->width = (int64_t)tc_get(r, 8), row->height = (int64_t)tc_get(r, 8), row->levels = (int)tc_get(r, 1);
    row->first = (int64_t)tc_get(r, 8), row->bytes = (int64_t)tc_get(r, 8);
    for (int side = 0; side < TC_SIDES; side++) {
        tc_seam *s = &c->side[side];
        s->chart = (int8_t)(uint8_t)tc_get(r, 1);
        for (int k = 0; k < 4; k++) {
            s->m[k] = (int8_t)(uint8_t)tc_get(r, 1);
            bad |= s->m[k] < -2 || s->m[k] > 2;
        }
        s->dx = (int64_t)tc_get(r, 8), s->dy = (int64_t)tc_get(r, 8);
        bad |= s->chart < -1 || s->chart >= charts;
        bad |= s->chart >= 0 && abs(s->m[0] * s->m[3] - s->m[1] * s->m[2]) != 1; /* a turn, a mirroring, a shear */
    }
    row->head = (size_t)tc_get(r, 4);
    return !bad && !r->failed;
}

static bool same_seams(const tc_envelope_chart *a, const tc_envelope_chart *b)
{
    for (int side = 0; side < TC_SIDES; side++) {
        const tc_seam *s = &a->side[side], *t = &b->side[side];
        if (s->chart != t->chart || s->dx != t->dx || s->dy != t->dy || memcmp(s->m, t->m, sizeof s->m) != 0)
            return false;
    }
    return true;
}

/* Whether all levels together fit into the file behind its head, so that sums of their sizes are safe. */
static bool check_sizes(const tc_envelope *e, size_t head_size)
{
    int64_t left = e->bytes - (int64_t)head_size;
    for (int n = 0; n < e->charts; n++) {
        const tc_container *c = &e->chart[n].container;
        for (int l = c->base; l < c->levels; l++) {
            const tc_level_record *r = &c->record[l];
            tc_pages pages = tc_level_pages(&c->level[l]);
            if (r->begin < 0 || r->end < r->begin || r->end - r->begin > left ||
                r->end - r->begin < tc_directory_bytes(&pages))
                return false;
            left -= r->end - r->begin;
        }
    }
    return true;
}

/* Whether a chart and its row of the table are as they must be: `own` is what follows from the containers. */
static bool check_chart(const tc_envelope *e, int n, const tc_envelope_chart *own, const table_row *row)
{
    const tc_envelope_chart *chart = &e->chart[n];
    const tc_container *c = &chart->container;
    int64_t first, bytes;
    extent_of(c, &first, &bytes);
    for (int l = c->base; l < c->levels; l++)
        if (own->container.record[l].begin != c->record[l].begin || own->container.record[l].end != c->record[l].end)
            return false;
    return own->kind == chart->kind && own->x0 == chart->x0 && own->y0 == chart->y0 && own->dx == chart->dx &&
           own->dy == chart->dy && same_seams(own, chart) && row->width == c->info.terrain.width &&
           row->height == c->info.terrain.height && row->levels == c->levels && row->first == first &&
           row->bytes == bytes && c->info.bytes == e->bytes;
}

/* Whether the table says what follows from the containers, and all levels lie where they must; rank_end then is set.
 * TC_ERR_FORMAT, TC_ERR_MEMORY. */
static tc_status check(tc_envelope *e, const table_row *row, size_t head_size)
{
    if (!check_sizes(e, head_size))
        return TC_ERR_FORMAT;
    tc_envelope *own = malloc(sizeof *own);
    if (!own)
        return TC_ERR_MEMORY;
    *own = *e; /* borrows the containers' memory */
    tc_envelope_place(own);
    tc_envelope_lay_out(own, head_size);
    bool good = own->bytes == e->bytes;
    for (int n = 0; good && n < e->charts; n++)
        good = check_chart(e, n, &own->chart[n], &row[n]);
    memcpy(e->rank_end, own->rank_end, sizeof e->rank_end);
    free(own);
    return good ? TC_OK : TC_ERR_FORMAT;
}

/* All of one atlas, of one size, on one lattice of levels. */
static bool known_faces(const tc_envelope *e)
{
    const tc_container *first = &e->chart[0].container;
    const tc_pack_terrain *t = &first->info.terrain;
    if (e->charts != tc_kind_faces(e->chart[0].kind)->charts || t->width < 2 || !(t->radius > 0))
        return false;
    for (int n = 0; n < e->charts; n++) {
        const tc_container *c = &e->chart[n].container;
        const tc_pack_terrain *f = &c->info.terrain;
        if (e->chart[n].kind != e->chart[0].kind || f->wraps_x || f->width != t->width || f->height != t->width ||
            f->z_base != t->z_base || (n > 0 && f->radius != 0) || f->voids != t->voids)
            return false;
    }
    return true;
}

/* Charts that this version knows: a plane; longitude and latitude, with two caps or none, which fit it. */
static bool known_charts(const tc_envelope *e)
{
    const tc_pack_terrain *t = &e->chart[0].container.info.terrain;
    tc_lonlat globe;
    if (tc_kind_faces(e->chart[0].kind))
        return known_faces(e);
    if (e->charts == 1)
        return true;
    if (e->charts != 1 + TC_CAP_CHARTS || !(t->radius > 0) || !tc_terrain_globe(t, &globe) || !globe.poles)
        return false;
    for (int n = 1; n < e->charts; n++) {
        const tc_pack_terrain *cap = &e->chart[n].container.info.terrain;
        if (cap->radius != 0 || cap->wraps_x || cap->width != cap->height || cap->width % 2 == 0 ||
            cap->z_base != t->z_base)
            return false;
    }
    return true;
}

/* A section of the head; one of a kind that this version does not know is passed over. False: there are two of a kind.
 */
static bool read_section(tc_byte_reader *r, tc_byte_reader section[KNOWN_SECTIONS])
{
    const unsigned kind = (unsigned)tc_get(r, 4);
    const size_t size = (size_t)tc_get(r, 4);
    const uint8_t *bytes = tc_get_bytes(r, size);
    if (kind < SECTION_SYNTHESIS || kind >= KNOWN_SECTIONS || !bytes)
        return true;
    bool first = !section[kind].at;
    section[kind] = (tc_byte_reader){bytes, bytes + size, false};
    return first;
}

/* Of a planet that is no sphere. */
static tc_status keep_body(tc_byte_reader section, tc_container *c)
{
    if (!section.at)
        return TC_OK;
    const double flattening = tc_get_f64(&section);
    if (section.failed || section.at != section.end || !(flattening > 0 && flattening < 1) ||
        !(c->info.terrain.radius > 0))
        return TC_ERR_FORMAT;
    c->info.terrain.flattening = flattening;
    return TC_OK;
}

/* Whose the heights are. */
static tc_status keep_credits(tc_byte_reader section, tc_container *c)
{
    if (!section.at)
        return TC_OK;
    const size_t length = (size_t)(section.end - section.at);
    if (length == 0 || length > TC_CREDITS_BYTES || memchr(section.at, 0, length))
        return TC_ERR_FORMAT;
    c->info.terrain.credits = strndup((const char *)section.at, length);
    return c->info.terrain.credits ? TC_OK : TC_ERR_MEMORY;
}

/* Of faces: before what the first one's container is checked for. */
static tc_status keep_faces(tc_byte_reader section, tc_envelope *e)
{
    tc_container *c = &e->chart[0].container;
    tc_face_source *s = &c->source;
    const bool faces = tc_kind_faces(e->chart[0].kind) != NULL;
    if (!section.at || !faces)
        return faces || section.at ? TC_ERR_FORMAT : TC_OK;
    const double radius = tc_get_f64(&section);
    s->width = (int64_t)tc_get(&section, 8), s->height = (int64_t)tc_get(&section, 8);
    bool bad = c->info.terrain.radius != 0 || c->info.terrain.georef.known;
    for (int i = 0; i < 6; i++) {
        s->transform[i] = tc_get_f64(&section);
        bad |= !isfinite(s->transform[i]);
    }
    s->rms = tc_get_f64(&section), s->max = tc_get_f64(&section);
    for (; !section.failed && section.at != section.end && s->ranks < c->levels; s->ranks++) {
        s->apart[s->ranks] = tc_get_f32(&section);
        bad |= !(s->apart[s->ranks] >= 0 && s->apart[s->ranks] <= 1e20f);
    }
    const int64_t most = (int64_t)1 << 40;
    bad |= section.failed || section.at != section.end || !(radius > 0) || !isfinite(radius) || s->width < 1 ||
           s->height < 1 || s->width > most || s->height > most || !(s->rms >= 0) || !(s->max >= s->rms) ||
           !isfinite(s->max);
    c->info.terrain.radius = bad ? 0 : radius;
    tc_georef placed = {.known = true, .geographic = true};
    memcpy(placed.transform, s->transform, sizeof placed.transform);
    tc_lonlat globe;
    return bad || !tc_lonlat_of(&placed, s->width, s->height, &globe) || !globe.poles ? TC_ERR_FORMAT : TC_OK;
}

/* Of a later form the file counts as one without. */
static tc_status keep_synthesis(const tc_byte_reader *section, tc_container *c)
{
    tc_synthesis_fit fit;
    if (!section->at)
        return TC_OK;
    tc_status status = tc_synthesis_get(section->at, (size_t)(section->end - section->at), &fit);
    if (status)
        return status == TC_ERR_UNSUPPORTED ? TC_OK : status;
    c->synthesis = malloc(sizeof fit);
    if (!c->synthesis)
        return TC_ERR_MEMORY;
    *c->synthesis = fit, c->info.synthesis_fit = true;
    return TC_OK;
}

/* Whether errors lie where they must: chart by chart, behind the last level's tiles and up to the end of the file. The
 * container of that level takes note of how many bytes they have; without them it is whole. */
static bool place_errors(tc_envelope *e)
{
    const tc_level_record *r = record_of(e, last_chart(e), 0);
    tc_container *last = &e->chart[last_chart(e)].container;
    int64_t begin = 0, at = 0;
    for (int n = 0; n < e->charts; n++) {
        const tc_container *c = &e->chart[n].container;
        if (c->levels == c->base)
            continue;
        if (at > 0 && c->error[c->base].begin != at)
            return false;
        begin = begin > 0 ? begin : c->error[c->base].begin;
        at = c->error[c->levels - 1].begin + c->error[c->levels - 1].bytes;
    }
    if (!r)
        return true;
    const tc_pages pages = tc_level_pages(&last->level[last->levels - 1]);
    last->error_bytes = at - begin;
    e->rank_end[0] = begin;
    return begin >= r->begin + tc_directory_bytes(&pages) && at == e->bytes;
}

/* Likewise; once it is known that levels lie where they must. */
static tc_status keep_errors(tc_byte_reader section, tc_envelope *e)
{
    if (!section.at || tc_get(&section, 2) != ERRORS_FORM)
        return section.failed ? TC_ERR_FORMAT : TC_OK;
    for (int n = 0; n < e->charts; n++)
        if (!tc_error_places_get(&e->chart[n].container, e->bytes, &section))
            return TC_ERR_FORMAT;
    return section.at == section.end && place_errors(e) ? TC_OK : TC_ERR_FORMAT;
}

static tc_status fail_damaged(const char *subject, tc_error *error)
{
    return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: its head contradicts itself", subject);
}

static tc_status read_head(const char *subject, const uint8_t *bytes, size_t head_size, tc_envelope *e, tc_error *error)
{
    tc_byte_reader r = {bytes + TC_HEAD_FIXED, bytes + head_size, false};
    tc_byte_reader section[KNOWN_SECTIONS] = {{NULL, NULL, false}};
    table_row row[TC_MOST_CHARTS];
    e->bytes = (int64_t)tc_get(&r, 8);
    int charts = (int)tc_get(&r, 1), sections = (int)tc_get(&r, 2);
    if (r.failed || charts < 1 || sections > MOST_SECTIONS || e->bytes < (int64_t)head_size)
        return fail_damaged(subject, error);
    if (charts > TC_MOST_CHARTS)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected at most %d charts, found %d", subject, TC_MOST_CHARTS,
                       charts);
    for (int n = 0; n < charts; n++)
        if (!read_chart(&e->chart[n], &row[n], charts, &r))
            return fail_damaged(subject, error);
    for (int s = 0; s < sections; s++)
        if (!read_section(&r, section))
            return fail_damaged(subject, error);
    for (int n = 0; n < charts; n++) {
        const uint8_t *head = tc_get_bytes(&r, row[n].head);
        size_t needed;
        if (!head)
            return fail_damaged(subject, error);
        tc_container *c = &e->chart[n].container;
        tc_status status = tc_container_read_placed(subject, head, row[n].head, c, &needed, error);
        if (status)
            return status;
        e->charts++;
        if (needed != row[n].head || c->info.charts != 1)
            return fail_damaged(subject, error);
        c->info.charts = charts, c->info.version = TC_ENVELOPE_VERSION;
        c->kind = e->chart[n].kind;
        c->steps = true;
    }
    tc_status status = keep_faces(section[SECTION_FACES], e);
    if (status || r.failed || r.at != r.end || !known_charts(e))
        return fail_damaged(subject, error);
    status = keep_synthesis(&section[SECTION_SYNTHESIS], &e->chart[0].container);
    if (!status)
        status = keep_body(section[SECTION_BODY], &e->chart[0].container);
    if (!status)
        status = keep_credits(section[SECTION_CREDITS], &e->chart[0].container);
    if (!status)
        status = check(e, row, head_size);
    if (!status)
        status = keep_errors(section[SECTION_ERRORS], e);
    return status == TC_ERR_MEMORY ? tc_fail(error, status, "%s: not enough memory", subject)
           : status                ? fail_damaged(subject, error)
                                   : TC_OK;
}

tc_status tc_envelope_read(const char *subject, const uint8_t *bytes, size_t size, tc_envelope **envelope_ret,
                           size_t *head_size_ret, tc_error *error)
{
    *head_size_ret = 0;
    if (size < TC_HEAD_FIXED)
        return tc_fail(error, TC_ERR_FORMAT, "%s: cut short: expected a head, found %zu bytes", subject, size);
    tc_status status = tc_head_check(subject, bytes, size, head_size_ret, error);
    if (status)
        return status;
    tc_envelope *e = calloc(1, sizeof *e);
    if (!e)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", subject);
    status = read_head(subject, bytes, *head_size_ret, e, error);
    if (status == TC_OK)
        *envelope_ret = e;
    else
        tc_envelope_free(e);
    return status;
}

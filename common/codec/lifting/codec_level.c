/* codec_level.c - any rectangle of a level from its tiles. */
#include "codec_tile.h"

/* Positions whose details the rectangle depends on. */
static tc_rect detail_rect(const tc_codec *c, tc_rect rect)
{
    return tc_lifting_needs(&c->level, rect);
}

static int64_t floor_div(int64_t a, int64_t b)
{
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

tc_rect tc_codec_read_needs(const tc_codec *c, tc_rect rect)
{
    if (tc_rect_empty(rect))
        return rect;
    tc_rect d = detail_rect(c, rect);
    /* Whole tiles, each in the period of the level that it lies in. */
    int64_t first = floor_div(d.x0, c->cw) * c->cw, last = floor_div(d.x1 - 1, c->cw) * c->cw;
    tc_rect t = {first + (d.x0 - first) / TC_TILE * TC_TILE, d.y0 / TC_TILE * TC_TILE,
                 last + tc_min64(((d.x1 - 1 - last) / TC_TILE + 1) * TC_TILE, c->cw),
                 tc_min64(((d.y1 - 1) / TC_TILE + 1) * TC_TILE, c->ch)};
    return tc_codec_tile_needs(c, t);
}

/* Details are held for one row of tiles and the rows before it that the next fine rows still need; of narrow rectangles
 * for more, since the transform begins anew for each part. */
enum { KEPT = 2 * TC_LIFTING_REACH, STRIP = TC_TILE + KEPT, HELD = 1 << 13 };

static int64_t rows_held(tc_rect d)
{
    return tc_max64(STRIP, tc_min64(d.y1 - d.y0, HELD / (d.x1 - d.x0)));
}

size_t tc_codec_assemble_scratch(const tc_codec *c, tc_rect rect)
{
    if (tc_rect_empty(rect))
        return 0;
    tc_rect d = detail_rect(c, rect);
    return sizeof(int32_t) *
           (TC_BANDS * (size_t)(rows_held(d) * (d.x1 - d.x0)) + tc_lifting_synthesise_scratch(&c->level, rect));
}

/* Moves rows from `first` on to the front. */
static void let_go(tc_plane band[TC_BANDS], int64_t first)
{
    for (int b = 0; b < TC_BANDS; b++) {
        tc_rect r = band[b].rect;
        memmove(band[b].z, tc_plane_at(&band[b], r.x0, first),
                (size_t)((r.y1 - first) * band[b].stride) * sizeof(int32_t));
        band[b].rect.y0 = first;
    }
}

/* Details of row ty of tiles, down to row `end`, behind those that are there. */
static tc_status add_details(const tc_assembly *from, int64_t ty, int64_t end, tc_plane band[TC_BANDS])
{
    tc_plane more[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++) {
        tc_rect r = band[b].rect;
        more[b] = (tc_plane){tc_plane_at(&band[b], r.x0, r.y1), band[b].stride, {r.x0, r.y1, r.x1, end}};
        band[b].rect.y1 = end;
    }
    return from->details(from->context, ty, more);
}

tc_status tc_codec_assemble(const tc_codec *c, const tc_plane *coarse, const tc_assembly *from, const tc_plane *fine,
                            void *scratch, tc_simd simd)
{
    if (tc_rect_empty(fine->rect))
        return TC_OK;
    tc_rect d = detail_rect(c, fine->rect);
    int32_t *at = scratch;
    int64_t columns = d.x1 - d.x0, room = rows_held(d), y = fine->rect.y0, have = d.y0; /* rows done: fine, details */
    tc_plane band[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++, at += room * columns)
        band[b] = (tc_plane){at, columns, {d.x0, d.y0, d.x1, d.y0}};
    for (int64_t ty = d.y0 / TC_TILE; have < d.y1; ty++) {
        int64_t end = tc_min64((ty + 1) * TC_TILE, d.y1), next = tc_min64(end + TC_TILE, d.y1);
        if (end - band[0].rect.y0 > room)
            let_go(band, tc_max64(band[0].rect.y0, have - KEPT));
        tc_status status = add_details(from, ty, end, band);
        if (status)
            return status;
        have = end;
        if (have < d.y1 && next - band[0].rect.y0 <= room)
            continue;
        int64_t ready = have == d.y1 ? fine->rect.y1 : tc_min64(fine->rect.y1, 2 * (have - TC_LIFTING_REACH));
        for (int64_t last; y < ready; y = last) {
            last = from->made ? tc_min64(y + tc_codec_made_rows(fine->rect), ready) : ready;
            tc_plane part = {from->made ? fine->z : tc_plane_at(fine, fine->rect.x0, y), fine->stride, fine->rect};
            part.rect.y0 = y, part.rect.y1 = last;
            tc_lifting_synthesise(&c->level, coarse, band, &part, at, simd);
            if (from->made)
                from->made(from->context, &part);
        }
    }
    return TC_OK;
}

/* ---- Of tiles from anywhere -------------------------------------------------------------------------------------- */

size_t tc_codec_read_scratch(const tc_codec *c, tc_rect rect)
{
    return tc_rect_empty(rect) ? 0 : sizeof(tc_tile_work) + tc_codec_assemble_scratch(c, rect);
}

/* What reading goes by. */
typedef struct reading {
    const tc_codec *codec;
    const tc_plane *coarse;
    tc_tile_source source;
    void *context;
    tc_tile_work *work;
    int64_t *damaged;
    tc_simd simd;
} reading;

/* Decodes the tiles of row ty that reach into the bands. */
static tc_status decode_row(void *context, int64_t ty, const tc_plane band[TC_BANDS])
{
    const reading *r = context;
    const tc_codec *c = r->codec;
    tc_rect d = band[0].rect;
    for (int64_t shift = floor_div(d.x0, c->cw) * c->cw; shift < d.x1; shift += c->cw) {
        int64_t tx0 = tc_max64(d.x0 - shift, 0) / TC_TILE, tx1 = (tc_min64(d.x1 - shift, c->cw) - 1) / TC_TILE;
        for (int64_t tx = tx0; tx <= tx1; tx++) {
            const uint8_t *bytes = NULL;
            size_t size = 0;
            tc_status status = r->source(r->context, tx, ty, &bytes, &size);
            if (status)
                return status;
            status = tc_codec_decode_tile(c, tx, ty, shift, bytes, size, r->coarse, band, r->work, r->simd);
            if (status == TC_ERR_FORMAT && r->damaged)
                ++*r->damaged;
        }
    }
    return TC_OK;
}

tc_status tc_codec_read(const tc_codec *c, const tc_plane *coarse, tc_tile_source source, void *context,
                        const tc_plane *fine, void *scratch, int64_t *damaged, tc_simd simd)
{
    tc_tile_work *work = scratch;
    reading r = {c, coarse, source, context, work, damaged, simd};
    return tc_codec_assemble(c, coarse, &(tc_assembly){decode_row, NULL, &r}, fine, work + 1, simd);
}

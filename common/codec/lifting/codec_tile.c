/* codec_tile.c - decoding a tile.
 *
 * A tile's bytes: one byte of flags (bit b: band b is coded; bits 3-4: 0 for 4 lanes, 1 for 8, 2 for 16), a rANS
 * stream (rans.h), and raw bits, low ones first. The symbols (magnitudes) come band after band, row after row, even
 * columns before odd ones; a run of a phase starts on lane 0. Raw bits hold what contexts do not need: for every run
 * the low bits of magnitudes and what escapes add, then the signs of all that is not zero. The first 16 raw bits of
 * each lane travel in its state. Nothing is left over at the end, and no raw bit behind the last one is set. */
#include "codec_tile.h"

#include "codec_symbols.h"
#include "codec_values.h"

/* The part of a tile's row that a plane holds. */
TC_INLINE void put_row(const tc_plane *p, tc_rect part, tc_rect tile, int j, const int32_t row[TC_TILE])
{
    int64_t y = tile.y0 + j;
    if (y >= part.y0 && y < part.y1)
        memcpy(tc_plane_at(p, part.x0, y), row + (part.x0 - tile.x0), (size_t)(part.x1 - part.x0) * sizeof *row);
}

/* Details of the tile from predictions and, where raw is not NULL, what was decoded. */
TC_INLINE void reconstruct(const tc_codec *c, tc_raw_reader *raw, int coded, tc_rect tile, int64_t shift,
                           const tc_plane band[TC_BANDS], tc_tile_work *w, bool simd)
{
    tc_rect part = tc_rect_intersect(tile, band[0].rect);
    tc_predict_hl(c, w, TC_TILE, TC_TILE);
    int columns, rows;
    tc_tile_extent(c, TC_HL, tile, shift, &columns, &rows);
    for (int j = 0; j < rows && coded >> TC_HL & 1; j++)
        tc_add_row(c, raw, TC_HL, j, w, &w->hl[j + 1][HL_X], simd);
    tc_predict_lh(c, w, TC_TILE, TC_TILE);
    tc_tile_extent(c, TC_LH, tile, shift, &columns, &rows);
    for (int j = 0; j < rows && coded >> TC_LH & 1; j++)
        tc_add_row(c, raw, TC_LH, j, w, w->pred[j], simd);
    for (int j = 0; j < TC_TILE && !tc_rect_empty(part); j++) {
        put_row(&band[TC_HL], part, tile, j, &w->hl[j + 1][HL_X]);
        put_row(&band[TC_LH], part, tile, j, w->pred[j]);
    }
    tc_tile_extent(c, TC_HH, tile, shift, &columns, &rows);
    for (int j = 0; j < TC_TILE; j++) {
        int32_t row[TC_TILE] = {0};
        if (j < rows && coded >> TC_HH & 1)
            tc_add_row(c, raw, TC_HH, j, w, row, simd);
        if (!tc_rect_empty(part))
            put_row(&band[TC_HH], part, tile, j, row);
    }
}

/* Starts a tile: what its contexts need, and its stream. */
TC_INLINE void begin_tile(const tc_codec *c, const tc_tile_job *job, const tc_plane *coarse, tc_tile_state *t,
                          bool simd)
{
    t->rect = tc_codec_tile_rect(c, job->tx, job->ty, job->shift);
    t->shift = job->shift, t->w = job->work, t->coded = 0, t->status = TC_OK;
    tc_tile_load(c, t->rect, TC_TILE, coarse, t->w);
    if (job->size == 0)
        return;
    int flags = job->bytes[0], lanes = 4 << (flags >> TC_TILE_LANES & 3);
    if (flags % (1 << TC_TILE_LANES) == 0 || flags >= 3 << TC_TILE_LANES ||
        !tc_rans_decode_begin(&t->rans, lanes, job->bytes + 1, job->size - 1)) {
        t->status = TC_ERR_FORMAT;
        return;
    }
    t->coded = flags % (1 << TC_TILE_LANES);
    memset(t->w->magnitude, 0, sizeof t->w->magnitude);
#if TC_AVX2
    if (simd)
        tile_curves_avx2(c, t->w);
    else
#endif
        tc_tile_curves(c, t->w);
    (void)simd;
}

/* Details, once all symbols are there; those of the empty tile where the bytes are damaged. */
TC_INLINE tc_status end_tile(const tc_codec *c, const tc_plane band[TC_BANDS], tc_tile_state *t, bool simd)
{
    if (t->coded) {
        t->raw = (tc_raw_reader){
            .at = t->payload, .end = t->payload + 2 * t->rans.lanes, .next = t->rans.at, .next_end = t->rans.end};
        if (!tc_rans_decode_end(&t->rans, t->payload))
            t->coded = 0, t->status = TC_ERR_FORMAT;
    }
    for (;;) {
        reconstruct(c, t->coded ? &t->raw : NULL, t->coded, t->rect, t->shift, band, t->w, simd);
        if (!t->coded || tc_raw_finished(&t->raw))
            return t->status;
        t->coded = 0, t->status = TC_ERR_FORMAT; /* once more */
    }
}

/* The same code for processors with AVX2 and without. */
#if TC_AVX2
TC_TARGET_AVX2 static __attribute__((noinline)) void begin_tile_avx2(const tc_codec *c, const tc_tile_job *job,
                                                                     const tc_plane *coarse, tc_tile_state *t)
{
    begin_tile(c, job, coarse, t, true);
}

TC_TARGET_AVX2 static __attribute__((noinline)) tc_status end_tile_avx2(const tc_codec *c,
                                                                        const tc_plane band[TC_BANDS], tc_tile_state *t)
{
    return end_tile(c, band, t, true);
}

TC_TARGET_AVX2 static void decode_tiles_avx2(const tc_codec *c, tc_tile_job job[], int count, const tc_plane *coarse)
{
    tc_tile_state t[TC_TOGETHER];
    for (int n = 0; n < count; n++)
        begin_tile_avx2(c, &job[n], coarse, &t[n]);
    tc_decode_symbols(c, TC_HL, t, count, true);
    tc_decode_symbols(c, TC_LH, t, count, true);
    tc_decode_symbols(c, TC_HH, t, count, true);
    for (int n = 0; n < count; n++)
        job[n].status = end_tile_avx2(c, job[n].band, &t[n]);
}
#endif

static void decode_tile(const tc_codec *c, tc_tile_job *job, const tc_plane *coarse)
{
    tc_tile_state t;
    begin_tile(c, job, coarse, &t, false);
    tc_decode_symbols(c, TC_HL, &t, 1, false);
    tc_decode_symbols(c, TC_LH, &t, 1, false);
    tc_decode_symbols(c, TC_HH, &t, 1, false);
    job->status = end_tile(c, job->band, &t, false);
}

void tc_codec_decode_tiles(const tc_codec *codec, tc_tile_job job[], int count, const tc_plane *coarse, tc_simd simd)
{
#if TC_AVX2
    if (simd == TC_SIMD_AUTO && tc_have_avx2()) {
        decode_tiles_avx2(codec, job, count, coarse);
        return;
    }
#endif
    (void)simd;
    for (int n = 0; n < count; n++)
        decode_tile(codec, &job[n], coarse);
}

tc_status tc_codec_decode_tile(const tc_codec *codec, int64_t tx, int64_t ty, int64_t shift, const uint8_t *bytes,
                               size_t size, const tc_plane *coarse, const tc_plane band[TC_BANDS], tc_tile_work *work,
                               tc_simd simd)
{
    tc_tile_job job = {tx, ty, shift, bytes, size, band, work, TC_OK};
    tc_codec_decode_tiles(codec, &job, 1, coarse, simd);
    return job.status;
}

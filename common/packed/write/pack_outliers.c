/* pack_outliers.c - how much of a level's square error corrections to a bound will take off, foreseen from a sample of
 * its tiles: few heights are beyond the bound, but on rough terrain they have a good part of the error. */
#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_level.h"

typedef struct trial {
    const tc_sample *sample;
    const tc_level_coder *coder;
    int32_t bound;
    double before[TC_SAMPLE_TILES], after[TC_SAMPLE_TILES]; /* square errors */
    tc_status status[TC_SAMPLE_TILES];
} trial;

typedef struct trial_memory {
    void *work;
    uint8_t *bytes;
    int32_t *details, *fine, *scratch;
} trial_memory;

static bool reserve(trial_memory *m, size_t scratch)
{
    m->work = malloc(tc_level_coder_work_bytes());
    m->bytes = malloc(tc_codec_tile_bound());
    m->details = malloc((size_t)TC_TILE_SYMBOLS * sizeof *m->details);
    m->fine = malloc((size_t)TC_TILE_SIDE * TC_TILE_SIDE * sizeof *m->fine);
    m->scratch = malloc(scratch * sizeof *m->scratch);
    return m->work && m->bytes && m->details && m->fine && m->scratch;
}

static void release(trial_memory *m)
{
    free(m->work), free(m->bytes), free(m->details), free(m->fine), free(m->scratch);
}

/* Heights of a tile's inside, which its own details give. */
static tc_status decoded_again(const trial *t, const tc_training_tile *tile, const tc_plane *fine, trial_memory *m)
{
    const tc_codec *codec = t->coder->codec;
    tc_plane detail[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        detail[b] = (tc_plane){m->details + b * TC_TILE * TC_TILE, TC_TILE, tile->band[0].rect};
    size_t size = 0;
    tc_status status = tc_codec_encode_tile(codec, tile->tx, tile->ty, &tile->coarse, tile->band,
                                            &(tc_encode_options){0}, m->bytes, &size, m->work);
    if (!status)
        status = tc_codec_decode_tile(codec, tile->tx, tile->ty, 0, m->bytes, size, &tile->coarse, detail, m->work,
                                      TC_SIMD_AUTO);
    if (!status)
        tc_lifting_synthesise(&t->coder->level, &tile->coarse, detail, fine, m->scratch, TC_SIMD_AUTO);
    return status;
}

static void try_tile(void *context, int64_t n)
{
    trial *t = context;
    const tc_training_tile *tile = &t->sample->tile[n];
    tc_rect p = tile->band[0].rect;
    tc_rect r = {2 * (p.x0 + TC_LIFTING_REACH), 2 * (p.y0 + TC_LIFTING_REACH), 2 * (p.x1 - TC_LIFTING_REACH),
                 2 * (p.y1 - TC_LIFTING_REACH)};
    t->before[n] = t->after[n] = 0, t->status[n] = TC_OK;
    if (r.x1 <= r.x0 || r.y1 <= r.y0)
        return;
    trial_memory m = {0};
    bool good = reserve(&m, tc_lifting_synthesise_scratch(&t->coder->level, r));
    tc_plane fine = {m.fine, r.x1 - r.x0, r};
    t->status[n] = good ? decoded_again(t, tile, &fine, &m) : TC_ERR_MEMORY;
    for (int64_t y = r.y0; y < r.y1 && !t->status[n]; y++) {
        const int32_t *z = tc_plane_at(&fine, r.x0, y), *truth = tc_plane_at(&t->sample->fine[n], r.x0, y);
        for (int64_t i = 0; i < r.x1 - r.x0; i++) {
            double off = (double)z[i] - truth[i];
            double left =
                tc_corrected(t->coder, z[i], tc_pack_correction(t->coder, z[i], truth[i], t->bound)) - (double)truth[i];
            t->before[n] += off * off, t->after[n] += left * left;
        }
    }
    release(&m);
}

tc_status tc_pack_left_by_corrections(tc_coding *coding, int l, const tc_sample *sample, int32_t bound, int32_t lattice,
                                      double *left_ret, tc_error *error)
{
    tc_packer *p = coding->p;
    tc_level_coder coder = {0};
    double before = 0, after = 0;
    tc_coding_correct(coding, l, bound, lattice);
    tc_status status = tc_level_coder_init(&coder, &sample->level, &p->container.record[l - 1]);
    trial t = {.sample = sample, .coder = &coder, .bound = bound};
    if (!status)
        tc_parallel_for(p->options.threads, sample->count, try_tile, &t);
    for (int n = 0; n < sample->count && !status; n++)
        status = t.status[n], before += t.before[n], after += t.after[n];
    tc_level_coder_free(&coder);
    if (status)
        return tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
    *left_ret = before > 0 && after > 0 ? after / before : 1;
    return TC_OK;
}

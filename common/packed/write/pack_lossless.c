/* pack_lossless.c - about how many bytes a terrain would take without loss, from a sample of the finest level's tiles
 * that is coded so: for those who are told what a loss comes to. */
#include <math.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "pack_internal.h"

enum { TILES = TC_SAMPLE_TILES, TRAINED = 8 };

typedef struct pricing {
    tc_exact *codec;
    tc_exact_tile tile[TILES];
    int64_t bytes[TILES];
    tc_status status[TILES];
} pricing;

/* Heights of another origin, which makes them multiples of `step`; those filled in under voids are made such. False:
 * no memory. */
static bool copy_shifted(const tc_plane *from, int32_t shift, int32_t step, tc_plane *to)
{
    int64_t w = from->rect.x1 - from->rect.x0;
    *to = (tc_plane){malloc((size_t)tc_rect_area(from->rect) * sizeof *to->z), w, from->rect};
    for (int64_t y = from->rect.y0; y < from->rect.y1 && to->z; y++) {
        const int32_t *z = tc_plane_at(from, from->rect.x0, y);
        int32_t *out = tc_plane_at(to, from->rect.x0, y);
        for (int64_t i = 0; i < w; i++)
            out[i] = step * (int32_t)lrint((double)(z[i] - shift) / step);
    }
    return to->z;
}

static void price_tile(void *context, int64_t n)
{
    pricing *p = context;
    const tc_exact_tile *t = &p->tile[n];
    size_t size = 0;
    tc_exact_work *work = malloc(tc_exact_work_bytes());
    uint8_t *bytes = malloc(tc_exact_tile_bound());
    p->status[n] = work && bytes
                       ? tc_exact_encode_tile(p->codec, t->tx, t->ty, &t->coarse, &t->fine, bytes, &size, work)
                       : TC_ERR_MEMORY;
    p->bytes[n] = (int64_t)size;
    free(work), free(bytes);
}

/* A model from some of the tiles, spread over all of them: training takes longer than coding. */
static tc_status learn(const pricing *all, const tc_sample *sample, int count, int32_t step, int threads,
                       tc_exact_model *model)
{
    tc_exact_tile tile[TRAINED];
    int trained = (int)tc_min64(count, TRAINED);
    for (int n = 0; n < trained; n++)
        tile[n] = all->tile[n * count / trained];
    return tc_exact_train(&sample->level, tile, trained, step, threads, model);
}

static tc_status price(pricing *all, const tc_sample *sample, int count, int32_t step, int threads, double *bytes_ret)
{
    tc_exact_model *model = malloc(sizeof *model);
    uint8_t *header = malloc(tc_exact_model_bound());
    all->codec = malloc(sizeof *all->codec);
    tc_status status = model && header && all->codec ? TC_OK : TC_ERR_MEMORY;
    if (!status)
        status = learn(all, sample, count, step, threads, model);
    double bytes = 0, samples = 0;
    if (!status) {
        tc_exact_init(all->codec, &sample->level, model);
        tc_parallel_for(threads, count, price_tile, all);
        for (int n = 0; n < count && !status; n++) {
            tc_rect r = tc_exact_tile_rect(all->codec, all->tile[n].tx, all->tile[n].ty);
            status = all->status[n], bytes += (double)all->bytes[n], samples += (double)tc_rect_area(r);
        }
        *bytes_ret = bytes / fmax(samples, 1) * (double)sample->level.width * (double)sample->level.height +
                     (double)tc_exact_model_write(model, header);
    }
    free(model), free(header), free(all->codec);
    return status;
}

void tc_pack_price_lossless(tc_packer *p, const tc_sample *sample)
{
    const tc_container *c = &p->container;
    double origin = 0, lattice = tc_pack_lattice(p, &origin), step = lattice / c->z_unit;
    double shift = (origin - c->z_origin) / c->z_unit;
    p->result.lossless_bytes = 0;
    if (!(step >= 1) || step != rint(step) || step > TC_MAX_STEP || shift != rint(shift))
        return;
    pricing all = {0};
    int count = sample->count;
    bool good = true;
    for (int n = 0; n < count; n++) {
        const tc_training_tile *t = &sample->tile[n];
        all.tile[n].tx = t->tx, all.tile[n].ty = t->ty;
        good &= copy_shifted(&t->coarse, (int32_t)fmod(shift, step), 1, &all.tile[n].coarse);
        good &= copy_shifted(&sample->fine[n], (int32_t)fmod(shift, step), (int32_t)step, &all.tile[n].fine);
    }
    double bytes = 0;
    if (good && !price(&all, sample, count, (int32_t)step, p->options.threads, &bytes))
        p->result.lossless_bytes = (int64_t)bytes + p->body_size;
    for (int n = 0; n < count; n++)
        free(all.tile[n].coarse.z), free(all.tile[n].fine.z);
}

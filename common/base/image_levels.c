/* image_levels.c - a cascade: two rows of a level make one of the next. */
#include "image_levels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rect.h"
#include "srgb.h"
#include "status.h"

int tc_image_sizes(int64_t width, int64_t height, int64_t least, tc_image_size size_ret[TC_IMAGE_LEVELS])
{
    int levels = 0;
    for (;; width = (width + 1) / 2, height = (height + 1) / 2) {
        size_ret[levels++] = (tc_image_size){width, height};
        if ((width <= least && height <= least) || levels == TC_IMAGE_LEVELS)
            return levels;
    }
}

typedef struct cascade {
    int levels;
    const tc_image_size *size;
    const tc_srgb *srgb;
    uint8_t (*row[TC_IMAGE_LEVELS])[4];   /* of level k > 0: the one that was just made */
    uint8_t (*first[TC_IMAGE_LEVELS])[4]; /* of a pair, waiting for the second */
    int64_t count[TC_IMAGE_LEVELS];       /* rows so far */
    tc_image_row_function give;
    void *context;
} cascade;

/* A pixel from four, weighed by their alpha. */
static void merge(const tc_srgb *t, const uint8_t *p[4], uint8_t out[4])
{
    int alpha = p[0][3] + p[1][3] + p[2][3] + p[3][3];
    out[3] = (uint8_t)((alpha + 2) / 4);
    if (alpha == 0) {
        memcpy(out, p[0], 3);
        return;
    }
    const float weight = 1 / (float)alpha;
    for (int k = 0; k < 3; k++) {
        float sum = 0;
        if (p[0][k] == p[1][k] && p[1][k] == p[2][k] && p[2][k] == p[3][k]) { /* nothing is rounded */
            out[k] = p[0][k];
            continue;
        }
        for (int i = 0; i < 4; i++)
            sum += (float)p[i][3] * t->linear[p[i][k]];
        out[k] = tc_srgb_shown(t, sqrtf(sum * weight));
    }
}

static void halve(const tc_srgb *t, const uint8_t (*a)[4], const uint8_t (*b)[4], int64_t width, uint8_t (*out)[4])
{
    for (int64_t i = 0; i < (width + 1) / 2; i++) {
        int64_t right = tc_min64(2 * i + 1, width - 1);
        const uint8_t *p[4] = {a[2 * i], a[right], b[2 * i], b[right]};
        merge(t, p, out[i]);
    }
}

/* Row after row of a level, and of those that follow from it. */
static tc_status push(cascade *c, int level, uint8_t (*row)[4], tc_error *error)
{
    for (tc_status status;; row = c->row[++level]) {
        int64_t y = c->count[level]++, width = c->size[level].width;
        if ((status = c->give(c->context, level, y, row, error)) || level + 1 == c->levels)
            return status;
        bool last = y + 1 == c->size[level].height;
        if (y % 2 == 0 && !last) {
            memcpy(c->first[level], row, (size_t)width * 4);
            return TC_OK;
        }
        halve(c->srgb, (const uint8_t(*)[4])(y % 2 ? c->first[level] : row), (const uint8_t(*)[4])row, width,
              c->row[level + 1]);
    }
}

static tc_status run(cascade *c, tc_image_rows *rows, uint8_t (*band)[4], int64_t most,
                     bool (*progress)(void *, double), void *progress_context, tc_error *error)
{
    tc_status status = TC_OK;
    for (int64_t y = 0; y < rows->height && !status; y += most) {
        int64_t count = tc_min64(most, rows->height - y);
        status = rows->read(rows, y, count, band, error);
        for (int64_t j = 0; j < count && !status; j++)
            status = push(c, 0, band + j * rows->width, error);
        if (!status && progress && !progress(progress_context, (double)(y + count) / (double)rows->height))
            status = tc_fail(error, TC_ERR_IO, "%s: interrupted", rows->name);
    }
    return status;
}

tc_status tc_image_make_levels(tc_image_rows *rows, int levels, const tc_image_size *size, tc_image_row_function give,
                               void *context, bool (*progress)(void *, double), void *progress_context, tc_error *error)
{
    enum { BAND_PIXELS = 1 << 20 };
    cascade c = {.levels = levels, .size = size, .srgb = tc_srgb_tables(), .give = give, .context = context};
    int64_t most = tc_clamp64(BAND_PIXELS / rows->width, 1, rows->height);
    uint8_t(*band)[4] = malloc((size_t)(most * rows->width) * 4);
    bool room = band != NULL;
    for (int k = 0; k + 1 < levels && room; k++) {
        c.first[k] = malloc((size_t)size[k].width * 4);
        c.row[k + 1] = malloc((size_t)size[k + 1].width * 4);
        room = c.first[k] && c.row[k + 1];
    }
    tc_status status = room ? run(&c, rows, band, most, progress, progress_context, error)
                            : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for rows of it", rows->name);
    for (int k = 0; k + 1 < levels; k++)
        free(c.first[k]), free(c.row[k + 1]);
    free(band);
    return status;
}

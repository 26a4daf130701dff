/* image_levels.c - a cascade: two rows of a level make one of the next. */
#include "image_levels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rect.h"
#include "srgb.h"
#include "status.h"

enum {
    BAND_PIXELS = 1 << 20, /* that are read at once, about */
    HALF_PIXELS = 24 << 20 /* of rows of level 1 that wait for the rest of their parts, at most */
};

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
    const tc_image_making *m;
    const tc_srgb *srgb;
    uint8_t (*row[TC_IMAGE_LEVELS])[4];   /* of level k > 0: the one that was just made */
    uint8_t (*first[TC_IMAGE_LEVELS])[4]; /* of a pair, waiting for the second */
    int64_t count[TC_IMAGE_LEVELS];       /* rows so far */
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
    const tc_image_making *m = c->m;
    for (;; row = c->row[++level]) {
        int64_t y = c->count[level]++, width = m->size[level].width;
        tc_status status = level >= m->first ? m->give(m->context, level, y, row, error) : TC_OK;
        if (status || level + 1 == m->levels)
            return status;
        bool last = y + 1 == m->size[level].height;
        if (y % 2 == 0 && !last) {
            memcpy(c->first[level], row, (size_t)width * 4);
            return TC_OK;
        }
        halve(c->srgb, (const uint8_t(*)[4])(y % 2 ? c->first[level] : row), (const uint8_t(*)[4])row, width,
              c->row[level + 1]);
    }
}

static tc_status tell(const cascade *c, const tc_image_rows *rows, int64_t done, tc_error *error)
{
    const tc_image_making *m = c->m;
    if (m->progress && !m->progress(m->progress_context, (double)done / (double)rows->height))
        return tc_fail(error, TC_ERR_IO, "%s: interrupted", rows->name);
    return TC_OK;
}

static tc_status no_memory(const tc_image_rows *rows, tc_error *error)
{
    return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for rows of it", rows->name);
}

static tc_status run_rows(cascade *c, tc_image_rows *rows, tc_error *error)
{
    int64_t most = tc_clamp64(BAND_PIXELS / rows->width, 1, rows->height);
    uint8_t(*band)[4] = malloc((size_t)(most * rows->width) * 4);
    tc_status status = band ? TC_OK : no_memory(rows, error);
    for (int64_t y = 0; y < rows->height && !status; y += most) {
        int64_t count = tc_min64(most, rows->height - y);
        status = rows->read(rows, y, count, band, error);
        for (int64_t j = 0; j < count && !status; j++)
            status = push(c, 0, band + j * rows->width, error);
        if (!status)
            status = tell(c, rows, y + count, error);
    }
    free(band);
    return status;
}

/* Level 1 of a part, whose pixels follow each other, into rows of that level, from column 0 of the part on. */
static void halve_part(const cascade *c, const uint8_t (*part)[4], int64_t width, int64_t height, uint8_t (*half)[4])
{
    for (int64_t y = 0; y < height; y += 2)
        halve(c->srgb, part + y * width, part + tc_min64(y + 1, height - 1) * width, width,
              half + y / 2 * c->m->size[1].width);
}

/* Rows of a row of parts that are read at once: all; of very wide pictures less, so that parts are read several times.
 */
static int64_t rows_at_once(const cascade *c, int64_t part_height)
{
    int64_t most = tc_max64(HALF_PIXELS / c->m->size[1].width, 1), down = part_height * (part_height % 2 ? 2 : 1);
    while (down > 2 * most && down % 4 == 0)
        down /= 2;
    return down;
}

/* Parts of even sizes, so that none of level 1's pixels is of two of them. */
static tc_status run_parts(cascade *c, tc_image_rows *rows, tc_error *error)
{
    const int64_t w = rows->width, h = rows->height, down = rows_at_once(c, rows->part_height),
                  least = rows->part_width * (rows->part_width % 2 ? 2 : 1),
                  across = least * tc_max64(BAND_PIXELS / (down * least), 1);
    const int64_t part_pixels = tc_min64(across, w) * tc_min64(down, h);
    uint8_t(*part)[4] = malloc((size_t)part_pixels * 4);
    uint8_t(*half)[4] = malloc((size_t)((tc_min64(down, h) + 1) / 2 * c->m->size[1].width) * 4);
    tc_status status = part && half ? TC_OK : no_memory(rows, error);
    for (int64_t y = 0; y < h && !status; y += down) {
        int64_t y1 = tc_min64(y + down, h);
        for (int64_t x = 0; x < w && !status; x += across) {
            int64_t x1 = tc_min64(x + across, w);
            status = rows->read_part(rows, (tc_rect){x, y, x1, y1}, part, error);
            if (!status)
                halve_part(c, (const uint8_t(*)[4])part, x1 - x, y1 - y, half + x / 2);
            if (!status)
                status = tell(c, rows, y, error);
        }
        for (int64_t j = 0; j < (y1 - y + 1) / 2 && !status; j++)
            status = push(c, 1, half + j * c->m->size[1].width, error);
    }
    free(part), free(half);
    return status ? status : tell(c, rows, h, error);
}

tc_status tc_image_make_levels(tc_image_rows *rows, const tc_image_making *m, tc_error *error)
{
    cascade c = {.m = m, .srgb = tc_srgb_tables()};
    bool room = true;
    for (int k = 0; k + 1 < m->levels && room; k++) {
        c.first[k] = malloc((size_t)m->size[k].width * 4);
        c.row[k + 1] = malloc((size_t)m->size[k + 1].width * 4);
        room = c.first[k] && c.row[k + 1];
    }
    bool parts = rows->read_part && m->first > 0 && m->levels > 1;
    tc_status status = !room ? no_memory(rows, error) : parts ? run_parts(&c, rows, error) : run_rows(&c, rows, error);
    for (int k = 0; k + 1 < m->levels; k++)
        free(c.first[k]), free(c.row[k + 1]);
    return status;
}

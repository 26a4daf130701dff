/* error_pages.c - pages of a packed file's errors, read and kept as those of its index: quadtrees of codes. */
#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "error_store.h"
#include "packed_file.h"

enum { SCALES = TC_ERROR_COARSEST - TC_ERROR_TILE_SHIFT + 1, NODES = TC_ERROR_PAGE_LEAVES * 4 / 3 + 2 };

/* In the cache. Nodes of a scale behind those of the finer one, row by row. */
typedef struct page {
    tc_status status;
    tc_rect leaves;
    int first[SCALES];
    uint8_t code[NODES];
} page;

static int64_t across(int64_t leaves, int scale)
{
    return tc_ceil_shift(leaves, scale);
}

/* Coarser scales from the leaves. */
static void build(page *p)
{
    const int64_t nx = p->leaves.x1 - p->leaves.x0, ny = p->leaves.y1 - p->leaves.y0;
    p->first[0] = 0;
    for (int k = 1; k < SCALES; k++) {
        const int64_t w = across(nx, k - 1), h = across(ny, k - 1), to = across(nx, k);
        const uint8_t *from = p->code + p->first[k - 1];
        p->first[k] = p->first[k - 1] + (int)(w * h);
        uint8_t *code = p->code + p->first[k];
        memset(code, 0, (size_t)(to * across(ny, k)));
        for (int64_t y = 0; y < h; y++)
            for (int64_t x = 0; x < w; x++) {
                uint8_t *c = &code[(y >> 1) * to + (x >> 1)];
                *c = from[y * w + x] > *c ? from[y * w + x] : *c;
            }
        if (w * h == 1)
            p->first[k] = p->first[k - 1]; /* there are no coarser ones */
    }
}

static tc_status read_page(const tc_packed_file *f, int l, const tc_pages *pages, int64_t px, int64_t py, page *to)
{
    const tc_error_place *e = &f->container.error[l - 1];
    uint8_t *bytes;
    size_t size;
    int64_t end;
    tc_status status = tc_packed_file_listed(f, e->begin, e->begin + e->bytes, pages->pages_x * pages->pages_y,
                                             py * pages->pages_x + px, &bytes, &size, &end);
    if (status)
        return status;
    status = tc_error_page_read(bytes, size, to->leaves.x1 - to->leaves.x0, to->leaves.y1 - to->leaves.y0, to->code);
    free(bytes);
    return status;
}

static uint64_t page_key(int l, const tc_pages *pages, int64_t px, int64_t py)
{
    return (uint64_t)l << 54 | (uint64_t)(py * pages->pages_x + px);
}

tc_status tc_packed_file_error_page(tc_packed_file *f, int l, int64_t px, int64_t py)
{
    const tc_level *level = &f->container.level[l - 1];
    const tc_pages pages = tc_level_pages(level);
    tc_block *block = tc_block_pin(&f->errors, page_key(l, &pages, px, py), sizeof(page));
    if (!block)
        return TC_ERR_MEMORY;
    page *p = (page *)block->bytes;
    if (!block->made) {
        p->leaves = tc_error_page_leaves(level, f->container.error[l - 1].shift, px, py);
        p->status = read_page(f, l, &pages, px, py, p);
        const bool known = p->status == TC_OK || p->status == TC_ERR_FORMAT;
        if (p->status == TC_ERR_FORMAT)
            memset(p->code, TC_ERROR_CODES - 1, sizeof p->code);
        if (known)
            build(p);
        tc_block_made(&f->errors, block, known);
    }
    const tc_status status = p->status;
    tc_block_release(&f->errors, block);
    return status;
}

/* The code of a page's node of a scale that holds a leaf; -1 where the page is not at hand. */
static int node(tc_packed_file *f, int l, const tc_pages *pages, int scale, int64_t x, int64_t y,
                tc_missing_pages *missing)
{
    const int shift = f->container.error[l - 1].shift;
    const int64_t px = x / (TC_ERROR_PAGE_WIDTH >> shift), py = y / (TC_ERROR_PAGE_HEIGHT >> shift);
    tc_block *block = tc_block_find(&f->errors, page_key(l, pages, px, py));
    if (!block) {
        missing->page[missing->count][0] = px, missing->page[missing->count++][1] = py;
        return -1;
    }
    const page *p = (const page *)block->bytes;
    const int64_t w = across(p->leaves.x1 - p->leaves.x0, scale);
    const int code = p->code[p->first[scale] + ((y - p->leaves.y0) >> scale) * w + ((x - p->leaves.x0) >> scale)];
    tc_block_release(&f->errors, block);
    return code;
}

float tc_packed_file_error(tc_packed_file *f, int l, tc_rect s, int64_t most_x, int *reads, tc_missing_pages *missing)
{
    const tc_container *c = &f->container;
    const tc_pages pages = tc_level_pages(&c->level[l - 1]);
    const int shift = c->error[l - 1].shift;
    const tc_rect t = {s.x0 >> shift, s.y0 >> shift, ((s.x1 - 1) >> shift) + 1, ((s.y1 - 1) >> shift) + 1};
    missing->count = 0;
    if (l == 1)
        return INFINITY;
    /* Nodes end with their page; further scales than its rows have are the level's. */
    for (int k = 0; k <= TC_ERROR_COARSEST - shift && l > c->base; k++) {
        const tc_rect n = {t.x0 >> k, t.y0 >> k, ((t.x1 - 1) >> k) + 1, ((t.y1 - 1) >> k) + 1};
        if (n.x1 - n.x0 > most_x || n.y1 - n.y0 > 2)
            continue;
        int most = 0;
        bool known = true;
        for (int64_t y = n.y0; y < n.y1; y++)
            for (int64_t x = n.x0; x < n.x1; x++, ++*reads) {
                const int code = node(f, l, &pages, k, x << k, y << k, missing);
                known &= code >= 0, most = code > most ? code : most;
            }
        if (!known)
            return INFINITY;
        return tc_error_metres(c->error[l - 1].most, most);
    }
    ++*reads;
    return c->error[l - 1].most;
}

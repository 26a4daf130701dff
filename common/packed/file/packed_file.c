/* packed_file.c - byte ranges of a packed file. */
#include "packed_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/base/crc32c.h"

enum {
    FIRST_READ = 16 << 10, /* holds most heads whole */
    PAGE_CACHE = 4 << 20,  /* bytes */
    ERROR_CACHE = 16 << 20,
    PAGE_NODES = 343, /* of a range pyramid over a page's tiles */
    PAGE_SCALES = 5,  /* above its leaves */
    PAGE_SCALES_Y = 3,
    MOST_PAGE = 1 << 16 /* bytes; no writer makes a longer page */
};

/* A page in the cache. */
typedef struct page {
    tc_status status;
    tc_tile_entry entry[TC_PAGE_TILES];
    tc_rect tiles;
    tc_range node[PAGE_NODES];
} page;

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static tc_status read_from_file(void *context, int64_t offset, void *bytes, size_t size)
{
    char *to = bytes;
    while (size > 0) {
        ssize_t n = pread(*(const int *)context, to, size, offset);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return n < 0 ? TC_ERR_IO : TC_ERR_FORMAT; /* the file has shrunk */
        to += n, offset += n, size -= (size_t)n;
    }
    return TC_OK;
}

static void close_file(void *context)
{
    close(*(const int *)context);
    free(context);
}

tc_status tc_file_source(const char *path, tc_byte_source *source_ret, tc_error *error)
{
    int *file = malloc(sizeof *file);
    struct stat about;
    if (!file)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    *file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe shall not hold us up */
    tc_status status = TC_OK;
    if (*file < 0 || fstat(*file, &about) != 0)
        status = tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    else if (!S_ISREG(about.st_mode))
        status = tc_fail(error, TC_ERR_IO, "%s: expected a file, found a %s", path,
                         S_ISDIR(about.st_mode) ? "directory" : "device or pipe");
    else
        *source_ret = (tc_byte_source){file, about.st_size, read_from_file, close_file};
    if (status && *file >= 0)
        close(*file);
    if (status)
        free(file);
    return status;
}

/* ---- Opening ------------------------------------------------------------------------------------------------------
 */

static tc_status read_at(const tc_packed_file *f, int64_t offset, void *bytes, size_t size)
{
    const tc_byte_source *s = &f->source;
    if (offset < 0 || offset > s->size || size > (uint64_t)(s->size - offset))
        return TC_ERR_FORMAT;
    return size ? s->read(s->context, offset, bytes, size) : TC_OK;
}

/* The chart's container, out of a file's head of either kind. */
static tc_status take_head(tc_packed_file *f, int chart, const uint8_t *bytes, size_t size, size_t *needed_ret,
                           tc_error *error)
{
    if (size < TC_HEAD_FIXED || !tc_envelope_is(bytes)) {
        tc_status status = tc_container_read(f->path, bytes, size, &f->container, needed_ret, error);
        for (int l = f->container.base; l < f->container.levels && !status; l++)
            f->rank_end[f->container.levels - 1 - l] = f->container.record[l].end;
        return status;
    }
    tc_envelope *e = NULL;
    tc_status status = tc_envelope_read(f->path, bytes, size, &e, needed_ret, error);
    if (status)
        return status;
    if (chart < e->charts) {
        f->container = e->chart[chart].container;
        e->chart[chart].container = (tc_container){0};
        memcpy(f->rank_end, e->rank_end, sizeof f->rank_end);
    } else {
        status = tc_fail(error, TC_ERR_USAGE, "%s: expected a chart below %d, found %d", f->path, e->charts, chart);
    }
    tc_envelope_free(e);
    return status;
}

/* The first `size` bytes of the file, and the head out of them. */
static tc_status try_head(tc_packed_file *f, int chart, size_t size, size_t *needed_ret, tc_error *error)
{
    uint8_t *bytes = malloc(size + 1);
    tc_status status = bytes ? read_at(f, 0, bytes, size) : TC_ERR_MEMORY;
    if (!status)
        status = take_head(f, chart, bytes, size, needed_ret, error);
    else
        tc_fail(error, status, "%s: cannot be read: %s", f->path, tc_status_text(status));
    free(bytes);
    return status;
}

static tc_status read_head(tc_packed_file *f, int chart, tc_error *error)
{
    tc_error why = {TC_OK, ""}; /* of the first attempt, which can be for too few bytes alone */
    size_t size = (size_t)tc_min64(FIRST_READ, f->source.size), needed = 0;
    tc_status status = try_head(f, chart, size, &needed, &why);
    if (status == TC_ERR_FORMAT && needed > size && (int64_t)needed <= f->source.size)
        return try_head(f, chart, needed, &needed, error);
    if (status && error)
        *error = why;
    return status;
}

static void close_source(const tc_byte_source *source)
{
    if (source->close)
        source->close(source->context);
}

tc_status tc_packed_file_open_bytes(const char *name, const tc_byte_source *source, int chart, tc_packed_file *f,
                                    tc_error *error)
{
    *f = (tc_packed_file){.path = strdup(name), .source = *source};
    tc_status status =
        f->path ? read_head(f, chart, error) : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    if (!status) {
        const tc_status pages = tc_block_cache_init(&f->pages, PAGE_CACHE),
                        errors = tc_block_cache_init(&f->errors, ERROR_CACHE);
        if (pages || errors) {
            tc_block_cache_free(&f->pages), tc_block_cache_free(&f->errors);
            tc_container_free(&f->container);
            status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
        }
    }
    if (status) {
        close_source(source);
        free(f->path);
        return status;
    }
    pthread_mutex_init(&f->mutex, NULL);
    tc_container *c = &f->container;
    c->info.cut_short = source->size < c->info.bytes;
    /* Also levels that stand in the head, where other charts have some as fine that do not: charts stay as fine as each
     * other. */
    while (c->levels > 1 && f->rank_end[c->info.levels_missing] > source->size)
        c->levels--, c->info.levels_missing++;
    return TC_OK;
}

tc_status tc_packed_file_open(const char *path, tc_packed_file *f, tc_error *error)
{
    tc_byte_source source;
    tc_status status = tc_file_source(path, &source, error);
    return status ? status : tc_packed_file_open_bytes(path, &source, 0, f, error);
}

void tc_packed_file_close(tc_packed_file *f)
{
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        free(f->range[l].pages.node), free(f->range[l].read);
    pthread_mutex_destroy(&f->mutex);
    tc_block_cache_free(&f->pages), tc_block_cache_free(&f->errors);
    tc_container_free(&f->container);
    close_source(&f->source);
    free(f->path);
}

/* ---- Index ----------------------------------------------------------------------------------------------------- */

/* Where a page is: `number` of `count` whose directory begins at `begin`. */
static tc_status find_page(const tc_packed_file *f, int64_t begin, int64_t end, int64_t count, int64_t number,
                           int64_t *offset_ret, uint32_t *size_ret, uint32_t *crc_ret)
{
    uint8_t bytes[TC_DIRECTORY_CHUNK * TC_DIRECTORY_ENTRY + 4];
    int64_t chunk = number / TC_DIRECTORY_CHUNK, first = chunk * TC_DIRECTORY_CHUNK;
    size_t size = (size_t)tc_min64(count - first, TC_DIRECTORY_CHUNK) * TC_DIRECTORY_ENTRY;
    tc_status status = read_at(f, begin + tc_directory_chunk_offset(chunk), bytes, size + 4);
    if (status || tc_crc32c(0, bytes, size) != tc_load(bytes + size, 4))
        return status ? status : TC_ERR_FORMAT;
    const uint8_t *entry = bytes + (number - first) * TC_DIRECTORY_ENTRY;
    uint64_t offset = tc_load(entry, 8);
    *size_ret = (uint32_t)tc_load(entry + 8, 4), *crc_ret = (uint32_t)tc_load(entry + 12, 4);
    if (*size_ret > MOST_PAGE || offset > (uint64_t)(end - begin) || *size_ret > (uint64_t)(end - begin) - offset)
        return TC_ERR_FORMAT;
    *offset_ret = begin + (int64_t)offset;
    return TC_OK;
}

tc_status tc_packed_file_listed(const tc_packed_file *f, int64_t begin, int64_t end, int64_t count, int64_t number,
                                uint8_t **bytes_ret, size_t *size_ret, int64_t *end_ret)
{
    int64_t offset = 0;
    uint32_t size = 0, crc = 0;
    tc_status status = find_page(f, begin, end, count, number, &offset, &size, &crc);
    if (status)
        return status;
    uint8_t *bytes = malloc(size + 1);
    if (!bytes)
        return TC_ERR_MEMORY;
    status = read_at(f, offset, bytes, size);
    if (!status && tc_crc32c(0, bytes, size) != crc)
        status = TC_ERR_FORMAT;
    if (status) {
        free(bytes);
        return status;
    }
    *bytes_ret = bytes, *size_ret = size, *end_ret = offset + size;
    return TC_OK;
}

static tc_status read_page(const tc_packed_file *f, int l, const tc_pages *pages, int64_t px, int64_t py, page *to)
{
    const tc_level_record *r = &f->container.record[l - 1];
    int64_t offset;
    uint8_t *bytes;
    size_t size;
    tc_status status = tc_packed_file_listed(f, r->begin, r->end, pages->pages_x * pages->pages_y,
                                             py * pages->pages_x + px, &bytes, &size, &offset);
    if (status)
        return status;
    tc_rect tiles = tc_page_tiles(pages, px, py);
    int count = (int)tc_rect_area(tiles);
    status = tc_page_read(tc_level_form(r, f->container.steps), bytes, size, to->entry, count);
    free(bytes);
    for (int i = 0; i < count && !status; i++) {
        to->entry[i].offset = (uint64_t)offset;
        offset += tc_tile_bytes(&to->entry[i]);
        if (offset > r->end)
            status = TC_ERR_FORMAT;
    }
    return status;
}

/* ---- Ranges ------------------------------------------------------------------------------------------------------ */

static tc_range in_metres(const tc_container *c, int32_t low, int32_t high)
{
    return (tc_range){(float)(c->z_origin + c->z_unit * low), (float)(c->z_origin + c->z_unit * high), INFINITY,
                      INFINITY};
}

static tc_range level_range(const tc_container *c, int l)
{
    return in_metres(c, c->record[l - 1].lowest, c->record[l - 1].highest);
}

/* A step covers as far as heights, which are told as floats, may be off the mesh of the coarser level, of which all are
 * off by up to half an ulp. Files before version 3 have none. */
static tc_range tile_range(const tc_container *c, const tc_tile_entry *entry)
{
    tc_range range = in_metres(c, entry->low, entry->high);
    double rounding = 2 * ldexp(fmax(fabs((double)range.lo), fabs((double)range.hi)), -23);
    if (entry->step != TC_STEP_UNKNOWN)
        range.step = nextafterf((float)(c->z_unit * entry->step + rounding), INFINITY);
    return range;
}

/* A page's own pyramid, over its tiles. */
static tc_range_pyramid pyramid_of(page *p)
{
    return (tc_range_pyramid){p->tiles.x1 - p->tiles.x0, p->tiles.y1 - p->tiles.y0, p->node};
}

/* Makes the pyramid over a level's pages. False where there is no memory: the level's whole range has to do. */
static bool make_ranges(tc_packed_file *f, int l, const tc_pages *pages)
{
    int64_t count = pages->pages_x * pages->pages_y, nodes = tc_range_nodes(pages->pages_x, pages->pages_y);
    if (f->range[l - 1].read)
        return true;
    tc_range *node = malloc((size_t)nodes * sizeof *node);
    uint8_t *read = calloc((size_t)count, 1);
    if (!node || !read) {
        free(node), free(read);
        return false;
    }
    for (int64_t n = 0; n < nodes; n++)
        node[n] = level_range(&f->container, l);
    f->range[l - 1].pages = (tc_range_pyramid){pages->pages_x, pages->pages_y, node};
    f->range[l - 1].read = read, f->range[l - 1].missing = count;
    f->range_bytes += (size_t)nodes * sizeof *node + (size_t)count;
    return true;
}

/* A page that has been read tells its ranges. */
static void take_ranges(tc_packed_file *f, int l, const tc_pages *pages, int64_t px, int64_t py, page *p)
{
    tc_range_pyramid own = pyramid_of(p);
    for (int64_t n = 0; n < own.nx * own.ny; n++)
        own.node[n] = p->status ? level_range(&f->container, l) : tile_range(&f->container, &p->entry[n]);
    tc_range_build(&own);
    pthread_mutex_lock(&f->mutex);
    int64_t at = py * pages->pages_x + px;
    if (make_ranges(f, l, pages) && !f->range[l - 1].read[at]) {
        f->range[l - 1].pages.node[at] = tc_range_node(&own, PAGE_SCALES + 1, 0, 0);
        tc_range_update(&f->range[l - 1].pages, px, py);
        f->range[l - 1].read[at] = 1, f->range[l - 1].missing--;
    }
    pthread_mutex_unlock(&f->mutex);
}

static uint64_t page_key(int l, const tc_pages *pages, int64_t px, int64_t py)
{
    return (uint64_t)l << 56 | (uint64_t)(py * pages->pages_x + px);
}

/* A page, read where it was not at hand; NULL where there is no memory. */
static tc_block *pin_page(tc_packed_file *f, int l, const tc_pages *pages, int64_t px, int64_t py)
{
    tc_block *block = tc_block_pin(&f->pages, page_key(l, pages, px, py), sizeof(page));
    if (!block || block->made)
        return block;
    page *p = (page *)block->bytes;
    p->tiles = tc_page_tiles(pages, px, py);
    p->status = read_page(f, l, pages, px, py, p);
    bool known = p->status == TC_OK || p->status == TC_ERR_FORMAT;
    if (known)
        take_ranges(f, l, pages, px, py, p);
    tc_block_made(&f->pages, block, known);
    return block;
}

tc_status tc_packed_file_page(tc_packed_file *f, int l, int64_t px, int64_t py)
{
    tc_pages pages = tc_level_pages(&f->container.level[l - 1]);
    tc_block *block = pin_page(f, l, &pages, px, py);
    if (!block)
        return TC_ERR_MEMORY;
    tc_status status = ((const page *)block->bytes)->status;
    tc_block_release(&f->pages, block);
    return status;
}

tc_status tc_packed_file_entry(tc_packed_file *f, int l, int64_t tx, int64_t ty, tc_tile_entry *entry_ret)
{
    tc_pages pages = tc_level_pages(&f->container.level[l - 1]);
    tc_block *block = pin_page(f, l, &pages, tx / TC_PAGE_COLUMNS, ty / TC_PAGE_ROWS);
    if (!block)
        return TC_ERR_MEMORY;
    const page *p = (const page *)block->bytes;
    tc_status status = p->status;
    if (!status)
        *entry_ret = p->entry[(ty - p->tiles.y0) * (p->tiles.x1 - p->tiles.x0) + tx - p->tiles.x0];
    tc_block_release(&f->pages, block);
    return status;
}

/* The node of a page's pyramid that holds a tile; the page's range where the page is not at hand. */
static tc_range tile_node(tc_packed_file *f, int l, const tc_pages *pages, int scale, int64_t tx, int64_t ty,
                          tc_missing_pages *missing)
{
    int64_t px = tx / TC_PAGE_COLUMNS, py = ty / TC_PAGE_ROWS;
    tc_block *block = tc_block_find(&f->pages, page_key(l, pages, px, py));
    if (block) {
        page *p = (page *)block->bytes;
        tc_range_pyramid own = pyramid_of(p);
        tc_range range = tc_range_node(&own, scale, tx - p->tiles.x0, ty - p->tiles.y0);
        tc_block_release(&f->pages, block);
        return range;
    }
    missing->page[missing->count][0] = px, missing->page[missing->count++][1] = py;
    pthread_mutex_lock(&f->mutex);
    tc_range range =
        f->range[l - 1].read ? f->range[l - 1].pages.node[py * pages->pages_x + px] : level_range(&f->container, l);
    pthread_mutex_unlock(&f->mutex);
    return range;
}

/* The same of several pages, from the pyramid over them. */
static tc_range page_nodes(tc_packed_file *f, int l, tc_rect touched, int64_t most_x, int *reads,
                           tc_missing_pages *missing)
{
    pthread_mutex_lock(&f->mutex);
    const uint8_t *read = f->range[l - 1].read;
    tc_range range = level_range(&f->container, l);
    if (read)
        range = tc_range_ask(&f->range[l - 1].pages, touched, most_x, reads);
    else
        ++*reads;
    bool ask = tc_rect_area(touched) <= TC_MISSING_PAGES && (!read || f->range[l - 1].missing > 0);
    for (int64_t y = touched.y0; y < touched.y1 && ask; y++)
        for (int64_t x = touched.x0; x < touched.x1; x++)
            if (!read || !read[y * f->range[l - 1].pages.nx + x])
                missing->page[missing->count][0] = x, missing->page[missing->count++][1] = y;
    pthread_mutex_unlock(&f->mutex);
    return range;
}

tc_range tc_packed_file_range(tc_packed_file *f, int l, tc_rect t, int64_t most_x, int *reads,
                              tc_missing_pages *missing)
{
    tc_pages pages = tc_level_pages(&f->container.level[l - 1]);
    missing->count = 0;
    for (int k = 0, ky = 0; k < PAGE_SCALES; k++, ky = k < PAGE_SCALES_Y ? k : PAGE_SCALES_Y) {
        tc_rect n = {t.x0 >> k, t.y0 >> ky, ((t.x1 - 1) >> k) + 1, ((t.y1 - 1) >> ky) + 1};
        if (n.x1 - n.x0 > most_x || n.y1 - n.y0 > 2)
            continue;
        tc_range all = TC_NO_RANGE;
        for (int64_t y = n.y0; y < n.y1; y++)
            for (int64_t x = n.x0; x < n.x1; x++, ++*reads)
                all = tc_range_both(all, tile_node(f, l, &pages, k, x << k, y << ky, missing));
        return all;
    }
    tc_rect touched = {t.x0 / TC_PAGE_COLUMNS, t.y0 / TC_PAGE_ROWS, (t.x1 - 1) / TC_PAGE_COLUMNS + 1,
                       (t.y1 - 1) / TC_PAGE_ROWS + 1};
    return page_nodes(f, l, touched, most_x, reads, missing);
}

size_t tc_packed_file_memory(tc_packed_file *f)
{
    pthread_mutex_lock(&f->mutex);
    size_t bytes = f->range_bytes;
    pthread_mutex_unlock(&f->mutex);
    return bytes + tc_block_cache_bytes(&f->pages) + tc_block_cache_bytes(&f->errors);
}

bool tc_packed_file_known(tc_packed_file *f, int l, int64_t tx, int64_t ty)
{
    tc_pages pages = tc_level_pages(&f->container.level[l - 1]);
    return tc_block_has(&f->pages, page_key(l, &pages, tx / TC_PAGE_COLUMNS, ty / TC_PAGE_ROWS));
}

tc_status tc_packed_file_tile(tc_packed_file *f, const tc_tile_entry *entry, uint8_t *bytes, size_t room)
{
    size_t size = tc_tile_bytes(entry);
    if (size > room)
        return TC_ERR_FORMAT;
    tc_status status = size ? read_at(f, (int64_t)entry->offset, bytes, size) : TC_OK;
    return !status && size && tc_crc32c(0, bytes, size) != entry->crc ? TC_ERR_FORMAT : status;
}

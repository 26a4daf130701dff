/* packed_file.c - byte ranges of a packed file. */
#include "packed_file.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/base/crc32c.h"

enum {
    FIRST_READ = 16 << 10, /* holds most heads whole */
    PAGE_CACHE = 2 << 20,  /* bytes */
    MOST_PAGE = 1 << 16,   /* bytes; no writer makes a longer page */
    SMALLEST_HEAD = 20
};

/* A page in the cache. */
typedef struct page {
    tc_status status;
    tc_tile_entry entry[TC_PAGE_TILES];
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
    if (!status && tc_block_cache_init(&f->pages, sizeof(page), PAGE_CACHE)) {
        tc_block_cache_free(&f->pages);
        tc_container_free(&f->container);
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    if (status) {
        close_source(source);
        free(f->path);
        return status;
    }
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
    tc_block_cache_free(&f->pages);
    tc_container_free(&f->container);
    close_source(&f->source);
    free(f->path);
}

/* ---- Index ----------------------------------------------------------------------------------------------------- */

/* Where a page of a level is. */
static tc_status find_page(const tc_packed_file *f, const tc_level_record *r, const tc_pages *pages, int64_t number,
                           int64_t *offset_ret, uint32_t *size_ret, uint32_t *crc_ret)
{
    uint8_t bytes[TC_DIRECTORY_CHUNK * TC_DIRECTORY_ENTRY + 4];
    int64_t chunk = number / TC_DIRECTORY_CHUNK, first = chunk * TC_DIRECTORY_CHUNK;
    size_t size = (size_t)tc_min64(pages->pages_x * pages->pages_y - first, TC_DIRECTORY_CHUNK) * TC_DIRECTORY_ENTRY;
    tc_status status = read_at(f, r->begin + tc_directory_chunk_offset(chunk), bytes, size + 4);
    if (status || tc_crc32c(0, bytes, size) != tc_load(bytes + size, 4))
        return status ? status : TC_ERR_FORMAT;
    const uint8_t *entry = bytes + (number - first) * TC_DIRECTORY_ENTRY;
    uint64_t offset = tc_load(entry, 8);
    *size_ret = (uint32_t)tc_load(entry + 8, 4), *crc_ret = (uint32_t)tc_load(entry + 12, 4);
    if (*size_ret > MOST_PAGE || offset > (uint64_t)(r->end - r->begin) ||
        *size_ret > (uint64_t)(r->end - r->begin) - offset)
        return TC_ERR_FORMAT;
    *offset_ret = r->begin + (int64_t)offset;
    return TC_OK;
}

static tc_status read_page(const tc_packed_file *f, int l, const tc_pages *pages, int64_t px, int64_t py, page *to)
{
    const tc_level_record *r = &f->container.record[l - 1];
    int64_t offset = 0;
    uint32_t size = 0, crc = 0;
    tc_status status = find_page(f, r, pages, py * pages->pages_x + px, &offset, &size, &crc);
    if (status)
        return status;
    uint8_t *bytes = malloc(size + 1);
    if (!bytes)
        return TC_ERR_MEMORY;
    status = read_at(f, offset, bytes, size);
    if (!status && tc_crc32c(0, bytes, size) != crc)
        status = TC_ERR_FORMAT;
    tc_rect tiles = tc_page_tiles(pages, px, py);
    int count = (int)tc_rect_area(tiles);
    if (!status)
        status = tc_page_read(tc_level_form(r, f->container.steps), bytes, size, to->entry, count);
    free(bytes);
    offset += size;
    for (int i = 0; i < count && !status; i++) {
        to->entry[i].offset = (uint64_t)offset;
        offset += tc_tile_bytes(&to->entry[i]);
        if (offset > r->end)
            status = TC_ERR_FORMAT;
    }
    return status;
}

static uint64_t page_key(int l, const tc_pages *pages, int64_t px, int64_t py)
{
    return (uint64_t)l << 56 | (uint64_t)(py * pages->pages_x + px);
}

tc_status tc_packed_file_entry(tc_packed_file *f, int l, int64_t tx, int64_t ty, tc_tile_entry *entry_ret)
{
    tc_pages pages = tc_level_pages(&f->container.level[l - 1]);
    int64_t px = tx / TC_PAGE_COLUMNS, py = ty / TC_PAGE_ROWS;
    tc_block *block = tc_block_pin(&f->pages, page_key(l, &pages, px, py));
    if (!block)
        return TC_ERR_MEMORY;
    page *p = (page *)block->bytes;
    if (!block->made) {
        p->status = read_page(f, l, &pages, px, py, p);
        tc_block_made(&f->pages, block, p->status == TC_OK || p->status == TC_ERR_FORMAT);
    }
    tc_status status = p->status;
    tc_rect tiles = tc_page_tiles(&pages, px, py);
    if (!status)
        *entry_ret = p->entry[(ty - tiles.y0) * (tiles.x1 - tiles.x0) + tx - tiles.x0];
    tc_block_release(&f->pages, block);
    return status;
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

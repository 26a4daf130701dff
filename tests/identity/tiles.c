/* tiles.c - tile-sums: what a packed terrain holds, without how it is framed.
 *
 *   tile-sums FILE.tclip
 *
 * A line for each chart, each coded level and each tile: sizes of its streams and a checksum of their bytes. Two files
 * with the same lines, sorted, hold the same compressed heights, wherever in the file they are. It reads
 * docs/format.md by itself and shares no code with the library, so one program reads the files of any build. Every
 * checksum of the file is held against its bytes: a layout that was not understood is an error, not another sum.
 *
 * Versions 1 to 3 are known; another one is added in main(). */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LEVELS = 41, BASE_SIDE = 16, TILE_SIDE = 128, PAGE_COLUMNS = 32, PAGE_ROWS = 8, CHUNK = 255 };

typedef struct bytes {
    const uint8_t *at;
    size_t size;
} bytes;

static void fail(const char *what)
{
    fprintf(stderr, "tile-sums: %s\n", what);
    exit(1);
}

/* `size` bytes from an offset on. */
static bytes part(bytes whole, uint64_t offset, uint64_t size)
{
    if (offset > whole.size || size > whole.size - offset)
        fail("a part lies outside the file");
    return (bytes){whole.at + offset, (size_t)size};
}

static uint64_t number(bytes from, uint64_t offset, unsigned size)
{
    uint64_t value = 0;
    bytes field = part(from, offset, size);
    for (unsigned i = 0; i < size; i++)
        value |= (uint64_t)field.at[i] << 8 * i;
    return value;
}

static uint32_t crc32c(uint32_t crc, bytes of)
{
    crc = ~crc;
    for (size_t i = 0; i < of.size; i++) {
        crc ^= of.at[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0x82f63b78 : 0);
    }
    return ~crc;
}

static void check(bytes of, uint64_t crc, const char *what)
{
    if (crc32c(0, of) != crc)
        fail(what);
}

static int64_t ceil_div(int64_t a, int64_t b)
{
    return (a + b - 1) / b;
}

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* ---- Adaptive binary coder (section 6) --------------------------------------------------------------------------- */

typedef struct decoder {
    bytes from;
    uint32_t range, code;
    size_t used;
} decoder;

typedef struct number_model {
    uint16_t length[32], lead[32][8];
} number_model;

static uint32_t next_byte(decoder *d)
{
    size_t at = d->used++;
    return at < d->from.size ? d->from.at[at] : 0;
}

static void begin(decoder *d, bytes from)
{
    *d = (decoder){.from = from, .range = UINT32_MAX};
    for (int i = 0; i < 4; i++)
        d->code = d->code << 8 | next_byte(d);
}

static void refill(decoder *d)
{
    for (; d->range < 1 << 24; d->range <<= 8)
        d->code = d->code << 8 | next_byte(d);
}

static bool bit(decoder *d, uint16_t *p)
{
    uint32_t zero = (d->range >> 12) * *p;
    bool one = d->code >= zero;
    if (one)
        d->code -= zero, d->range -= zero, *p = (uint16_t)(*p - (*p >> 5));
    else
        d->range = zero, *p = (uint16_t)(*p + ((4096 - *p) >> 5));
    refill(d);
    return one;
}

static uint32_t raw(decoder *d, int bits)
{
    uint32_t value = 0;
    for (; bits > 0; bits--) {
        d->range >>= 1;
        bool one = d->code >= d->range;
        d->code -= one ? d->range : 0;
        value = value << 1 | one;
        refill(d);
    }
    return value;
}

static uint32_t coded_number(decoder *d, number_model *m)
{
    int n = 0;
    while (n < 31 && bit(d, &m->length[n]))
        n++;
    uint32_t v = 1, node = 1;
    int left = n;
    for (; left > 0 && node < 8; left--) {
        bool b = bit(d, &m->lead[n][node]);
        v = 2 * v + b, node = 2 * node + b;
    }
    uint32_t low = raw(d, left);
    return (v << left) + low - 1;
}

/* ---- Levels (sections 2 to 5) ------------------------------------------------------------------------------------ */

typedef struct level {
    const char *chart;
    int number;
    int64_t width, height;
    bool corrections, mask;
    bool steps;   /* pages tell tiles' largest steps: since version 3 */
    bool repeats; /* and of exact levels whether a tile has the size of the one before */
} level;

enum { VALID, VOID, CODED };

/* Models of a page; all are 16-bit chances, one behind the other. */
typedef struct page_models {
    uint16_t coded[2], first[3], second[3];
    number_model size[3], low, high, step;
} page_models;

/* One page, then its tiles; (x, y) is its first tile. */
static void print_page(const level *l, bytes page, bytes tiles, int64_t x, int64_t y, int64_t columns, int64_t rows)
{
    page_models m;
    uint16_t *p = (uint16_t *)&m;
    for (size_t i = 0; i < sizeof m / sizeof *p; i++)
        p[i] = 2048;
    decoder d;
    begin(&d, page);
    raw(&d, 32), raw(&d, 32);
    uint64_t at = 0;
    uint32_t before = 0;
    int class_before = VALID;
    for (int64_t k = 0; k < columns * rows; k++) {
        uint32_t size[3] = {0}, crc = 0;
        int class = VALID;
        if (bit(&d, &m.coded[before > 0]))
            size[0] = coded_number(&d, &m.size[0]);
        else if (l->repeats)
            size[0] = before;
        if (l->corrections)
            size[1] = coded_number(&d, &m.size[1]);
        if (l->mask && !bit(&d, &m.first[class_before]))
            class = bit(&d, &m.second[class_before]) ? VOID : CODED;
        if (class == CODED)
            size[2] = coded_number(&d, &m.size[2]);
        uint64_t all = (uint64_t)size[0] + size[1] + size[2];
        if (all > 0)
            crc = raw(&d, 32);
        coded_number(&d, &m.low), coded_number(&d, &m.high);
        if (l->steps)
            coded_number(&d, &m.step);
        bytes tile = part(tiles, at, all);
        check(tile, crc, "a tile's checksum is wrong");
        printf("%s level %d tile %" PRId64 " %" PRId64 ": %" PRIu32 " %" PRIu32 " %" PRIu32
               " bytes, mask %d, %08" PRIx32 "\n",
               l->chart, l->number, x + k % columns, y + k / columns, size[0], size[1], size[2], class, crc);
        at += all, before = size[0], class_before = class;
    }
    if (page.size > d.used)
        fail("a page has bytes left over");
}

static void print_level(const level *l, bytes content)
{
    int64_t across = ceil_div(l->width, TILE_SIDE), up = ceil_div(l->height, TILE_SIDE);
    int64_t pages_x = ceil_div(across, PAGE_COLUMNS), pages = pages_x * ceil_div(up, PAGE_ROWS);
    for (int64_t n = 0; n < pages; n++) {
        uint64_t chunk = (uint64_t)(n / CHUNK) * (16 * CHUNK + 4);
        uint64_t entries = (uint64_t)least(CHUNK, pages - n / CHUNK * CHUNK);
        check(part(content, chunk, 16 * entries), number(content, chunk + 16 * entries, 4),
              "a directory's checksum is wrong");
        uint64_t entry = chunk + 16 * (uint64_t)(n % CHUNK), offset = number(content, entry, 8);
        bytes page = part(content, offset, number(content, entry + 8, 4));
        check(page, number(content, entry + 12, 4), "a page's checksum is wrong");
        int64_t x = n % pages_x * PAGE_COLUMNS, y = n / pages_x * PAGE_ROWS;
        print_page(l, page, part(content, offset + page.size, content.size - offset - page.size), x, y,
                   least(PAGE_COLUMNS, across - x), least(PAGE_ROWS, up - y));
    }
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

/* A head, that of a file or of a container in it, as far as its size says; checked. */
static bytes read_head(bytes from)
{
    static const uint8_t magic[8] = {0x89, 'T', 'C', 'L', 'I', 'P', '\r', '\n'}, zeros[4];
    if (memcmp(part(from, 0, sizeof magic).at, magic, sizeof magic) != 0)
        fail("expected a packed terrain");
    bytes head = part(from, 0, number(from, 12, 4));
    if (head.size < 20)
        fail("a head is too short");
    uint32_t crc = crc32c(crc32c(0, part(head, 0, 16)), (bytes){zeros, 4});
    if (crc32c(crc, part(head, 20, head.size - 20)) != number(head, 16, 4))
        fail("a head's checksum is wrong");
    return head;
}

/* Prints what the head of a container and its levels hold. Returns the bytes of the levels; *rest_ret: where in the
 * head the records end. */
static uint64_t print_container(bytes head, bytes file, const char *chart, bool steps, uint64_t *rest_ret)
{
    uint64_t at = 235 + number(head, 175, 4), all = 0;
    int levels = 1, base = 1;
    int64_t w[MOST_LEVELS] = {(int64_t)number(head, 41, 8)}, h[MOST_LEVELS] = {(int64_t)number(head, 49, 8)};
    for (; (w[levels - 1] > 1 || h[levels - 1] > 1) && levels < MOST_LEVELS; levels++) /* finest first */
        w[levels] = ceil_div(w[levels - 1], 2), h[levels] = ceil_div(h[levels - 1], 2);
    while (base < levels && w[levels - base - 1] <= BASE_SIDE && h[levels - base - 1] <= BASE_SIDE)
        base++;
    bytes coded = part(head, at + 2, number(head, at, 2));
    printf("%s base: %zu bytes, %08" PRIx32 "\n", chart, coded.size, crc32c(0, coded));
    at += 2 + coded.size;
    for (int l = base + 1; l <= levels; l++) {
        uint64_t coder = number(head, at, 1), begin = number(head, at + 2, 8), end = number(head, at + 10, 8);
        if (end < begin)
            fail("a level ends before it begins");
        bytes model = part(head, at + 48, number(head, at + 46, 2));
        level now = {chart,
                     l,
                     w[levels - l],
                     h[levels - l],
                     coder == 1 || coder == 4,
                     number(head, at + 1, 1) != 0,
                     steps,
                     steps && coder == 2};
        printf("%s level %d: coder %" PRIu64 ", %" PRId64 " x %" PRId64 ", heights %d to %d, corrections %" PRIu64
               " snap %" PRIu64 ", model %zu bytes, %08" PRIx32 "\n",
               chart, l, coder, now.width, now.height, (int)(int32_t)number(head, at + 18, 4),
               (int)(int32_t)number(head, at + 22, 4), number(head, at + 38, 4), number(head, at + 42, 4), model.size,
               crc32c(0, model));
        print_level(&now, part(file, begin, end - begin));
        at += 48 + model.size, all += end - begin;
    }
    *rest_ret = at;
    return all;
}

static const char *const chart_names[] = {"main", "north", "south"};

/* Versions 1 and 2 (section 19): a container whose levels follow its head, then those of the caps. Returns the bytes
 * that were understood. */
static uint64_t print_version_2(bytes file, const char *chart)
{
    bytes head = read_head(file);
    uint64_t rest, at = head.size + print_container(head, file, chart, false, &rest);
    for (int k = 1; number(head, 29, 1) == 3 && k < 3; k++) {
        uint64_t size = number(head, rest + 8 * (uint64_t)k, 8);
        at += print_version_2(part(file, at, size), chart_names[k]);
    }
    return at;
}

/* Version 3 (section 3): a table of charts, the containers' heads, then levels of all of them. */
static uint64_t print_version_3(bytes file)
{
    enum { TABLE = 31, ROW = 154, HEAD_BYTES = 150 };
    bytes head = read_head(file);
    uint64_t charts = number(head, 28, 1), at = TABLE + ROW * charts, all = head.size, rest;
    if (charts > sizeof chart_names / sizeof *chart_names)
        fail("more charts than are known");
    for (uint64_t n = number(head, 29, 2); n > 0; n--)
        at += 8 + number(head, at + 4, 4);
    for (uint64_t k = 0; k < charts; k++) {
        bytes container = part(head, at, number(head, TABLE + ROW * k + HEAD_BYTES, 4));
        if (read_head(container).size != container.size)
            fail("a container's head has another size than the table says");
        all += print_container(container, file, chart_names[k], true, &rest);
        at += container.size;
    }
    if (at != head.size)
        fail("the head has bytes left over");
    return all;
}

int main(int argc, char **argv)
{
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (!file || fseek(file, 0, SEEK_END) != 0)
        fail("expected a packed terrain");
    long size = ftell(file);
    uint8_t *all = size > 0 ? malloc((size_t)size) : NULL;
    rewind(file);
    if (!all || fread(all, 1, (size_t)size, file) != (size_t)size)
        fail("the file cannot be read");
    fclose(file);
    bytes whole = {all, (size_t)size};
    uint64_t understood = 0;
    switch (number(whole, 8, 4)) {
    case 1:
    case 2: understood = print_version_2(whole, chart_names[0]); break;
    case 3: understood = print_version_3(whole); break;
    default: fail("a version of the format that is not known here");
    }
    if (understood != whole.size)
        fail("the file has parts that belong to nothing");
    free(all);
    return 0;
}

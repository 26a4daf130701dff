/* source_whole.c - whether a file is all there, where the libraries do not look.
 *
 * libpng stops at the last pixel and does not miss the end of a PNG. libtiff (4.5) goes on without directory entries
 * whose values are cut off: a lost table of block offsets makes the blocks zero, a lost nodata tag makes voids pits.
 * Blocks that are cut off themselves it does report; they are checked here all the same, before minutes of reading. */
#include "source_internal.h"

#include "common/base/status.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

bool tc_is_tiff(const unsigned char signature[4])
{
    return memcmp(signature, "II*\0", 4) == 0 || memcmp(signature, "MM\0*", 4) == 0 ||
           memcmp(signature, "II+\0", 4) == 0 || memcmp(signature, "MM\0+", 4) == 0; /* + is BigTIFF */
}

bool tc_is_png(const unsigned char signature[4])
{
    return memcmp(signature, "\x89PNG", 4) == 0;
}

bool tc_is_tclip(const unsigned char signature[8])
{
    return memcmp(signature, "\x89TCLIP\r\n", 8) == 0;
}

typedef struct reader {
    FILE *file;
    uint64_t size;
    bool big_endian;
} reader;

/* An unsigned number of up to 8 bytes. */
static uint64_t number(const reader *r, const unsigned char *bytes, int count)
{
    uint64_t value = 0;
    for (int i = 0; i < count; i++)
        value = value << 8 | bytes[r->big_endian ? i : count - 1 - i];
    return value;
}

static bool read_at(reader *r, uint64_t offset, void *bytes, size_t count)
{
    return offset <= r->size && count <= r->size - offset && fseeko(r->file, (off_t)offset, SEEK_SET) == 0 &&
           fread(bytes, 1, count, r->file) == count;
}

/* ---- PNG -------------------------------------------------------------------------------------------------------- */

static const char *find_png_damage(reader *r)
{
    unsigned char chunk[8];
    uint64_t at = 8;
    r->big_endian = true;
    while (read_at(r, at, chunk, sizeof chunk)) {
        at += 12 + number(r, chunk, 4); /* length, type, content, checksum */
        if (memcmp(chunk + 4, "IEND", 4) == 0)
            return at <= r->size ? NULL : "the end chunk is cut off";
    }
    return "the end chunk is missing";
}

/* ---- TIFF ------------------------------------------------------------------------------------------------------- */

/* An array of a directory: where its values are. */
typedef struct array {
    uint64_t at, count;
    int size; /* bytes a value; 0: no such array */
} array;

static bool array_value(reader *r, array a, uint64_t i, uint64_t *value_ret)
{
    unsigned char bytes[8];
    bool there = i < a.count && read_at(r, a.at + i * (uint64_t)a.size, bytes, (size_t)a.size);
    *value_ret = there ? number(r, bytes, a.size) : 0;
    return there;
}

/* The first directory and the blocks that it names. */
static const char *find_tiff_damage(reader *r)
{
    static const int sizes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8}; /* by type */
    unsigned char bytes[20];
    if (!read_at(r, 0, bytes, 8))
        return "the header is cut off";
    r->big_endian = bytes[0] == 'M';
    bool large = number(r, bytes + 2, 2) == 43; /* BigTIFF */
    if (large && !read_at(r, 0, bytes, 16))
        return "the header is cut off";
    uint64_t at = large ? number(r, bytes + 8, 8) : number(r, bytes + 4, 4);
    const int count_size = large ? 8 : 2, entry_size = large ? 20 : 12, value_size = large ? 8 : 4;
    if (!read_at(r, at, bytes, (size_t)count_size))
        return "the directory is missing";
    uint64_t entries = number(r, bytes, count_size);
    at += (uint64_t)count_size;

    array offsets = {0}, counts = {0};
    for (uint64_t i = 0; i < entries; i++, at += (uint64_t)entry_size) {
        if (!read_at(r, at, bytes, (size_t)entry_size))
            return "the directory is cut off";
        uint64_t tag = number(r, bytes, 2), type = number(r, bytes + 2, 2), count = number(r, bytes + 4, value_size);
        int size = type < sizeof sizes / sizeof *sizes ? sizes[type] : 0;
        if (size == 0 || count == 0)
            continue; /* not of our making: the library's business */
        int head = 4 + value_size;
        bool inside = count <= (uint64_t)(value_size / size);
        array a = {inside ? at + (uint64_t)head : number(r, bytes + head, value_size), count, size};
        if (a.at > r->size || count > (r->size - a.at) / (uint64_t)size)
            return "values of the directory are cut off";
        if (tag == 273 || tag == 324)
            offsets = a;
        if (tag == 279 || tag == 325)
            counts = a;
    }
    uint64_t offset, count;
    for (uint64_t i = 0; array_value(r, offsets, i, &offset) && array_value(r, counts, i, &count); i++)
        if (offset > r->size || count > r->size - offset)
            return "samples are cut off";
    return NULL;
}

tc_status tc_check_whole(const char *path, tc_error *error)
{
    struct stat about;
    unsigned char signature[4] = {0};
    reader r = {.file = fopen(path, "rb")};
    const char *damage = NULL; /* what cannot be opened at all is for others to say */
    if (r.file && fstat(fileno(r.file), &about) == 0 && S_ISREG(about.st_mode)) {
        r.size = (uint64_t)about.st_size;
        if (read_at(&r, 0, signature, 4) && tc_is_tiff(signature))
            damage = find_tiff_damage(&r);
        else if (tc_is_png(signature))
            damage = find_png_damage(&r);
    }
    if (r.file)
        fclose(r.file);
    return damage ? tc_fail(error, TC_ERR_FORMAT, "%s: damaged or truncated: %s", path, damage) : TC_OK;
}

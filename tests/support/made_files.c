/* made_files.c - files byte by byte. */
#include "made_files.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void die(const char *what)
{
    perror(what);
    abort();
}

/* ---- Folder ----------------------------------------------------------------------------------------------------- */

static char folder[256];

const char *made_folder(void)
{
    if (!*folder) {
        const char *place = getenv("TMPDIR");
        snprintf(folder, sizeof folder, "%s/terraclip-test-XXXXXX", place ? place : "/tmp");
        if (!mkdtemp(folder))
            die(folder);
    }
    return folder;
}

const char *made_path(const char *name)
{
    static char paths[8][512];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", made_folder(), name);
    return path;
}

const char *made_name(const char *text)
{
    size_t length = strlen(folder);
    return length && strncmp(text, folder, length) == 0 && text[length] == '/' ? text + length + 1 : text;
}

/* Deletes the folder's files where asked to; the number of them. */
static int each_file(bool unlinked)
{
    DIR *directory = opendir(made_folder());
    int count = 0;
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        if (entry->d_name[0] == '.' && (!entry->d_name[1] || entry->d_name[1] == '.'))
            continue;
        count++;
        if (!unlinked)
            continue;
        const char *path = made_path(entry->d_name);
        if (unlink(path) != 0)
            rmdir(path);
    }
    if (directory)
        closedir(directory);
    return count;
}

int made_folder_count(void)
{
    return each_file(false);
}

void made_folder_remove(void)
{
    each_file(true);
    rmdir(made_folder());
    *folder = '\0';
}

/* ---- Bytes ------------------------------------------------------------------------------------------------------ */

void make_bytes(const char *path, const void *bytes, size_t count)
{
    unlink(path); /* a file that is written over is flushed to the disk by some systems, which takes long */
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, count, file) != count || fclose(file) != 0)
        die(path);
}

void cut_file(const char *path, long keep)
{
    struct stat about;
    if (stat(path, &about) != 0 || truncate(path, keep < 0 ? about.st_size + keep : keep) != 0)
        die(path);
}

typedef struct buffer {
    unsigned char *bytes;
    size_t count, room;
} buffer;

static void put(buffer *b, const void *bytes, size_t count)
{
    if (b->count + count > b->room) {
        b->room = 2 * (b->count + count);
        b->bytes = realloc(b->bytes, b->room);
        if (!b->bytes)
            die("memory");
    }
    if (count)
        memcpy(b->bytes + b->count, bytes, count);
    b->count += count;
}

static void put_little(buffer *b, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        put(b, &(unsigned char){(unsigned char)(value >> 8 * i)}, 1);
}

static void put_big(buffer *b, uint64_t value, int bytes)
{
    for (int i = bytes - 1; i >= 0; i--)
        put(b, &(unsigned char){(unsigned char)(value >> 8 * i)}, 1);
}

static void put_text(buffer *b, const char *text)
{
    put(b, text, strlen(text) + 1);
}

static void finish(buffer *b, const char *path)
{
    make_bytes(path, b->bytes, b->count);
    free(b->bytes);
}

/* ---- TIFF ------------------------------------------------------------------------------------------------------- */

/* A directory under construction: entries in order of tags, longer values in a heap behind it. */
typedef struct directory {
    buffer entries, heap;
    int count;
    uint32_t heap_start;
} directory;

enum { ASCII = 2, SHORT = 3, LONG = 4, DOUBLE = 12 };

static void entry(directory *d, int tag, int type, uint32_t count, const void *values)
{
    static const int sizes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8};
    size_t size = (size_t)sizes[type] * count;
    put_little(&d->entries, (uint64_t)tag, 2);
    put_little(&d->entries, (uint64_t)type, 2);
    put_little(&d->entries, count, 4);
    if (size <= 4) {
        unsigned char inside[4] = {0};
        memcpy(inside, values, size);
        put(&d->entries, inside, 4);
    } else {
        put_little(&d->entries, d->heap_start + d->heap.count, 4);
        put(&d->heap, values, size);
    }
    d->count++;
}

static void entry_number(directory *d, int tag, uint32_t value)
{
    entry(d, tag, LONG, 1, &value);
}

static void entry_shorts(directory *d, int tag, uint32_t count, int value)
{
    uint16_t values[8];
    for (uint32_t i = 0; i < count && i < 8; i++)
        values[i] = (uint16_t)value;
    entry(d, tag, SHORT, count, values);
}

static void put_geo(directory *d, const made_tiff *t)
{
    const double *g = t->transform;
    const double matrix[16] = {g[1], g[2], 0, g[0], g[4], g[5], 0, g[3], 0, 0, 0, 0, 0, 0, 0, 1};
    entry(d, 34264, DOUBLE, 16, matrix);
    bool geographic = t->epsg == 4326;
    const uint16_t keys[16] = {1,    1, 0, (uint16_t)(t->epsg ? 3 : 1),    1025, 0, 1, (uint16_t)(t->point ? 2 : 1),
                               1024, 0, 1, (uint16_t)(geographic ? 2 : 1), 0,    0, 1, 0};
    /* Keys must come in order: 1024 before 1025. */
    uint16_t ordered[16];
    memcpy(ordered, keys, 8);
    if (t->epsg) {
        memcpy(ordered + 4, keys + 8, 8);
        memcpy(ordered + 8, keys + 4, 8);
        const uint16_t crs[4] = {(uint16_t)(geographic ? 2048 : 3072), 0, 1, (uint16_t)t->epsg};
        memcpy(ordered + 12, crs, 8);
    } else {
        memcpy(ordered + 4, keys + 4, 8);
    }
    entry(d, 34735, SHORT, t->epsg ? 16 : 8, ordered);
}

void make_tiff(const char *path, const made_tiff *t)
{
    int channels = t->channels ? t->channels : 1;
    size_t sample = (size_t)t->bits / 8 * (size_t)channels, row = sample * (size_t)t->width;
    int block_width = t->tile ? t->tile : t->width, block_height = t->tile ? t->tile : 2;
    int across = (t->width + block_width - 1) / block_width, down = (t->height + block_height - 1) / block_height;
    uint32_t blocks = (uint32_t)(across * down);
    uint32_t *offsets = calloc(blocks, sizeof *offsets), *counts = calloc(blocks, sizeof *counts);

    /* Header, samples, directory, heap. */
    buffer b = {0};
    put(&b, "II*\0\0\0\0\0", 8);
    const unsigned char *samples = t->samples;
    for (uint32_t k = 0; k < blocks; k++) {
        int x0 = (int)(k % (uint32_t)across) * block_width, y0 = (int)(k / (uint32_t)across) * block_height;
        offsets[k] = (uint32_t)b.count;
        for (int y = y0; y < y0 + block_height && (t->tile || y < t->height); y++) {
            for (int x = x0; x < x0 + block_width; x++) {
                static const unsigned char nothing[64] = {0};
                bool inside = x < t->width && y < t->height;
                put(&b, inside ? samples + (size_t)y * row + (size_t)x * sample : nothing, sample);
            }
        }
        counts[k] = (uint32_t)b.count - offsets[k];
    }
    if (b.count % 2)
        put(&b, "", 1);
    uint32_t start = (uint32_t)b.count;
    for (int i = 0; i < 4; i++)
        b.bytes[4 + i] = (unsigned char)(start >> 8 * i);

    directory d = {.heap_start = start + 2 + 32 * 12 + 4}; /* room for 32 entries */
    entry_number(&d, 256, (uint32_t)t->width);
    entry_number(&d, 257, (uint32_t)t->height);
    entry_shorts(&d, 258, (uint32_t)channels, t->bits);
    entry_shorts(&d, 259, 1, 1);
    entry_shorts(&d, 262, 1, t->palette ? 3 : channels == 3 ? 2 : 1);
    if (!t->tile)
        entry(&d, 273, LONG, blocks, offsets);
    entry_shorts(&d, 277, 1, channels);
    if (t->tile) {
        uint16_t colours[768] = {0};
        if (t->palette)
            entry(&d, 320, SHORT, 768, colours);
        entry_number(&d, 322, (uint32_t)t->tile);
        entry_number(&d, 323, (uint32_t)t->tile);
        entry(&d, 324, LONG, blocks, offsets);
        entry(&d, 325, LONG, blocks, counts);
    } else {
        entry_number(&d, 278, (uint32_t)block_height);
        entry(&d, 279, LONG, blocks, counts);
        uint16_t colours[768] = {0};
        if (t->palette)
            entry(&d, 320, SHORT, 768, colours);
    }
    entry_shorts(&d, 339, (uint32_t)channels, (int)t->format);
    if (t->transform)
        put_geo(&d, t);
    if (t->metadata) {
        char text[1024];
        snprintf(text, sizeof text, "<GDALMetadata>%s</GDALMetadata>", t->metadata);
        entry(&d, 42112, ASCII, (uint32_t)strlen(text) + 1, text);
    }
    if (t->nodata)
        entry(&d, 42113, ASCII, (uint32_t)strlen(t->nodata) + 1, t->nodata);

    put_little(&b, (uint64_t)d.count, 2);
    put(&b, d.entries.bytes, d.entries.count);
    put_little(&b, 0, 4); /* no further directory */
    while (b.count < d.heap_start)
        put(&b, "", 1);
    put(&b, d.heap.bytes, d.heap.count);
    finish(&b, path);
    free(d.entries.bytes);
    free(d.heap.bytes);
    free(offsets);
    free(counts);
}

/* ---- Pictures --------------------------------------------------------------------------------------------------- */

static uint32_t crc(const unsigned char *bytes, size_t count)
{
    uint32_t c = 0xffffffff;
    for (size_t i = 0; i < count; i++) {
        c ^= bytes[i];
        for (int k = 0; k < 8; k++)
            c = c & 1 ? 0xedb88320 ^ c >> 1 : c >> 1;
    }
    return ~c;
}

static void put_chunk(buffer *b, const char *type, const buffer *content)
{
    put_big(b, content->count, 4);
    size_t start = b->count;
    put(b, type, 4);
    put(b, content->bytes, content->count);
    put_big(b, crc(b->bytes + start, b->count - start), 4);
}

void make_png(const char *path, int width, int height, int depth, int colour, const void *samples)
{
    int size = depth / 8 * (colour == 2 ? 3 : 1);
    buffer header = {0}, rows = {0}, packed = {0}, b = {0}, none = {0};
    put_big(&header, (uint64_t)width, 4);
    put_big(&header, (uint64_t)height, 4);
    const unsigned char kind[5] = {(unsigned char)depth, (unsigned char)colour, 0, 0, 0};
    put(&header, kind, 5);

    const unsigned char *bytes = samples;
    for (int y = 0; y < height; y++) {
        put(&rows, "\0", 1); /* no filter */
        for (int i = 0; i < width * size; i++) {
            size_t at = (size_t)(y * width * size + i);
            put(&rows, bytes + (depth == 16 ? at ^ 1 : at), 1); /* big-endian */
        }
    }
    put(&packed, "\x78\x01", 2);
    uint32_t low = 1, high = 0;
    for (size_t at = 0; at < rows.count;) {
        size_t count = rows.count - at < 65535 ? rows.count - at : 65535;
        put_little(&packed, at + count == rows.count, 1);
        put_little(&packed, count, 2);
        put_little(&packed, ~count & 0xffff, 2);
        put(&packed, rows.bytes + at, count);
        at += count;
    }
    for (size_t i = 0; i < rows.count; i++) {
        low = (low + rows.bytes[i]) % 65521;
        high = (high + low) % 65521;
    }
    put_big(&packed, high << 16 | low, 4);

    put(&b, "\x89PNG\r\n\x1a\n", 8);
    put_chunk(&b, "IHDR", &header);
    if (colour == 3) {
        buffer palette = {0};
        for (int i = 0; i < 768; i++)
            put(&palette, &(unsigned char){(unsigned char)i}, 1);
        put_chunk(&b, "PLTE", &palette);
        free(palette.bytes);
    }
    put_chunk(&b, "IDAT", &packed);
    put_chunk(&b, "IEND", &none);
    finish(&b, path);
    free(header.bytes);
    free(rows.bytes);
    free(packed.bytes);
}

static void put_attribute(buffer *b, const char *name, const char *type, const buffer *value)
{
    put_text(b, name);
    put_text(b, type);
    put_little(b, value->count, 4);
    put(b, value->bytes, value->count);
    free(value->bytes);
}

void make_exr(const char *path, int width, int height, const float *samples)
{
    make_exr_channels(path, width, height, "Y", samples);
}

void make_exr_channels(const char *path, int width, int height, const char *channels, const float *samples)
{
    buffer b = {0}, v = {0};
    const size_t count = strlen(channels);
    put(&b, "\x76\x2f\x31\x01\x02\0\0\0", 8);
    for (size_t k = 0; k < count; k++) {
        put(&v, &channels[k], 1);
        put_little(&v, 0, 1);
        put_little(&v, 2, 4); /* float */
        put_little(&v, 0, 4);
        put_little(&v, 1, 4);
        put_little(&v, 1, 4);
    }
    put_little(&v, 0, 1);
    put_attribute(&b, "channels", "chlist", &v);
    v = (buffer){0};
    put_little(&v, 0, 1);
    put_attribute(&b, "compression", "compression", &v);
    for (int i = 0; i < 2; i++) {
        v = (buffer){0};
        put_little(&v, 0, 8);
        put_little(&v, (uint64_t)width - 1, 4);
        put_little(&v, (uint64_t)height - 1, 4);
        put_attribute(&b, i ? "displayWindow" : "dataWindow", "box2i", &v);
    }
    v = (buffer){0};
    put_little(&v, 0, 1);
    put_attribute(&b, "lineOrder", "lineOrder", &v);
    v = (buffer){0};
    put(&v, &(float){1}, 4);
    put_attribute(&b, "pixelAspectRatio", "float", &v);
    v = (buffer){0};
    put_little(&v, 0, 8);
    put_attribute(&b, "screenWindowCenter", "v2f", &v);
    v = (buffer){0};
    put(&v, &(float){1}, 4);
    put_attribute(&b, "screenWindowWidth", "float", &v);
    put_little(&b, 0, 1);
    uint64_t line = 8 + 4 * count * (uint64_t)width, first = b.count + 8 * (uint64_t)height;
    for (int y = 0; y < height; y++)
        put_little(&b, first + (uint64_t)y * line, 8);
    for (int y = 0; y < height; y++) {
        put_little(&b, (uint64_t)y, 4);
        put_little(&b, line - 8, 4);
        for (size_t k = 0; k < count; k++)
            for (int x = 0; x < width; x++)
                put(&b, samples + ((size_t)y * (size_t)width + (size_t)x) * count + k, 4);
    }
    finish(&b, path);
}

void make_tga(const char *path, int width, int height, int channels, const uint8_t *samples)
{
    const unsigned char head[18] = {[2] = 2, [16] = (unsigned char)(8 * channels), [17] = channels == 4 ? 0x28 : 0x20};
    buffer b = {0};
    put(&b, head, 12);
    put_little(&b, (uint64_t)width, 2);
    put_little(&b, (uint64_t)height, 2);
    put(&b, head + 16, 2);
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
        for (int k = 0; k < channels; k++) /* blue, green, red, alpha */
            put(&b, samples + i * (size_t)channels + (k < 3 ? 2 - k : 3), 1);
    finish(&b, path);
}

void make_pgm(const char *path, int width, int height, const uint16_t *samples)
{
    buffer b = {0};
    char header[64];
    snprintf(header, sizeof header, "P5\n%d %d\n65535\n", width, height);
    put(&b, header, strlen(header));
    for (int i = 0; i < width * height; i++)
        put_big(&b, samples[i], 2);
    finish(&b, path);
}

void make_hgt(const char *path, int side, const int16_t *samples)
{
    buffer b = {0};
    for (int i = 0; i < side * side; i++)
        put_big(&b, (uint16_t)samples[i], 2);
    finish(&b, path);
}

void make_jp2(const char *path)
{
    static const unsigned char bytes[] = {
        0x00, 0x00, 0x00, 0x0c, 0x6a, 0x50, 0x20, 0x20, 0x0d, 0x0a, 0x87, 0x0a, 0x00, 0x00, 0x00, 0x14, 0x66, 0x74,
        0x79, 0x70, 0x6a, 0x70, 0x32, 0x20, 0x00, 0x00, 0x00, 0x00, 0x6a, 0x70, 0x32, 0x20, 0x00, 0x00, 0x00, 0x2d,
        0x6a, 0x70, 0x32, 0x68, 0x00, 0x00, 0x00, 0x16, 0x69, 0x68, 0x64, 0x72, 0x00, 0x00, 0x00, 0x0c, 0x00, 0x00,
        0x00, 0x10, 0x00, 0x01, 0x0f, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x0f, 0x63, 0x6f, 0x6c, 0x72, 0x01, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x11, 0x00, 0x00, 0x01, 0x8c, 0x6a, 0x70, 0x32, 0x63, 0xff, 0x4f, 0xff, 0x51, 0x00,
        0x29, 0x00, 0x02, 0x00, 0x00, 0x00, 0x10, 0x00, 0x00, 0x00, 0x0c, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x10, 0x00, 0x00, 0x00, 0x0c, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x01, 0x0f, 0x01, 0x01, 0xff, 0x52, 0x00, 0x0d, 0x01, 0x00, 0x00, 0x01, 0x00, 0x00, 0x04, 0x04, 0x00, 0x01,
        0x99, 0xff, 0x5c, 0x00, 0x04, 0x40, 0x80, 0xff, 0x64, 0x00, 0x3d, 0x00, 0x01, 0x43, 0x72, 0x65, 0x61, 0x74,
        0x65, 0x64, 0x20, 0x62, 0x79, 0x20, 0x4f, 0x70, 0x65, 0x6e, 0x4a, 0x50, 0x45, 0x47, 0x20, 0x76, 0x65, 0x72,
        0x73, 0x69, 0x6f, 0x6e, 0x20, 0x32, 0x2e, 0x35, 0x2e, 0x30, 0x2e, 0x20, 0x4c, 0x4f, 0x53, 0x53, 0x4c, 0x45,
        0x53, 0x53, 0x20, 0x73, 0x65, 0x74, 0x74, 0x69, 0x6e, 0x67, 0x73, 0x20, 0x75, 0x73, 0x65, 0x64, 0xff, 0x90,
        0x00, 0x0a, 0x00, 0x00, 0x00, 0x00, 0x01, 0x01, 0x00, 0x01, 0xff, 0x93, 0xcf, 0xfc, 0x33, 0xbc, 0x11, 0x50,
        0x54, 0xaf, 0xff, 0x7d, 0x7a, 0x9c, 0x00, 0x00, 0x00, 0x01, 0x84, 0x83, 0x52, 0x77, 0x6f, 0x04, 0x12, 0xce,
        0x03, 0x80, 0x06, 0xd9, 0x20, 0x18, 0x48, 0x3d, 0xc7, 0xd2, 0x40, 0x06, 0xa8, 0x86, 0x0d, 0xff, 0x7c, 0x20,
        0x80, 0x63, 0xd1, 0x2e, 0x60, 0xb2, 0x40, 0x06, 0xa8, 0x86, 0x0d, 0xff, 0x7c, 0x20, 0x80, 0x63, 0xd1, 0x2d,
        0x50, 0xa1, 0x6f, 0x03, 0xe6, 0x0b, 0x17, 0x71, 0x48, 0xd5, 0x0a, 0x18, 0x1e, 0x54, 0xaf, 0x94, 0xc2, 0x3b,
        0x98, 0xff, 0x84, 0x73, 0x8f, 0xf1, 0xac, 0x90, 0xc7, 0xb9, 0xce, 0x3f, 0xc7, 0x7d, 0x05, 0x8a, 0xb4, 0x82,
        0x8c, 0x2c, 0xe0, 0xb4, 0x47, 0x87, 0x62, 0x9a, 0xcc, 0x0b, 0x31, 0xac, 0xa7, 0x6b, 0x0d, 0x27, 0x94, 0xa5,
        0x68, 0xd5, 0xa0, 0x15, 0xd2, 0x77, 0x85, 0xf9, 0xa1, 0xad, 0xb4, 0x0f, 0xcd, 0x0a, 0xdc, 0x23, 0xd5, 0x25,
        0xe1, 0x7e, 0x68, 0x56, 0xe1, 0x1e, 0xa9, 0x2f, 0x0b, 0xf3, 0x43, 0x5b, 0x63, 0x3c, 0x38, 0xc8, 0x7c, 0x64,
        0x3e, 0x32, 0x16, 0xe4, 0x29, 0xa1, 0xb3, 0xe1, 0xc6, 0x43, 0xe2, 0xf1, 0x4c, 0xb9, 0x1a, 0x1b, 0x3e, 0x1c,
        0x64, 0x3e, 0xec, 0xba, 0xaa, 0x02, 0xc5, 0x01, 0x62, 0x82, 0x0f, 0xe4, 0x21, 0xd8, 0x0d, 0x50, 0x16, 0x28,
        0x20, 0xfe, 0x42, 0x1d, 0x80, 0xd5, 0x01, 0x62, 0x80, 0x7b, 0xea, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa,
        0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0x51, 0x10, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x01, 0xff, 0xd9};
    make_bytes(path, bytes, sizeof bytes);
}

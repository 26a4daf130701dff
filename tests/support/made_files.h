/* made_files.h - elevation files written byte by byte, so that tests need neither samples in the tree nor the libraries
 * that are being tested. */
#ifndef MADE_FILES_H
#define MADE_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A folder of this test program's own, made at the first call; and a path in it (in one of a few static buffers). */
const char *made_folder(void);
const char *made_path(const char *name);
void made_folder_remove(void);
/* What follows the folder in a text that begins with it, as messages about its files do; else the text. */
const char *made_name(const char *text);

/* Number of files in the folder. */
int made_folder_count(void);

void make_bytes(const char *path, const void *bytes, size_t count);

/* Cuts a file to its first keep bytes, or by -keep bytes where negative. */
void cut_file(const char *path, long keep);

typedef enum made_format { MADE_UINT = 1, MADE_INT = 2, MADE_FLOAT = 3 } made_format;

/* An uncompressed little-endian TIFF. Zero is the default: strips, one channel, no georeference. */
typedef struct made_tiff {
    int width, height;
    int bits; /* a sample */
    made_format format;
    const void *samples; /* rows top to bottom */
    int channels;        /* 0: one; interleaved */
    int tile;            /* side of square tiles, a multiple of 16; 0: strips of 2 rows */
    bool palette;
    const double *transform; /* x0, dx, rx, y0, ry, dy as GDAL's, of the registration below */
    int epsg;                /* with transform: 4326 or a projected one; 0 none */
    bool point;              /* registration */
    const char *nodata;
    const char *metadata; /* GDAL's XML items: scale, offset, unit */
} made_tiff;
void make_tiff(const char *path, const made_tiff *tiff);

/* A PNG whose bytes are stored, not compressed. colour: 0 grey, 2 RGB, 3 palette; depth 8 or 16, samples of that size.
 */
void make_png(const char *path, int width, int height, int depth, int colour, const void *samples);

/* An uncompressed OpenEXR picture with one float channel "Y"; or with several, a letter each in alphabetical order,
 * whose samples follow each other. */
void make_exr(const char *path, int width, int height, const float *samples);
void make_exr_channels(const char *path, int width, int height, const char *channels, const float *samples);

/* A TGA picture of 24 or 32 bits, from the top: red, green, blue and perhaps alpha. */
void make_tga(const char *path, int width, int height, int channels, const uint8_t *samples);

/* A 16-bit binary PGM. */
void make_pgm(const char *path, int width, int height, const uint16_t *samples);

/* A square .hgt of int16 samples. */
void make_hgt(const char *path, int side, const int16_t *samples);

/* A JPEG 2000 file of 16 x 12 samples, 1000 + 10 column + row. */
void make_jp2(const char *path);

#endif

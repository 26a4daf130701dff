/* window_pixels.c - what an X window dump (xwd, 24 or 32 bits) shows:
 *
 *     window-pixels RRGGBB < DUMP         how many pixels are not of that colour, and how many there are
 *     window-pixels middle RRGGBB < DUMP  the middle of those that are about of that colour, and how many: "X Y N"
 *     window-pixels colours < DUMP        how many colours there are */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    HEADER_SIZE,
    VERSION,
    FORMAT,
    DEPTH,
    WIDTH,
    HEIGHT,
    XOFFSET,
    BYTE_ORDER_AT,
    BITS_AT = 11,
    LINE_AT = 12,
    COLOURS_AT = 19,
    FIELDS = 25
};

static uint32_t word(const unsigned char *p) /* the head is big-endian */
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

typedef struct dump {
    uint32_t width, height;
    uint32_t *pixel; /* RRGGBB, row by row */
} dump;

static bool read_dump(FILE *file, dump *d)
{
    unsigned char head[4 * FIELDS];
    if (fread(head, 1, sizeof head, file) != sizeof head || word(head + 4 * VERSION) != 7)
        return false;
    uint32_t field[FIELDS];
    for (int i = 0; i < FIELDS; i++)
        field[i] = word(head + 4 * i);
    for (uint32_t skip = field[HEADER_SIZE] - sizeof head + 12 * field[COLOURS_AT]; skip > 0; skip--)
        if (fgetc(file) == EOF)
            return false;
    uint32_t pixel_bytes = field[BITS_AT] / 8, line = field[LINE_AT];
    *d = (dump){.width = field[WIDTH], .height = field[HEIGHT]};
    unsigned char *row = malloc(line);
    d->pixel = malloc((size_t)d->width * d->height * sizeof *d->pixel);
    if (!row || !d->pixel || pixel_bytes < 3 || line < d->width * pixel_bytes)
        return false;
    for (uint32_t y = 0; y < d->height; y++) {
        if (fread(row, 1, line, file) != line)
            return false;
        for (uint32_t x = 0; x < d->width; x++) {
            const unsigned char *p = row + x * pixel_bytes;
            d->pixel[(size_t)y * d->width + x] =
                field[BYTE_ORDER_AT] == 0 ? (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | p[0] : word(p) & 0xffffff;
        }
    }
    free(row);
    return true;
}

static bool alike(uint32_t a, uint32_t b)
{
    for (int shift = 0; shift < 24; shift += 8)
        if (abs((int)(a >> shift & 255) - (int)(b >> shift & 255)) > 64)
            return false;
    return true;
}

static void print_middle(const dump *d, uint32_t wanted)
{
    double x_sum = 0, y_sum = 0;
    long count = 0;
    for (uint32_t y = 0; y < d->height; y++)
        for (uint32_t x = 0; x < d->width; x++)
            if (alike(d->pixel[(size_t)y * d->width + x], wanted))
                x_sum += x + 0.5, y_sum += y + 0.5, count++;
    printf("%.1f %.1f %ld\n", count ? x_sum / (double)count : 0, count ? y_sum / (double)count : 0, count);
}

static int by_value(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static void print_colours(dump *d)
{
    size_t count = (size_t)d->width * d->height;
    long colours = count > 0;
    qsort(d->pixel, count, sizeof *d->pixel, by_value);
    for (size_t i = 1; i < count; i++)
        colours += d->pixel[i] != d->pixel[i - 1];
    printf("%ld\n", colours);
}

static void print_others(const dump *d, uint32_t wanted)
{
    long count = (long)d->width * (long)d->height, other = 0;
    for (long i = 0; i < count; i++)
        other += d->pixel[i] != wanted;
    printf("%ld of %ld\n", other, count);
}

int main(int argc, char **argv)
{
    dump d = {0};
    if (argc < 2 || argc > 3 || !read_dump(stdin, &d))
        return 2;
    uint32_t colour = (uint32_t)strtoul(argv[argc - 1], NULL, 16);
    if (argc == 3 && strcmp(argv[1], "middle") == 0)
        print_middle(&d, colour);
    else if (argc == 2 && strcmp(argv[1], "colours") == 0)
        print_colours(&d);
    else if (argc == 2)
        print_others(&d, colour);
    else
        return 2;
    free(d.pixel);
    return 0;
}

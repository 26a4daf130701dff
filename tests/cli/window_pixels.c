/* window_pixels.c - window-pixels RRGGBB < DUMP: how many pixels of an X window dump (xwd, 24 or 32 bits) are not of
 * that colour, and how many there are. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

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

int main(int argc, char **argv)
{
    unsigned char head[4 * FIELDS];
    if (argc != 2 || fread(head, 1, sizeof head, stdin) != sizeof head || word(head + 4 * VERSION) != 7)
        return 2;
    uint32_t field[FIELDS];
    for (int i = 0; i < FIELDS; i++)
        field[i] = word(head + 4 * i);
    for (uint32_t skip = field[HEADER_SIZE] - sizeof head + 12 * field[COLOURS_AT]; skip > 0; skip--)
        if (getchar() == EOF)
            return 2;
    uint32_t wanted = (uint32_t)strtoul(argv[1], NULL, 16), pixel_bytes = field[BITS_AT] / 8, line = field[LINE_AT];
    unsigned char *row = malloc(line);
    long other = 0;
    if (!row || pixel_bytes < 3 || line < field[WIDTH] * pixel_bytes)
        return 2;
    for (uint32_t y = 0; y < field[HEIGHT]; y++) {
        if (fread(row, 1, line, stdin) != line)
            return 2;
        for (uint32_t x = 0; x < field[WIDTH]; x++) {
            const unsigned char *p = row + x * pixel_bytes;
            uint32_t value =
                field[BYTE_ORDER_AT] == 0 ? (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | p[0] : word(p) & 0xffffff;
            other += value != wanted;
        }
    }
    printf("%ld of %ld\n", other, (long)field[WIDTH] * (long)field[HEIGHT]);
    free(row);
    return 0;
}

/* fuzz_tile.h - what fuzz_tile.c makes of its input. */
#ifndef FUZZ_TILE_H
#define FUZZ_TILE_H

#include <stdbool.h>

#include "common/packed/file/envelope.h"

enum { FUZZ_MASK = TC_CODERS, FUZZ_PAGE, FUZZ_HEAD, FUZZ_KINDS, FUZZ_FIXED = 7 };

typedef struct fuzz_tile {
    int kind; /* a tc_coder or one of the above */
    int64_t width, height;
    int tile;
    unsigned seed;
    const uint8_t *model, *bytes;
    size_t model_size, size;
} fuzz_tile;

/* False for too few bytes. */
static inline bool fuzz_tile_read(const uint8_t *data, size_t size, fuzz_tile *f)
{
    if (size < FUZZ_FIXED)
        return false;
    *f = (fuzz_tile){.kind = data[0] % FUZZ_KINDS,
                     .width = 1 + 2 * data[1] / 3 * 2, /* up to three tiles */
                     .height = 1 + data[2],
                     .tile = data[3],
                     .seed = data[4]};
    f->model = data + FUZZ_FIXED;
    f->model_size = (size_t)tc_load(data + 5, 2) % (size - FUZZ_FIXED + 1);
    f->bytes = f->model + f->model_size;
    f->size = size - FUZZ_FIXED - f->model_size;
    return true;
}

#endif

/* packed_internal.h - a pyramid read from a packed file: what the files that read it share.
 *
 *     packed_heights.c   heights in height units, from tiles and the coarser level
 *     packed_masks.c     masks of voids, likewise
 *     packed_field.c   the pyramid's interface, and opening
 *     packed_scratch.c   memory that they use meanwhile */
#ifndef TC_PACKED_INTERNAL_H
#define TC_PACKED_INTERNAL_H

#include <stdatomic.h>

#include "common/packed/file/level_coder.h"
#include "common/packed/file/packed_file.h"
#include "prefetch.h"

enum {
    WHOLE_SIZE = 256, /* levels of at most so many samples along a side are held whole */
    CACHE_BYTES = 32 << 20,
    MASK_SIDE = 2 * TC_TILE,
    MASK_BYTES = 8 << 20,
    /* Samples that are read at once; about so many, next_cut(). */
    BLOCK_WIDTH = 512,
    BLOCK_HEIGHT = 256,
    CHUNK_BYTES = 1 << 20,
    AT_ONCE = 2 /* tiles that are decoded */
};

/* ---- Scratch memory: a stack of chunks, kept from call to call ------------------------------------------------- */

typedef struct chunk {
    struct chunk *before;
    size_t size, used;
    _Alignas(64) unsigned char bytes[];
} chunk;

typedef struct scratch {
    struct scratch *next;
    chunk *top, *spare; /* spare: chunks let go of, largest last */
    void *work[AT_ONCE];
    uint8_t *stream[AT_ONCE]; /* bytes of a tile */
} scratch;

typedef struct mark {
    chunk *top;
    size_t used;
} mark;

mark tc_scratch_here(const scratch *s);
/* NULL where there is no memory. */
void *tc_scratch_take(scratch *s, size_t bytes);
/* Gives back all that was taken since the mark. */
void tc_scratch_return(scratch *s, mark m);
void tc_scratch_free(scratch *s);

/* ---- The pyramid ------------------------------------------------------------------------------------------------ */

/* What is made of a level when it is first needed. */
typedef struct level_state {
    pthread_mutex_t mutex;
    _Atomic bool ready;
    tc_status status;
    tc_level_coder coder;
    int32_t *whole; /* heights in height units, [j * width + i]; NULL for large levels */
} level_state;

typedef struct packed_field {
    tc_field head;
    tc_packed_file file;
    tc_block_cache tiles, masks; /* masks: as bytes, [j][i] over 128 x 128 samples */
    level_state level[TC_MAX_FIELD_LEVELS];
    pthread_mutex_t mutex;
    scratch *idle;
    tc_prefetch prefetch;
    tc_void_policy voids;
    float void_height; /* metres above z_base */
    _Atomic int64_t damaged, decoded;
} packed_field;

/* Scratch memory for one reading; NULL where there is no memory. */
scratch *tc_packed_borrow(packed_field *p);
void tc_packed_give_back(packed_field *p, scratch *s);

/* ---- Heights and masks ------------------------------------------------------------------------------------------ */

tc_status tc_scratch_plane(scratch *s, tc_rect rect, tc_plane *plane_ret);

/* Heights of level l over to->rect, in height units. */
tc_status tc_packed_units(packed_field *p, int l, const tc_plane *to, scratch *s);

/* Mask of level l over to->rect. */
tc_status tc_packed_mask(packed_field *p, int l, const tc_mask_plane *to, scratch *s);

/* Whether all tiles are decoded from level l down to one that is held whole; or so many that the cache could not keep
 * them until they are asked for. */
bool tc_packed_decoded(packed_field *p, int l, tc_rect rect);

#endif

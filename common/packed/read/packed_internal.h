/* packed_internal.h - a pyramid read from a packed file: what the files that read it share.
 *
 *     packed_heights.c   heights, from tiles and the coarser level
 *     packed_tiles.c     the tiles of a rectangle
 *     packed_metres.c    metres from height units
 *     packed_masks.c     masks of voids, likewise
 *     packed_ready.c     whether they need no waiting, and reading ahead
 *     packed_range.c     bounds of heights
 *     packed_error.c     bounds of what levels are off the finest one
 *     packed_field.c     the field's interface
 *     packed_open.c      opening
 *     packed_scratch.c   memory that they use meanwhile */
#ifndef TC_PACKED_INTERNAL_H
#define TC_PACKED_INTERNAL_H

#include <stdatomic.h>

#include "common/packed/file/level_coder.h"
#include "common/packed/file/packed_file.h"
#include "common/field/measured_errors.h"
#include "tile_set.h"
#include "tile_store.h"

enum {
    WHOLE_SIZE = 256, /* levels of at most so many samples along a side are held whole */
    MASK_SIDE = 2 * TC_TILE,
    CHUNK_BYTES = 1 << 20,
    LARGE = 1 << 19,      /* samples of a block that no nearer cache holds */
    AT_ONCE = TC_TOGETHER /* tiles that are decoded */
};

/* ---- Scratch memory: a stack of chunks, kept from call to call ------------------------------------------------- */

typedef struct chunk {
    struct chunk *before;
    size_t size, used;
    _Alignas(64) unsigned char bytes[];
} chunk;

typedef struct scratch {
    struct scratch *next;
    /* Of the reading under way. */
    bool only_ready; /* it must not wait; missed: it would have had to, and fails */
    bool missed;
    bool waited;        /* for the file, for decoding, for another thread that decodes */
    int large;          /* the finest level, where a block of at least LARGE of its samples is read; else 0 */
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

/* Where what is known of errors comes from. */
typedef enum packed_errors { ERRORS_BY_STEPS, ERRORS_MEASURED, ERRORS_STORED } packed_errors;

typedef struct packed_field {
    tc_field head;
    tc_packed_file file;
    tc_tile_store *store;
    int owner; /* in the store */
    level_state level[TC_MAX_FIELD_LEVELS];
    tc_range_pyramid base[TC_MAX_FIELD_LEVELS]; /* of levels that stand in the head; leaves: samples */
    tc_range_pyramid
        error[TC_MAX_FIELD_LEVELS]; /* once errors_known; leaves: as measured, by steps tiles, of base's samples */
    packed_errors errors;
    _Atomic bool errors_known;
    pthread_mutex_t errors_mutex;
    pthread_mutex_t mutex;
    scratch *idle;
    tc_void_policy voids;
    float void_height;  /* metres above z_base */
    tc_tile_set damage; /* tiles that `damaged` counts */
    _Atomic int64_t damaged, decoded, waits, ranges, range_reads, cancelled;
} packed_field;

/* Scratch memory for one reading; NULL where there is no memory. */
scratch *tc_packed_borrow(packed_field *p);
void tc_packed_give_back(packed_field *p, scratch *s);

/* ---- Heights and masks ------------------------------------------------------------------------------------------ */

tc_status tc_scratch_plane(scratch *s, tc_rect rect, tc_plane *plane_ret);

/* Heights of level l over to->rect, in height units. */
tc_status tc_packed_units(packed_field *p, int l, const tc_plane *to, scratch *s);

/* Where the samples of a rectangle go; z or voids may be NULL. */
typedef struct packed_target {
    tc_rect rect;
    float *z;
    uint8_t *voids;
    ptrdiff_t stride;
} packed_target;
/* The same in metres, without voids. */
tc_status tc_packed_heights(packed_field *p, int l, const packed_target *to, scratch *s);
/* Part of them, from height units. */
void tc_packed_metres(const packed_field *p, const tc_plane *units, const packed_target *to);

/* Mask of level l over to->rect. */
tc_status tc_packed_mask(packed_field *p, int l, const tc_mask_plane *to, scratch *s);

/* Keys in the store. */
static inline uint64_t tc_packed_key(const packed_field *p, int l, bool mask, int64_t index)
{
    return (uint64_t)p->owner << TC_BLOCK_OWNER_SHIFT | (uint64_t)mask << 60 | (uint64_t)l << 54 | (uint64_t)index;
}

/* The same for pages of the index, in the store's faults alone: levels end far below. Those of errors have another. */
static inline uint64_t tc_packed_page_key(const packed_field *p, int l, int64_t px, int64_t py)
{
    return tc_packed_key(p, l, false, ((int64_t)1 << 53) + py * tc_level_pages(&p->head.level[l - 1]).pages_x + px);
}

static inline uint64_t tc_packed_wish_key(const packed_field *p, int index, int l, int64_t px, int64_t py)
{
    return tc_packed_page_key(p, l, px, py) - (index == TC_WISH_ERRORS ? (uint64_t)1 << 52 : 0);
}

/* Whether a level is small enough to be held whole. */
bool tc_packed_is_whole(const packed_field *p, int l);

tc_status tc_packed_read_block(packed_field *p, int l, tc_rect block, const packed_target *to, scratch *s);
/* About how many samples are read at once: by who waits for all of them, and ahead, where something more urgent may
 * come. */
typedef struct block_size {
    int64_t width, height;
} block_size;
static const block_size block_waited = {1024, 1024}, block_ahead = {512, 256};
/* The block at which *rest begins; *rest goes on behind it, and is empty at the end. */
tc_rect tc_packed_next_block(tc_rect rect, block_size most, tc_rect *rest);

extern const tc_field_class tc_packed_class;

/* Its functions. */
tc_ready tc_packed_ready(const tc_field *field, int l, tc_rect rect, tc_urgency urgency);
void tc_packed_overtaken(const tc_field *field, int l, tc_rect rect);
tc_range tc_packed_range(const tc_field *field, int l, tc_rect rect);
void tc_packed_know_errors(const tc_field *field);

/* Reads a piece of what is wished ahead: what it decodes stays in the store. */
tc_piece tc_packed_read_piece(tc_wish *wish);

/* ---- Tiles of a rectangle ---------------------------------------------------------------------------------------- */

/* Positions whose tiles reading rect takes, and the part of the coarser level. */
tc_rect tc_packed_positions(const tc_level_coder *c, tc_rect rect);
tc_rect tc_packed_coarse(const tc_level_coder *c, tc_rect rect);

/* A tile of a gathering. */
typedef struct wanted_tile {
    int64_t tx, ty;
    int64_t turn;    /* positions: where the gathering goes round, the turn on which it meets the tile first */
    bool empty;      /* a tile of details without a byte */
    bool once;       /* nobody else will want it: it is made where it is wanted, and not kept */
    tc_block *block; /* NULL: it is either of these, or another thread is making it */
} wanted_tile;

/* Columns of tiles that positions x0 .. x1 - 1 touch, each once: the first of them, on its turn; the others follow. */
typedef struct tile_columns {
    int64_t turn, first, count, across;
} tile_columns;

tile_columns tc_packed_columns(const tc_level_coder *c, int64_t x0, int64_t x1);
wanted_tile tc_packed_column(const tc_level_coder *c, const tile_columns *t, int64_t n, int64_t ty);
uint64_t tc_packed_tile_key(const packed_field *p, int l, int64_t across, const wanted_tile *t);

/* Copies `from`, which holds `rect` of a level `width` wide, to a plane that may stick out of the level, on every turn
 * that it reaches into. */
void tc_packed_copy_round(const int32_t *from, ptrdiff_t stride, tc_rect rect, int64_t width, const tc_plane *to);

/* Where tiles go: those of the planes that the coder makes use of. */
typedef struct tile_planes {
    tc_plane band[TC_BANDS], sample, correction;
} tile_planes;

/* The tiles that some positions touch, row by row. Those that nobody was making are this thread's to make. Who waits
 * for another thread's has made all of its own in that row and before, and holds unmade ones behind it alone, or of
 * finer levels: so somebody always goes on. */
typedef struct gathering {
    packed_field *field;
    int level;
    scratch *scratch;
    tc_plane coarse; /* the coarser level around them */
    int64_t across;
    wanted_tile *tile;
    int count, begun, done; /* begun: made as far as they are this thread's; done: given out */
} gathering;

/* Takes the tiles, and reads at least `need` of the coarser level. tc_gather_end() has to follow in any case. */
tc_status tc_gather_begin(packed_field *p, int l, tc_rect positions, tc_rect need, scratch *s, gathering *g);
/* Copies tiles down to row ty, of which rows before were given out already. Empty ones are worked out. */
tc_status tc_gather_row(gathering *g, int64_t ty, const tile_planes *to);
void tc_gather_end(gathering *g);

/* Whether a tile is known to be empty, from what is at hand of the index. */
bool tc_packed_known_empty(packed_field *p, int l, const wanted_tile *t);

#endif

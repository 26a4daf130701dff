/* clipmap.h - geometry clipmaps: nested toroidal windows of a field around the viewer (LH04 sections 3 to 5).
 *
 * Level l holds a clip region of at most n x n samples (n = 2^k - 1) in toroidal arrays of (n+1) x (n+1): sample
 * (i, j) lies at (i mod (n+1), j mod (n+1)), so a move fills only the newly exposed L. What a sample is in the arrays
 * is the affair of contents (common/content), of which a clipmap keeps one or several; the regions are one for all.
 *
 * The map of level l is its extent, 0 <= i < extent.x1: the level's own samples and, where the finest level does not
 * end on one of them, one more vertex that lies ON the terrain's edge (and a second one on the same spot where needed
 * to make the perimeter even), so that every level ends exactly where the terrain ends.
 *
 * Where the map wraps, extents have no end in x: column `width` of a level is column 0 again. Level 1 is then held not
 * as the whole map but once around, about where it is wanted, and moves without reading the field: a content depends on
 * where a sample lies on the map, not on which turn.
 *
 * No GL in it. A clipmap belongs to one thread; any number of them may share a field. */
#ifndef TC_CLIPMAP_H
#define TC_CLIPMAP_H

#include "common/terraclip.h"

typedef struct tc_clipmap tc_clipmap;

enum { TC_MAX_LEVELS = 32, TC_CLIPMAP_MAX_N = 2047, TC_MAX_CONTENTS = 4 };

/* ---- Contents ---------------------------------------------------------------------------------------------------- */

/* How a texel lies in memory; who draws makes textures by it. */
typedef enum tc_texel_format {
    TC_TEXEL_RG32F,        /* two floats */
    TC_TEXEL_RGBA8_SNORM,  /* four signed bytes, -127 .. 127 for -1 .. 1 */
    TC_TEXEL_RGBA16_SNORM, /* four of two, -32767 .. 32767 */
    TC_TEXEL_SRGB8_ALPHA8, /* four bytes, 0 .. 255 for 0 .. 1, the first three as shown: filtered as light */
    TC_TEXEL_R8,           /* one */
    TC_TEXEL_FORMATS
} tc_texel_format;
size_t tc_texel_bytes(tc_texel_format format);

typedef struct tc_content_class tc_content_class;

/* A content of a clipmap: its class, and what that is told. */
typedef struct tc_content {
    const tc_content_class *class;
    double parameter;    /* or, where that is not enough: */
    const void *context; /* outlives the clipmap */
} tc_content;

/* What is to be filled: samples rect of a level, within its extent. */
typedef struct tc_fill {
    const tc_clipmap *clipmap;
    const tc_content *content;
    int level;
    tc_rect rect;
    void *texels;       /* the level's toroidal array, */
    const void *coarse; /* and the coarser level's, which holds rect / 2; NULL for level 1 */
    int64_t size;       /* texels along a side of both: a power of two */
    void *scratch;      /* of scratch_bytes() */
    bool *late;         /* NULL: the field is waited for */
} tc_fill;

/* Reads the field's samples or voids for a fill, as tc_field_read_samples() does, which it is instead of. Where it may
 * not wait and would have to, it fails, and the fill with it, which is then made another time. */
tc_status tc_fill_read(const tc_fill *fill, int level, tc_rect rect, void *samples, uint8_t *voids, ptrdiff_t stride);

struct tc_content_class {
    const char *name;
    tc_texel_format format;
    int scale;       /* texels a sample along a side */
    int border;      /* texels to all sides of a rectangle's that change with it */
    int reach;       /* samples of the level around a rectangle that fill reads, */
    int reach_finer; /* and of the next finer level, where there is one; -1: it reads none of it */
    size_t (*scratch_bytes)(int n);
    /* Reads the field and stores texels, toroidally. On failure what it has stored does not count. */
    tc_status (*fill)(const tc_fill *fill);
};

/* ---- Clipmaps ---------------------------------------------------------------------------------------------------- */

typedef struct tc_clipmap_options {
    int n;          /* window size, 2^k - 1, 15 .. TC_CLIPMAP_MAX_N; 0: 255 */
    int max_levels; /* 0: as many as the field needs */
    int coarsest;   /* samples a side of the coarsest level at most; 0: as many as fit a window */
    bool wraps;     /* go on in x beyond the field's sides, where its levels wrap; a sample then has many numbers */
    double spacing_x, spacing_y; /* metres between the finest samples; 0: the field's */
    tc_content content[TC_MAX_CONTENTS];
    int contents;
} tc_clipmap_options;

/* The levels of a clipmap are the field's from the first that fits in a window to the finest (or max_levels of
 * them); they are numbered 1 (coarsest, always resident as a whole) to m. */
tc_status tc_clipmap_create(const tc_field *field, const tc_clipmap_options *options, tc_clipmap **clipmap_ret,
                            tc_error *error);
void tc_clipmap_destroy(tc_clipmap *clipmap);

/* Of a clipmap of windows of n samples over a field, not wrapping and all levels of it: the field's level that is its
 * coarsest, of at most so many samples in x (0: as many as fit a window); and the whole map of a level. */
int tc_clipmap_coarsest(const tc_field *field, int n, int coarsest);
tc_rect tc_clipmap_extent(const tc_field *field, int field_level);

/* Window size for a frame: at the distances where a level is drawn its cells cover about as many pixels as in LH04's
 * setting (n = 255 for a frame of 640 pixels and 90 degrees), 2^k - 1 from 63 to 2047. */
int tc_clipmap_n_for(const tc_camera *camera);

/* TC_ERR_USAGE where n is no window's size. */
tc_status tc_clipmap_check_n(int n, tc_error *error);

int tc_clipmap_n(const tc_clipmap *clipmap);
int tc_clipmap_levels(const tc_clipmap *clipmap);
const tc_field *tc_clipmap_field(const tc_clipmap *clipmap);

/* The field's number of a clipmap level. */
int tc_clipmap_field_level(const tc_clipmap *clipmap, int level);

/* One level as it stands. */
typedef struct tc_clip_level {
    tc_rect extent;              /* the whole map of this level */
    tc_rect clip;                /* samples held */
    tc_rect active;              /* samples to be drawn: LH04's active region; its perimeter lies on even samples */
    tc_rect wanted;              /* what clip is on its way to */
    int shift;                   /* spacing = the field's finest << shift */
    double spacing_x, spacing_y; /* metres */
    int64_t edge_x, edge_y;      /* where the terrain ends, in samples of the field's finest level */
    bool wraps;                  /* in x */
} tc_clip_level;
const tc_clip_level *tc_clipmap_level(const tc_clipmap *clipmap, int level);

/* A content's toroidal array of a level, scale * (n + 1) texels along a side; NULL where it is not kept. */
const void *tc_clipmap_texels(const tc_clipmap *clipmap, const tc_content_class *content, int level);

/* What is kept, 0 .. contents - 1. */
int tc_clipmap_contents(const tc_clipmap *clipmap);
const tc_content_class *tc_clipmap_content(const tc_clipmap *clipmap, int content);

/* Texels of a content that change with a rectangle of samples. */
static inline tc_rect tc_content_rect(const tc_content_class *content, tc_rect r)
{
    return (tc_rect){content->scale * r.x0 - content->border, content->scale * r.y0 - content->border,
                     content->scale * (r.x1 - 1) + 1 + content->border,
                     content->scale * (r.y1 - 1) + 1 + content->border};
}

/* Moves the windows towards wanted[level - 1] (each at most n x n, even origin, within the extent), coarse to fine,
 * filling at most budget height samples, whole rows or columns (budget < 0: no limit; use at least n for progress).
 * A window that reaches beyond what the coarser one wanted can surround is cut. Crops what falls behind so that LH04's
 * four constraints hold: clip(l+1) within clip(l) eroded by 1; active(l) within clip(l); perimeter of active(l) on even
 * samples; active(l+1) within active(l) eroded by 2 (each in the coarser level's samples; nothing is eroded where the
 * terrain ends).
 *
 * wait: what a packed field has yet to decode is waited for. Else it is left to later calls, and decoded by a thread
 * meanwhile, piece by piece, and windows fill as pieces come; and what could not be read is left alone for a time that
 * grows with each failure, by the clock `now`, seconds of any origin. Nothing is held that was not filled. Returns the
 * samples filled, which the budget counts (normals read up to four times as many from the next finer level). */
int64_t tc_clipmap_update(tc_clipmap *clipmap, const tc_rect *wanted, int64_t budget, bool wait, double now);

/* The same with more to say. Who waits gets what is wanted whatever the time is, and asks for nothing ahead. */
typedef struct tc_update {
    int64_t budget; /* samples; below 0: no limit */
    double until; /* by tc_clock_ms(): no piece of some 8,000 samples (a row or column at least) but the first is begun
                   * later; 0: no limit */
    bool wait;
    double now;   /* seconds of any origin */
    double ahead; /* the field is asked, without urgency, for what windows that go on as they move will want so many
                   * seconds on; 0: not */
} tc_update;
int64_t tc_clipmap_update_as(tc_clipmap *clipmap, const tc_rect *wanted, const tc_update *how);

/* Fills samples of a level, whose coarser level holds those around half of it, with all contents, whatever is wanted or
 * held: what an update does of a rectangle, for measuring it. */
tc_status tc_clipmap_fill(tc_clipmap *clipmap, int level, tc_rect rect);

/* Whether every wanted window is held. */
bool tc_clipmap_resident(const tc_clipmap *clipmap);

/* Why a part of what is wanted could not be read the last time it was tried; TC_OK: it could. */
tc_status tc_clipmap_failed(const tc_clipmap *clipmap);

/* Rectangles of a level's samples changed since the reader of this cursor last asked; returns how many and moves the
 * cursor on. A cursor begins as 0, for which, as for one that has fallen too far behind, all that is held has changed.
 */
enum { TC_MAX_CHANGES = 64 };
int tc_clipmap_changes(const tc_clipmap *clipmap, int level, uint64_t *cursor, tc_rect changes[TC_MAX_CHANGES]);

/* Bytes held by a content; NULL: by working space. */
size_t tc_clipmap_bytes(const tc_clipmap *clipmap, const tc_content_class *content);

#endif

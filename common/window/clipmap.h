/* clipmap.h - geometry clipmaps: nested toroidal windows of a pyramid around the viewer (LH04 sections 3 to 5).
 *
 * Level l holds a clip region of at most n x n samples (n = 2^k - 1) in a toroidal array of (n+1) x (n+1): sample
 * (i, j) lies at (i mod (n+1), j mod (n+1)), so a move fills only the newly exposed L. Each sample is the pair
 * (z, z_c): the level's height and that of the coarser level's mesh at the same place, the target of the morph.
 *
 * The map of level l is its extent, 0 <= i < extent.x1: the level's own samples and, where the finest level does not
 * end on one of them, one more vertex that lies ON the terrain's edge (and a second one on the same spot where needed
 * to make the perimeter even), so that every level ends exactly where the terrain ends.
 *
 * Where the map wraps, extents have no end in x: column `width` of a level is column 0 again. Level 1 is then held not
 * as the whole map but once around, about where it is wanted.
 *
 * No GL in it. */
#ifndef TC_CLIPMAP_H
#define TC_CLIPMAP_H

#include <math.h>

#include "common/terraclip.h"

typedef struct tc_clipmap tc_clipmap;

enum { TC_MAX_LEVELS = 32, TC_CLIPMAP_MAX_N = 2047 };

typedef struct tc_clipmap_options {
    int n;          /* window size, 2^k - 1, 15 .. TC_CLIPMAP_MAX_N; 0: 255 */
    int max_levels; /* 0: as many as the pyramid needs */
    bool normals;   /* keep normals, too, at twice the resolution */
    bool holes;     /* keep the void mask, too */
    bool wraps;     /* go on in x beyond the pyramid's sides, where its levels wrap; a sample then has many numbers */
    double spacing_x, spacing_y; /* metres between the finest samples, for normals; 0: the pyramid's */
    /* Metres: levels of spacing g keep slopes times tc_normal_relief(g, relief), since slopes between samples far apart
     * are gentle and would be lost in eight bits. 0: as they are. */
    double relief;
} tc_clipmap_options;

/* The levels of a clipmap are the pyramid's from the first that fits in a window to the finest (or max_levels of
 * them); they are numbered 1 (coarsest, always resident as a whole) to m. */
tc_status tc_clipmap_create(const tc_field *field, const tc_clipmap_options *options, tc_clipmap **clipmap_ret,
                            tc_error *error);
void tc_clipmap_destroy(tc_clipmap *clipmap);

/* Window size for a frame: at the distances where a level is drawn its cells cover about as many pixels as in LH04's
 * setting (n = 255 for a frame of 640 pixels and 90 degrees), 2^k - 1 from 63 to 2047. */
int tc_clipmap_n_for(const tc_camera *camera);

int tc_clipmap_n(const tc_clipmap *clipmap);
int tc_clipmap_levels(const tc_clipmap *clipmap);
const tc_field *tc_clipmap_field(const tc_clipmap *clipmap);

/* The pyramid's number of a clipmap level. */
int tc_clipmap_field_level(const tc_clipmap *clipmap, int level);

/* By how much a level's normals are steeper than the terrain; at least 1. */
static inline double tc_normal_relief(double spacing, double relief)
{
    return relief > 0 && spacing > relief ? sqrt(spacing / relief) : 1;
}

/* One level as it stands. */
typedef struct tc_clip_level {
    tc_rect extent;              /* the whole map of this level */
    tc_rect clip;                /* samples held */
    tc_rect active;              /* samples to be drawn: LH04's active region; its perimeter lies on even samples */
    tc_rect wanted;              /* what clip is on its way to */
    int shift;                   /* spacing = the pyramid's finest << shift */
    double spacing_x, spacing_y; /* metres */
    int64_t edge_x, edge_y;      /* where the terrain ends, in samples of the pyramid's finest level */
} tc_clip_level;
const tc_clip_level *tc_clipmap_level(const tc_clipmap *clipmap, int level);

/* Toroidal arrays of a level, row stride n+1 (normals: 2(n+1)): pairs (z, z_c) in metres above z_base; normals as
 * (x, y) in 1/127, the level's own and then the coarser level's on the same spot; voids 0 or 255. NULL where not kept.
 */
const float (*tc_clipmap_heights(const tc_clipmap *clipmap, int level))[2];
const int8_t (*tc_clipmap_normals(const tc_clipmap *clipmap, int level))[4];
const uint8_t *tc_clipmap_voids(const tc_clipmap *clipmap, int level);

/* Moves the windows towards wanted[level - 1] (each at most n x n, even origin, within the extent), coarse to fine,
 * filling at most budget height samples, whole rows or columns (budget < 0: no limit; use at least n for progress).
 * A window that reaches beyond what the coarser one wanted can surround is cut. What a packed pyramid has yet to decode
 * is waited for, or left to later calls and decoded by a thread meanwhile. Crops what falls behind so that LH04's four
 * constraints hold: clip(l+1) within clip(l) eroded by 1; active(l) within clip(l); perimeter of active(l) on even
 * samples; active(l+1) within active(l) eroded by 2 (each in the coarser level's samples; nothing is eroded where the
 * terrain ends). Returns the height samples filled, which the budget counts (normals read up to four times as many from
 * the next finer level). */
int64_t tc_clipmap_update(tc_clipmap *clipmap, const tc_rect *wanted, int64_t budget, bool wait);

/* Whether every wanted window is held. */
bool tc_clipmap_resident(const tc_clipmap *clipmap);

/* Whether the pyramid could not be read at some time: what is shown there is older data. */
bool tc_clipmap_failed(const tc_clipmap *clipmap);

/* Rectangles of a level's toroidal array changed since they were last taken, in samples of the level (one may wrap);
 * returns how many and forgets them. */
enum { TC_MAX_CHANGES = 64 };
int tc_clipmap_take_changes(tc_clipmap *clipmap, int level, tc_rect changes[TC_MAX_CHANGES]);

/* Bytes held by heights with their void masks and working space, and by normals. */
void tc_clipmap_bytes(const tc_clipmap *clipmap, size_t *heights_ret, size_t *normals_ret);

#endif

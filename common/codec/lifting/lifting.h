/* lifting.h - one level of the terrain's transform in integers: four-point lifting with update, in two dimensions.
 *
 * The same transform as filter.h's D and U, exactly invertible in int32: every step adds a function of samples that
 * the inverse knows too. Arithmetic wraps modulo 2^32, so no input can overflow it; for heights within
 * TC_LIFTING_LIMIT nothing wraps. A level of w x h samples splits into ceil(w/2) x ceil(h/2) positions, each with
 *     LL the next coarser level's height, at (2i, 2j);
 *     HL the horizontal detail, at (2i + 1, 2j);  LH the vertical one, at (2i, 2j + 1);  HH, at (2i + 1, 2j + 1).
 * Where the fine sample does not exist (odd sizes) the detail is zero and means nothing. */
#ifndef TC_LIFTING_H
#define TC_LIFTING_H

#include "common/terraclip.h"
#include "common/field/filter.h"

enum { TC_LIFTING_LIMIT = 1 << 23, TC_LIFTING_REACH = 3 };
enum { TC_HL, TC_LH, TC_HH, TC_BANDS };

/* Which instructions to use: the best there are, or none but the compiler's. The results are the same. */
typedef enum tc_simd { TC_SIMD_AUTO, TC_SIMD_NONE } tc_simd;

/* A fine level. wrap_x: column 0 follows the last one; only for even widths. */
typedef struct tc_lifting_level {
    int64_t width, height;
    bool wrap_x;
} tc_lifting_level;

/* Heights or details over a rectangle: (x, y) is z[(y - rect.y0) * stride + (x - rect.x0)]. */
typedef struct tc_plane {
    int32_t *z;
    ptrdiff_t stride;
    tc_rect rect;
} tc_plane;

static inline int32_t *tc_plane_at(const tc_plane *p, int64_t x, int64_t y)
{
    return p->z + (y - p->rect.y0) * p->stride + (x - p->rect.x0);
}

/* Rows of the fine level that rows j0 <= j < j1 of the bands depend on. */
tc_rect tc_lifting_support(const tc_lifting_level *level, int64_t j0, int64_t j1);

/* Rows j0 <= j < j1 of LL and the details from the fine level, of which `fine` holds at least the rows that
 * tc_lifting_support() names, over the whole width. Results do not depend on how the rows are cut. ll and the bands
 * cover at least those rows over the whole width. scratch: tc_lifting_analyse_scratch() integers. */
size_t tc_lifting_analyse_scratch(const tc_lifting_level *level, int64_t rows);
void tc_lifting_analyse(const tc_lifting_level *level, const tc_plane *fine, int64_t j0, int64_t j1, const tc_plane *ll,
                        const tc_plane band[TC_BANDS], int32_t *scratch);

/* Positions (LL and details) that the fine samples of `rect` depend on. Where the level wraps in x the rectangle may
 * stick out of it, and holds the columns of the other side there. */
tc_rect tc_lifting_needs(const tc_lifting_level *level, tc_rect rect);

/* The fine samples of fine->rect from LL and details, which cover at least what tc_lifting_needs() names. scratch:
 * tc_lifting_synthesise_scratch() integers. */
size_t tc_lifting_synthesise_scratch(const tc_lifting_level *level, tc_rect rect);
void tc_lifting_synthesise(const tc_lifting_level *level, const tc_plane *ll, const tc_plane band[TC_BANDS],
                           const tc_plane *fine, int32_t *scratch, tc_simd simd);

/* L2 norm of the fine level's answer to a unit detail of a band `depth` levels above the finest (0: the finest): a
 * quantiser step of q / norm in every band spends the bits where they lower the error most. */
double tc_lifting_norm(int band, int depth);

#endif

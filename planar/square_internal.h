/* square_internal.h - what the files of the planar surface share. */
#ifndef TC_SQUARE_INTERNAL_H
#define TC_SQUARE_INTERNAL_H

#include "common/blocks/block_errors.h"
#include "common/render/block_geometry.h"
#include "common/view/camera.h"
#include "square.h"

typedef struct square_surface {
    tc_surface head;
    tc_block_geometry index;
    bool wide;                /* places relative to the viewer do not fit 32 bits (square_wide.glsl) */
    int strips, lists;        /* the most draws of either kind */
    bool cut;                 /* there are finer levels than may be drawn */
    tc_block_lattice lattice; /* of blocks that are chosen by their error, */
    tc_square_blocks blocks;  /* how, and whose normals and colours are seen */
    tc_ground_options windows;
} square_surface;

/* How heights of a level pass over into the coarser level's: alpha is the largest of four ramps, one a side, of
 * `from` + ..., and of `least`. In cells of the level, relative to the snapped viewer. Sides: west, east, south,
 * north; alpha rises from 0 at `start` to 1 outwards with `rate` a cell. */
typedef struct square_morph {
    double start[4], rate[4], least;
} square_morph;

/* Where the viewer is: the sample of the pyramid's finest level next to it, and the offset from it. Of another one the
 * offset could be a whole cell less a millimetre, which as a float loses a part of that millimetre; a vertex so
 * near would be seen some pixels off. */
typedef struct square_viewer {
    int64_t snap_x, snap_y; /* finest samples, within the terrain */
    double rest_x, rest_y;  /* metres, eye minus snapped sample */
    double x, y;            /* metres */
    double height;          /* metres above ground */
} square_viewer;

/* What is known of the ground that hides what is behind it (square_horizon.c), and room for a frame's blocks: those
 * beyond it are not asked for. */
enum { SQUARE_BOXES = 4096, SQUARE_BINS = 128, SQUARE_BUCKETS = 1024 };
typedef struct square_box {
    float lo[3], hi[3]; /* metres east, north and above the eye culled for */
    int32_t triangles;
    int level;
    bool hidden;
} square_box;
typedef struct square_bin {
    float slope;  /* metres above the eye per |x| + |y|: what is below is hidden */
    float x1, y1; /* |x|, |y|: far ends of the block that says so */
} square_bin;
typedef struct square_horizon {
    square_box boxes[SQUARE_BOXES]; /* of the first blocks that are drawn */
    int16_t next[SQUARE_BOXES];     /* further away; -1: none */
    square_bin bins[4][SQUARE_BINS];
} square_horizon;

typedef struct square_view {
    tc_view head;
    square_viewer viewer;
    square_horizon horizon; /* of the frame that is made of it */
} square_view;

/* wait: the ground is the finest level's, read from the field; else that of the finest level which is held there and
 * wanted. */
square_viewer tc_square_viewer(const tc_clipmap *clipmap, const tc_camera *camera, bool wait);
square_morph tc_square_morph(const tc_clipmap *clipmap, int level, const square_viewer *viewer,
                             const tc_frame_options *options);
/* The least alpha of a level of windows of n samples, by the height above the ground: at 1 it is dropped. */
double tc_square_least(const tc_clipmap *clipmap, int level, double n, double height);
/* What is drawn of a level's active region, or is a finer level's hole in it: all, or less in a throttled frame. */
tc_rect tc_square_region(const tc_clipmap *clipmap, int level, const square_viewer *viewer,
                         const tc_frame_options *options);
/* The most that frames over windows of n samples a side can be throttled. */
double tc_square_most_throttle(int n);
double tc_square_alpha(const square_morph *morph, double x, double y);

/* Windows of n samples. */
void tc_square_wanted(const tc_clipmap *clipmap, int n, const square_viewer *viewer, tc_rect *wanted);
/* Cell of a level that a place, in samples of the finest level, is in, and where in it. */
void tc_square_cell(const tc_clip_level *level, double px, double py, int64_t cell_ret[2], double t_ret[2]);
/* The pair of heights that windows hold of a sample. */
const float *tc_square_held(const tc_clipmap *clipmap, int level, int64_t i, int64_t j);
/* A place in samples of the finest level; false: outside the terrain. */
bool tc_square_place(const tc_field *field, double x, double y, double place_ret[2]);
/* Height drawn at a place, metres; false where nothing is. */
bool tc_square_height(const tc_clipmap *clipmap, const square_viewer *viewer, const tc_frame_options *options, double x,
                      double y, double *z_ret);

/* ---- Draws (square_draws.c) --------------------------------------------------------------------------------------
 */

/* All that is looked at while a frame is put together. */
typedef struct square_draws {
    const square_surface *s;
    const tc_view *view;
    const tc_clipmap *clipmap;
    const tc_field *field;
    tc_frame *frame;
    square_viewer viewer; /* of the camera drawn */
    tc_frustum frustum;   /* of the camera culled for */
    double eye[3];        /* of the camera culled for; x, y relative to viewer's snapped sample, z above z_base */
    double spacing[2];    /* of the finest level */
    square_horizon *horizon;
    int strips, lists, walls, blocks;
    int64_t triangles, triangles_unculled;
} square_draws;

/* Bounds of everything drawn over cells, metres from the eye culled for; whether that sees any of such bounds. */
void tc_square_box(const square_draws *d, int level, tc_rect cells, double lo[3], double hi[3]);
bool tc_square_in_view(const square_draws *d, const double lo[3], const double hi[3]);
/* What the vertex stage reads of a block. */
tc_instance tc_square_instance(const square_draws *d, int level, int64_t x, int64_t y, const float corners[4]);
square_draws tc_square_begin_draws(const square_view *view, tc_frame *frame);
/* A block of a level, of at most as many cells as the geometry has a side; what is not visible is left out. corners:
 * alpha of a whole block's at the first cell, south-west, south-east, north-west, north-east; NULL: by the morph. */
void tc_square_add_block(square_draws *d, int level, tc_rect cells, const float corners[4]);
/* What of the edge of the terrain a block has goes down to the foot (square_walls.c). */
void tc_square_add_walls(square_draws *d, int level, tc_rect cells, const float corners[4]);
/* Puts them behind all other draws. */
void tc_square_end_walls(square_draws *d);
/* Closers of a level along a row or a column, from (x, y) `cells` cells east or north. */
void tc_square_add_closers(square_draws *d, int level, int64_t x, int64_t y, int64_t cells, bool row);
/* Tells of the block that is drawn next, and its bounds, metres from the eye culled for. */
void tc_square_horizon_add(square_draws *d, int level, tc_rect cells, const double lo[3], const double hi[3]);
/* Takes blocks behind nearer ground out of the frame: only for an eye above a surface without holes or gaps. */
void tc_square_horizon_cut(square_draws *d);
/* Puts the frame together, but for what is told of levels. all: what is held of what is wanted is all of it. */
void tc_square_end_draws(square_draws *d, const square_view *view, bool all);

/* ---- Ways of choosing what is drawn
 * ----------------------------------------------------------------------------------
 */

/* Nests (square_nests.c), and a tree of blocks by their error (square_tree.c): what a surface does with a view. */
typedef struct square_way {
    size_t view_bytes;
    /* Sets the numbers of draws, most_throttle and what else is its own. */
    tc_status (*prepare)(square_surface *s, tc_error *error);
    void (*look)(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                 const tc_frame_options *options, bool wait, tc_view *view_ret);
    void (*wanted)(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS]);
    void (*draws)(const tc_view *view, const tc_layers *layers, tc_frame *frame);
    bool (*height)(const tc_view *view, double x, double y, double *z_ret);
    int (*block)(const square_surface *s); /* cells of the largest block along a side */
    const char *const *vertex_defines;     /* or NULL */
} square_way;
/* Cells of a level, around the viewer, in which its blocks may pass over by error alone, in windows of n samples. */
double tc_square_tree_reach(int n, int side);
extern const square_way tc_square_nests, tc_square_tree;

#endif

/* faces_internal.h - what the files of the surfaces over faces share.
 *
 * Directions are unit normals of the body; d is one less the viewer's, in the viewer's axes: east, north, up.
 * Distances are in lengths on the unit sphere. Places on a chart are counted in cells of its finest level from its
 * first sample. */
#ifndef TC_FACES_INTERNAL_H
#define TC_FACES_INTERNAL_H

#include "common/blocks/block_errors.h"
#include "common/render/block_geometry.h"
#include "common/view/camera.h"
#include "faces.h"

enum {
    FACES_VECTORS = 5,  /* of surface[] for each chart; faces.glsl */
    FACES_INTEGERS = 5, /* and of whole[] */
    FACES_FIRST_VECTOR = 4,
    FACES_FIRST_INTEGER = 1
};

/* A place on a chart as floats have it: its nearest sample, and the rest, cells. */
typedef struct faces_spot {
    int64_t at[2];
    double rest[2];
} faces_spot;

typedef struct faces_view faces_view;

struct faces_kind {
    const char *name, *help;
    const tc_chart_class *chart;
    int charts;
    const char *metric; /* file of shaders/ that says `distance` to a shader */
    /* How far a place is from the viewer, for the choice of its level; height: what counts of the eye's above the
     * ground, which it never is less than. Continuous all around the globe. */
    double (*distance)(const double d[3], double height);
    /* Cells along a side of a chart that a distance of as many mean cells can cover. */
    double reach;
    /* What cells of terrain bend by beside the body, next to a pole: over that of the body, times the angle to it. */
    double bends;
    bool morphs;
    /* What the chart's GLSL reads of its vectors and integers. */
    void (*place)(const faces_view *view, int chart, float (*vectors)[4], int32_t (*integers)[4]);
};

typedef struct faces_surface {
    tc_surface head;
    const faces_kind *kind;
    const tc_map *map;
    tc_block_lattice lattice;
    tc_block_geometry index;
    int own;           /* levels that have windows: the lattice's further ones lie on the mesh of the last of them */
    bool cut;          /* there are finer levels than may be drawn */
    int64_t cells;     /* of a chart along a side, finest level */
    double cell;       /* mean length of one on the unit sphere: that of a quarter of the equator */
    double diagonal;   /* longest way between two corners of a cell, in mean cells */
    double range;      /* distance up to which the finest level is drawn; */
    double shaded;     /* and up to which its normals and colours are seen; 0: as the blocks are drawn */
    double z_lo, z_hi; /* of all levels of all charts, metres above z_base */
    int strips, lists; /* the most draws of either kind */
    tc_ground_options windows;
    tc_shear shear;
    const char *vertex_parts[6], *fragment_parts[9], *sky_parts[4];
} faces_surface;

struct faces_view {
    tc_view head;
    double axes[3][3];              /* east, north, up of the viewer, in the body's */
    double place[2];                /* longitude and latitude */
    double z_eye;                   /* metres above z_base */
    double above;                   /* metres, of the eye above the ground below it */
    double radius;                  /* metres, of what heights are above; z_base added */
    double height;                  /* what counts of the eye's above the ground below it, lengths on the unit sphere */
    double range;                   /* as the surface's; shorter in a throttled frame */
    double edge;                    /* longest of the data's cells, angle */
    double sag;                     /* angle that their flat triangles may be off, as they are seen */
    double from_pole;               /* angle to the nearer one, of what lies where cells are seen to be curved */
    int finest;                     /* level on the data's mesh that the eye is low enough for; own: none */
    double horizon;                 /* angle from the viewer beyond which no ground can be seen */
    double chart[TC_MAX_CHARTS][2]; /* the viewer's place, also beyond a chart's sides */
    bool sight[TC_MAX_CHARTS];      /* any of a chart is this side of the horizon; others have no windows */
    tc_block_tree tree;             /* of blocks that the view calls for */
    tc_block_tree held;             /* of what windows held of them when the view was made, */
    bool all;                       /* unless that was all */
    tc_block_tree behind;           /* room for what a frame draws of them where something is missing */
    /* Where blocks are chosen by error; NULL else. */
    tc_block_errors *error;
    tc_block_tree *shading; /* of blocks whose normals and colours distance calls for */
};

/* What such a view ends with. */
typedef struct faces_error_view {
    faces_view view;
    tc_block_tree shading;
    tc_block_errors error;
} faces_error_view;

/* Share of a level's range in which it passes over into the coarser one, up to FACES_PASSED of it. */
#define FACES_PASSAGE 0.2
#define FACES_PASSED 0.98

/* Pixels that a cell's flat triangles may be off the curved ones. */
#define FACES_SAG 0.2

/* Share of the eye's height above the ground that counts as distance: LH04 drops a level where the eye is 0.4 n of its
 * cells up, squares here at 0.8 n; a range is some 0.28 n. */
#define FACES_HEIGHT_SHARE 0.5

/* A cell's longest edge over the mean one: 1.64 of the sheared charts. */
#define FACES_LONGEST 1.7

_Static_assert(FACES_FIRST_VECTOR + FACES_VECTORS * TC_MAX_CHARTS <= TC_SURFACE_VECTORS &&
                   FACES_FIRST_INTEGER + FACES_INTEGERS * TC_MAX_CHARTS <= TC_SURFACE_INTEGERS,
               "what faces.glsl reads has room");

static inline const faces_surface *tc_faces_of(const faces_view *view)
{
    return (const faces_surface *)view->head.surface;
}

/* ---- Where the viewer is (faces_view.c) ----------------------------------------------------------------------------
 */

void tc_faces_look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                   const tc_frame_options *options, bool wait, tc_view *view_ret);
void tc_faces_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS]);
bool tc_faces_stand(const tc_view *view, int chart, const double texel[2], tc_standing *standing_ret);

/* The tree of what the windows hold of what the view calls for: levels up to ready[chart] of each. */
void tc_faces_tree(const faces_view *view, const int ready[TC_MAX_CHARTS], tc_block_tree *tree_ret);

/* Whether windows, as they stand, hold all that the view's tree has of a chart. */
bool tc_faces_all_held(const faces_view *view, int chart);

/* The chart that answers for a place. */
int tc_faces_chart(const tc_map *map, const double normal[3]);
/* Angle beyond which no ground can be seen from so high above z_base. */
double tc_faces_horizon(const faces_view *view, double z_eye);
/* d of a place on a chart. */
void tc_faces_direction(const faces_view *view, int chart, double u, double v, double d_ret[3]);
/* The unit normal there, in the body's axes. */
void tc_faces_normal(const faces_surface *s, int chart, double u, double v, double n_ret[3]);
/* Distance up to which a level is drawn. */
double tc_faces_range(const faces_view *view, int level);
/* Nearest sample and rest of a place. */
faces_spot tc_faces_spot(double u, double v);
/* Samples of a block at its level: the first one, and one beyond the last. */
tc_rect tc_faces_samples(const tc_block_lattice *lattice, tc_block block);
/* The level of the windows that a level reads, and its samples around those of a rectangle. */
int tc_faces_window(const faces_surface *s, int level, tc_rect *samples);

/* d of fewer digits, 1e-16 of the unit: enough to choose by. */
void tc_faces_roughly(const faces_view *view, int chart, double u, double v, double d_ret[3]);
/* By how much the flat triangles of cells of an edge are off those that follow the chart, on the unit sphere. */
double tc_faces_sag(const faces_view *view, double edge, double from_pole);

/* ---- Tolerance (faces_error.c) ------------------------------------------------------------------------------------
 */

void tc_faces_begin_errors(faces_view *view);
/* Whether blocks are chosen by it. */
bool tc_faces_by_error(const faces_view *view);
/* Whether any corner of a block has an alpha below 1 by it. */
bool tc_faces_want_by_error(const faces_view *view, tc_block block);
/* alpha of a leaf's corner by it, a multiple of 2^-16. */
float tc_faces_corner(const faces_view *view, const tc_leaf *leaf, int corner);

/* ---- Heights drawn (faces_map.c) ------------------------------------------------------------------------------------
 */

/* Share of the coarser level's height at vertex (i, j) of the `cells` cells a side that a leaf is drawn by. */
double tc_faces_alpha(const faces_view *view, const tc_leaf *leaf, int level, int64_t cells, int64_t i, int64_t j,
                      const double d[3]);
/* As a tree has it; and as that of the view has it of what windows held. */
bool tc_faces_height_in(const faces_view *view, const tc_block_tree *tree, double x, double y, double *z_ret);
bool tc_faces_drawn_height(const tc_view *view, double x, double y, double *z_ret);

#endif

/* rings_internal.h - what the files of the rings share.
 *
 * Frames of unit vectors: of the viewer's meridian, z to the north pole, the viewer in the half plane x > 0 = y; and of
 * the viewer: x~ south, y~ east, z~ up (CH06 section 3.2, errata in the design), in which a vertex is
 *     (sin theta~ cos phi~, sin theta~ sin phi~, cos theta~) = (s_x, s_y, 1 - h). */
#ifndef TC_RINGS_INTERNAL_H
#define TC_RINGS_INTERNAL_H

#include "rings.h"

/* Of all columns and rows of a sector, 0 .. last, a stage leaves out those of the stages before, and what has no
 * neighbour on both sides is never left out: stage 0 all odd ones (stage 1 draws what is left), stage 1 every second of
 * the rest. */
enum { RINGS_STAGES = 2 };
/* The stage that leaves it out; RINGS_STAGES: none. */
int tc_rings_stage_of(int at, int last);

/* Indices of all sectors, one after the other. */
typedef struct rings_strips {
    uint32_t first, count; /* of a sector */
    int triangles;         /* likewise */
} rings_strips;

/* Static geometry: for each level m + 1 rows of vertices, the last one shared with the next level, and for each level a
 * disc that fills its inside where it is the finest. A vertex is (s_x, s_y, h, w): w the level, counted on within it
 * from its outer edge inwards, so i at the outer edge of level i and i + 1 at its inner one. */
typedef struct rings_geometry {
    int levels, n_phi, m, fill; /* fill: rows of the disc */
    bool throttled;             /* there are lists of later stages, too */
    int stride;                 /* vertices from row to row */
    int sectors;                /* parts of a level that are drawn alone */
    /* [stage][1: with an outer row of the stage before] */
    rings_strips ring_strips[RINGS_STAGES + 1][2], fill_strips[RINGS_STAGES + 1][2];
} rings_geometry;

/* Where terrain ends, as a share of the distance from the viewer: heights come down to the body within it. */
#define RINGS_APRON 0.05
/* Passage to the coarser level at the sides of windows, per sample and window. */
#define RINGS_PASSAGE 10.0

enum { RINGS_SECTORS = 16 };
enum { RINGS_MAX = 46 }; /* rings, and the disc inside */

tc_status tc_rings_geometry(rings_geometry *g, tc_geometry *geometry, tc_error *error);
/* First vertex of level i, and of the disc inside it. */
int tc_rings_level_base(const rings_geometry *g, int i);
int tc_rings_fill_base(const rings_geometry *g, int i);

/* ---- Where the viewer is (rings_view.c) ---------------------------------------------------------------------------
 */

/* A rectangle of samples. */
typedef struct rings_extent {
    double x0, y0, x1, y1;
} rings_extent;

/* The viewer as seen by one chart. */
typedef struct rings_place {
    double x, y;   /* finest samples: of the viewer, or of the pole for a cap that the viewer is far from */
    bool near;     /* the former */
    double c[3];   /* of a cap: x' = 2 (c0 s_x + c1 h + c2) / (1 + |p_z|), y' = 2 s_y / (1 + |p_z|) from there */
    double weight; /* of the chart in the viewer's height */
} rings_place;

/* Heights close to the viewer on one chart: z_chart + b u + c v + d u v, in samples, within the viewer's cell, and no
 * steeper than `steepest` from sample to sample for some samples around it. */
typedef struct rings_near {
    int shift; /* samples are 2^shift of the finest; -1: unknown */
    double z, slope[3], steepest;
} rings_near;

typedef struct rings_range {
    bool known;
    double lo, hi; /* lo > hi: none */
} rings_range;

typedef struct rings_view {
    tc_view head;
    double theta, sin_theta, cos_theta; /* colatitude */
    double cos_lambda, sin_lambda;
    double z_eye;       /* metres above z_base */
    double radius;      /* metres, at the equator of what heights are above: z_base added */
    double least, most; /* radii of curvature anywhere of what heights are above */
    rings_place place[TC_MAX_CHARTS];
    /* A part of a globe, or one without caps: chart 0 has sides then, finest samples relative to the viewer; x of them
     * is none's where the chart wraps. south, north: that one is the pole, to within a sample, beyond which heights go
     * on. */
    bool partial, south, north;
    rings_extent sides;
    double detail;     /* levels by which shading is finer than geometry */
    double horizon;    /* angle from the foot point beyond which nothing can be seen */
    int first, finest; /* levels of the rings to be drawn */
    rings_near near[TC_MAX_CHARTS];
    /* Of a throttled frame, as floats have it: ring coordinates from which inwards a stage leaves its vertices out, and
     * one less, where they begin to pass over to the middle of their neighbours; and how far any may have. */
    bool throttled;
    float front[RINGS_STAGES], ease;
    double z;                                    /* height drawn at the foot point */
    rings_range range[RINGS_MAX][TC_MAX_CHARTS]; /* of the charts' heights within pi 2^-i of the foot point */
} rings_view;

/* How far a sector goes to the south and to the east, at a distance of 1. */
typedef struct rings_sector {
    double south[2], east[2];
} rings_sector;

/* Parts of shaders, each list ended by NULL. The first one of those for vertices and fragments is CH06's alone. */
typedef struct rings_parts {
    const char *vertex[7], *fragment[8], *sky[4];
} rings_parts;

typedef struct rings_surface {
    tc_surface head;
    const tc_map *map;
    rings_parts parts;
    tc_rings_scheme scheme;
    rings_geometry geometry;
    rings_sector sector[RINGS_SECTORS];
    double z_lo, z_hi; /* of all levels of all charts, metres above z_base */
    int shift_base; /* S_0: ring i reads levels S_0 - i (inner edge) to S_0 - i + 1 (outer), counted from the finest */
    double outside; /* height where no chart is, metres above z_base */
    tc_ground_options windows; /* but for what a chart settles */
} rings_surface;

/* The viewer as a view's: where it is on the charts and which levels are to be drawn. `near` is the pyramids' where it
 * may be waited for, so that the same view always wants the same windows; else what the windows hold says. z is not
 * known. */
void tc_rings_look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                   const tc_frame_options *options, bool wait, tc_view *view_ret);
/* The ground as it is drawn, from the windows as they stand: sets near and z. */
void tc_rings_ground(rings_view *view);

/* The rectangle of finest samples, relative to the view's place on the chart, that the disc of `angle` around the
 * viewer covers where the chart is used; empty where x1 < x0. */
rings_extent tc_rings_extent(const rings_view *view, int chart, double angle);

/* Bounds of all heights within pi 2^-i of the foot point on all levels, metres above z_base. */
void tc_rings_bounds(const rings_view *view, int i, double *lo_ret, double *hi_ret);

bool tc_rings_stand(const tc_view *view, int chart, const double texel[2], tc_standing *standing_ret);
void tc_rings_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS]);

/* ---- The map transform in double (rings_map.c) ---------------------------------------------------------------------
 */

/* Which level a vertex reads of a chart, and where. */
typedef struct rings_sample {
    int level;    /* of the chart's clipmap; 0: the chart does not have it */
    double alpha; /* share of the coarser level */
    double u, v;  /* samples of the level */
} rings_sample;

/* Place of direction (s_x, s_y, 1 - h) on a chart, finest samples relative to the view's place there. */
void tc_rings_map(const rings_view *view, int chart, double s_x, double s_y, double h, double *du_ret, double *dv_ret);
/* Shares of the charts there. */
void tc_rings_weights(const rings_view *view, double s_x, double h, double weight_ret[TC_MAX_CHARTS]);
/* Level of detail that vertices of ring coordinate w read: coarser levels from the finest one, and so many more. */
double tc_rings_shift(const rings_view *view, double w, int coarser);
/* How many that are in a throttled frame, and the share of what is read with one more yet: whole levels are mixed,
 * since what a level has of the coarser one is not quite what that has. */
int tc_rings_coarser(const rings_view *view, double w, double *share_ret);
/* What is held of a level, samples: up to the terrain's end where it reaches it. There the last samples of the level's
 * lattice (x1 and y1 of the second) may lie up to one before, and heights go on as they are. */
rings_extent tc_rings_held(const tc_clipmap *clipmap, int level);
rings_extent tc_rings_lattice(const tc_clipmap *clipmap, int level);
rings_sample tc_rings_find(const rings_view *view, int chart, double du, double dv, double shift);
double tc_rings_sample_height(const rings_view *view, int chart, const rings_sample *sample);
/* How far vertices that a stage leaves out have passed over to the middle of their neighbours, and others to what the
 * next stage reads there, at ring coordinate w. */
double tc_rings_passed(const rings_view *view, int stage, double w);
/* The stage that ring i, or the disc inside ring i - 1, is drawn with. */
int tc_rings_stage(const rings_view *view, int i);
/* Height of a vertex of ring coordinate w, so many levels coarser, metres above z_base. */
double tc_rings_height(const rings_view *view, double s_x, double s_y, double h, double w, int coarser);
/* The same at longitude and latitude. */
bool tc_rings_drawn_height(const tc_view *view, double x, double y, double *z_ret);

static inline const rings_surface *tc_rings_of(const rings_view *view)
{
    return (const rings_surface *)view->head.surface;
}
static inline const tc_clipmap *tc_rings_clipmap(const rings_view *view, int chart)
{
    return view->head.windows->clipmap[chart];
}

#endif

/* surface.h - what a scheme (square grids, rings, hexagons, ...) hands the shared windows and renderer.
 *
 * A surface is a map transform with its static support geometry: parts of shaders, and what C needs to choose windows
 * and draws. It never changes once it is made; any number of viewers, each with windows of its own, may look at it at
 * once, from several threads. look() makes a view once a frame; which windows are wanted, what is drawn and how high
 * the ground is are then only read from it. No GL in it. */
#ifndef TC_SURFACE_H
#define TC_SURFACE_H

#include "common/map/map.h"
#include "common/terraclip.h"
#include "common/content/ground.h"

/* Levels that are drawn, at most: rings have more than windows have, since they go on to the eye. */
enum { TC_DRAWN_LEVELS = 44 };

/* ---- Geometry ---------------------------------------------------------------------------------------------------- */

typedef enum tc_vertex_format {
    TC_VERTEX_UINT16_2, /* GLSL: ivec2 */
    TC_VERTEX_FLOAT_4   /* GLSL: vec4 */
} tc_vertex_format;

/* Static support geometry: vertices, and indices of triangles. */
typedef struct tc_geometry {
    tc_vertex_format format;
    void *vertices;
    int vertex_count;
    void *indices;
    int index_count;
    int index_bytes; /* each: 2 or 4 */
} tc_geometry;

/* Bytes of an index where so many vertices are counted from a draw's first one. */
static inline int tc_index_bytes(int64_t vertices)
{
    return vertices <= UINT16_MAX ? 2 : 4;
}
static inline uint32_t tc_index(const tc_geometry *g, size_t at)
{
    return g->index_bytes == 2 ? ((const uint16_t *)g->indices)[at] : ((const uint32_t *)g->indices)[at];
}
static inline void tc_set_index(tc_geometry *g, size_t at, uint32_t index)
{
    if (g->index_bytes == 2)
        ((uint16_t *)g->indices)[at] = (uint16_t)index;
    else
        ((uint32_t *)g->indices)[at] = index;
}

/* ---- Windows ----------------------------------------------------------------------------------------------------- */

/* Charts of a map that a surface can draw. */
enum { TC_MAX_CHARTS = 6 };

/* What one viewer holds of a map: a clipmap for each chart, all of one size n and with the same contents. */
typedef struct tc_windows {
    int charts;
    tc_clipmap *clipmap[TC_MAX_CHARTS];
} tc_windows;

void tc_windows_destroy(tc_windows *windows);

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* One indirect draw, laid out as OpenGL wants it (DrawElementsIndirectCommand). */
typedef struct tc_draw {
    uint32_t count, instance_count, first_index;
    int32_t base_vertex;
    uint32_t base_instance; /* its tc_instance */
} tc_draw;

/* Per-draw data of the vertex shader; the meaning is the surface's. */
typedef struct tc_instance {
    int32_t v[4];
    float corner[4]; /* a block's alpha at its corners */
} tc_instance;

/* A layer of the vertex textures is a level of a chart: first those of chart 0, coarse to fine, then those of chart 1.
 * Levels and charts that are not in use need not have one. What shaders know of a surface, vectors of four; frame.glsl
 * is told these sizes. */
enum {
    TC_MAX_LAYERS = 120, /* as many as fit the 16 KB that a uniform block has with every driver */
    TC_LAYER_VECTORS = 3,
    TC_SURFACE_VECTORS = 34,
    TC_SURFACE_INTEGERS = 31 /* vectors of integers */
};

/* The layers that there are: levels of each chart, from the coarsest on, that have one; and of them, from the coarsest
 * on, those whose layer is up to date. The others are drawn by coarser ones. */
typedef struct tc_layers {
    int held[TC_MAX_CHARTS], ready[TC_MAX_CHARTS];
} tc_layers;

/* What one frame draws. Belongs to who draws, and is used again from frame to frame. */
typedef struct tc_frame {
    tc_draw *draws;         /* blocks first, then crack closers; the surface's draw_capacity of them */
    tc_instance *instances; /* one a draw, where the surface has them */
    int strip_draws, list_draws;
    int wall_draws; /* behind those, where the scene has walls: of arrays, first an instance's number for base_vertex */
    int64_t wall_triangles;
    bool one_sided;              /* no back of a block's triangle (counter-clockwise from the eye) can be seen */
    int64_t triangles;           /* that cover area: without joints and without crack closers */
    int64_t triangles_unculled;  /* the same if nothing had been outside the view or hidden */
    int draws_unculled;          /* blocks, likewise */
    int blocks[TC_DRAWN_LEVELS]; /* drawn of each level, coarse to fine */
    double error_bound; /* pixels that it is off at most, where it is drawn by a tolerance; else, and where nothing
                         * is known, INFINITY */
    int levels_active;  /* drawn; and not: */
    int levels_fine;    /* too fine for the height above ground, or not where the viewer is; finer than a pixel */
    int levels_beyond;  /* beyond the horizon */
    float layer[TC_MAX_LAYERS][TC_LAYER_VECTORS][4];
    float surface[TC_SURFACE_VECTORS][4];
    float body[TC_BODY_VECTORS]
              [4]; /* what the class of the map's body makes of the eye (body.h); a plane's is not told */
    int32_t integers[TC_SURFACE_INTEGERS][4];
} tc_frame;

/* How a frame is drawn; zero is the default. */
typedef struct tc_frame_options {
    bool no_morph;                /* levels meet abruptly, yet without cracks */
    bool no_closers;              /* leaves T-junctions open, and */
    bool no_stitch;               /* edges of levels where they are as well: for the tests that look for cracks */
    bool no_cull;                 /* draws what is outside the view or hidden, too */
    bool two_sided;               /* draws backs of triangles, too, even where none can be seen */
    bool walls;                   /* below the edge of a flat terrain, for surfaces with wall_parts: */
    double foot, shore;           /* metres, absolute: down to this height; and they are seen from within where
                                   * ground is below that: -INFINITY: nowhere */
    double error;                 /* pixels that what is drawn may be off the finest level's mesh, as far as windows
                                   * reach; 0: levels by distance alone. For surfaces by_error */
    double throttle;              /* octaves by which all is drawn coarser, 0 to the surface's most_throttle */
    const tc_camera *cull_camera; /* the camera to cull for, where it is not the one drawn (frozen culling) */
} tc_frame_options;

/* Where a view stands on a chart, for windows of other contents than the surface's own, whose samples ("texels") are
 * `texel` chart coordinates apart. */
typedef struct tc_standing {
    double x, y;         /* texels: what the shaders' places on the chart are relative to */
    double per_place[2]; /* texels per unit of those places */
    double lo[2], hi[2]; /* texels, relative to x and y, of what may be in sight */
    double texel;        /* metres of a texel on the body */
    double distance;     /* metres to the ground below */
} tc_standing;

/* ---- Surfaces ---------------------------------------------------------------------------------------------------- */

/* What a surface calls what it is made of, where that is told (--explain, left_out of --stats). */
typedef struct tc_surface_words {
    const char *levels, *blocks; /* "levels", "blocks" */
    const char *fine;            /* why a level is not drawn: tc_frame.levels_fine */
    const char *beyond;          /* likewise levels_beyond; NULL: there are none */
    const char *outside;         /* why a triangle is not: "outside the view" */
    bool charts;                 /* there may be several */
} tc_surface_words;

typedef struct tc_surface tc_surface;

/* The head of what a surface makes of a camera; what follows is its own. */
typedef struct tc_view {
    const tc_surface *surface;
    const tc_windows *windows;
    tc_camera camera;
    tc_camera culled; /* for */
    bool frozen;      /* which is another one */
    tc_frame_options options;
} tc_view;

struct tc_surface {
    const char *name; /* as in figures: "square", "rings", ... */
    const tc_surface_words *words;
    /* GLSL files, NULL-terminated, that map a vertex and know the ground at a fragment; the functions that they define
     * are named in renderer.vert and ground.glsl. */
    const char *const *vertex_parts, *const *fragment_parts, *const *sky_parts;
    const char *const *wall_parts;      /* instead of fragment_parts, of walls below its edge (surroundings.h), which it
                                         * then draws; NULL: it has none */
    const struct tc_shader_file *texts; /* of parts that are no files, {name, text}, ended by a NULL name; NULL: none */
    const char *const *defines;         /* for both, NULL-terminated; NULL: none */
    bool closers;                       /* draws triangle lists, too, where levels meet */
    bool instances;                     /* its vertex stage reads a tc_instance */
    bool own_haze;     /* its fragment stage knows how far one sees: haze is given the near plane alone */
    double near_plane; /* metres, for positions relative to the eye */
    double extent;     /* metres, of all that there is to see */
    tc_geometry geometry;
    const tc_field *field; /* of chart 0 */
    tc_body body;          /* of the map; without a class: a plane */
    int refined;           /* of the levels drawn those finer than the map's, on its mesh */
    int n;                 /* size of the windows */
    int shaded_n;          /* of those that shading alone would call for; 0: n */
    bool by_error;         /* heeds tc_frame_options.error */
    int draw_capacity;     /* the most draws that a frame can have, */
    int wall_capacity;     /* and of walls */
    double most_throttle;  /* that frames can have; 0: none. With more of it there are never more triangles, and heights
                            * pass over evenly */
    bool throttled_stage;  /* its vertex stage has more to do in throttled frames: THROTTLED is defined */
    size_t view_bytes;     /* of what look() makes */
    /* Windows for one more viewer, to be destroyed with tc_windows_destroy(). */
    tc_status (*make_windows)(const tc_surface *surface, tc_windows *windows_ret, tc_error *error);
    /* Looks at the surface through a camera: fills in *view_ret, view_bytes of the caller's. All that follows is valid
     * while the windows exist; no memory is allocated. wait: whatever is needed of the fields may be read and decoded
     * now; else only what windows hold counts. */
    void (*look)(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                 const tc_frame_options *options, bool wait, tc_view *view_ret);
    /* Windows wanted at each level: wanted[chart][level - 1]; empty for levels too fine for the view, and for all
     * levels of a chart that no vertex reads. */
    void (*wanted)(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS]);
    /* False for a chart of which nothing is in sight. */
    bool (*stand)(const tc_view *view, int chart, const double texel[2], tc_standing *standing_ret);
    /* What is visible of the windows as they stand. */
    void (*draws)(const tc_view *view, const tc_layers *layers, tc_frame *frame);
    /* Height drawn at map position (x, y), in the camera's units, by the same rules as the GLSL, in double: metres
     * absolute. False where nothing is drawn. */
    bool (*height)(const tc_view *view, double x, double y, double *z_ret);
    void (*destroy)(tc_surface *surface);
};

/* A vector of four as shaders have it. */
static inline void tc_set4(float *out, double x, double y, double z, double w)
{
    out[0] = (float)x, out[1] = (float)y, out[2] = (float)z, out[3] = (float)w;
}

/* A view's head. */
tc_view tc_view_of(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                   const tc_frame_options *options);

/* Memory for views of a surface, and for its frames; freed with free() and tc_frame_free(). NULL and false: there is
 * not enough. */
tc_view *tc_view_allocate(const tc_surface *surface);
bool tc_frame_allocate(const tc_surface *surface, tc_frame *frame);
void tc_frame_free(tc_frame *frame);

/* The layer of a chart's level 1; of the chart behind the last: how many layers there are. */
static inline int tc_first_layer(const tc_layers *layers, int chart)
{
    int layer = 0;
    for (int c = 0; c < chart; c++)
        layer += layers->held[c];
    return layer;
}

#endif

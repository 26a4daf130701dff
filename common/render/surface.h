/* surface.h - what a scheme (square grids, rings, hexagons, ...) hands the shared clipmap and renderer.
 *
 * A surface is: static support geometry; a map transform in GLSL (vertex_parts); the windows of the map that a camera
 * wants; the visible parts of the geometry for a camera; and the surface so drawn in C double (drawn_height), the
 * oracle of tests. Everything else is shared. No GL in it. */
#ifndef TC_SURFACE_H
#define TC_SURFACE_H

#include "common/map/map.h"
#include "common/terraclip.h"
#include "common/content/ground.h"

/* Static support geometry: vertices and indices of triangle strips or triangles. TC_RESTART ends a strip and begins the
 * next. */
enum { TC_RESTART = 0xffff };
typedef enum tc_vertex_format {
    TC_VERTEX_UINT16_2, /* GLSL: ivec2 */
    TC_VERTEX_FLOAT_4   /* GLSL: vec4 */
} tc_vertex_format;
typedef struct tc_geometry {
    tc_vertex_format format;
    void *vertices;
    int vertex_count;
    uint16_t *indices;
    int index_count;
} tc_geometry;

/* One indirect draw, laid out as OpenGL wants it (DrawElementsIndirectCommand). */
typedef struct tc_draw {
    uint32_t count, instance_count, first_index;
    int32_t base_vertex;
    uint32_t base_instance; /* its tc_instance */
} tc_draw;

/* Per-draw data of the vertex shader; the meaning is the surface's. */
typedef struct tc_instance {
    int32_t v[4];
} tc_instance;

/* Charts of a map that a surface can draw. */
enum { TC_MAX_CHARTS = 3 };

/* A layer of the vertex textures is a level of a chart: first those of chart 0, coarse to fine, then those of chart 1.
 * Levels and charts that are not in use need not have one. */
enum { TC_MAX_LAYERS = TC_MAX_CHARTS * TC_MAX_LEVELS, TC_LAYER_UNIFORMS = 12, TC_SURFACE_UNIFORMS = 52 };

/* The layers that there are: levels of each chart, from the coarsest on, that have one; and of them, from the coarsest
 * on, those whose layer is up to date. The others are drawn by coarser ones. */
typedef struct tc_layers {
    int held[TC_MAX_CHARTS], ready[TC_MAX_CHARTS];
} tc_layers;

/* What one frame draws. Arrays are the surface's own and stay valid until its next frame. */
typedef struct tc_frame {
    const tc_draw *draws;         /* strips first, then triangle lists */
    const tc_instance *instances; /* one a draw, where the surface has them */
    int strip_draws, list_draws;
    bool one_sided;             /* no back of a strip's triangle (counter-clockwise from the eye) can be seen */
    int64_t triangles;          /* that cover area: without joints and without crack closers */
    int64_t triangles_unculled; /* the same if nothing had been outside the view */
    int draws_unculled;         /* strips, likewise */
    int levels_active;          /* drawn; and not: */
    int levels_fine;   /* too fine for the height above ground, or not where the viewer is; finer than a pixel */
    int levels_beyond; /* beyond the horizon */
    const float (*layer_uniforms)[TC_LAYER_UNIFORMS]; /* one a layer: GLSL `vec4 layer[3 * ...]` */
    const float *surface_uniforms;                    /* TC_SURFACE_UNIFORMS floats */
} tc_frame;

/* How a frame is drawn; zero is the default. */
typedef struct tc_frame_options {
    bool no_morph;                /* levels meet abruptly, yet without cracks */
    bool no_closers;              /* leaves T-junctions open, and */
    bool no_stitch;               /* edges of levels where they are as well: for the tests that look for cracks */
    bool no_cull;                 /* draws what is outside the view, too */
    bool two_sided;               /* draws backs of triangles, too, even where none can be seen */
    const tc_camera *cull_camera; /* the camera to cull for, where it is not the one drawn (frozen culling) */
} tc_frame_options;

/* What a surface calls what it is made of, where that is told (--explain, left_out of --stats). */
typedef struct tc_surface_words {
    const char *levels, *blocks; /* "levels", "blocks" */
    const char *fine;            /* why a level is not drawn: tc_frame.levels_fine */
    const char *beyond;          /* likewise levels_beyond; NULL: there are none */
    const char *outside;         /* why a triangle is not: "outside the view" */
    bool charts;                 /* there may be several */
} tc_surface_words;

typedef struct tc_surface tc_surface;
struct tc_surface {
    const char *name; /* as in figures: "square", "rings", ... */
    const tc_surface_words *words;
    /* GLSL files, NULL-terminated, that map a vertex and colour a fragment; the functions that they define are named in
     * renderer.vert and renderer.frag. */
    const char *const *vertex_parts, *const *fragment_parts;
    const struct tc_shader_file *texts; /* of parts that are no files, {name, text}, ended by a NULL name; NULL: none */
    const char *const *defines;         /* for both, NULL-terminated; NULL: none */
    const char *sky;                    /* the sky's fragment shader */
    bool closers;                       /* draws triangle lists, too, where levels meet */
    bool instances;                     /* its vertex stage reads a tc_instance */
    bool own_haze;     /* its fragment stage knows how far one sees: haze is given the near plane alone */
    double near_plane; /* metres, for positions relative to the eye */
    double extent;     /* metres, of all that there is to see */
    tc_geometry geometry;
    int charts;
    tc_clipmap *clipmap[TC_MAX_CHARTS]; /* of each chart; all of one window size n. The surface's own */
    /* Windows wanted at each level for this camera: wanted[chart][level - 1]; empty for levels too fine for it, and for
     * all levels of a chart that no vertex reads. */
    void (*wanted)(tc_surface *surface, const tc_camera *camera, tc_rect (*wanted)[TC_MAX_LEVELS]);
    /* What is visible of the clipmaps as they stand. */
    void (*frame)(tc_surface *surface, const tc_camera *camera, const tc_frame_options *options,
                  const tc_layers *layers, tc_frame *frame_ret);
    /* Height drawn at map position (x, y), in the camera's units, for this camera, by the same rules as the GLSL, in
     * double: metres absolute. False where nothing is drawn. */
    bool (*drawn_height)(tc_surface *surface, const tc_camera *camera, const tc_frame_options *options, double x,
                         double y, double *z_ret);
    void (*destroy)(tc_surface *surface);
};

/* The layer of a chart's level 1; of the chart behind the last: how many layers there are. */
static inline int tc_first_layer(const tc_layers *layers, int chart)
{
    int layer = 0;
    for (int c = 0; c < chart; c++)
        layer += layers->held[c];
    return layer;
}

#endif

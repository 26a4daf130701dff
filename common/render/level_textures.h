/* level_textures.h - the windows of charts' clipmaps as array textures: one a content, one layer a level of a chart.
 *
 * Only levels that a view has asked for so far have layers: not those too fine for all heights above ground flown at,
 * and not charts out of sight. */
#ifndef TC_LEVEL_TEXTURES_H
#define TC_LEVEL_TEXTURES_H

#include "common/gl/gl.h"
#include "surface.h"
#include "upload_ring.h"

/* How a texel format is stored by OpenGL. */
typedef struct tc_gl_format {
    const char *name; /* of the internal format, "RG32F" */
    GLenum internal, format, type;
    GLint filter;
} tc_gl_format;
const tc_gl_format *tc_gl_format_of(tc_texel_format format);

typedef struct tc_level_texture {
    const tc_content_class *content;
    GLuint texture; /* scale * (n + 1) texels along a side, repeating */
    int size;
    size_t bytes;
} tc_level_texture;

enum { TC_LEFT = 4 };

typedef struct tc_level_textures {
    tc_level_texture content[TC_MAX_CONTENTS]; /* of all clipmaps, which have the same n and the same contents */
    int contents;
    float anisotropy;     /* of filtering, where it is linear; 0, 1: none */
    tc_upload_ring *ring; /* that uploads go through, begun by who draws; NULL: none */
    tc_layers layers;
    int depth; /* layers of all charts, at least one */
    uint64_t cursor[TC_MAX_LAYERS];
    tc_rect left[TC_MAX_LAYERS][TC_LEFT]; /* before the cursor: samples that time did not suffice for; else empty */
} tc_level_textures;

/* Has layers for at least the first levels[chart] levels of each chart's clipmap. Once allocated, textures only grow,
 * and then by half of a chart's levels at least: a flight makes them a few times anew, copying on the GPU what there
 * was, and then no more. A picture does not depend on how often. TC_ERR_MEMORY where the driver has no room; they are
 * then as before, and what they hold can be drawn. */
tc_status tc_level_textures_hold(const tc_gl *gl, tc_level_textures *textures, tc_clipmap *const *clipmaps, int charts,
                                 const int levels[TC_MAX_CHARTS], tc_error *error);
void tc_level_textures_destroy(const tc_gl *gl, tc_level_textures *textures);

/* The texture of a content, zero where it is not kept. */
tc_level_texture tc_level_texture_of(const tc_level_textures *textures, const tc_content_class *content);

/* Uploads what has changed since the last call and says in layers.ready which levels are up to date by that; returns
 * the bytes. The coarsest levels always are, the others coarse to fine until `budget` samples are used up (below 0: no
 * limit; exceeded by less than a level, so that there is always progress), and `until` by tc_clock_ms() (0: no limit;
 * exceeded by a piece of some 8,000 samples); what is left comes with the next calls. Call before anything is drawn in
 * a frame: an upload to a texture that a queued draw reads waits for that draw. */
int64_t tc_level_textures_upload(const tc_gl *gl, tc_level_textures *textures, tc_clipmap *const *clipmaps, int charts,
                                 int64_t budget, double until);

#endif

/* level_textures.h - the windows of a surface's clipmaps as array textures, one layer a level of a chart.
 *
 * Only levels that a view has asked for so far have layers: not those too fine for all heights above ground flown at,
 * and not charts out of sight. */
#ifndef TC_LEVEL_TEXTURES_H
#define TC_LEVEL_TEXTURES_H

#include "surface.h"
#include "common/gl/gl.h"

typedef struct tc_level_textures {
    GLuint heights; /* RG32F, (z, z_c), (n+1)^2 */
    GLuint normals; /* RGBA8_SNORM, (n, n_c) at twice the resolution, filtered, repeating; 0 where not kept */
    GLuint voids;   /* R8; 0 where not kept */
    int size, layers;
    bool empty; /* new: all that is held is to be uploaded */
    size_t height_bytes, normal_bytes, void_bytes;
} tc_level_textures;

/* Has layers for at least the first levels[chart] levels of each chart, and sets surface->layers to what there is.
 * Once allocated, textures only grow, and then by half of a chart's levels at least: a flight makes them a few times
 * anew and then no more. A picture does not depend on how often. */
tc_status tc_level_textures_hold(const tc_gl *gl, tc_level_textures *textures, tc_surface *surface,
                                 const int levels[TC_MAX_CHARTS], tc_error *error);
void tc_level_textures_destroy(const tc_gl *gl, tc_level_textures *textures);

/* Uploads what has changed since the last call; returns the bytes. Call before anything is drawn in a frame: an upload
 * to a texture that a queued draw reads waits for that draw. */
int64_t tc_level_textures_upload(const tc_gl *gl, tc_level_textures *textures, const tc_surface *surface);

#endif

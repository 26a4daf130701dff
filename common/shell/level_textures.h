/* level_textures.h - the windows of a surface's clipmaps as array textures, one layer a level of a chart. */
#ifndef TC_LEVEL_TEXTURES_H
#define TC_LEVEL_TEXTURES_H

#include "common/core/clipmap/surface.h"
#include "gl.h"

typedef struct tc_level_textures {
    GLuint heights; /* RG32F, (z, z_c), (n+1)^2 */
    GLuint normals; /* RGBA8_SNORM, (n, n_c) at twice the resolution, filtered, repeating; 0 where not kept */
    GLuint voids;   /* R8; 0 where not kept */
    size_t height_bytes, normal_bytes;
} tc_level_textures;

tc_status tc_level_textures_create(const tc_gl *gl, const tc_surface *surface, tc_level_textures *textures_ret,
                                   tc_error *error);
void tc_level_textures_destroy(const tc_gl *gl, tc_level_textures *textures);

/* Uploads what has changed since the last call; returns the bytes. Call before anything is drawn in a frame: an upload
 * to a texture that a queued draw reads waits for that draw. */
int64_t tc_level_textures_upload(const tc_gl *gl, tc_level_textures *textures, const tc_surface *surface);

#endif

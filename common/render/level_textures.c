/* level_textures.c - uploads of toroidal rectangles, cut where they wrap. */
#include "level_textures.h"

#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"

static GLuint array_texture(const tc_gl *gl, GLenum format, int size, int layers, GLint filter)
{
    GLuint t;
    gl->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &t);
    gl->TextureStorage3D(t, 1, format, size, size, layers);
    gl->TextureParameteri(t, GL_TEXTURE_MIN_FILTER, filter);
    gl->TextureParameteri(t, GL_TEXTURE_MAG_FILTER, filter);
    gl->TextureParameteri(t, GL_TEXTURE_WRAP_S, GL_REPEAT);
    gl->TextureParameteri(t, GL_TEXTURE_WRAP_T, GL_REPEAT);
    return t;
}

static tc_status create(const tc_gl *gl, const tc_surface *surface, int layers, tc_level_textures *textures_ret,
                        tc_error *error)
{
    const tc_clipmap *clipmap = surface->clipmap[0];
    int size = tc_clipmap_n(clipmap) + 1;
    while (gl->GetError() != GL_NO_ERROR) /* what went wrong before is none of ours */
        ;
    size_t texels = (size_t)size * (size_t)size * (size_t)layers;
    tc_level_textures t = {.heights = array_texture(gl, GL_RG32F, size, layers, GL_NEAREST),
                           .size = size,
                           .layers = layers,
                           .empty = true,
                           .height_bytes = texels * 8};
    if (tc_clipmap_normals(clipmap, 1)) {
        t.normals = array_texture(gl, GL_RGBA8_SNORM, 2 * size, layers, GL_LINEAR);
        t.normal_bytes = texels * 16;
    }
    if (tc_clipmap_voids(clipmap, 1)) {
        t.voids = array_texture(gl, GL_R8, size, layers, GL_NEAREST);
        t.void_bytes = texels;
    }
    if (gl->GetError() != GL_NO_ERROR) {
        tc_level_textures_destroy(gl, &t);
        *textures_ret = (tc_level_textures){0};
        return tc_fail(error, TC_ERR_MEMORY, "vertex textures: no room for %d layers of %dx%d", layers, size, size);
    }
    *textures_ret = t;
    return TC_OK;
}

tc_status tc_level_textures_hold(const tc_gl *gl, tc_level_textures *textures, tc_surface *surface,
                                 const int levels[TC_MAX_CHARTS], tc_error *error)
{
    int held[TC_MAX_CHARTS], layers = 0;
    bool grows = !textures->heights;
    for (int chart = 0; chart < surface->charts; chart++) {
        int now = textures->heights ? surface->layers[chart] : 0, all = tc_clipmap_levels(surface->clipmap[chart]);
        held[chart] = now;
        if (levels[chart] > now) {
            held[chart] = (int)tc_min64(all, tc_max64(levels[chart], now + (now ? (all + 1) / 2 : 0)));
            grows = true;
        }
        layers += held[chart];
    }
    if (!grows)
        return TC_OK;
    tc_level_textures_destroy(gl, textures);
    memcpy(surface->layers, held, (size_t)surface->charts * sizeof *held);
    return create(gl, surface, layers > 0 ? layers : 1, textures, error);
}

void tc_level_textures_destroy(const tc_gl *gl, tc_level_textures *textures)
{
    gl->DeleteTextures(3, (GLuint[]){textures->heights, textures->normals, textures->voids});
}

/* What upload_wrapped needs to know of a texture. */
typedef struct target {
    const tc_gl *gl;
    GLuint texture;
    GLenum format, type;
    int64_t size; /* texels along a side: a power of two */
    int bytes;    /* a texel */
    int layer;
    const void *texels; /* the whole toroidal array */
} target;

static int64_t upload_wrapped(const target *t, int64_t x, int64_t y, int64_t w, int64_t h)
{
    w = tc_min64(w, t->size);
    h = tc_min64(h, t->size);
    t->gl->PixelStorei(GL_UNPACK_ROW_LENGTH, (GLint)t->size);
    for (int64_t dy = 0, run_y; dy < h; dy += run_y) {
        int64_t ty = (y + dy) & (t->size - 1);
        run_y = tc_min64(h - dy, t->size - ty);
        for (int64_t dx = 0, run_x; dx < w; dx += run_x) {
            int64_t tx = (x + dx) & (t->size - 1);
            run_x = tc_min64(w - dx, t->size - tx);
            t->gl->TextureSubImage3D(t->texture, 0, (GLint)tx, (GLint)ty, t->layer, (GLsizei)run_x, (GLsizei)run_y, 1,
                                     t->format, t->type, (const char *)t->texels + (ty * t->size + tx) * t->bytes);
        }
    }
    return w * h * t->bytes;
}

/* Uploads what changed of a level, whose layer it is, or all of it. */
static int64_t upload_level(const tc_gl *gl, const tc_level_textures *textures, tc_clipmap *clipmap, int level,
                            int layer)
{
    int64_t bytes = 0, size = tc_clipmap_n(clipmap) + 1;
    tc_rect changes[TC_MAX_CHANGES];
    int count = tc_clipmap_take_changes(clipmap, level, changes);
    if (textures->empty) {
        changes[0] = (tc_rect){0, 0, size, size};
        count = tc_rect_empty(tc_clipmap_level(clipmap, level)->clip) ? 0 : 1;
    }
    target heights = {gl, textures->heights, GL_RG, GL_FLOAT, size, 8, layer, tc_clipmap_heights(clipmap, level)};
    target voids = {gl, textures->voids, GL_RED, GL_UNSIGNED_BYTE, size, 1, layer, tc_clipmap_voids(clipmap, level)};
    target normals = {gl, textures->normals, GL_RGBA, GL_BYTE, 2 * size, 4, layer, tc_clipmap_normals(clipmap, level)};
    for (int i = 0; i < count; i++) {
        tc_rect r = changes[i];
        bytes += upload_wrapped(&heights, r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0);
        if (textures->voids)
            bytes += upload_wrapped(&voids, r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0);
        if (textures->normals) /* from half a sample before to half a sample behind */
            bytes += upload_wrapped(&normals, 2 * r.x0 - 1, 2 * r.y0 - 1, 2 * (r.x1 - r.x0) + 1, 2 * (r.y1 - r.y0) + 1);
    }
    return bytes;
}

int64_t tc_level_textures_upload(const tc_gl *gl, tc_level_textures *textures, const tc_surface *surface)
{
    int64_t bytes = 0;
    int layer = 0;
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (int chart = 0; chart < surface->charts; chart++)
        for (int level = 1; level <= surface->layers[chart]; level++)
            bytes += upload_level(gl, textures, surface->clipmap[chart], level, layer++);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    textures->empty = false;
    return bytes;
}

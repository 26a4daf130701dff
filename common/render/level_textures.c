/* level_textures.c - uploads of toroidal rectangles, cut where they wrap. */
#include "level_textures.h"

#include <stdio.h>
#include <string.h>

#include "common/base/clock.h"
#include "common/base/rect.h"
#include "common/base/status.h"

const tc_gl_format *tc_gl_format_of(tc_texel_format format)
{
    static const tc_gl_format formats[TC_TEXEL_FORMATS] = {
        [TC_TEXEL_RG32F] = {"RG32F", GL_RG32F, GL_RG, GL_FLOAT, GL_NEAREST},
        [TC_TEXEL_RGBA8_SNORM] = {"RGBA8_SNORM", GL_RGBA8_SNORM, GL_RGBA, GL_BYTE, GL_LINEAR},
        [TC_TEXEL_RGBA16_SNORM] = {"RGBA16_SNORM", GL_RGBA16_SNORM, GL_RGBA, GL_SHORT, GL_LINEAR},
        [TC_TEXEL_SRGB8_ALPHA8] = {"SRGB8_ALPHA8", GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR},
        [TC_TEXEL_R8] = {"R8", GL_R8, GL_RED, GL_UNSIGNED_BYTE, GL_NEAREST}};
    return &formats[format];
}

/* ---- Allocation -------------------------------------------------------------------------------------------------- */

static GLuint array_texture(const tc_gl *gl, const tc_gl_format *format, int size, int layers, float anisotropy)
{
    GLuint t;
    gl->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &t);
    gl->TextureStorage3D(t, 1, format->internal, size, size, layers);
    gl->TextureParameteri(t, GL_TEXTURE_MIN_FILTER, format->filter);
    gl->TextureParameteri(t, GL_TEXTURE_MAG_FILTER, format->filter);
    gl->TextureParameteri(t, GL_TEXTURE_WRAP_S, GL_REPEAT);
    gl->TextureParameteri(t, GL_TEXTURE_WRAP_T, GL_REPEAT);
    if (anisotropy > 1 && format->filter == GL_LINEAR)
        gl->TextureParameteri(t, GL_TEXTURE_MAX_ANISOTROPY, (GLint)anisotropy);
    return t;
}

static tc_status create(const tc_gl *gl, const tc_clipmap *clipmap, tc_level_textures *t, tc_error *error)
{
    int n = tc_clipmap_n(clipmap);
    tc_gl_forget_errors(gl); /* what went wrong before is none of ours */
    t->contents = tc_clipmap_contents(clipmap);
    for (int k = 0; k < t->contents; k++) {
        const tc_content_class *content = tc_clipmap_content(clipmap, k);
        int size = content->scale * (n + 1);
        size_t texels = (size_t)size * (size_t)size * (size_t)t->depth;
        t->content[k] = (tc_level_texture){
            .content = content,
            .texture = array_texture(gl, tc_gl_format_of(content->format), size, t->depth, t->anisotropy),
            .size = size,
            .bytes = texels * tc_texel_bytes(content->format),
        };
    }
    char what[64];
    snprintf(what, sizeof what, "%d layers of %dx%d", t->depth, n + 1, n + 1);
    tc_status status = tc_gl_allocated(gl, what, error);
    if (status != TC_OK)
        tc_level_textures_destroy(gl, t);
    return status;
}

/* Takes over the layers that there were. */
static void copy_layers(const tc_gl *gl, const tc_level_textures *from, tc_level_textures *to, int charts)
{
    for (int chart = 0; chart < charts; chart++) {
        int old = tc_first_layer(&from->layers, chart), now = tc_first_layer(&to->layers, chart);
        int held = from->layers.held[chart];
        if (held == 0)
            continue;
        memcpy(&to->cursor[now], &from->cursor[old], (size_t)held * sizeof *to->cursor);
        memcpy(&to->left[now], &from->left[old], (size_t)held * sizeof *to->left);
        for (int k = 0; k < to->contents; k++)
            gl->CopyImageSubData(from->content[k].texture, GL_TEXTURE_2D_ARRAY, 0, 0, 0, old, to->content[k].texture,
                                 GL_TEXTURE_2D_ARRAY, 0, 0, 0, now, to->content[k].size, to->content[k].size, held);
    }
}

tc_status tc_level_textures_hold(const tc_gl *gl, tc_level_textures *textures, tc_clipmap *const *clipmaps, int charts,
                                 const int levels[TC_MAX_CHARTS], tc_error *error)
{
    tc_level_textures grown = {.layers = textures->layers, .anisotropy = textures->anisotropy, .ring = textures->ring};
    bool grows = textures->contents == 0;
    for (int chart = 0; chart < charts; chart++) {
        int now = textures->layers.held[chart], all = tc_clipmap_levels(clipmaps[chart]);
        if (levels[chart] > now) {
            grown.layers.held[chart] = (int)tc_min64(all, tc_max64(levels[chart], now + (now ? (all + 1) / 2 : 0)));
            grows = true;
        }
        grown.depth += grown.layers.held[chart];
    }
    if (!grows)
        return TC_OK;
    grown.depth = grown.depth > 0 ? grown.depth : 1;
    tc_status status = create(gl, clipmaps[0], &grown, error);
    if (status != TC_OK)
        return status;
    if (textures->contents)
        copy_layers(gl, textures, &grown, charts);
    tc_level_textures_destroy(gl, textures);
    *textures = grown;
    return TC_OK;
}

void tc_level_textures_destroy(const tc_gl *gl, tc_level_textures *textures)
{
    for (int k = 0; k < textures->contents; k++)
        gl->DeleteTextures(1, &textures->content[k].texture);
    textures->contents = 0;
}

tc_level_texture tc_level_texture_of(const tc_level_textures *textures, const tc_content_class *content)
{
    for (int k = 0; k < textures->contents; k++)
        if (textures->content[k].content == content)
            return textures->content[k];
    return (tc_level_texture){0};
}

/* ---- Uploads ----------------------------------------------------------------------------------------------------- */

/* A rectangle of a layer from texels in rows that are t->size long: through the ring, packed, or as they lie. */
static void upload_run(const tc_gl *gl, tc_upload_ring *ring, const tc_level_texture *t, int layer, const char *texels,
                       tc_rect r)
{
    const tc_gl_format *format = tc_gl_format_of(t->content->format);
    const size_t texel = tc_texel_bytes(t->content->format), row = (size_t)t->size * texel;
    const size_t w = (size_t)(r.x1 - r.x0), h = (size_t)(r.y1 - r.y0);
    size_t offset = 0;
    const char *from = texels + (size_t)r.y0 * row + (size_t)r.x0 * texel;
    char *room = ring ? tc_upload_ring_take(ring, w * h * texel, &offset) : NULL;
    for (size_t y = 0; y < h && room; y++)
        memcpy(room + y * w * texel, from + y * row, w * texel);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, room ? 0 : t->size);
    if (room)
        gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, ring->buffer);
    gl->TextureSubImage3D(t->texture, 0, (GLint)r.x0, (GLint)r.y0, layer, (GLsizei)w, (GLsizei)h, 1, format->format,
                          format->type, room ? (const void *)offset : from);
    if (room)
        gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

/* Texels r of a layer, from the whole toroidal array. */
static int64_t upload_wrapped(const tc_gl *gl, tc_upload_ring *ring, const tc_level_texture *t, int layer,
                              const void *texels, tc_rect r)
{
    int64_t size = t->size;
    int64_t w = tc_min64(r.x1 - r.x0, size), h = tc_min64(r.y1 - r.y0, size);
    for (int64_t dy = 0, run_y; dy < h; dy += run_y) {
        int64_t ty = (r.y0 + dy) & (size - 1);
        run_y = tc_min64(h - dy, size - ty);
        for (int64_t dx = 0, run_x; dx < w; dx += run_x) {
            int64_t tx = (r.x0 + dx) & (size - 1);
            run_x = tc_min64(w - dx, size - tx);
            upload_run(gl, ring, t, layer, texels, (tc_rect){tx, ty, tx + run_x, ty + run_y});
        }
    }
    return w * h * (int64_t)tc_texel_bytes(t->content->format);
}

/* What is left to upload of a level. */
typedef struct pending {
    tc_rect rect[TC_MAX_CHANGES + TC_LEFT];
    int count;
    int64_t samples;
    uint64_t cursor; /* once it is done */
} pending;

static pending changes_of(const tc_level_textures *textures, const tc_clipmap *clipmap, int level, int layer)
{
    pending p = {.cursor = textures->cursor[layer]};
    p.count = tc_clipmap_changes(clipmap, level, &p.cursor, p.rect);
    for (int i = 0; i < TC_LEFT; i++)
        if (!tc_rect_empty(textures->left[layer][i]))
            p.rect[p.count++] = textures->left[layer][i];
    for (int i = 0; i < p.count; i++)
        p.samples += tc_rect_area(p.rect[i]);
    return p;
}

/* What is uploaded between two looks at the clock, in samples. */
enum { TIMED_SAMPLES = 1 << 13 };

/* An upload under way. */
typedef struct uploading {
    const tc_gl *gl;
    const tc_level_textures *textures;
    double until; /* 0: no limit */
    bool begun;   /* a piece has been uploaded, of a level that is not always */
    int64_t bytes;
} uploading;

static bool is_over(const uploading *u)
{
    return u->until > 0 && u->begun && tc_clock_ms() >= u->until;
}

/* Samples r of a level in all textures. Returns what of it is left, since it is late. */
static tc_rect upload_rect(uploading *u, const tc_clipmap *clipmap, int level, int layer, tc_rect r)
{
    const bool timed = u->until > 0 && level > 1;
    const int64_t size = tc_clipmap_n(clipmap) + 1;
    r.x1 = tc_min64(r.x1, r.x0 + size), r.y1 = tc_min64(r.y1, r.y0 + size); /* no more differ */
    const int64_t rows = timed ? tc_max64(TIMED_SAMPLES / (r.x1 - r.x0), 1) : r.y1 - r.y0;
    while (r.y0 < r.y1 && !(timed && is_over(u))) {
        tc_rect piece = {r.x0, r.y0, r.x1, tc_min64(r.y1, r.y0 + rows)};
        for (int k = 0; k < u->textures->contents; k++) {
            const tc_level_texture *t = &u->textures->content[k];
            u->bytes +=
                upload_wrapped(u->gl, u->textures->ring, t, layer, tc_clipmap_texels(clipmap, t->content, level),
                               tc_content_rect(t->content, piece));
        }
        u->begun |= level > 1;
        r.y0 = piece.y1;
    }
    return r.y0 < r.y1 ? r : (tc_rect){0, 0, 0, 0};
}

/* What is left of a level goes to left[]: the last rectangles as one around them where there are many. True where
 * nothing is. */
static bool upload_level(uploading *u, const tc_clipmap *clipmap, int level, int layer, const pending *p,
                         tc_rect left[TC_LEFT])
{
    int count = 0;
    memset(left, 0, TC_LEFT * sizeof *left);
    for (int i = 0; i < p->count; i++) {
        const tc_rect late = upload_rect(u, clipmap, level, layer, p->rect[i]);
        tc_rect *to = &left[count < TC_LEFT ? count : TC_LEFT - 1];
        *to = tc_rect_around(*to, late);
        count += !tc_rect_empty(late);
    }
    return count == 0;
}

int64_t tc_level_textures_upload(const tc_gl *gl, tc_level_textures *textures, tc_clipmap *const *clipmaps, int charts,
                                 int64_t budget, double until)
{
    tc_layers *layers = &textures->layers;
    int64_t spent = 0;
    uploading u = {.gl = gl, .textures = textures, .until = until};
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (int chart = 0; chart < charts; chart++) {
        int first = tc_first_layer(layers, chart);
        layers->ready[chart] = 0;
        for (int level = 1; level <= layers->held[chart]; level++) {
            int layer = first + level - 1;
            pending p = changes_of(textures, clipmaps[chart], level, layer);
            if (p.count > 0 && level > 1 && ((budget >= 0 && spent >= budget) || is_over(&u)))
                break;
            textures->cursor[layer] = p.cursor;
            if (!upload_level(&u, clipmaps[chart], level, layer, &p, textures->left[layer]))
                break;
            spent += level > 1 ? p.samples : 0;
            layers->ready[chart] = level;
        }
    }
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    return u.bytes;
}

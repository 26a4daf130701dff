/* plain_mesh.c - meshes of ready-made positions. */
#include "plain_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/view/camera.h"
#include "planar/square_internal.h"

void plain_create(const tc_gl *gl, int width, int height, plain_mesh *m, const float (*positions)[3], size_t count,
                  const uint16_t *indices, int index_count, const tc_draw *draws, int strips, int lists)
{
    static const char *vs = "#version 450 core\nlayout(location = 0) in vec3 p; uniform mat4 m;\n"
                            "void main() { gl_Position = m * vec4(p, 1.0); }\n";
    static const char *fs = "#version 450 core\nout vec4 c; void main() { c = vec4(0.5, 0.6, 0.4, 1.0); }\n";
    GLuint v = gl->CreateShader(GL_VERTEX_SHADER), f = gl->CreateShader(GL_FRAGMENT_SHADER);
    *m = (plain_mesh){.width = width, .height = height, .strip_draws = strips, .list_draws = lists};
    gl->ShaderSource(v, 1, &vs, NULL), gl->CompileShader(v);
    gl->ShaderSource(f, 1, &fs, NULL), gl->CompileShader(f);
    m->program = gl->CreateProgram();
    gl->AttachShader(m->program, v), gl->AttachShader(m->program, f), gl->LinkProgram(m->program);
    gl->DeleteShader(v), gl->DeleteShader(f);
    m->matrix = gl->GetUniformLocation(m->program, "m");
    gl->CreateBuffers(1, &m->vertices);
    gl->NamedBufferStorage(m->vertices, (GLsizeiptr)(count * sizeof *positions), positions, 0);
    gl->CreateBuffers(1, &m->indices);
    gl->NamedBufferStorage(m->indices, (GLsizeiptr)((size_t)index_count * sizeof *indices), indices, 0);
    gl->CreateBuffers(1, &m->draws);
    gl->NamedBufferStorage(m->draws, (GLsizeiptr)((size_t)(strips + lists) * sizeof *draws), draws, 0);
    gl->CreateVertexArrays(1, &m->vao);
    gl->VertexArrayElementBuffer(m->vao, m->indices);
    gl->VertexArrayVertexBuffer(m->vao, 0, m->vertices, 0, sizeof *positions);
    gl->EnableVertexArrayAttrib(m->vao, 0);
    gl->VertexArrayAttribFormat(m->vao, 0, 3, GL_FLOAT, GL_FALSE, 0);
    gl->VertexArrayAttribBinding(m->vao, 0, 0);
    gl->CreateRenderbuffers(2, m->renderbuffers);
    gl->NamedRenderbufferStorage(m->renderbuffers[0], GL_RGBA8, width, height);
    gl->NamedRenderbufferStorage(m->renderbuffers[1], GL_DEPTH_COMPONENT32F, width, height);
    gl->CreateFramebuffers(1, &m->framebuffer);
    gl->NamedFramebufferRenderbuffer(m->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, m->renderbuffers[0]);
    gl->NamedFramebufferRenderbuffer(m->framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, m->renderbuffers[1]);
    if (gl->GetError() != GL_NO_ERROR) {
        fprintf(stderr, "plain mesh: the driver cannot hold %zu vertices\n", count);
        exit(99);
    }
}

void plain_draw(const tc_gl *gl, const plain_mesh *m, const tc_camera *camera, double near_plane, bool one_sided)
{
    float matrix[16];
    tc_camera_matrix(camera, near_plane, matrix);
    gl->BindFramebuffer(GL_FRAMEBUFFER, m->framebuffer);
    gl->Viewport(0, 0, m->width, m->height);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->ClearNamedFramebufferfv(m->framebuffer, GL_DEPTH, 0, (float[]){0});
    gl->ClearNamedFramebufferfv(m->framebuffer, GL_COLOR, 0, (float[]){0, 0, 0, 1});
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_GREATER);
    gl->BindVertexArray(m->vao);
    gl->UseProgram(m->program);
    gl->ProgramUniformMatrix4fv(m->program, m->matrix, 1, GL_FALSE, matrix);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, m->draws);
    gl->Disable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    gl->FrontFace(GL_CW);
    if (one_sided)
        gl->Enable(GL_CULL_FACE);
    gl->MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT, NULL, m->strip_draws, 0);
    gl->Disable(GL_CULL_FACE);
    if (m->list_draws)
        gl->MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT,
                                      (const void *)((size_t)m->strip_draws * sizeof(tc_draw)), m->list_draws, 0);
}

float *plain_depth(const tc_gl *gl, const plain_mesh *m)
{
    size_t row = (size_t)m->width;
    float *depth = malloc(row * (size_t)m->height * sizeof *depth);
    if (!depth)
        exit(99);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, m->framebuffer);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < m->height; y++)
        gl->ReadPixels(0, m->height - 1 - y, m->width, 1, GL_DEPTH_COMPONENT, GL_FLOAT, depth + (size_t)y * row);
    return depth;
}

void plain_destroy(const tc_gl *gl, plain_mesh *m)
{
    gl->DeleteProgram(m->program);
    gl->DeleteVertexArrays(1, &m->vao);
    gl->DeleteBuffers(3, (GLuint[]){m->vertices, m->indices, m->draws});
    gl->DeleteFramebuffers(1, &m->framebuffer);
    gl->DeleteRenderbuffers(2, m->renderbuffers);
    *m = (plain_mesh){0};
}

/* ---- Brute force ------------------------------------------------------------------------------------------------- */

enum { B = 128, STRIDE = B + 1 }; /* cells of a tile along a side */

/* A grid of columns x rows vertices, of which `rows_of` gives the positions of a rectangle, at most a tile's. */
typedef struct lattice {
    int64_t columns, rows;
    void (*positions)(const struct lattice *l, tc_rect rect, float (*out)[3]);
    const tc_field *field;
    const tc_map *atlas;
    const tc_camera *camera;
} lattice;

static bool fits(int64_t columns, int64_t rows)
{
    if (columns * rows <= PLAIN_MOST_SAMPLES)
        return true;
    printf("brute force: not measured: %lld x %lld samples are too many for one mesh (at most %lld)\n",
           (long long)columns, (long long)rows, (long long)PLAIN_MOST_SAMPLES);
    return false;
}

/* All cells in tiles of B x B, those at the far sides smaller. */
static void build(const tc_gl *gl, const lattice *l, plain_mesh *m)
{
    tc_geometry g = {0};
    tc_block_geometry index;
    tc_error error;
    if (tc_block_geometry_make(B, &g, &index, &error))
        exit(99);
    int64_t across = (l->columns - 1 + B - 1) / B, up = (l->rows - 1 + B - 1) / B, count = across * up;
    float(*positions)[3] = calloc((size_t)(count * g.vertex_count), sizeof *positions);
    tc_draw *draws = malloc((size_t)count * sizeof *draws);
    if (!positions || !draws) {
        fputs("brute force: not enough memory\n", stderr);
        exit(99);
    }
    for (int64_t t = 0; t < count; t++) {
        int64_t x = t % across * B, y = t / across * B;
        tc_rect r = {x, y, tc_min64(x + STRIDE, l->columns), tc_min64(y + STRIDE, l->rows)};
        l->positions(l, r, positions + t * g.vertex_count);
        int64_t w = r.x1 - x - 1, h = r.y1 - y - 1;
        draws[t] =
            (tc_draw){tc_block_strip_count(w, h), 1, index.strip_first[w - 1], (int32_t)(t * g.vertex_count), 0};
    }
    plain_create(gl, l->camera->width, l->camera->height, m, (const float(*)[3])positions,
                 (size_t)(count * g.vertex_count), g.indices, g.index_count, draws, (int)count, 0);
    m->triangles = 2 * (l->columns - 1) * (l->rows - 1);
    free(positions), free(draws), free(g.vertices), free(g.indices), free(index.strip_first);
}

static void flat_positions(const lattice *l, tc_rect r, float (*out)[3])
{
    float z[STRIDE * STRIDE];
    int finest = tc_field_info(l->field)->levels;
    tc_level level = tc_field_level(l->field, finest);
    if (tc_field_read(l->field, finest, r, z, NULL, STRIDE))
        exit(99);
    double eye = l->camera->z - tc_field_info(l->field)->z_base;
    for (int64_t y = r.y0; y < r.y1; y++)
        for (int64_t x = r.x0; x < r.x1; x++) {
            int64_t k = (y - r.y0) * STRIDE + x - r.x0;
            out[k][0] = (float)((double)x * level.spacing_x - l->camera->x);
            out[k][1] = (float)((double)y * level.spacing_y - l->camera->y);
            out[k][2] = (float)((double)z[k] - eye);
        }
}

bool plain_brute_flat(const tc_gl *gl, const tc_field *field, const tc_camera *camera, plain_mesh *m)
{
    tc_level level = tc_field_level(field, tc_field_info(field)->levels);
    if (!fits(level.width, level.height))
        return false;
    build(gl,
          &(lattice){.columns = level.width,
                     .rows = level.height,
                     .positions = flat_positions,
                     .field = field,
                     .camera = camera},
          m);
    return true;
}

/* Heights of chart 0's samples: its own where no cap has a share. */
static double globe_height(const tc_map *a, double own, double longitude, double latitude)
{
    double base = tc_field_info(a->chart[0].field)->z_base, z = own + base;
    if (a->charts > 1 && fabs(latitude) >= TC_CAP_BLEND_START * M_PI / 180 && tc_map_height(a, longitude, latitude, &z))
        exit(99);
    return z - base;
}

/* Relative to the eye: east, north, up. Rows 0 and the last are the poles, where the map reaches them. */
static void globe_positions(const lattice *l, tc_rect r, float (*out)[3])
{
    const tc_map *a = l->atlas;
    const tc_chart *c = &a->chart[0];
    const tc_camera *eye = l->camera;
    int finest = tc_field_info(c->field)->levels;
    tc_level level = tc_field_level(c->field, finest);
    bool poles = a->charts > 1;
    double base = tc_field_info(c->field)->z_base, se = sin(eye->y), ce = cos(eye->y);
    float z[STRIDE];
    for (int64_t y = r.y0; y < r.y1; y++) {
        int64_t row = tc_clamp64(y - poles, 0, level.height - 1);
        bool pole = poles && row != y - 1;
        double latitude = pole ? (y ? M_PI / 2 : -M_PI / 2) : c->y0 + (double)row * c->dy;
        if (tc_field_read(c->field, finest, (tc_rect){r.x0, row, r.x1, row + 1}, z, NULL, STRIDE))
            exit(99);
        for (int64_t x = r.x0; x < r.x1; x++) {
            double longitude = c->x0 + (double)x * c->dx, turn = longitude - eye->x;
            double h = globe_height(a, z[x - r.x0], longitude, latitude);
            double s = sin(latitude), q = cos(latitude), across = q * cos(turn), distance = a->body.radius + base + h;
            float *p = out[(y - r.y0) * STRIDE + x - r.x0];
            p[0] = (float)(distance * q * sin(turn));
            p[1] = (float)(distance * (ce * s - se * across));
            p[2] = (float)(distance * (se * s + ce * across) - (a->body.radius + eye->z));
        }
    }
}

bool plain_brute_globe(const tc_gl *gl, const tc_map *atlas, const tc_camera *camera, plain_mesh *m)
{
    const tc_chart *c = &atlas->chart[0];
    tc_level level = tc_field_level(c->field, tc_field_info(c->field)->levels);
    int64_t columns = level.width + c->wraps, rows = level.height + 2 * (atlas->charts > 1);
    if (!fits(columns, rows))
        return false;
    build(gl,
          &(lattice){.columns = columns, .rows = rows, .positions = globe_positions, .atlas = atlas, .camera = camera},
          m);
    m->triangles -= atlas->charts > 1 ? 2 * level.width : 0; /* at a pole every other one has no area */
    return true;
}

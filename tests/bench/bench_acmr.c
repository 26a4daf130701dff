/* bench_acmr.c - vertices that are run for each triangle of the static geometry (ACMR): by models of vertex caches,
 * first in first out of 16 and of 32 entries and 256 entries each for the vertices of one index modulo 256; and as the
 * driver counts them, where it does. Of a block as wide as high, and of all sectors of a ring. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/status.h"
#include "common/render/block_geometry.h"
#include "spherical/rings_internal.h"
#include "tests/support/measure.h"
#include "tests/support/scene.h"

/* What is drawn of a geometry: some lists of as many indices. */
typedef struct drawn {
    const tc_geometry *geometry;
    uint32_t first, count;
    int lists;
    int64_t triangles;
} drawn;

typedef struct cache {
    int64_t missed;
    int size, next;
    uint32_t entry[256];
} cache;

static void fifo(cache *c, uint32_t index)
{
    for (int k = 0; k < c->size; k++)
        if (c->entry[k] == index)
            return;
    c->entry[c->next] = index, c->next = (c->next + 1) % c->size, c->missed++;
}

static void mapped(cache *c, uint32_t index)
{
    uint32_t *entry = &c->entry[index % (uint32_t)c->size];
    c->missed += *entry != index;
    *entry = index;
}

static double model(const drawn *d, void (*look)(cache *, uint32_t), int size)
{
    cache c = {.size = size};
    for (int list = 0; list < d->lists; list++) {
        memset(c.entry, 0xff, sizeof c.entry); /* no draw finds what another has left */
        for (uint32_t k = 0; k < d->count; k++)
            look(&c, tc_index(d->geometry, d->first + (uint32_t)list * d->count + k));
    }
    return (double)c.missed / (double)d->triangles;
}

/* Runs of a vertex stage that does nothing. Less than 0: not told. */
static double counted(const tc_gl *gl, const drawn *d)
{
    static const char *text = "#version 450 core\nlayout(location = 0) in vec4 p;\n"
                              "layout(std430, binding = 0) buffer Count { uint runs; };\n"
                              "void main() { atomicAdd(runs, 1u); gl_Position = p; }\n";
    const tc_geometry *g = d->geometry;
    GLuint program = gl->CreateProgram(), shader = gl->CreateShader(GL_VERTEX_SHADER), vao, buffers[4];
    gl->ShaderSource(shader, 1, &text, NULL), gl->CompileShader(shader);
    gl->AttachShader(program, shader), gl->LinkProgram(program), gl->DeleteShader(shader);
    const size_t bytes = g->format == TC_VERTEX_FLOAT_4 ? 16 : 4;
    tc_draw draws[RINGS_SECTORS];
    for (int k = 0; k < d->lists; k++)
        draws[k] = (tc_draw){.count = d->count, .instance_count = 1, .first_index = d->first + (uint32_t)k * d->count};
    uint32_t runs = 0;
    gl->CreateBuffers(4, buffers);
    gl->NamedBufferStorage(buffers[3], sizeof runs, &runs, 0);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[3]);
    gl->NamedBufferStorage(buffers[0], (GLsizeiptr)((size_t)g->vertex_count * bytes), g->vertices, 0);
    gl->NamedBufferStorage(buffers[1], (GLsizeiptr)g->index_count * g->index_bytes, g->indices, 0);
    gl->NamedBufferStorage(buffers[2], sizeof draws, draws, 0);
    gl->CreateVertexArrays(1, &vao);
    gl->VertexArrayElementBuffer(vao, buffers[1]);
    gl->VertexArrayVertexBuffer(vao, 0, buffers[0], 0, (GLsizei)bytes);
    gl->EnableVertexArrayAttrib(vao, 0);
    gl->VertexArrayAttribFormat(vao, 0, bytes == 16 ? 4 : 2, bytes == 16 ? GL_FLOAT : GL_UNSIGNED_SHORT, GL_FALSE, 0);
    gl->VertexArrayAttribBinding(vao, 0, 0);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, buffers[2]);
    gl->BindVertexArray(vao), gl->UseProgram(program);
    gl->MultiDrawElementsIndirect(GL_TRIANGLES, g->index_bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT, NULL,
                                  d->lists, 0);
    gl->Finish();
    gl->GetNamedBufferSubData(buffers[3], 0, sizeof runs, &runs);
    const bool told = gl->GetError() == GL_NO_ERROR;
    gl->DeleteVertexArrays(1, &vao), gl->DeleteBuffers(4, buffers);
    gl->DeleteProgram(program);
    return told ? (double)runs / (double)d->triangles : -1;
}

static void measure(const measure_options *o, const tc_gl *gl, const char *what, const drawn *d)
{
    const double acmr[3] = {model(d, fifo, 16), model(d, fifo, 32), model(d, mapped, 256)}, driver = counted(gl, d);
    printf("%-24s %7lld triangles: FIFO 16 %.3f, FIFO 32 %.3f, modulo 256 %.3f, driver %.3f\n", what,
           (long long)d->triangles, acmr[0], acmr[1], acmr[2], driver);
    if (o->csv)
        fprintf(o->csv, "%s,%lld,%.4f,%.4f,%.4f,%.4f\n", what, (long long)d->triangles, acmr[0], acmr[1], acmr[2],
                driver);
}

static void blocks(const measure_options *o, const tc_gl *gl, int block)
{
    tc_geometry g = {0};
    tc_block_geometry index;
    tc_error error;
    char what[64];
    if (tc_block_geometry_make(block, &g, &index, &error))
        exit(99);
    for (int cells = block; cells >= block / 2; cells -= block / 4) {
        snprintf(what, sizeof what, "block of %d, %d cells", block, cells);
        measure(o, gl, what,
                &(drawn){.geometry = &g,
                         .first = index.strip_first[cells - 1],
                         .count = tc_block_strip_count(cells, cells),
                         .lists = 1,
                         .triangles = 2 * (int64_t)cells * cells});
    }
    free(g.vertices), free(g.indices), free(index.strip_first);
}

static void rings(const measure_options *o, const tc_gl *gl, int n_phi)
{
    rings_geometry r = {.levels = 1, .n_phi = n_phi, .m = tc_rings_steps(n_phi)};
    tc_geometry g = {0};
    tc_error error;
    char what[64];
    r.fill = r.m / 2;
    if (tc_rings_geometry(&r, &g, &error))
        exit(99);
    for (int disc = 0; disc < 2; disc++) {
        const rings_strips *list = &(disc ? r.fill_strips : r.ring_strips)[0][0];
        snprintf(what, sizeof what, "%s of %d by %d", disc ? "disc" : "ring", n_phi, disc ? r.fill : r.m);
        measure(o, gl, what,
                &(drawn){.geometry = &g,
                         .first = list->first,
                         .count = list->count,
                         .lists = r.sectors,
                         .triangles = (int64_t)list->triangles * r.sectors});
    }
    free(g.vertices), free(g.indices);
}

int main(int argc, char **argv)
{
    measure_options o = measure_begin(argc, argv, "what,triangles,fifo_16,fifo_32,modulo_256,driver");
    tc_context *context = scene_context();
    if (!context)
        return 1;
    for (int block = 8; block <= 64; block *= 2)
        blocks(&o, tc_context_gl(context), block);
    for (int n_phi = 256; n_phi <= 2048; n_phi *= 2)
        rings(&o, tc_context_gl(context), n_phi);
    tc_context_destroy(context);
    return measure_end(&o);
}

/* drawn_triangles.c - the triangles of a frame as the driver puts them together. */
#include "drawn_triangles.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "feedback.h"

triangle_catcher triangle_catcher_create(const tc_gl *gl, scene *s)
{
    triangle_catcher c = {.gl = gl, .scene = s};
    c.program = feedback_program(gl, s->surface, "", "renderer.vert", "", (const char *[]){"gl_Position", NULL});
    gl->CreateQueries(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, 1, &c.query);
    return c;
}

void triangle_catcher_destroy(triangle_catcher *c)
{
    c->gl->DeleteProgram(c->program);
    c->gl->DeleteQueries(1, &c->query);
}

/* Strips of the last frame: how many, and a bound of their triangles. */
static int strips_of(scene *s, const tc_camera *camera, int64_t *most_ret)
{
    tc_frame frame;
    if (!tc_frame_allocate(s->surface, &frame))
        exit(99);
    s->surface->draws(scene_look(s, camera, NULL), &tc_renderer_used(s->renderer).textures->layers, &frame);
    *most_ret = 0;
    for (int k = 0; k < frame.strip_draws; k++)
        *most_ret += frame.draws[k].count;
    int strips = frame.strip_draws;
    tc_frame_free(&frame);
    return strips;
}

drawn_triangles triangle_catcher_draw(triangle_catcher *c, const tc_camera *camera)
{
    const tc_gl *gl = c->gl;
    int64_t most;
    GLuint buffer;
    GLuint64 count = 0;
    gl->Enable(GL_RASTERIZER_DISCARD);
    scene_draw(c->scene, camera, true);
    const int strips = strips_of(c->scene, camera, &most);
    drawn_triangles t = {.clip = malloc((size_t)(most + 1) * sizeof *t.clip)};
    if (!t.clip)
        exit(99);
    gl->CreateBuffers(1, &buffer);
    gl->NamedBufferStorage(buffer, (GLsizeiptr)((size_t)(most + 1) * sizeof *t.clip), NULL, 0);
    gl->BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    gl->UseProgram(c->program);
    gl->BeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, c->query);
    gl->BeginTransformFeedback(GL_TRIANGLES);
    gl->MultiDrawElementsIndirect(GL_TRIANGLES,
                                  c->scene->surface->geometry.index_bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT,
                                  NULL, strips, 0);
    gl->EndTransformFeedback();
    gl->EndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
    gl->GetQueryObjectui64v(c->query, GL_QUERY_RESULT, &count);
    gl->Disable(GL_RASTERIZER_DISCARD);
    t.count = (int64_t)count;
    gl->GetNamedBufferSubData(buffer, 0, (GLsizeiptr)((size_t)count * sizeof *t.clip), t.clip);
    gl->BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    gl->DeleteBuffers(1, &buffer);
    if (gl->GetError() != GL_NO_ERROR) {
        fputs("drawn triangles: the driver does not give them\n", stderr);
        exit(99);
    }
    return t;
}

double drawn_triangle_area(const float clip[3][4], const tc_camera *camera)
{
    double p[3][2];
    for (int k = 0; k < 3; k++) {
        const double w = clip[k][3];
        if (!(w > 0 && fabs((double)clip[k][0]) <= w && fabs((double)clip[k][1]) <= w))
            return 0;
        p[k][0] = 0.5 * camera->width * (double)clip[k][0] / w, p[k][1] = 0.5 * camera->height * (double)clip[k][1] / w;
    }
    return 0.5 * fabs((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]));
}

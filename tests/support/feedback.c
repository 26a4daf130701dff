/* feedback.c - what a vertex stage puts out, read back from the driver by transform feedback. */
#include "feedback.h"

#include <stdio.h>
#include <stdlib.h>

#include "common/gl/program.h"
#include "common/render/scene_programs.h"

static void complain(const char *log)
{
    fprintf(stderr, "feedback: %s\n", log);
    exit(99);
}

GLuint feedback_program(const tc_gl *gl, const tc_surface *surface, const char *scene, const char *last,
                        const char *own, const char *const *varyings)
{
    char defines[TC_FRAME_DEFINES], mask[400];
    tc_scene_frame_defines(defines);
    size_t used = (size_t)snprintf(mask, sizeof mask,
                                   "#define WINDOW_MASK %d\n#define INTERPOLATED centroid\n"
                                   "#define NEARNESS_AT(p) (p.z / p.w)\n",
                                   surface->n);
    for (const char *const *define = surface->defines; define && *define; define++)
        used += (size_t)snprintf(mask + used, sizeof mask - used, "#define %s\n", *define);
    const char *text[16] = {"#version 450 core\n", defines, mask, scene, tc_shader_text(NULL, "frame.glsl")};
    int texts = 5, captured = 0;
    for (const char *const *part = surface->vertex_parts; *part && texts < 14; part++)
        if (!(text[texts++] = tc_shader_text(surface->texts, *part)))
            complain(*part);
    if (last)
        text[texts++] = tc_shader_text(NULL, last);
    text[texts++] = own;
    char log[1024] = "";
    GLint done = GL_FALSE;
    GLuint shader = gl->CreateShader(GL_VERTEX_SHADER), program = gl->CreateProgram();
    gl->ShaderSource(shader, texts, text, NULL);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) {
        gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
        complain(log);
    }
    while (varyings[captured])
        captured++;
    gl->AttachShader(program, shader);
    gl->TransformFeedbackVaryings(program, captured, varyings, GL_INTERLEAVED_ATTRIBS);
    gl->LinkProgram(program);
    gl->DeleteShader(shader);
    gl->GetProgramiv(program, GL_LINK_STATUS, &done);
    if (!done) {
        gl->GetProgramInfoLog(program, sizeof log, NULL, log);
        complain(log);
    }
    return program;
}

/* What is drawn between begin() and end() is captured. */
static GLuint begin(const tc_gl *gl, GLuint program, GLsizeiptr bytes)
{
    GLuint buffer;
    gl->CreateBuffers(1, &buffer);
    gl->NamedBufferStorage(buffer, bytes, NULL, 0);
    gl->BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    gl->UseProgram(program);
    gl->Enable(GL_RASTERIZER_DISCARD);
    gl->BeginTransformFeedback(GL_POINTS);
    return buffer;
}

static void end(const tc_gl *gl, GLuint buffer, GLsizeiptr bytes, float *out)
{
    gl->EndTransformFeedback();
    gl->Disable(GL_RASTERIZER_DISCARD);
    gl->GetNamedBufferSubData(buffer, 0, bytes, out);
    gl->BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    gl->DeleteBuffers(1, &buffer);
}

void feedback_run(const tc_gl *gl, GLuint program, int first, int count, int floats, float *out)
{
    const GLsizeiptr bytes = (GLsizeiptr)((size_t)count * (size_t)floats * sizeof *out);
    const GLuint buffer = begin(gl, program, bytes);
    gl->DrawArrays(GL_POINTS, first, count);
    end(gl, buffer, bytes, out);
}

void feedback_elements(const tc_gl *gl, GLuint program, const uint32_t *element, int count, int floats, float *out)
{
    const GLsizeiptr bytes = (GLsizeiptr)((size_t)count * (size_t)floats * sizeof *out);
    const tc_draw draw = {.count = (uint32_t)count, .instance_count = 1};
    GLint vertices, own, indirect;
    GLuint buffers[2]; /* elements, the draw of them */
    gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertices);
    gl->GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &own);
    gl->GetIntegerv(GL_DRAW_INDIRECT_BUFFER_BINDING, &indirect);
    gl->CreateBuffers(2, buffers);
    gl->NamedBufferStorage(buffers[0], (GLsizeiptr)((size_t)count * sizeof *element), element, 0);
    gl->NamedBufferStorage(buffers[1], sizeof draw, &draw, 0);
    gl->VertexArrayElementBuffer((GLuint)vertices, buffers[0]);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, buffers[1]);
    const GLuint buffer = begin(gl, program, bytes);
    gl->MultiDrawElementsIndirect(GL_POINTS, GL_UNSIGNED_INT, NULL, 1, 0);
    end(gl, buffer, bytes, out);
    gl->VertexArrayElementBuffer((GLuint)vertices, (GLuint)own);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, (GLuint)indirect);
    gl->DeleteBuffers(2, buffers);
}

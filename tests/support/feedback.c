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

void feedback_run(const tc_gl *gl, GLuint program, int first, int count, int floats, float *out)
{
    GLsizeiptr bytes = (GLsizeiptr)((size_t)count * (size_t)floats * sizeof *out);
    GLuint buffer;
    gl->CreateBuffers(1, &buffer);
    gl->NamedBufferStorage(buffer, bytes, NULL, 0);
    gl->BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    gl->UseProgram(program);
    gl->Enable(GL_RASTERIZER_DISCARD);
    gl->BeginTransformFeedback(GL_POINTS);
    gl->DrawArrays(GL_POINTS, first, count);
    gl->EndTransformFeedback();
    gl->Disable(GL_RASTERIZER_DISCARD);
    gl->GetNamedBufferSubData(buffer, 0, bytes, out);
    gl->BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    gl->DeleteBuffers(1, &buffer);
}

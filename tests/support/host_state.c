/* host_state.c - OpenGL state in a list of its own, not that of the renderer. */
#include "host_state.h"

#include <stdio.h>

#include "test.h"

static const struct named {
    GLenum name;
    const char *text;
    bool usual; /* of a switch: as a context begins */
} switches[] = {
#define SWITCH(name, usual)                                                                                            \
    {                                                                                                                  \
        GL_##name, #name, usual                                                                                        \
    }
    SWITCH(BLEND, false),
    SWITCH(COLOR_LOGIC_OP, false),
    SWITCH(CULL_FACE, false),
    SWITCH(DEPTH_CLAMP, false),
    SWITCH(DEPTH_TEST, false),
    SWITCH(DITHER, true),
    SWITCH(FRAMEBUFFER_SRGB, false),
    SWITCH(LINE_SMOOTH, false),
    SWITCH(MULTISAMPLE, true),
    SWITCH(POLYGON_OFFSET_FILL, false),
    SWITCH(POLYGON_OFFSET_LINE, false),
    SWITCH(POLYGON_SMOOTH, false),
    SWITCH(PRIMITIVE_RESTART, false),
    SWITCH(PRIMITIVE_RESTART_FIXED_INDEX, false),
    SWITCH(SAMPLE_ALPHA_TO_COVERAGE, false),
    SWITCH(SAMPLE_ALPHA_TO_ONE, false),
    SWITCH(SAMPLE_COVERAGE, false),
    SWITCH(SAMPLE_SHADING, false),
    SWITCH(SAMPLE_MASK, false),
    SWITCH(SCISSOR_TEST, false),
    SWITCH(STENCIL_TEST, false),
    SWITCH(CLIP_DISTANCE0, false),
    SWITCH(CLIP_DISTANCE7, false),
    SWITCH(PROGRAM_POINT_SIZE, false),
    SWITCH(TEXTURE_CUBE_MAP_SEAMLESS, false),
    SWITCH(RASTERIZER_DISCARD, false),
#undef SWITCH
};
enum { SWITCHES = sizeof switches / sizeof *switches };

/* Numbers, and how many of each. */
static const struct numbers {
    GLenum name;
    const char *text;
    int count;
} numbers[] = {
#define NUMBER(name, count)                                                                                            \
    {                                                                                                                  \
        GL_##name, #name, count                                                                                        \
    }
    NUMBER(DRAW_FRAMEBUFFER_BINDING, 1),
    NUMBER(READ_FRAMEBUFFER_BINDING, 1),
    NUMBER(RENDERBUFFER_BINDING, 1),
    NUMBER(VIEWPORT, 4),
    NUMBER(SCISSOR_BOX, 4),
    NUMBER(CLIP_ORIGIN, 1),
    NUMBER(CLIP_DEPTH_MODE, 1),
    NUMBER(DEPTH_FUNC, 1),
    NUMBER(DEPTH_WRITEMASK, 1),
    NUMBER(CULL_FACE_MODE, 1),
    NUMBER(FRONT_FACE, 1),
    NUMBER(POLYGON_MODE, 1),
    NUMBER(PROVOKING_VERTEX, 1),
    NUMBER(LOGIC_OP_MODE, 1),
    NUMBER(BLEND_SRC_RGB, 1),
    NUMBER(BLEND_DST_ALPHA, 1),
    NUMBER(STENCIL_FUNC, 1),
    NUMBER(CURRENT_PROGRAM, 1),
    NUMBER(PROGRAM_PIPELINE_BINDING, 1),
    NUMBER(VERTEX_ARRAY_BINDING, 1),
    NUMBER(ARRAY_BUFFER_BINDING, 1),
    NUMBER(DRAW_INDIRECT_BUFFER_BINDING, 1),
    NUMBER(PIXEL_UNPACK_BUFFER_BINDING, 1),
    NUMBER(PIXEL_PACK_BUFFER_BINDING, 1),
    NUMBER(UNIFORM_BUFFER_BINDING, 1),
    NUMBER(ACTIVE_TEXTURE, 1),
    NUMBER(UNPACK_SWAP_BYTES, 1),
    NUMBER(UNPACK_LSB_FIRST, 1),
    NUMBER(UNPACK_ROW_LENGTH, 1),
    NUMBER(UNPACK_IMAGE_HEIGHT, 1),
    NUMBER(UNPACK_SKIP_ROWS, 1),
    NUMBER(UNPACK_SKIP_PIXELS, 1),
    NUMBER(UNPACK_SKIP_IMAGES, 1),
    NUMBER(UNPACK_ALIGNMENT, 1),
    NUMBER(PACK_ALIGNMENT, 1),
    NUMBER(PACK_ROW_LENGTH, 1),
#undef NUMBER
};
enum { NUMBERS = sizeof numbers / sizeof *numbers, UNITS = 6, BUFFERS = 3 };

static const GLenum bindings[] = {GL_TEXTURE_BINDING_1D, GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_2D_ARRAY,
                                  GL_TEXTURE_BINDING_2D_MULTISAMPLE, GL_SAMPLER_BINDING};

/* ---- Odd --------------------------------------------------------------------------------------------------------- */

static void set_switches(const tc_gl *gl, bool odd)
{
    for (int i = 0; i < SWITCHES; i++)
        if (switches[i].name != GL_RASTERIZER_DISCARD) /* by which a host asks for no pixels */
            (switches[i].usual != odd ? gl->Enable : gl->Disable)(switches[i].name);
}

static void set_units(const tc_gl *gl, const GLuint texture[3], GLuint sampler)
{
    static const GLenum targets[3] = {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY};
    for (GLuint i = 0; i < UNITS; i++) {
        gl->ActiveTexture(GL_TEXTURE0 + i);
        for (int k = 0; k < 3; k++)
            gl->BindTexture(targets[k], texture[k]);
        gl->BindSampler(i, sampler);
    }
}

static void set_unpacking(const tc_gl *gl, GLint row, GLint skip, GLint alignment, bool swap)
{
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, row);
    gl->PixelStorei(GL_UNPACK_IMAGE_HEIGHT, row);
    gl->PixelStorei(GL_UNPACK_SKIP_ROWS, skip);
    gl->PixelStorei(GL_UNPACK_SKIP_PIXELS, skip);
    gl->PixelStorei(GL_UNPACK_SKIP_IMAGES, skip);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, alignment);
    gl->PixelStorei(GL_UNPACK_SWAP_BYTES, swap);
    gl->PixelStorei(GL_UNPACK_LSB_FIRST, swap);
}

host_odd host_odd_begin(const tc_gl *gl)
{
    host_odd o;
    static const GLenum targets[3] = {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY};
    for (int k = 0; k < 3; k++)
        gl->CreateTextures(targets[k], 1, &o.texture[k]);
    gl->CreateSamplers(1, &o.sampler);
    gl->CreateBuffers(1, &o.buffer);
    gl->NamedBufferStorage(o.buffer, 4096, NULL, 0);
    gl->CreateVertexArrays(1, &o.vertex_array);
    gl->CreateFramebuffers(1, &o.framebuffer);
    o.program = gl->CreateProgram();
    set_switches(gl, true);
    set_units(gl, o.texture, o.sampler);
    set_unpacking(gl, 77, 3, 8, true);
    gl->ActiveTexture(GL_TEXTURE0 + 2);
    gl->BindFramebuffer(GL_FRAMEBUFFER, o.framebuffer);
    gl->Viewport(3, 5, 7, 11);
    gl->Scissor(13, 1, 2, 3);
    gl->DepthRange(0.75, 0.25);
    gl->ClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    gl->DepthFunc(GL_NEVER);
    gl->DepthMask(GL_FALSE);
    gl->CullFace(GL_FRONT_AND_BACK);
    gl->FrontFace(GL_CW);
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    gl->ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    for (GLuint i = 0; i < BUFFERS; i++)
        gl->ColorMaski(i, i != 0, i == 1, i == 2, GL_FALSE);
    gl->BindVertexArray(o.vertex_array);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, o.buffer);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, o.buffer);
    gl->BindBufferRange(GL_UNIFORM_BUFFER, 0, o.buffer, 256, 512);
    gl->BindBuffer(GL_UNIFORM_BUFFER, 0);
    return o;
}

void host_odd_end(const tc_gl *gl, host_odd *o)
{
    set_switches(gl, false);
    set_units(gl, (const GLuint[3]){0}, 0);
    set_unpacking(gl, 0, 0, 4, false);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl->DepthRange(0, 1);
    gl->ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    gl->DepthFunc(GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->CullFace(GL_BACK);
    gl->FrontFace(GL_CCW);
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    gl->ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    for (GLuint i = 0; i < BUFFERS; i++)
        gl->ColorMaski(i, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->BindVertexArray(0);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, 0);
    gl->DeleteTextures(3, o->texture);
    gl->DeleteSamplers(1, &o->sampler);
    gl->DeleteBuffers(1, &o->buffer);
    gl->DeleteVertexArrays(1, &o->vertex_array);
    gl->DeleteFramebuffers(1, &o->framebuffer);
    gl->DeleteProgram(o->program);
}

/* ---- Asking ------------------------------------------------------------------------------------------------------ */

static void note(host_state *s, const char *name, int index, double value)
{
    assert_true(s->count < HOST_STATE_VALUES);
    snprintf(s->name[s->count], sizeof s->name[0], "%s[%d]", name, index);
    s->value[s->count++] = value;
}

static void note_indexed(const tc_gl *gl, host_state *s)
{
    for (GLuint i = 0; i < BUFFERS; i++) {
        GLboolean mask[4];
        GLint buffer;
        GLint64 range[2];
        GLfloat viewport[4];
        GLdouble depth[2];
        gl->GetBooleani_v(GL_COLOR_WRITEMASK, i, mask);
        gl->GetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, i, &buffer);
        gl->GetInteger64i_v(GL_UNIFORM_BUFFER_START, i, &range[0]);
        gl->GetInteger64i_v(GL_UNIFORM_BUFFER_SIZE, i, &range[1]);
        gl->GetFloati_v(GL_VIEWPORT, i, viewport);
        gl->GetDoublei_v(GL_DEPTH_RANGE, i, depth);
        note(s, "BLEND", (int)i, gl->IsEnabledi(GL_BLEND, i));
        note(s, "SCISSOR_TEST", (int)i, gl->IsEnabledi(GL_SCISSOR_TEST, i));
        note(s, "uniform buffer", (int)i, buffer);
        for (int k = 0; k < 4; k++) {
            note(s, "colour mask", (int)i, mask[k]);
            note(s, "viewport", (int)i, viewport[k]);
        }
        for (int k = 0; k < 2; k++) {
            note(s, "uniform range", (int)i, (double)range[k]);
            note(s, "depth range", (int)i, depth[k]);
        }
    }
}

host_state host_state_now(const tc_gl *gl)
{
    host_state s = {0};
    for (int i = 0; i < SWITCHES; i++)
        note(&s, switches[i].text, 0, gl->IsEnabled(switches[i].name));
    for (int i = 0; i < NUMBERS; i++) {
        GLint value[4] = {0};
        gl->GetIntegerv(numbers[i].name, value);
        for (int k = 0; k < numbers[i].count; k++)
            note(&s, numbers[i].text, k, value[k]);
    }
    note_indexed(gl, &s);
    GLint active;
    gl->GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (GLuint i = 0; i < UNITS; i++) {
        gl->ActiveTexture(GL_TEXTURE0 + i);
        for (size_t k = 0; k < sizeof bindings / sizeof *bindings; k++) {
            GLint value;
            gl->GetIntegerv(bindings[k], &value);
            note(&s, "unit", (int)i, value);
        }
    }
    gl->ActiveTexture((GLenum)active);
    return s;
}

void host_state_assert_same(const host_state *before, const host_state *after)
{
    assert_int_equal(before->count, after->count);
    for (int i = 0; i < before->count; i++)
        if (before->value[i] != after->value[i])
            fail_msg("%s was %g and is %g", before->name[i], before->value[i], after->value[i]);
}

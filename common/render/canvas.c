/* canvas.c - a framebuffer and its resolving. */
#include "canvas.h"

#include "common/base/status.h"
#include "common/gl/program.h"

int tc_canvas_samples(const tc_gl *gl, int samples)
{
    GLint most = 1;
    gl->GetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &most);
    return samples < 1 ? 1 : samples > most ? (most < 1 ? 1 : most) : samples;
}

/* What depends on the size. What resolves stays. */
static void delete_attachments(const tc_gl *gl, tc_canvas *c)
{
    gl->DeleteFramebuffers(1, &c->framebuffer);
    if (c->samples > 1) {
        gl->DeleteFramebuffers(1, &c->picture);
        gl->DeleteTextures(2, (GLuint[]){c->colour, c->depth});
        gl->DeleteRenderbuffers(1, &c->resolved);
    } else {
        gl->DeleteRenderbuffers(2, (GLuint[]){c->colour, c->depth});
    }
    *c = (tc_canvas){.program = c->program, .vertices = c->vertices};
}

void tc_canvas_destroy(const tc_gl *gl, tc_canvas *c)
{
    delete_attachments(gl, c);
    gl->DeleteProgram(c->program);
    gl->DeleteVertexArrays(1, &c->vertices);
    *c = (tc_canvas){0};
}

static GLuint renderbuffer(const tc_gl *gl, GLenum format, int width, int height)
{
    GLuint b;
    gl->CreateRenderbuffers(1, &b);
    gl->NamedRenderbufferStorageMultisample(b, 0, format, width, height);
    return b;
}

static GLuint sampled_texture(const tc_gl *gl, GLenum format, const tc_canvas *c)
{
    GLuint t;
    gl->CreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &t);
    gl->TextureStorage2DMultisample(t, c->samples, format, c->width, c->height, GL_TRUE);
    return t;
}

static void make_plain(const tc_gl *gl, tc_canvas *c)
{
    c->colour = renderbuffer(gl, GL_RGBA8, c->width, c->height);
    c->depth = renderbuffer(gl, GL_DEPTH_COMPONENT32F, c->width, c->height);
    gl->NamedFramebufferRenderbuffer(c->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, c->colour);
    gl->NamedFramebufferRenderbuffer(c->framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, c->depth);
    c->picture = c->framebuffer;
}

static tc_status make_sampled(const tc_gl *gl, tc_canvas *c, tc_error *error)
{
    c->colour = sampled_texture(gl, GL_RGBA8, c);
    c->depth = sampled_texture(gl, GL_DEPTH_COMPONENT32F, c);
    gl->NamedFramebufferTexture(c->framebuffer, GL_COLOR_ATTACHMENT0, c->colour, 0);
    gl->NamedFramebufferTexture(c->framebuffer, GL_DEPTH_ATTACHMENT, c->depth, 0);
    c->resolved = renderbuffer(gl, GL_RGBA8, c->width, c->height);
    gl->CreateFramebuffers(1, &c->picture);
    gl->NamedFramebufferRenderbuffer(c->picture, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, c->resolved);
    if (c->program)
        return TC_OK;
    gl->CreateVertexArrays(1, &c->vertices);
    static const char *const vertex[] = {"canvas.vert", NULL}, *const fragment[] = {"canvas.frag", NULL};
    return tc_program_build(gl, vertex, fragment, NULL, "", &c->program, error);
}

tc_status tc_canvas_resize(const tc_gl *gl, tc_canvas *canvas, int width, int height, int samples, tc_error *error)
{
    samples = tc_canvas_samples(gl, samples);
    if (width == canvas->width && height == canvas->height && samples == canvas->samples)
        return TC_OK;
    delete_attachments(gl, canvas);
    tc_canvas c = *canvas;
    c.width = width, c.height = height, c.samples = samples;
    *canvas = (tc_canvas){0};
    tc_gl_forget_errors(gl); /* what went wrong before is none of ours */
    gl->CreateFramebuffers(1, &c.framebuffer);
    tc_status status = TC_OK;
    if (samples > 1)
        status = make_sampled(gl, &c, error);
    else
        make_plain(gl, &c);
    GLenum wrong = gl->GetError();
    if (status == TC_OK && wrong == GL_OUT_OF_MEMORY)
        status = tc_fail(error, TC_ERR_MEMORY, "frame: the driver has no memory for %dx%d pixels", width, height);
    if (status == TC_OK && (wrong != GL_NO_ERROR ||
                            gl->CheckNamedFramebufferStatus(c.framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
                            gl->CheckNamedFramebufferStatus(c.picture, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE))
        status = tc_fail(error, TC_ERR_CONTEXT, "frame: the driver cannot draw %dx%d pixels", width, height);
    if (status == TC_OK)
        *canvas = c;
    else
        tc_canvas_destroy(gl, &c);
    return status;
}

void tc_canvas_resolve(const tc_gl *gl, const tc_canvas *c)
{
    if (c->samples == 1)
        return;
    gl->BindFramebuffer(GL_FRAMEBUFFER, c->picture);
    gl->Viewport(0, 0, c->width, c->height);
    gl->Disable(GL_DEPTH_TEST);
    gl->BindTextureUnit(0, c->colour);
    gl->BindVertexArray(c->vertices);
    gl->UseProgram(c->program);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

/* Turns rows that OpenGL gives bottom to top. */
static void flip_rows(void *pixels, size_t row_bytes, int rows)
{
    char *lo = pixels, *hi = lo + row_bytes * (size_t)(rows > 0 ? rows - 1 : 0);
    for (; lo < hi; lo += row_bytes, hi -= row_bytes)
        for (size_t i = 0; i < row_bytes; i++) {
            char c = lo[i];
            lo[i] = hi[i];
            hi[i] = c;
        }
}

void tc_canvas_read(const tc_gl *gl, const tc_canvas *c, uint8_t *rgb, float *depth)
{
    int w = c->width, h = c->height;
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, c->picture);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
    if (rgb) {
        gl->ReadPixels(0, 0, w, h, GL_RGB, GL_UNSIGNED_BYTE, rgb);
        flip_rows(rgb, 3 * (size_t)w, h);
    }
    if (depth) {
        gl->ReadPixels(0, 0, w, h, GL_DEPTH_COMPONENT, GL_FLOAT, depth);
        flip_rows(depth, sizeof *depth * (size_t)w, h);
    }
}

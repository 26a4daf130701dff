/* target.c - conventions of depth, and targets held against what they say. */
#include "target.h"

#include "common/base/status.h"

const tc_depth_convention *tc_depth_convention_of(tc_depth depth)
{
    static const tc_depth_convention conventions[TC_DEPTHS] = {
        [TC_DEPTH_REVERSED] = {"reversed", GL_ZERO_TO_ONE, GL_GREATER, GL_GEQUAL, 0, 0},
        [TC_DEPTH_CONVENTIONAL] = {"conventional", GL_NEGATIVE_ONE_TO_ONE, GL_LESS, GL_LEQUAL, 1, 1},
        [TC_DEPTH_ZERO_TO_ONE] = {"zero to one", GL_ZERO_TO_ONE, GL_LESS, GL_LEQUAL, 1, 1}};
    return &conventions[depth];
}

/* ---- Checks ------------------------------------------------------------------------------------------------------ */

static GLint attachment(const tc_gl *gl, const tc_target_place *place, GLenum which, GLenum what)
{
    GLint value = 0;
    gl->GetNamedFramebufferAttachmentParameteriv(place->framebuffer, which, what, &value);
    return value;
}

/* Whether the rectangle lies within what is attached, where that can be told. */
static tc_status check_size(const tc_gl *gl, const tc_target_place *p, GLenum which, tc_error *error)
{
    GLint width = 0, height = 0;
    GLuint object = (GLuint)attachment(gl, p, which, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME);
    if (attachment(gl, p, which, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_RENDERBUFFER) {
        gl->GetNamedRenderbufferParameteriv(object, GL_RENDERBUFFER_WIDTH, &width);
        gl->GetNamedRenderbufferParameteriv(object, GL_RENDERBUFFER_HEIGHT, &height);
    } else {
        GLint level = attachment(gl, p, which, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL);
        gl->GetTextureLevelParameteriv(object, level, GL_TEXTURE_WIDTH, &width);
        gl->GetTextureLevelParameteriv(object, level, GL_TEXTURE_HEIGHT, &height);
    }
    if (p->x < 0 || p->y < 0 || p->width > width - p->x || p->height > height - p->y)
        return tc_fail(error, TC_ERR_USAGE,
                       "target: expected a rectangle within %d x %d pixels, found %d x %d from (%d, %d)", width, height,
                       p->width, p->height, p->x, p->y);
    return TC_OK;
}

static tc_status check_attachments(const tc_gl *gl, const tc_target_place *p, tc_error *error)
{
    bool window = p->framebuffer == 0;
    GLenum colour = window ? GL_BACK_LEFT : GL_COLOR_ATTACHMENT0, depth = window ? GL_DEPTH : GL_DEPTH_ATTACHMENT;
    if (!window && attachment(gl, p, colour, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE)
        return tc_fail(error, TC_ERR_USAGE, "target: expected a first colour attachment, found none");
    if (attachment(gl, p, depth, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE)
        return tc_fail(error, TC_ERR_USAGE, "target: expected a depth attachment, found none");
    bool srgb = attachment(gl, p, colour, GL_FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING) == GL_SRGB;
    bool floats = attachment(gl, p, colour, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_FLOAT;
    /* A window of sRGB may be written as it is, without conversion. */
    if (p->encoding == TC_ENCODING_SRGB ? !srgb : p->encoding == TC_ENCODING_LINEAR ? !floats : srgb && !window)
        return tc_fail(error, TC_ERR_USAGE, "target: expected colours %s, found another format",
                       p->encoding == TC_ENCODING_SRGB     ? "of an sRGB format"
                       : p->encoding == TC_ENCODING_LINEAR ? "of a float format"
                                                           : "of a format without conversion");
    tc_status status = window ? TC_OK : check_size(gl, p, colour, error);
    return status || window ? status : check_size(gl, p, depth, error);
}

tc_status tc_target_check(const tc_gl *gl, const tc_target_place *p, tc_error *error)
{
    GLint samples = 0;
    if (p->width < 1 || p->height < 1)
        return tc_fail(error, TC_ERR_USAGE, "target: expected at least 1 x 1 pixels, found %d x %d", p->width,
                       p->height);
    if ((unsigned)p->depth >= TC_DEPTHS || (unsigned)p->encoding >= TC_ENCODINGS)
        return tc_fail(error, TC_ERR_USAGE, "target: expected a known depth and encoding, found %d and %d",
                       (int)p->depth, (int)p->encoding);
    if (p->framebuffer && !gl->IsFramebuffer(p->framebuffer))
        return tc_fail(error, TC_ERR_USAGE, "target: expected a framebuffer of this context, found %u", p->framebuffer);
    GLenum state = gl->CheckNamedFramebufferStatus(p->framebuffer, GL_FRAMEBUFFER);
    if (state != GL_FRAMEBUFFER_COMPLETE)
        return tc_fail(error, TC_ERR_USAGE, "target: expected a complete framebuffer, found status 0x%x", state);
    gl->GetNamedFramebufferParameteriv(p->framebuffer, GL_SAMPLES, &samples);
    if ((samples > 1 ? samples : 1) != (p->samples > 1 ? p->samples : 1))
        return tc_fail(error, TC_ERR_USAGE, "target: expected %d samples a pixel, found %d",
                       p->samples > 1 ? p->samples : 1, samples > 1 ? samples : 1);
    return check_attachments(gl, p, error);
}

/* draw_state.c - state as tables: what a frame sets is what is asked for before and set again after it.
 *
 * Of state that there is once for each viewport or colour buffer only the first is touched; the other buffers' colours
 * are masked. */
#include "draw_state.h"

/* What is on or off while a frame is drawn. Drawing changes the culling of faces, a target the conversion to sRGB and
 * the scissors. */
static const struct state_switch {
    GLenum name;
    bool on, indexed;
} switches[] = {
    {GL_DEPTH_TEST, true, false},
    {GL_PRIMITIVE_RESTART_FIXED_INDEX, false, false},
    {GL_MULTISAMPLE, true, false},
    {GL_DITHER, true, false},
    {GL_FRAMEBUFFER_SRGB, false, false},
    {GL_SCISSOR_TEST, false, true},
    {GL_BLEND, false, true},
    {GL_CULL_FACE, false, false},
    {GL_STENCIL_TEST, false, false},
    {GL_PRIMITIVE_RESTART, false, false},
    {GL_POLYGON_OFFSET_FILL, false, false},
    {GL_POLYGON_OFFSET_LINE, false, false},
    {GL_POLYGON_SMOOTH, false, false},
    {GL_LINE_SMOOTH, false, false},
    {GL_DEPTH_CLAMP, false, false},
    {GL_COLOR_LOGIC_OP, false, false},
    {GL_SAMPLE_ALPHA_TO_COVERAGE, false, false},
    {GL_SAMPLE_ALPHA_TO_ONE, false, false},
    {GL_SAMPLE_COVERAGE, false, false},
    {GL_SAMPLE_MASK, false, false},
    {GL_SAMPLE_SHADING, false, false},
    {GL_CLIP_DISTANCE0, false, false},
    {GL_CLIP_DISTANCE1, false, false},
    {GL_CLIP_DISTANCE2, false, false},
    {GL_CLIP_DISTANCE3, false, false},
    {GL_CLIP_DISTANCE4, false, false},
    {GL_CLIP_DISTANCE5, false, false},
    {GL_CLIP_DISTANCE6, false, false},
    {GL_CLIP_DISTANCE7, false, false},
};
enum { SWITCHES = sizeof switches / sizeof *switches };
_Static_assert((int)SWITCHES <= (int)TC_DRAW_SWITCHES, "room for all");

/* How pixels lie in memory that is uploaded from. */
static const struct unpack {
    GLenum name;
    GLint value;
} unpacks[TC_DRAW_UNPACKS] = {{GL_UNPACK_SWAP_BYTES, 0},   {GL_UNPACK_LSB_FIRST, 0},   {GL_UNPACK_ROW_LENGTH, 0},
                              {GL_UNPACK_SKIP_ROWS, 0},    {GL_UNPACK_SKIP_PIXELS, 0}, {GL_UNPACK_ALIGNMENT, 1},
                              {GL_UNPACK_IMAGE_HEIGHT, 0}, {GL_UNPACK_SKIP_IMAGES, 0}};

/* What the units hold (renderer.c). */
static const struct unit {
    GLenum target, binding;
} units[TC_DRAW_UNITS] = {{GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
                          {GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D},
                          {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
                          {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
                          {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY}};

static void turn(const tc_gl *gl, const struct state_switch *s, bool on)
{
    if (s->indexed)
        (on ? gl->Enablei : gl->Disablei)(s->name, 0);
    else
        (on ? gl->Enable : gl->Disable)(s->name);
}

/* ---- A host's ---------------------------------------------------------------------------------------------------- */

static void get_units(const tc_gl *gl, tc_draw_state *s)
{
    gl->GetIntegerv(GL_ACTIVE_TEXTURE, &s->active_unit);
    for (GLuint i = 0; i < TC_DRAW_UNITS; i++) {
        gl->ActiveTexture(GL_TEXTURE0 + i);
        gl->GetIntegerv(units[i].binding, &s->texture[i]);
        gl->GetIntegerv(GL_SAMPLER_BINDING, &s->sampler[i]);
    }
    gl->ActiveTexture((GLenum)s->active_unit);
}

void tc_draw_state_get(const tc_gl *gl, tc_draw_state *s)
{
    for (int i = 0; i < SWITCHES; i++)
        s->on[i] = switches[i].indexed ? gl->IsEnabledi(switches[i].name, 0) : gl->IsEnabled(switches[i].name);
    for (int i = 0; i < TC_DRAW_UNPACKS; i++)
        gl->GetIntegerv(unpacks[i].name, &s->unpack[i]);
    gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &s->framebuffer[0]);
    gl->GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &s->framebuffer[1]);
    gl->GetFloati_v(GL_VIEWPORT, 0, s->viewport);
    gl->GetIntegeri_v(GL_SCISSOR_BOX, 0, s->scissor);
    gl->GetDoublei_v(GL_DEPTH_RANGE, 0, s->depth_range);
    gl->GetIntegerv(GL_CLIP_ORIGIN, &s->clip_control[0]);
    gl->GetIntegerv(GL_CLIP_DEPTH_MODE, &s->clip_control[1]);
    gl->GetIntegerv(GL_DEPTH_FUNC, &s->depth_func);
    gl->GetIntegerv(GL_CULL_FACE_MODE, &s->cull_face);
    gl->GetIntegerv(GL_FRONT_FACE, &s->front_face);
    GLint modes[2]; /* some drivers still tell two */
    gl->GetIntegerv(GL_POLYGON_MODE, modes);
    s->polygon_mode = modes[0];
    gl->GetIntegerv(GL_PROVOKING_VERTEX, &s->provoking);
    gl->GetBooleanv(GL_DEPTH_WRITEMASK, &s->depth_mask);
    gl->GetIntegerv(GL_MAX_DRAW_BUFFERS, &s->colour_buffers);
    s->colour_buffers = s->colour_buffers < TC_DRAW_BUFFERS ? s->colour_buffers : TC_DRAW_BUFFERS;
    for (GLuint i = 0; i < (GLuint)s->colour_buffers; i++)
        gl->GetBooleani_v(GL_COLOR_WRITEMASK, i, s->colour_mask[i]);
    gl->GetIntegerv(GL_CURRENT_PROGRAM, &s->program);
    gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &s->vertex_array);
    gl->GetIntegerv(GL_DRAW_INDIRECT_BUFFER_BINDING, &s->indirect);
    gl->GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &s->unpack_buffer);
    gl->GetIntegerv(GL_UNIFORM_BUFFER_BINDING, &s->uniform_buffer);
    gl->GetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, 0, &s->uniforms);
    gl->GetInteger64i_v(GL_UNIFORM_BUFFER_START, 0, &s->uniforms_start);
    gl->GetInteger64i_v(GL_UNIFORM_BUFFER_SIZE, 0, &s->uniforms_size);
    get_units(gl, s);
}

static void give_units_back(const tc_gl *gl, const tc_draw_state *s)
{
    for (GLuint i = 0; i < TC_DRAW_UNITS; i++) {
        gl->ActiveTexture(GL_TEXTURE0 + i);
        gl->BindTexture(units[i].target, (GLuint)s->texture[i]);
        gl->BindSampler(i, (GLuint)s->sampler[i]);
    }
    gl->ActiveTexture((GLenum)s->active_unit);
}

void tc_draw_state_give_back(const tc_gl *gl, const tc_draw_state *s)
{
    for (int i = 0; i < SWITCHES; i++)
        turn(gl, &switches[i], s->on[i]);
    for (int i = 0; i < TC_DRAW_UNPACKS; i++)
        gl->PixelStorei(unpacks[i].name, s->unpack[i]);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->framebuffer[0]);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)s->framebuffer[1]);
    gl->ViewportIndexedf(0, s->viewport[0], s->viewport[1], s->viewport[2], s->viewport[3]);
    gl->ScissorIndexed(0, s->scissor[0], s->scissor[1], s->scissor[2], s->scissor[3]);
    gl->DepthRangeIndexed(0, s->depth_range[0], s->depth_range[1]);
    gl->ClipControl((GLenum)s->clip_control[0], (GLenum)s->clip_control[1]);
    gl->DepthFunc((GLenum)s->depth_func);
    gl->CullFace((GLenum)s->cull_face);
    gl->FrontFace((GLenum)s->front_face);
    gl->PolygonMode(GL_FRONT_AND_BACK, (GLenum)s->polygon_mode);
    gl->ProvokingVertex((GLenum)s->provoking);
    gl->DepthMask(s->depth_mask);
    for (GLuint i = 0; i < (GLuint)s->colour_buffers; i++)
        gl->ColorMaski(i, s->colour_mask[i][0], s->colour_mask[i][1], s->colour_mask[i][2], s->colour_mask[i][3]);
    /* One that was deleted while in use is gone with its last use. */
    gl->UseProgram(gl->IsProgram((GLuint)s->program) ? (GLuint)s->program : 0);
    gl->BindVertexArray((GLuint)s->vertex_array);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, (GLuint)s->indirect);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, (GLuint)s->unpack_buffer);
    if (s->uniforms_size > 0)
        gl->BindBufferRange(GL_UNIFORM_BUFFER, 0, (GLuint)s->uniforms, s->uniforms_start, s->uniforms_size);
    else
        gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, (GLuint)s->uniforms);
    gl->BindBuffer(GL_UNIFORM_BUFFER, (GLuint)s->uniform_buffer); /* which binding the first one has set, too */
    give_units_back(gl, s);
}

/* ---- A frame's --------------------------------------------------------------------------------------------------- */

void tc_draw_state_for_uploads(const tc_gl *gl)
{
    for (int i = 0; i < TC_DRAW_UNPACKS; i++)
        gl->PixelStorei(unpacks[i].name, unpacks[i].value);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void tc_draw_state_for_frame(const tc_gl *gl, const tc_target_place *place, bool whole, bool mirrored)
{
    const tc_depth_convention *depth = tc_depth_convention_of(place->depth);
    GLint buffers;
    gl->GetIntegerv(GL_MAX_DRAW_BUFFERS, &buffers);
    for (int i = 0; i < SWITCHES; i++)
        turn(gl, &switches[i], switches[i].on);
    if (place->encoding == TC_ENCODING_SRGB)
        gl->Enable(GL_FRAMEBUFFER_SRGB);
    if (!whole) /* what is cleared, and wide lines */
        gl->Enablei(GL_SCISSOR_TEST, 0);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, place->framebuffer);
    gl->ViewportIndexedf(0, (float)place->x, (float)place->y, (float)place->width, (float)place->height);
    gl->ScissorIndexed(0, place->x, place->y, place->width, place->height);
    gl->DepthRangeIndexed(0, 0, 1);
    gl->ClipControl(GL_LOWER_LEFT, depth->clip);
    gl->DepthFunc(depth->nearer);
    gl->CullFace(GL_BACK);
    gl->FrontFace(mirrored ? GL_CCW : GL_CW);
    gl->ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    gl->DepthMask(GL_TRUE);
    for (GLuint i = 0; i < (GLuint)buffers && i < TC_DRAW_BUFFERS; i++)
        gl->ColorMaski(i, whole || i == 0, whole || i == 0, whole || i == 0, whole || i == 0);
    for (GLuint i = 0; i < TC_DRAW_UNITS; i++)
        gl->BindSampler(i, 0);
}

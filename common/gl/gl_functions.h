/* gl_functions.h - the OpenGL 4.5 core functions that may be called, as one X-macro: TC_GL_FUNCTIONS(X) expands
 * X(type, name) for each, where the function is gl<name>.
 *
 * All of them are part of OpenGL 4.5 core, so a context that lacks one is broken. Prefer the direct-state-access forms:
 * nothing then depends on what another part of the program has bound. To call one more, add its line here; the order
 * within a group means nothing. */
#ifndef TC_GL_FUNCTIONS_H
#define TC_GL_FUNCTIONS_H

/* clang-format off */
/* State, clearing, reading */
#define TC_GL_STATE_CLEARING_READING(X) \
    X(PFNGLGETERRORPROC, GetError) \
    X(PFNGLDEBUGMESSAGECALLBACKPROC, DebugMessageCallback) \
    X(PFNGLGETSTRINGPROC, GetString) \
    X(PFNGLGETSTRINGIPROC, GetStringi) \
    X(PFNGLGETINTEGERVPROC, GetIntegerv) \
    X(PFNGLGETINTEGERI_VPROC, GetIntegeri_v) \
    X(PFNGLGETINTEGER64I_VPROC, GetInteger64i_v) \
    X(PFNGLGETBOOLEANVPROC, GetBooleanv) \
    X(PFNGLGETBOOLEANI_VPROC, GetBooleani_v) \
    X(PFNGLGETFLOATI_VPROC, GetFloati_v) \
    X(PFNGLGETDOUBLEI_VPROC, GetDoublei_v) \
    X(PFNGLISENABLEDPROC, IsEnabled) \
    X(PFNGLISENABLEDIPROC, IsEnabledi) \
    X(PFNGLENABLEIPROC, Enablei) \
    X(PFNGLDISABLEIPROC, Disablei) \
    X(PFNGLENABLEPROC, Enable) \
    X(PFNGLDISABLEPROC, Disable) \
    X(PFNGLVIEWPORTPROC, Viewport) \
    X(PFNGLCLEARPROC, Clear) \
    X(PFNGLCLEARCOLORPROC, ClearColor) \
    X(PFNGLCLEARDEPTHPROC, ClearDepth) \
    X(PFNGLDEPTHFUNCPROC, DepthFunc) \
    X(PFNGLDEPTHMASKPROC, DepthMask) \
    X(PFNGLDEPTHRANGEPROC, DepthRange) \
    X(PFNGLDEPTHRANGEINDEXEDPROC, DepthRangeIndexed) \
    X(PFNGLVIEWPORTINDEXEDFPROC, ViewportIndexedf) \
    X(PFNGLSCISSORINDEXEDPROC, ScissorIndexed) \
    X(PFNGLCOLORMASKIPROC, ColorMaski) \
    X(PFNGLSCISSORPROC, Scissor) \
    X(PFNGLPROVOKINGVERTEXPROC, ProvokingVertex) \
    X(PFNGLCULLFACEPROC, CullFace) \
    X(PFNGLCLIPCONTROLPROC, ClipControl) \
    X(PFNGLFRONTFACEPROC, FrontFace) \
    X(PFNGLPOLYGONMODEPROC, PolygonMode) \
    X(PFNGLREADPIXELSPROC, ReadPixels) \
    X(PFNGLPIXELSTOREIPROC, PixelStorei) \
    X(PFNGLFENCESYNCPROC, FenceSync) \
    X(PFNGLCLIENTWAITSYNCPROC, ClientWaitSync) \
    X(PFNGLDELETESYNCPROC, DeleteSync) \
    X(PFNGLFINISHPROC, Finish)

/* Buffers */
#define TC_GL_BUFFERS(X) \
    X(PFNGLCREATEBUFFERSPROC, CreateBuffers) \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers) \
    X(PFNGLBINDBUFFERPROC, BindBuffer) \
    X(PFNGLBINDBUFFERBASEPROC, BindBufferBase) \
    X(PFNGLBINDBUFFERRANGEPROC, BindBufferRange) \
    X(PFNGLNAMEDBUFFERSTORAGEPROC, NamedBufferStorage) \
    X(PFNGLNAMEDBUFFERDATAPROC, NamedBufferData) \
    X(PFNGLNAMEDBUFFERSUBDATAPROC, NamedBufferSubData) \
    X(PFNGLMAPNAMEDBUFFERRANGEPROC, MapNamedBufferRange) \
    X(PFNGLGETNAMEDBUFFERSUBDATAPROC, GetNamedBufferSubData)

/* Vertex arrays */
#define TC_GL_VERTEX_ARRAYS(X) \
    X(PFNGLCREATEVERTEXARRAYSPROC, CreateVertexArrays) \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays) \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray) \
    X(PFNGLENABLEVERTEXARRAYATTRIBPROC, EnableVertexArrayAttrib) \
    X(PFNGLVERTEXARRAYVERTEXBUFFERPROC, VertexArrayVertexBuffer) \
    X(PFNGLVERTEXARRAYELEMENTBUFFERPROC, VertexArrayElementBuffer) \
    X(PFNGLVERTEXARRAYATTRIBFORMATPROC, VertexArrayAttribFormat) \
    X(PFNGLVERTEXARRAYATTRIBIFORMATPROC, VertexArrayAttribIFormat) \
    X(PFNGLVERTEXARRAYATTRIBBINDINGPROC, VertexArrayAttribBinding) \
    X(PFNGLVERTEXARRAYBINDINGDIVISORPROC, VertexArrayBindingDivisor)

/* Textures and samplers */
#define TC_GL_TEXTURES_SAMPLERS(X) \
    X(PFNGLCREATETEXTURESPROC, CreateTextures) \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures) \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture) \
    X(PFNGLBINDTEXTUREPROC, BindTexture) \
    X(PFNGLBINDTEXTUREUNITPROC, BindTextureUnit) \
    X(PFNGLBINDSAMPLERPROC, BindSampler) \
    X(PFNGLCREATESAMPLERSPROC, CreateSamplers) \
    X(PFNGLDELETESAMPLERSPROC, DeleteSamplers) \
    X(PFNGLGETTEXTUREIMAGEPROC, GetTextureImage) \
    X(PFNGLGETTEXTURELEVELPARAMETERIVPROC, GetTextureLevelParameteriv) \
    X(PFNGLTEXTURESTORAGE1DPROC, TextureStorage1D) \
    X(PFNGLTEXTURESTORAGE2DPROC, TextureStorage2D) \
    X(PFNGLTEXTURESTORAGE2DMULTISAMPLEPROC, TextureStorage2DMultisample) \
    X(PFNGLTEXTURESTORAGE3DPROC, TextureStorage3D) \
    X(PFNGLTEXTURESUBIMAGE1DPROC, TextureSubImage1D) \
    X(PFNGLTEXTURESUBIMAGE3DPROC, TextureSubImage3D) \
    X(PFNGLCOPYIMAGESUBDATAPROC, CopyImageSubData) \
    X(PFNGLGETTEXTURESUBIMAGEPROC, GetTextureSubImage) \
    X(PFNGLTEXTUREPARAMETERIPROC, TextureParameteri)

/* Framebuffers */
#define TC_GL_FRAMEBUFFERS(X) \
    X(PFNGLCREATEFRAMEBUFFERSPROC, CreateFramebuffers) \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers) \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer) \
    X(PFNGLISFRAMEBUFFERPROC, IsFramebuffer) \
    X(PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC, CheckNamedFramebufferStatus) \
    X(PFNGLGETNAMEDFRAMEBUFFERPARAMETERIVPROC, GetNamedFramebufferParameteriv) \
    X(PFNGLGETNAMEDFRAMEBUFFERATTACHMENTPARAMETERIVPROC, GetNamedFramebufferAttachmentParameteriv) \
    X(PFNGLGETNAMEDRENDERBUFFERPARAMETERIVPROC, GetNamedRenderbufferParameteriv) \
    X(PFNGLNAMEDFRAMEBUFFERDRAWBUFFERSPROC, NamedFramebufferDrawBuffers) \
    X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv) \
    X(PFNGLNAMEDFRAMEBUFFERTEXTUREPROC, NamedFramebufferTexture) \
    X(PFNGLNAMEDFRAMEBUFFERRENDERBUFFERPROC, NamedFramebufferRenderbuffer) \
    X(PFNGLCLEARNAMEDFRAMEBUFFERFVPROC, ClearNamedFramebufferfv) \
    X(PFNGLBLITNAMEDFRAMEBUFFERPROC, BlitNamedFramebuffer) \
    X(PFNGLCREATERENDERBUFFERSPROC, CreateRenderbuffers) \
    X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers) \
    X(PFNGLNAMEDRENDERBUFFERSTORAGEPROC, NamedRenderbufferStorage) \
    X(PFNGLNAMEDRENDERBUFFERSTORAGEMULTISAMPLEPROC, NamedRenderbufferStorageMultisample)

/* Programs and uniforms */
#define TC_GL_PROGRAMS_UNIFORMS(X) \
    X(PFNGLCREATESHADERPROC, CreateShader) \
    X(PFNGLDELETESHADERPROC, DeleteShader) \
    X(PFNGLSHADERSOURCEPROC, ShaderSource) \
    X(PFNGLCOMPILESHADERPROC, CompileShader) \
    X(PFNGLGETSHADERIVPROC, GetShaderiv) \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog) \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram) \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram) \
    X(PFNGLATTACHSHADERPROC, AttachShader) \
    X(PFNGLDETACHSHADERPROC, DetachShader) \
    X(PFNGLLINKPROGRAMPROC, LinkProgram) \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv) \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog) \
    X(PFNGLUSEPROGRAMPROC, UseProgram) \
    X(PFNGLISPROGRAMPROC, IsProgram) \
    X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation) \
    X(PFNGLPROGRAMUNIFORMMATRIX4FVPROC, ProgramUniformMatrix4fv)

/* Drawing */
#define TC_GL_DRAWING(X) \
    X(PFNGLDRAWARRAYSPROC, DrawArrays) \
    X(PFNGLMULTIDRAWELEMENTSINDIRECTPROC, MultiDrawElementsIndirect) \
    X(PFNGLTRANSFORMFEEDBACKVARYINGSPROC, TransformFeedbackVaryings) \
    X(PFNGLBEGINTRANSFORMFEEDBACKPROC, BeginTransformFeedback) \
    X(PFNGLENDTRANSFORMFEEDBACKPROC, EndTransformFeedback)

/* Timer queries */
#define TC_GL_QUERIES(X) \
    X(PFNGLCREATEQUERIESPROC, CreateQueries) \
    X(PFNGLDELETEQUERIESPROC, DeleteQueries) \
    X(PFNGLBEGINQUERYPROC, BeginQuery) \
    X(PFNGLENDQUERYPROC, EndQuery) \
    X(PFNGLGETQUERYIVPROC, GetQueryiv) \
    X(PFNGLGETQUERYOBJECTUI64VPROC, GetQueryObjectui64v)

#define TC_GL_FUNCTIONS(X) \
    TC_GL_STATE_CLEARING_READING(X) \
    TC_GL_BUFFERS(X) \
    TC_GL_VERTEX_ARRAYS(X) \
    TC_GL_TEXTURES_SAMPLERS(X) \
    TC_GL_FRAMEBUFFERS(X) \
    TC_GL_PROGRAMS_UNIFORMS(X) \
    TC_GL_DRAWING(X) \
    TC_GL_QUERIES(X)
/* clang-format on */

#endif

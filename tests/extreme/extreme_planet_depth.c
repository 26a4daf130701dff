/* extreme_planet_depth.c - two surfaces a hundred-thousandth of their distance apart: 0.5 m at 50 km, 50 m at 5000 km.
 *
 * First two planets, one higher than the other by that much, drawn by the renderer itself: in no pixel may the farther
 * one's depth be as near as the nearer one's. Then sheets of the two in one frame of its format and projection, the
 * farther drawn last and winning a draw; and the same sheets with a depth buffer as others have it, of which the same
 * count of pixels must tell that it fails. */
#include "tests/support/extreme.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/view/camera.h"
#include "common/measure/view_error.h"
#include "common/gl/program.h"
#include "tests/support/globe_scene.h"
#include "tests/support/planet_scene.h"

static const double RADIUS = 6371000;
enum { SIZE = 240, SIDE = 64 };

static const struct {
    double distance, apart;
} cases[] = {{50, 0.0005}, {5e3, 0.05}, {5e4, 0.5}, {5e5, 5}, {5e6, 50}};
enum { CASES = sizeof cases / sizeof *cases };

static tc_context *context;

/* ---- Two planets ------------------------------------------------------------------------------------------------- */

static double level(void *height, const double p[3])
{
    (void)p;
    return *(double *)height;
}

static float *depth_of(double height, const tc_camera *camera, double *near_ret)
{
    tc_map *atlas = planet_atlas(256, RADIUS, level, &height);
    globe_scene globe = globe_scene_create(context, atlas, &(tc_rings_options){.n_phi = 512});
    scene s = {.surface = globe.surface, .renderer = globe.renderer};
    globe_scene_frame(&globe, camera, true);
    float *depth = planet_depth(&s, camera);
    *near_ret = globe.surface->near_plane;
    globe_scene_destroy(&globe);
    tc_map_destroy(atlas);
    return depth;
}

/* Down, and down at a slant: the lower planet's pixels that are not behind the higher one's. */
static void planets(double distance, double apart, double pitch)
{
    tc_camera c = {.x = 0.4, .y = 0.3, .z = distance + apart, .heading = 1, .pitch = pitch, .fov = 0.5};
    c.width = c.height = SIZE;
    double near_plane;
    float *high = depth_of(apart, &c, &near_plane), *low = depth_of(0, &c, &near_plane);
    int64_t both = 0, lost = 0, not_apart = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        both += high[i] > 0 && low[i] > 0;
        lost += high[i] > 0 && low[i] > 0 && low[i] >= high[i]; /* reversed: nearer is more */
        double gap = near_plane / (double)low[i] - near_plane / (double)high[i];
        not_apart += high[i] > 0 && low[i] > 0 && !(gap > 0.5 * apart);
    }
    char name[100];
    snprintf(name, sizeof name, "planets %g m apart, %g km off, %s", apart, distance / 1000,
             pitch < -1.5 ? "straight down" : "at a slant");
    extreme_at_most(name, "pixels where the farther wins", both > SIZE * SIZE / 2 ? (double)lost : NAN, 0,
                    "%lld pixels; in %lld less than half as far apart", (long long)both, (long long)not_apart);
    free(high), free(low);
}

/* ---- Two sheets in one frame ------------------------------------------------------------------------------------ */

typedef enum buffer { REVERSED_FLOAT, CONVENTIONAL_24 } buffer;

static const char vertex_shader[] = "#version 450 core\n"
                                    "layout(location = 0) in vec4 position;\n"
                                    "layout(location = 0) uniform mat4 projection;\n"
                                    "flat out float far_one;\n"
                                    "void main()\n"
                                    "{\n"
                                    "    far_one = position.w;\n"
                                    "    gl_Position = projection * vec4(position.xyz, 1.0);\n"
                                    "}\n";
static const char fragment_shader[] = "#version 450 core\n"
                                      "flat in float far_one;\n"
                                      "out vec4 colour;\n"
                                      "void main() { colour = vec4(far_one, 1.0 - far_one, 0.0, 1.0); }\n";

static GLuint compiled(const tc_gl *gl)
{
    const char *const text[2] = {vertex_shader, fragment_shader};
    const GLenum stage[2] = {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER};
    GLuint program = gl->CreateProgram();
    GLint done = GL_FALSE;
    for (int k = 0; k < 2; k++) {
        GLuint shader = gl->CreateShader(stage[k]);
        gl->ShaderSource(shader, 1, &text[k], NULL);
        gl->CompileShader(shader);
        gl->AttachShader(program, shader);
        gl->DeleteShader(shader);
    }
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &done);
    if (!done)
        fprintf(stderr, "depth: a program that does not link\n"), exit(99);
    return program;
}

/* Where the ray through a place of the frame meets the sphere of that height: relative to the eye, as a vertex shader
 * has it. */
static void meet(const tc_camera *c, double u, double v, double height, float far_one, float out[4])
{
    double d[3], eye = RADIUS + c->z, down;
    tc_view_ray(c, u * c->width, v * c->height, d);
    down = -eye * d[2];
    double t = down - sqrt(fmax(down * down - (eye * eye - (RADIUS + height) * (RADIUS + height)), 0));
    for (int i = 0; i < 3; i++)
        out[i] = (float)(t * d[i]);
    out[3] = far_one;
}

/* A sheet that fills the frame and more, of SIDE x SIDE cells: the same for both, since chords of cells
 * lie as far below a sphere as the two are apart. */
static int sheet(const tc_camera *c, double height, float far_one, float (*v)[4])
{
    static const int corner[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    int count = 0;
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++)
            for (int k = 0; k < 6; k++) {
                double u = (double)(i + corner[k][0]) / SIDE, w = (double)(j + corner[k][1]) / SIDE;
                meet(c, 1.2 * u - 0.1, 1.2 * w - 0.1, height, far_one, v[count++]);
            }
    return count;
}

/* A conventional projection: depth from 0 at a near plane of 1 m, which is generous, to 1 at 1e8 m. */
static void conventional(const tc_camera *c, float m[16])
{
    const double near = 1, far = 1e8;
    tc_camera_matrix(c, near, m);
    for (int i = 0; i < 3; i++)
        m[4 * i + 2] = (float)(far / (far - near) * (double)m[4 * i + 3]);
    m[14] = (float)(-far * near / (far - near));
}

static int64_t far_pixels(const tc_gl *gl, GLuint framebuffer)
{
    static uint8_t rgb[SIZE * SIZE][4];
    int64_t count = 0, blank = 0;
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    gl->ReadPixels(0, 0, SIZE, SIZE, GL_RGBA, GL_UNSIGNED_BYTE, rgb);
    for (int i = 0; i < SIZE * SIZE; i++)
        count += rgb[i][0] > 128, blank += rgb[i][0] + rgb[i][1] < 128;
    return blank ? -1 : count;
}

/* Draws the nearer sheet, then the farther one, which wins where depths are equal; pixels of the latter, -1 where some
 * show neither. */
static int64_t drawn(const tc_camera *c, const float (*v)[4], const int count[2], buffer kind)
{
    const tc_gl *gl = tc_context_gl(context);
    GLuint framebuffer, render[2], array, vertices, program = compiled(gl);
    float m[16];
    gl->CreateRenderbuffers(2, render);
    gl->NamedRenderbufferStorage(render[0], GL_RGBA8, SIZE, SIZE);
    gl->NamedRenderbufferStorage(render[1], kind == REVERSED_FLOAT ? GL_DEPTH_COMPONENT32F : GL_DEPTH_COMPONENT24, SIZE,
                                 SIZE);
    gl->CreateFramebuffers(1, &framebuffer);
    gl->NamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, render[0]);
    gl->NamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, render[1]);
    gl->CreateBuffers(1, &vertices);
    gl->NamedBufferStorage(vertices, (GLsizeiptr)((size_t)(count[0] + count[1]) * sizeof *v), v, 0);
    gl->CreateVertexArrays(1, &array);
    gl->VertexArrayVertexBuffer(array, 0, vertices, 0, sizeof *v);
    gl->EnableVertexArrayAttrib(array, 0);
    gl->VertexArrayAttribFormat(array, 0, 4, GL_FLOAT, GL_FALSE, 0);
    gl->VertexArrayAttribBinding(array, 0, 0);
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl->Viewport(0, 0, SIZE, SIZE);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->ClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, (float[]){0, 0, 0, 0});
    gl->ClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, (float[]){kind == REVERSED_FLOAT ? 0 : 1});
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(kind == REVERSED_FLOAT ? GL_GEQUAL : GL_LEQUAL);
    gl->BindVertexArray(array);
    gl->UseProgram(program);
    if (kind == REVERSED_FLOAT)
        tc_camera_matrix(c, 1e-4, m); /* as rings.c has it */
    else
        conventional(c, m);
    gl->ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, m);
    gl->DrawArrays(GL_TRIANGLES, 0, count[0]);
    gl->DrawArrays(GL_TRIANGLES, count[0], count[1]);
    int64_t far_count = far_pixels(gl, framebuffer);
    gl->DeleteFramebuffers(1, &framebuffer);
    gl->DeleteRenderbuffers(2, render);
    gl->DeleteVertexArrays(1, &array);
    gl->DeleteBuffers(1, &vertices);
    gl->DeleteProgram(program);
    return far_count;
}

static void sheets(double distance, double apart)
{
    tc_camera c = {.z = distance + apart, .heading = 1, .pitch = -M_PI / 2, .fov = 0.5, .width = SIZE, .height = SIZE};
    float(*v)[4] = malloc(2 * 6 * SIDE * SIDE * sizeof *v);
    if (!v)
        exit(99);
    int count[2];
    count[0] = sheet(&c, apart, 0, v);
    count[1] = sheet(&c, 0, 1, v + count[0]);
    int64_t ours = drawn(&c, v, count, REVERSED_FLOAT), theirs = drawn(&c, v, count, CONVENTIONAL_24);
    free(v);
    char name[100];
    snprintf(name, sizeof name, "sheets %g m apart, %g km off", apart, distance / 1000);
    extreme_at_most(name, "pixels where the farther wins", ours < 0 ? NAN : (double)ours, 0,
                    "of %d; reversed 32-bit floats", SIZE * SIZE);
    if (distance < 5e4) /* where such a buffer is still good */
        return;
    snprintf(name, sizeof name, "sheets %g m apart, %g km off, conventional depth", apart, distance / 1000);
    extreme_at_most(name, "not found to fail", theirs < SIZE * SIZE / 100, 0,
                    "24 bits, from 1 m on: the farther wins in %lld of %d pixels", (long long)theirs, SIZE * SIZE);
}

int main(void)
{
    extreme_begin("planet_depth");
    context = scene_context();
    if (!context) {
        extreme_skipped("all of it", "no OpenGL context");
        return extreme_end();
    }
    for (int k = 0; k < CASES; k++) {
        planets(cases[k].distance, cases[k].apart, -M_PI / 2);
        if (cases[k].distance < 1e6)
            planets(cases[k].distance, cases[k].apart, -1.1);
    }
    for (int k = 0; k < CASES; k++)
        sheets(cases[k].distance, cases[k].apart);
    tc_context_destroy(context);
    return extreme_end();
}

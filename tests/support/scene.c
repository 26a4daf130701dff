/* scene.c - a planar scene over a pyramid, for picture tests. */
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "planar/square.h"

/* Says, once, what draws: the report takes the line for its sections. */
static tc_context *announced(tc_context *context)
{
    static bool said;
    if (!said)
        printf("OpenGL: %s, %s\n", tc_context_backend(context),
               (const char *)tc_context_gl(context)->GetString(GL_RENDERER));
    said = true;
    return context;
}

tc_context *scene_context(void)
{
    static const struct {
        const char *name; /* as the viewers' --backend */
        tc_backend backend;
    } of[] = {{"osmesa", TC_BACKEND_OSMESA}, {"egl", TC_BACKEND_EGL}, {"auto", TC_BACKEND_AUTO}};
    const char *asked = getenv("TERRACLIP_BACKEND");
    tc_context *context;
    tc_error error = {.text = "TERRACLIP_BACKEND: expected auto, egl or osmesa"};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const bool wanted = asked && *asked ? strcmp(asked, of[k].name) == 0 : of[k].backend != TC_BACKEND_EGL;
        if (wanted && tc_context_create(of[k].backend, &context, &error) == TC_OK)
            return announced(context);
    }
    printf("no OpenGL context: %s\n", error.text);
    return NULL;
}

tc_context *scene_context_fastest(void)
{
    tc_context *context;
    tc_error error;
    if (tc_context_create(TC_BACKEND_EGL, &context, &error) == TC_OK) {
        if (strcmp(tc_context_backend(context), "egl-device") == 0) /* which none that draws in software gets to be */
            return announced(context);
        tc_context_destroy(context);
    }
    return scene_context();
}

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "scene: %s\n", error->text);
        exit(99);
    }
}

scene scene_create(const tc_context *context, const tc_field *field, int n, const tc_scene_options *options)
{
    scene s = {.field = field};
    tc_error error;
    const tc_scene_needs needs = tc_scene_needs_of(options, tc_field_info(field));
    tc_ground_options clip = {
        .n = n, .normals = needs.normals, .fine_normals = needs.fine_normals, .holes = needs.holes};
    tc_square_blocks blocks = {.shaded_n = n && n < 255 ? n : 255};
    if (options->frame.error > 0) /* of the size that a frame of the papers would have */
        tc_square_n_for(field, options->frame.error, &(tc_camera){.fov = M_PI / 2, .width = 640}, &blocks.side);
    must(tc_square_create(field, &clip, options->frame.error > 0 ? &blocks : NULL, &s.surface, &error), &error);
    must(tc_renderer_create(tc_context_gl(context), s.surface, options, &s.renderer, &error), &error);
    s.clipmap = tc_renderer_used(s.renderer).windows->clipmap[0];
    return s;
}

void scene_destroy(scene *s)
{
    tc_renderer_destroy(s->renderer);
    if (s->surface)
        s->surface->destroy(s->surface);
    free(s->view);
}

const tc_view *scene_look(scene *s, const tc_camera *camera, const tc_frame_options *options)
{
    const tc_windows *windows = tc_renderer_used(s->renderer).windows;
    if (!s->view && !(s->view = tc_view_allocate(s->surface)))
        exit(99);
    s->surface->look(s->surface, windows, camera, options ? options : &(tc_frame_options){0}, true, s->view);
    return s->view;
}

bool scene_height(scene *s, const tc_camera *camera, const tc_frame_options *options, double x, double y, double *z_ret)
{
    return s->surface->height(scene_look(s, camera, options), x, y, z_ret);
}

tc_frame_stats scene_draw(scene *s, const tc_camera *camera, bool resident)
{
    tc_frame_stats stats;
    tc_error error;
    do
        must(tc_renderer_frame(s->renderer, camera, true, &stats, &error), &error);
    while (resident && !stats.resident);
    return stats;
}

static void (*own_draws)(const tc_view *, const tc_layers *, tc_frame *);

static void no_draws(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    own_draws(view, layers, frame);
    frame->strip_draws = frame->list_draws = 0;
}

void scene_leave_draws_out(tc_surface *surface)
{
    own_draws = surface->draws;
    surface->draws = no_draws;
}

void scene_put_draws_back(tc_surface *surface)
{
    surface->draws = own_draws;
}

uint8_t *scene_pixels(scene *s, const tc_camera *camera)
{
    uint8_t *rgb = malloc(3 * (size_t)camera->width * (size_t)camera->height);
    if (!rgb)
        exit(99);
    tc_renderer_read(s->renderer, rgb, NULL);
    return rgb;
}

void write_ppm(const char *path, const uint8_t *rgb, int width, int height)
{
    FILE *f = fopen(path, "wb");
    if (!f)
        return;
    fprintf(f, "P6\n%d %d\n255\n", width, height);
    fwrite(rgb, 3, (size_t)width * (size_t)height, f);
    fclose(f);
}

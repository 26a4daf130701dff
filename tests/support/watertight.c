/* watertight.c - background that shows through a planar scene. */
#include "watertight.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/view/camera.h"
#include "common/measure/view_error.h"

tc_scene_options watertight_options(void)
{
    return (tc_scene_options){.unlit = true, .background_set = true, .background = {255, 0, 255}};
}

static tc_level finest_of(const tc_field *p)
{
    return tc_field_level(p, tc_field_info(p)->levels);
}

bool watertight_over(const tc_field *p, const tc_camera *c)
{
    tc_level finest = finest_of(p);
    return c->x >= 0 && c->y >= 0 && c->x <= (double)(finest.width - 1) * finest.spacing_x &&
           c->y <= (double)(finest.height - 1) * finest.spacing_y;
}

tc_camera watertight_view(test_random *r, const tc_field *p, double highest, int width, int height)
{
    tc_level finest = finest_of(p);
    const double w = (double)(finest.width - 1) * finest.spacing_x, h = (double)(finest.height - 1) * finest.spacing_y;
    const double near_x = 10 * finest.spacing_x, near_y = 10 * finest.spacing_y;
    tc_camera c = {.width = width, .height = height};
    double where = test_random_unit(r);
    if (where < 0.55) { /* anywhere over it */
        c.x = test_random_range(r, 0, w), c.y = test_random_range(r, 0, h);
    } else if (where < 0.75) { /* near a corner or an edge */
        c.x = w * (double)test_random_int(r, 0, 1) + test_random_range(r, -near_x, near_x);
        c.y = h * (double)test_random_int(r, 0, 2) / 2 + test_random_range(r, -near_y, near_y);
    } else { /* outside */
        c.x = test_random_range(r, -1, 2) * w, c.y = test_random_range(r, -1, 2) * h;
    }
    double ground;
    tc_field_height(p, c.x, c.y, &ground);
    c.z = tc_field_info(p)->z_base + ground + pow(10, test_random_range(r, 0, log10(highest)));
    c.heading = test_random_range(r, 0, 2 * M_PI);
    c.pitch = where < 0.1 ? -M_PI / 2 : test_random_range(r, -M_PI / 2, M_PI / 6);
    c.fov = test_random_range(r, 20, 110) * M_PI / 180;
    return c;
}

/* A frame that is looked at. */
typedef struct picture {
    const uint8_t *rgb;
    int width, height;
    bool *solid; /* of each pixel: terrain is drawn all around it */
    tc_rect box; /* of those */
} picture;

static bool magenta(const picture *f, int x, int y)
{
    const uint8_t *p = f->rgb + 3 * ((size_t)y * (size_t)f->width + (size_t)x);
    return p[0] == 255 && p[1] == 0 && p[2] == 255;
}

static void find_solid(picture *f)
{
    f->solid = calloc((size_t)f->width * (size_t)f->height, sizeof *f->solid);
    if (!f->solid)
        exit(99);
    f->box = (tc_rect){f->width, f->height, 0, 0};
    for (int y = 1; y < f->height - 1; y++)
        for (int x = 1; x < f->width - 1; x++) {
            bool all = true;
            for (int k = 0; k < 9 && all; k++)
                all = !magenta(f, x + k % 3 - 1, y + k / 3 - 1);
            f->solid[y * f->width + x] = all;
            if (all)
                f->box = (tc_rect){tc_min64(f->box.x0, x), tc_min64(f->box.y0, y), tc_max64(f->box.x1, x + 1),
                                   tc_max64(f->box.y1, y + 1)};
        }
}

/* Whether terrain is drawn between the pixel and the frame's edge, or the vanishing point (vx, vy, vw: homogeneous,
 * pixels) of the direction walked in. */
static bool terrain_towards(const picture *f, int x, int y, double vx, double vy, double vw)
{
    double px = x + 0.5, py = y + 0.5;
    double dx = vx - vw * px, dy = vy - vw * py, length = hypot(dx, dy), most = 2 * (f->width + f->height);
    if (length < 1e-9)
        return false;
    if (vw > 0) /* the vanishing point lies ahead: not beyond it */
        most = length / vw;
    for (double s = 1; s < most; s++) {
        int qx = (int)floor(px + s * dx / length), qy = (int)floor(py + s * dy / length);
        if (qx < 0 || qy < 0 || qx >= f->width || qy >= f->height)
            return false;
        if ((dx <= 0 && qx < f->box.x0) || (dx >= 0 && qx >= f->box.x1) || (dy <= 0 && qy < f->box.y0) ||
            (dy >= 0 && qy >= f->box.y1))
            return false; /* nothing of it lies further on */
        if (f->solid[qy * f->width + qx])
            return true;
    }
    return false;
}

/* Where along the ray from the camera the terrain's box lies, a cell and its relief larger; false: nowhere. */
static bool ray_within(const tc_field *p, const tc_camera *camera, const double d[3], double *from_ret, double *to_ret)
{
    tc_level finest = finest_of(p);
    const tc_terrain_info *info = tc_field_info(p);
    const double eye[3] = {camera->x, camera->y, camera->z}, relief = (double)info->z_max - info->z_min + 1;
    const double lo[3] = {-finest.spacing_x, -finest.spacing_y, info->z_base + info->z_min - relief};
    const double hi[3] = {(double)finest.width * finest.spacing_x, (double)finest.height * finest.spacing_y,
                          info->z_base + info->z_max + relief};
    double from = 0, to = INFINITY;
    for (int i = 0; i < 3; i++) {
        double a = (lo[i] - eye[i]) / d[i], b = (hi[i] - eye[i]) / d[i];
        if (d[i] == 0 && (eye[i] < lo[i] || eye[i] > hi[i]))
            return false;
        if (d[i] != 0)
            from = fmax(from, fmin(a, b)), to = fmin(to, fmax(a, b));
    }
    *from_ret = from, *to_ret = to;
    return from < to;
}

/* Whether the ray through the middle of pixel (x, y) goes through the drawn surface. Steps are a fraction of the way
 * from the eye, and far from a small terrain of the way across it. */
static bool ray_crosses(scene *s, const tc_camera *camera, const tc_frame_options *options, int x, int y)
{
    tc_level finest = finest_of(s->field);
    double d[3], from, to, margin = 0.25 / tc_camera_pixel_scale(camera);
    double step = fmin(finest.spacing_x, finest.spacing_y);
    tc_view_ray(camera, x + 0.5, y + 0.5, d);
    if (!ray_within(s->field, camera, d, &from, &to))
        return false;
    bool above = false, below = false;
    const tc_view *view = scene_look(s, camera, options);
    for (double t = fmax(from, fmin(0.01, 3e-4 * step)); t < to && !(above && below);
         t += fmin(1e-3 * (to - from), fmax(0.002 * t, fmin(0.1 * step, 0.1 * t)))) {
        double p[3] = {camera->x + t * d[0], camera->y + t * d[1], camera->z + t * d[2]}, z;
        if (!s->surface->height(view, p[0], p[1], &z))
            continue;
        above = above || p[2] - z > margin * t;
        below = below || z - p[2] > margin * t;
    }
    return above && below;
}

int watertight_cracks(scene *s, const uint8_t *rgb, const tc_camera *camera, const tc_frame_options *options,
                      int64_t *terrain_ret)
{
    picture f = {.rgb = rgb, .width = camera->width, .height = camera->height};
    find_solid(&f);
    bool outside = !watertight_over(s->field, camera);
    tc_basis b = tc_camera_basis(camera);
    double tx, ty;
    tc_camera_tangents(camera, &tx, &ty);
    /* Where the direction straight up vanishes, in pixels from the top left. */
    double w = b.forward[2], x = (b.right[2] / tx + w) * f.width / 2, y = (w - b.up[2] / ty) * f.height / 2;
    int cracks = 0;
    int64_t terrain = 0;
    for (int j = 0; j < f.height; j++)
        for (int i = 0; i < f.width; i++) {
            if (!magenta(&f, i, j))
                terrain++;
            else if (terrain_towards(&f, i, j, x, y, w) && (!outside || terrain_towards(&f, i, j, -x, -y, -w)) &&
                     ray_crosses(s, camera, options, i, j))
                cracks++;
        }
    if (terrain_ret)
        *terrain_ret = terrain;
    free(f.solid);
    return cracks;
}

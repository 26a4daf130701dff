/* globe_holes.c - background that shows through a planet.
 *
 * What is drawn encloses the planet's middle: a ray from outside it that anywhere is nearer to the middle than the mesh
 * can be there has passed through it. The mesh is at least as far out as the lowest height, but for the chords of its
 * triangles, whose length goes with the angle from the foot point. That finds any hole; a finer rule finds those next
 * to the horizon: sky begins above the last hit and goes on, so a magenta pixel with terrain further up is suspect, and
 * is a crack where the drawn surface, in double, says that its ray passes from clearly above to clearly below. */
#include "globe_holes.h"

#include <math.h>
#include <stdlib.h>

#include "common/measure/view_error.h"
#include "spherical/faces_internal.h"
#include "spherical/rings_internal.h"

static bool magenta(const uint8_t *rgb, const tc_camera *c, int x, int y)
{
    const uint8_t *p = rgb + 3 * (y * c->width + x);
    return p[0] == 255 && p[1] == 0 && p[2] == 255;
}

/* ---- Meshes ----------------------------------------------------------------------------------------------------- */

/* Corners of a triangle are at most this far from its middle. */
static double half_of_rings(const globe_mesh *m, double theta)
{
    return 0.5 * hypot(2 * theta * m->apart[0], m->apart[1] * fmin(theta * 1.1, 1));
}

globe_mesh globe_mesh_of_rings(const tc_surface *surface, const tc_frame_options *options)
{
    const rings_surface *s = (const rings_surface *)surface;
    double apart = options ? exp2(ceil(fmin(options->throttle, surface->most_throttle))) : 1;
    return (globe_mesh){.body = s->map->body,
                        .z_lo = s->z_lo,
                        .z_hi = s->z_hi,
                        .half = half_of_rings,
                        .apart = {apart / s->geometry.m, apart * 2 * M_PI / s->geometry.n_phi}};
}

/* Cells of a place at a distance are at most half of the level's range long that it is in. */
static double half_of_faces(const globe_mesh *m, double theta)
{
    return fmin(fmax(m->apart[0], theta * m->apart[2]), m->apart[1]);
}

globe_mesh globe_mesh_of_faces(const tc_surface *surface, const tc_camera *camera, const tc_frame_options *options,
                               bool lagging)
{
    const faces_surface *s = (const faces_surface *)surface;
    const double longest = 1.5; /* from a cell's middle to its corners, cells */
    double cell = longest * s->cell, share = 2 * cell / s->range * (options ? exp2(options->throttle) : 1);
    double most = cell * (double)(s->cells / tc_block_cells(&s->lattice, 1));
    /* Blocks are drawn by a level as long as any of it is within its range. */
    double height = FACES_HEIGHT_SHARE * fmax(camera->z - s->z_lo, 0) / s->map->body.radius;
    double least = fmin(fmax(cell, share * height), most);
    return (globe_mesh){.body = s->map->body,
                        .z_lo = s->z_lo,
                        .z_hi = s->z_hi,
                        .half = half_of_faces,
                        .apart = {lagging ? most : least, most, share}};
}

/* ---- Rays ------------------------------------------------------------------------------------------------------- */

/* A space in which an ellipsoid is a sphere, stretched along its axis, from the body's middle along the eye's axes: the
 * eye, the pole, and by how much it is longer there. */
typedef struct stretched {
    double eye[3], pole[3], longer;
} stretched;

/* The ratio is that of the semi-axes with so much added to them. */
static stretched stretch(const tc_body *body, const tc_camera *c, double more)
{
    stretched s = {.pole = {0, cos(c->y), sin(c->y)},
                   .longer = (body->radius + more) / (body->radius * (1 - body->flattening) + more) - 1};
    const double place[3] = {c->x, c->y, c->z};
    double axes[3][3], p[3], of_eye = 0;
    body->class->position(body, place, p);
    body->class->axes(body, place, axes);
    for (int i = 0; i < 3; i++) {
        s.eye[i] = axes[i][0] * p[0] + axes[i][1] * p[1] + axes[i][2] * p[2];
        of_eye += s.pole[i] * s.eye[i];
    }
    for (int i = 0; i < 3; i++)
        s.eye[i] += s.longer * of_eye * s.pole[i];
    return s;
}

static void stretch_ray(const stretched *s, const double d[3], double ray[3])
{
    double of_ray = 0, length = 0;
    for (int i = 0; i < 3; i++)
        of_ray += s->pole[i] * d[i];
    for (int i = 0; i < 3; i++) {
        ray[i] = d[i] + s->longer * of_ray * s->pole[i];
        length += ray[i] * ray[i];
    }
    for (int i = 0; i < 3; i++)
        ray[i] /= sqrt(length);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether the ray surely goes through the mesh; s: stretched by the mesh's lowest height. */
static bool ray_enters(const globe_mesh *m, const stretched *s, const double d[3])
{
    /* A body as much lower is a little smaller than what semi-axes as much shorter make. */
    const double flattening = m->body.flattening, slack = 1e-6 + flattening * fabs(m->z_lo) / m->body.radius;
    double low = m->body.radius + m->z_lo, ray[3];
    stretch_ray(s, d, ray);
    double ahead = -dot(s->eye, ray), away = sqrt(dot(s->eye, s->eye));
    if (ahead <= 0)
        return false;
    /* Where it is nearest to the middle: the angle from the foot point, and how near. */
    double theta = asin(fmin(ahead / away, 1)), nearest = sqrt(fmax(away * away - ahead * ahead, 0));
    theta /= (1 - flattening) * (1 - flattening); /* or less, by how normals turn */
    return nearest < low * cos(fmin(m->half(m, theta), M_PI / 2)) * (1 - slack);
}

/* Whether terrain is drawn all around each pixel, to be freed. */
static bool *solid_pixels(const uint8_t *rgb, const tc_camera *c)
{
    bool *solid = calloc((size_t)(c->width * c->height), sizeof *solid);
    if (!solid)
        exit(99);
    for (int y = 1; y < c->height - 1; y++)
        for (int x = 1; x < c->width - 1; x++) {
            bool all = true;
            for (int k = 0; k < 9 && all; k++)
                all = !magenta(rgb, c, x + k % 3 - 1, y + k / 3 - 1);
            solid[y * c->width + x] = all;
        }
    return solid;
}

/* Whether terrain is drawn between the pixel and where the direction straight up vanishes. */
static bool terrain_above(const bool *solid, const tc_camera *c, const tc_lens *lens, int x, int y)
{
    const tc_basis *b = &lens->basis;
    double vw = b->forward[2], vx = (b->right[2] / lens->tangent_x + vw) * c->width / 2,
           vy = (vw - b->up[2] / lens->tangent_y) * c->height / 2;
    double px = x + 0.5, py = y + 0.5, dx = vx - vw * px, dy = vy - vw * py, length = hypot(dx, dy);
    double most = vw > 0 ? length / vw : 2 * (c->width + c->height);
    if (length < 1e-9)
        return false;
    for (double s = 1; s < most; s++) {
        int qx = (int)floor(px + s * dx / length), qy = (int)floor(py + s * dy / length);
        if (qx < 0 || qy < 0 || qx >= c->width || qy >= c->height)
            return false;
        if (solid[qy * c->width + qx])
            return true;
    }
    return false;
}

/* Where the ray is within the sphere of the highest height; false where it never is ahead of the eye. */
static bool ray_within(const globe_mesh *m, const tc_camera *c, const double d[3], double *from_ret, double *to_ret)
{
    const stretched s = stretch(&m->body, c, 0);
    double ray[3], high = (m->body.radius + m->z_hi) / (1 - m->body.flattening);
    stretch_ray(&s, d, ray);
    double nearest = -dot(s.eye, ray), half = high * high - (dot(s.eye, s.eye) - nearest * nearest);
    if (half <= 0)
        return false;
    half = sqrt(half);
    *from_ret = fmax(nearest - half, 0.01), *to_ret = nearest + half;
    return *to_ret > *from_ret;
}

/* Whether the ray passes from above to below the drawn surface by more than a quarter of a pixel. From far away a
 * fraction of the way is many of a small planet's radii: a thousandth of what the ray has in front of it at most. */
static bool ray_crosses(scene *s, const globe_mesh *m, const tc_camera *c, const tc_frame_options *options,
                        const double d[3])
{
    const tc_view *view = scene_look(s, c, options);
    double margin = 0.25 / tc_camera_pixel_scale(c), from, to;
    if (!ray_within(m, c, d, &from, &to))
        return false;
    bool above = c->z > m->z_hi, below = false;
    for (double t = from; t < to && !(above && below); t += fmin(0.002 * t, 1e-3 * (to - from))) {
        double p[3], from_eye[3] = {t * d[0], t * d[1], t * d[2]}, z;
        tc_view_place(c, &m->body, from_eye, p);
        if (!s->surface->height(view, p[0], p[1], &z))
            continue;
        above = above || p[2] > z + margin * t;
        below = below || p[2] < z - margin * t;
    }
    return above && below;
}

globe_holes globe_holes_of(scene *s, const globe_mesh *mesh, const tc_camera *c, const tc_frame_options *options,
                           int64_t most_suspects)
{
    globe_holes h = {0};
    const tc_lens lens = tc_view_lens(c);
    const stretched low = stretch(&mesh->body, c, mesh->z_lo);
    uint8_t *rgb = scene_pixels(s, c);
    bool *solid = solid_pixels(rgb, c);
    for (int y = 0; y < c->height; y++)
        for (int x = 0; x < c->width; x++) {
            double d[3];
            tc_lens_ray(&lens, x + 0.5, y + 0.5, d);
            bool sure = ray_enters(mesh, &low, d), open = magenta(rgb, c, x, y);
            h.terrain += !open, h.sure += sure;
            h.holes += sure && open;
            if (open && !sure && terrain_above(solid, c, &lens, x, y)) {
                h.suspects++;
                h.cracks += h.suspects <= most_suspects && ray_crosses(s, mesh, c, options, d);
            }
        }
    free(rgb), free(solid);
    return h;
}

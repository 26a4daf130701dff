/* fidelity.c - pictures as they should be, and how near others are to them. */
#include "fidelity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "ray_cast.h"

static void *must_have(size_t bytes)
{
    void *p = calloc(1, bytes);
    if (!p) {
        fputs("fidelity: not enough memory\n", stderr);
        exit(99);
    }
    return p;
}

/* ---- The picture as it should be --------------------------------------------------------------------------------- */

/* renderer.frag and its linear texture fetch. */
void palette_colour(const tc_palette *palette, double z, double rgb[3])
{
    double h = z - palette->heights[0], at = 0.5 + fmin(fmax(h * palette->heights[2], 0.001), 0.999) * 0.5;
    if (palette->water && h <= palette->heights[3])
        at = 0.5 - fmin(fmax(-h * palette->heights[1], 0.001), 0.999) * 0.5;
    double texel = fmin(fmax(at * TC_RAMP_SIZE - 0.5, 0), TC_RAMP_SIZE - 1);
    int i = (int)texel, j = i + 1 < TC_RAMP_SIZE ? i + 1 : i;
    for (int c = 0; c < 3; c++) {
        double squared = palette->ramp[i][c] + (texel - i) * ((double)palette->ramp[j][c] - palette->ramp[i][c]);
        rgb[c] = 255 * sqrt(squared / 255);
    }
}

struct caster {
    const measured *m;
    ray_flat *flat;
    ray_globe *globe;
    tc_palette palette;
    double z_base;
    tc_image *image; /* NULL: by height */
};

caster *caster_create(const measured *m)
{
    caster *c = must_have(sizeof *c);
    const tc_field *field = m->round ? tc_map_field(m->planet, 0) : m->field;
    c->m = m;
    c->palette = tc_palette_make(tc_field_info(field));
    c->z_base = tc_field_info(field)->z_base;
    if (m->round)
        c->globe = ray_globe_create(m->planet);
    else
        c->flat = ray_flat_create(m->field);
    return c;
}

void caster_destroy(caster *c)
{
    if (c->flat)
        ray_flat_destroy(c->flat);
    if (c->globe)
        ray_globe_destroy(c->globe);
    free(c);
}

void caster_drape(caster *c, tc_image *image)
{
    c->image = image;
}

static void colour_at(const caster *c, const double place[3], double rgb[3])
{
    if (!c->image) {
        palette_colour(&c->palette, place[2] - c->z_base, rgb);
        return;
    }
    const tc_level l = tc_field_level(c->m->field, tc_field_info(c->m->field)->levels);
    double w = (double)l.width, h = (double)l.height;
    draped_colour(c->image, (place[0] / l.spacing_x + 0.5) / w * (double)c->image->level[0].width,
                  (h - 0.5 - place[1] / l.spacing_y) / h * (double)c->image->level[0].height, false, rgb);
}

typedef struct casting {
    const caster *c;
    const tc_camera *camera;
    cast_picture *p;
} casting;

static void cast_row(void *context, int64_t y)
{
    const casting *k = context;
    const tc_camera *camera = k->camera;
    const tc_body body = measured_body(k->c->m);
    for (int x = 0; x < camera->width; x++) {
        size_t at = (size_t)y * (size_t)camera->width + (size_t)x;
        double d[3], s, place[3], rgb[3];
        tc_view_ray(camera, x + 0.5, (double)y + 0.5, d);
        if (!(k->c->flat ? ray_flat_hit(k->c->flat, camera, d, &s) : ray_globe_hit(k->c->globe, camera, d, &s)))
            continue;
        const double from_eye[3] = {s * d[0], s * d[1], s * d[2]};
        tc_view_place(camera, &body, from_eye, place);
        colour_at(k->c, place, rgb);
        k->p->distance[at] = s;
        for (int i = 0; i < 3; i++)
            k->p->rgb[3 * at + (size_t)i] = (uint8_t)lrint(rgb[i]);
    }
}

cast_picture caster_picture(const caster *c, const tc_camera *camera, const uint8_t background[3])
{
    size_t count = (size_t)camera->width * (size_t)camera->height;
    cast_picture p = {.width = camera->width, .height = camera->height};
    p.rgb = must_have(3 * count), p.distance = must_have(count * sizeof *p.distance);
    for (size_t i = 0; i < count; i++)
        memcpy(p.rgb + 3 * i, background, 3);
    casting k = {c, camera, &p};
    tc_parallel_for(0, camera->height, cast_row, &k);
    for (size_t i = 0; i < count; i++)
        p.covered += p.distance[i] > 0;
    return p;
}

void cast_picture_free(cast_picture *p)
{
    free(p->rgb), free(p->distance);
    *p = (cast_picture){0};
}

/* ---- Nearness ---------------------------------------------------------------------------------------------------- */

enum { SIDE = 11, PLANES = 5 }; /* means of a, b, a a, b b, a b */

static void weights(double w[SIDE])
{
    double sum = 0;
    for (int i = 0; i < SIDE; i++) {
        double x = i - SIDE / 2;
        sum += w[i] = exp(-x * x / (2 * 1.5 * 1.5));
    }
    for (int i = 0; i < SIDE; i++)
        w[i] /= sum;
}

static double luminance(const uint8_t *rgb)
{
    return 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
}

/* Weighted means along one row: out[plane][x] of the window that begins at x. */
static void filter_row(const uint8_t *a, const uint8_t *b, int width, const double w[SIDE], double *out)
{
    int across = width - SIDE + 1;
    for (int x = 0; x < across; x++) {
        double sum[PLANES] = {0};
        for (int i = 0; i < SIDE; i++) {
            double p = luminance(a + 3 * (x + i)), q = luminance(b + 3 * (x + i));
            sum[0] += w[i] * p, sum[1] += w[i] * q;
            sum[2] += w[i] * p * p, sum[3] += w[i] * q * q, sum[4] += w[i] * p * q;
        }
        for (int k = 0; k < PLANES; k++)
            out[k * across + x] = sum[k];
    }
}

static double ssim_of(const double mean[PLANES])
{
    const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
    double ma = mean[0], mb = mean[1], va = mean[2] - ma * ma, vb = mean[3] - mb * mb, cov = mean[4] - ma * mb;
    return (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

double picture_ssim(const uint8_t *a, const uint8_t *b, int width, int height)
{
    int across = width - SIDE + 1, down = height - SIDE + 1;
    if (across < 1 || down < 1)
        return NAN;
    double w[SIDE], sum = 0;
    weights(w);
    size_t row = (size_t)PLANES * (size_t)across;
    double *rows = must_have(row * (size_t)height * sizeof *rows);
    for (int y = 0; y < height; y++)
        filter_row(a + (size_t)y * 3 * (size_t)width, b + (size_t)y * 3 * (size_t)width, width, w,
                   rows + (size_t)y * row);
    for (int y = 0; y < down; y++)
        for (int x = 0; x < across; x++) {
            double mean[PLANES] = {0};
            for (int i = 0; i < SIDE; i++)
                for (int k = 0; k < PLANES; k++)
                    mean[k] += w[i] * rows[(size_t)(y + i) * row + (size_t)(k * across + x)];
            sum += ssim_of(mean);
        }
    free(rows);
    return sum / across / down;
}

double picture_rmse(const uint8_t *a, const uint8_t *b, int width, int height)
{
    double sum = 0;
    size_t count = 3 * (size_t)width * (size_t)height;
    for (size_t i = 0; i < count; i++)
        sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
    return sqrt(sum / (double)count);
}

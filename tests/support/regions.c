/* regions.c - the invariants of a clipmap, restated without its code. */
#include "regions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/content/colours.h"
#include "common/field/field.h"

static bool eroded_contains(tc_rect coarse, tc_rect extent, int64_t distance, tc_rect fine)
{
    if (tc_rect_empty(fine))
        return true;
    if (tc_rect_empty(coarse))
        return false;
    /* In the coarser level's samples; where the coarser region reaches the terrain's end nothing is eroded. */
    double lo_x = (double)coarse.x0 + (coarse.x0 > extent.x0 ? (double)distance : 0);
    double hi_x = (double)coarse.x1 - 1 - (coarse.x1 < extent.x1 ? (double)distance : 0);
    double lo_y = (double)coarse.y0 + (coarse.y0 > extent.y0 ? (double)distance : 0);
    double hi_y = (double)coarse.y1 - 1 - (coarse.y1 < extent.y1 ? (double)distance : 0);
    return (double)fine.x0 / 2 >= lo_x && (double)(fine.x1 - 1) / 2 <= hi_x && (double)fine.y0 / 2 >= lo_y &&
           (double)(fine.y1 - 1) / 2 <= hi_y;
}

/* Whether the map has no end in x (clipmap.h). */
static bool goes_round(const tc_clip_level *v)
{
    return v->extent.x0 < 0;
}

const char *regions_broken(const tc_clipmap *clipmap)
{
    int64_t n = tc_clipmap_n(clipmap);
    for (int l = 1; l <= tc_clipmap_levels(clipmap); l++) {
        const tc_clip_level *v = tc_clipmap_level(clipmap, l);
        if (!tc_rect_within(v->clip, v->wanted))
            return "clip region outside the window";
        if (v->clip.x1 - v->clip.x0 > n || v->clip.y1 - v->clip.y0 > n)
            return "clip region larger than n";
        if (!tc_rect_within(v->active, v->clip))
            return "constraint 2: active region outside the clip region";
        if (l == 1) {
            tc_level size = tc_field_level(tc_clipmap_field(clipmap), tc_clipmap_field_level(clipmap, 1));
            bool around = goes_round(v) && v->active.x1 - v->active.x0 > size.width && v->active.y0 == v->extent.y0 &&
                          v->active.y1 == v->extent.y1;
            if (!around && !tc_rect_equal(v->active, v->extent))
                return "the coarsest level does not cover the terrain";
            continue;
        }
        const tc_clip_level *c = tc_clipmap_level(clipmap, l - 1);
        if (!eroded_contains(c->clip, c->extent, 1, v->clip))
            return "constraint 1: clip(l+1) outside clip(l) eroded by 1";
        if (!eroded_contains(c->active, c->extent, 2, v->active))
            return "constraint 4: active(l+1) outside active(l) eroded by 2";
        if (!tc_rect_empty(v->active) &&
            ((v->active.x0 & 1) || (v->active.y0 & 1) || ((v->active.x1 - 1) & 1) || ((v->active.y1 - 1) & 1)))
            return "constraint 3: perimeter on odd samples";
    }
    return NULL;
}

/* Height of level `pl` at vertex (i, j): the sample, or on the terrain's edge the line through the last two. */
static double sample(const tc_field *p, int pl, int64_t i, int64_t j, bool straight)
{
    tc_level size = tc_field_level(p, pl);
    int m = tc_field_info(p)->levels;
    tc_level top = tc_field_level(p, m);
    double g = ldexp(1, m - pl);
    double u = straight ? (double)i : fmin((double)i, (double)(top.width - 1) / g);
    double v = straight ? (double)j : fmin((double)j, (double)(top.height - 1) / g);
    int64_t a = tc_clamp64((int64_t)floor(u), 0, tc_max64(0, size.width - 2)),
            b = tc_clamp64((int64_t)floor(v), 0, tc_max64(0, size.height - 2));
    float z[4];
    tc_rect r = {a, b, tc_min64(a + 2, size.width), tc_min64(b + 2, size.height)};
    if (tc_field_read(p, pl, r, z, NULL, 2))
        return NAN;
    if (size.width < 2)
        z[1] = z[0], z[3] = z[2];
    if (size.height < 2)
        z[2] = z[0], z[3] = z[1];
    double s = u - (double)a, t = v - (double)b;
    double south = z[0] + s * (z[1] - (double)z[0]), north = z[2] + s * (z[3] - (double)z[2]);
    return south + t * (north - south);
}

/* The coarser mesh below vertex (i, j) of level pl, straight from the geometry: the triangle that holds it. */
static double coarse_mesh(const tc_field *p, int pl, int64_t i, int64_t j)
{
    int m = tc_field_info(p)->levels;
    tc_level top = tc_field_level(p, m);
    double g = ldexp(1, m - pl), ex = (double)(top.width - 1), ey = (double)(top.height - 1);
    double x = fmin((double)i * g, ex), y = fmin((double)j * g, ey);
    int64_t a = i >> 1, b = j >> 1;
    double x0 = fmin((double)a * 2 * g, ex), x1 = fmin((double)(a + 1) * 2 * g, ex);
    double y0 = fmin((double)b * 2 * g, ey), y1 = fmin((double)(b + 1) * 2 * g, ey);
    double s = (i & 1) && x1 > x0 ? (x - x0) / (x1 - x0) : 0, t = (j & 1) && y1 > y0 ? (y - y0) / (y1 - y0) : 0;
    double z00 = sample(p, pl - 1, a, b, false), z10 = s > 0 ? sample(p, pl - 1, a + 1, b, false) : z00;
    double z01 = t > 0 ? sample(p, pl - 1, a, b + 1, false) : z00;
    if (s > 0 && t > 0 && s + t > 1) {
        double z11 = sample(p, pl - 1, a + 1, b + 1, false);
        return z11 + (1 - s) * (z01 - z11) + (1 - t) * (z10 - z11);
    }
    return z00 + s * (z10 - z00) + t * (z01 - z00);
}

static char said[200];

static const char *say(const char *what, int level, int64_t i, int64_t j, double got, double want)
{
    snprintf(said, sizeof said, "%s: level %d sample (%lld, %lld): %.9g, not %.9g", what, level, (long long)i,
             (long long)j, got, want);
    return said;
}

/* Four-point value of the finest level at half-sample (a, b), for normals below it. */
static double half_sample(const tc_field *p, int pl, int64_t a, int64_t b)
{
    if (pl < tc_field_info(p)->levels)
        return sample(p, pl + 1, a, b, true);
    static const double w[4] = {-1.0 / 16, 9.0 / 16, 9.0 / 16, -1.0 / 16};
    int64_t i = tc_floor_shift(a, 1), j = tc_floor_shift(b, 1);
    double sum = 0;
    for (int v = 0; v < 4; v++)
        for (int u = 0; u < 4; u++) {
            double wu = a & 1 ? w[u] : u == 1, wv = b & 1 ? w[v] : v == 1;
            if (wu != 0 && wv != 0)
                sum += wu * wv * sample(p, pl, i + u - 1, j + v - 1, true);
        }
    return sum;
}

static const char *normal_broken(const tc_clipmap *clipmap, int level, int64_t i, int64_t j)
{
    const tc_field *p = tc_clipmap_field(clipmap);
    const tc_clip_level *v = tc_clipmap_level(clipmap, level);
    int pl = tc_clipmap_field_level(clipmap, level);
    int64_t mask = 2 * (tc_clipmap_n(clipmap) + 1) - 1;
    for (int64_t b = 2 * j; b <= 2 * j + (j < v->clip.y1 - 1); b++)
        for (int64_t a = 2 * i; a <= 2 * i + (i < v->clip.x1 - 1); a++) {
            double dx = (half_sample(p, pl, a + 1, b) - half_sample(p, pl, a - 1, b)) / v->spacing_x;
            double dy = (half_sample(p, pl, a, b + 1) - half_sample(p, pl, a, b - 1)) / v->spacing_y;
            double scale = -127 / sqrt(1 + dx * dx + dy * dy);
            const int8_t *n = tc_ground_normals(clipmap, level)[(b & mask) * (mask + 1) + (a & mask)];
            if (fabs(n[0] - dx * scale) > 0.51 || fabs(n[1] - dy * scale) > 0.51)
                return say("normal", level, a, b, n[0], dx * scale);
            for (int k = 0; k < 2; k++) { /* the coarser level's map, between its texels */
                double sum = 0;
                for (int corner = 0; corner < 4; corner++) {
                    int64_t u = (a + (corner & 1)) >> 1 & mask, w = (b + (corner >> 1)) >> 1 & mask;
                    sum += level == 1 ? n[k] : tc_ground_normals(clipmap, level - 1)[w * (mask + 1) + u][k];
                }
                if (fabs(n[2 + k] - sum / 4) > 0.51)
                    return say("coarser normal", level, a, b, n[2 + k], sum / 4);
            }
        }
    return NULL;
}

const char *heights_broken(const tc_clipmap *clipmap)
{
    const tc_field *p = tc_clipmap_field(clipmap);
    int64_t mask = tc_clipmap_n(clipmap);
    for (int l = 1; l <= tc_clipmap_levels(clipmap); l++) {
        const tc_clip_level *v = tc_clipmap_level(clipmap, l);
        int pl = tc_clipmap_field_level(clipmap, l);
        tc_level size = tc_field_level(p, pl);
        int64_t x1 = goes_round(v) ? v->clip.x1 : tc_min64(v->clip.x1, size.width),
                y1 = tc_min64(v->clip.y1, size.height);
        enum { ROWS = 32 }; /* read at once, since some fields make many for one */
        float rows[ROWS][2048];
        for (int64_t j = v->clip.y0; j < y1; j++) {
            int64_t r = (j - v->clip.y0) % ROWS;
            if (r == 0 &&
                tc_field_read(p, pl, (tc_rect){v->clip.x0, j, x1, tc_min64(j + ROWS, y1)}, rows[0], NULL, 2048))
                return "the pyramid cannot be read";
            const float *row = rows[r], (*z)[2] = tc_ground_heights(clipmap, l) + (j & mask) * (mask + 1);
            for (int64_t i = v->clip.x0; i < x1; i++)
                if (z[i & mask][0] != row[i - v->clip.x0])
                    return say("height", l, i, j, z[i & mask][0], row[i - v->clip.x0]);
        }
    }
    return NULL;
}

const char *colours_broken(const tc_clipmap *clipmap, int level)
{
    const tc_field *p = tc_clipmap_field(clipmap);
    const tc_clip_level *v = tc_clipmap_level(clipmap, level);
    int pl = tc_clipmap_field_level(clipmap, level);
    tc_level size = tc_field_level(p, pl);
    int64_t mask = tc_clipmap_n(clipmap), y1 = tc_min64(v->clip.y1, size.height),
            x1 = goes_round(v) ? v->clip.x1 : tc_min64(v->clip.x1, size.width);
    const uint8_t(*texels)[4] = tc_clipmap_texels(clipmap, &tc_colours_content, level);
    for (int64_t j = v->clip.y0; j < y1; j++) {
        uint8_t row[2048][4];
        if (v->clip.x0 < x1 && tc_field_read_samples(p, pl, (tc_rect){v->clip.x0, j, x1, j + 1}, row, NULL, 2048))
            return "the colours cannot be read";
        for (int64_t i = v->clip.x0; i < x1; i++) {
            const uint8_t *got = texels[(j & mask) * (mask + 1) + (i & mask)], *want = row[i - v->clip.x0];
            for (int k = 0; k < 4; k++)
                if (got[k] != want[k])
                    return say("colour", level, i, j, got[k], want[k]);
        }
    }
    return NULL;
}

const char *content_broken(const tc_clipmap *clipmap, int level, int64_t first_row, int64_t step)
{
    const tc_field *p = tc_clipmap_field(clipmap);
    const tc_clip_level *v = tc_clipmap_level(clipmap, level);
    int pl = tc_clipmap_field_level(clipmap, level);
    tc_level size = tc_field_level(p, pl);
    int64_t mask = tc_clipmap_n(clipmap);
    double range = tc_field_info(p)->z_max - (double)tc_field_info(p)->z_min;
    for (int64_t j = v->clip.y0 + first_row; j < v->clip.y1; j += step)
        for (int64_t i = v->clip.x0; i < v->clip.x1; i++) {
            const float *z = tc_ground_heights(clipmap, level)[(j & mask) * (mask + 1) + (i & mask)];
            bool inside = i < size.width && j < size.height;
            double want = sample(p, pl, i, j, false);
            if (inside ? (double)z[0] != want : !(fabs(z[0] - want) <= 1e-5 * range))
                return say("height", level, i, j, z[0], want);
            want = level == 1 ? (double)z[0] : coarse_mesh(p, pl, i, j);
            bool exact = inside && (level == 1 || ((i | j) & 1) == 0);
            if (exact ? (double)z[1] != want : !(fabs(z[1] - want) <= 1e-5 * range))
                return say("morph target", level, i, j, z[1], want);
            if (tc_ground_voids(clipmap, level)) {
                float unused;
                uint8_t is_void;
                int64_t a = tc_min64(i, size.width - 1), b = tc_min64(j, size.height - 1);
                if (tc_field_read(p, pl, (tc_rect){a, b, a + 1, b + 1}, &unused, &is_void, 1) ||
                    tc_ground_voids(clipmap, level)[(j & mask) * (mask + 1) + (i & mask)] != (is_void ? 255 : 0))
                    return say("void", level, i, j, is_void, is_void);
            }
            const char *broken = tc_ground_normals(clipmap, level) ? normal_broken(clipmap, level, i, j) : NULL;
            if (broken)
                return broken;
        }
    return NULL;
}

wanderer wanderer_start(const tc_field *field, uint64_t seed)
{
    tc_level l = tc_field_level(field, tc_field_info(field)->levels);
    wanderer w = {.random = {seed},
                  .spacing = l.spacing_x,
                  .size_x = (double)(l.width - 1) * l.spacing_x,
                  .size_y = (double)(l.height - 1) * l.spacing_y};
    w.camera = (tc_camera){.x = w.size_x / 2, .y = w.size_y / 2, .z = 0, .fov = 1, .width = 64, .height = 64};
    return w;
}

void wanderer_move(wanderer *w, const tc_field *field)
{
    test_random *r = &w->random;
    double what = test_random_unit(r);
    if (what < 0.01) { /* teleport */
        w->camera.x = test_random_range(r, -0.2, 1.2) * w->size_x;
        w->camera.y = test_random_range(r, -0.2, 1.2) * w->size_y;
    } else if (what < 0.012) { /* far outside */
        w->camera.x = test_random_range(r, -1, 1) * pow(10, test_random_range(r, 3, 12));
        w->camera.y = test_random_range(r, -1, 1) * pow(10, test_random_range(r, 3, 12));
    } else if (what < 0.03) { /* another speed */
        double speed = w->spacing * pow(2, test_random_range(r, -4, 8)), heading = test_random_range(r, 0, 6.2832);
        w->vx = speed * cos(heading), w->vy = speed * sin(heading);
    } else if (what < 0.06) {
        w->vx = -w->vx, w->vy = -w->vy;
    }
    w->camera.x += w->vx, w->camera.y += w->vy;
    double limit = 3 * (w->size_x + w->size_y);
    if (what > 0.012 && (fabs(w->camera.x) > limit || fabs(w->camera.y) > limit))
        w->camera.x = w->size_x * test_random_unit(r), w->camera.y = w->size_y * test_random_unit(r);
    if (what > 0.97) { /* another height */
        double ground = 0;
        tc_field_height(field, w->camera.x, w->camera.y, &ground);
        w->camera.z = ground + w->spacing * pow(2, test_random_range(r, -3, 11));
    }
}

/* frame_uniforms.c - a frame's numbers for all stages. */
#include "frame_uniforms.h"

#include <math.h>
#include <string.h>

/* Where each layer's window lies in its textures. */
static void set_windows(tc_frame_uniforms *u, const tc_windows *windows, const tc_layers *layers)
{
    int64_t torus = 2 * (tc_clipmap_n(windows->clipmap[0]) + 1);
    int layer = 0;
    for (int chart = 0; chart < windows->charts; chart++)
        for (int l = 1; l <= layers->held[chart]; l++) {
            tc_rect c = tc_clipmap_level(windows->clipmap[chart], l)->clip;
            float window[4] = {(float)(c.x0 & (torus - 1)), (float)(c.y0 & (torus - 1)), (float)(c.x1 - 1 - c.x0),
                               (float)(c.y1 - 1 - c.y0)};
            memcpy(u->window[layer++], window, sizeof window);
        }
}

/* Tangents across a pixel, and from the side of the framebuffer's first pixel to the middle of what is seen. */
static void set_rays(tc_frame_uniforms *u, const tc_sight *s, const tc_target_place *place)
{
    double wide = 0.5 * (s->right - s->left), high = 0.5 * (s->top - s->bottom);
    double across_x = 2 * wide / place->width, across_y = 2 * high / place->height;
    double first_x = place->x * across_x - s->left, first_y = place->y * across_y - s->bottom;
    float lens[4] = {(float)across_x, (float)across_y, (float)first_x, (float)first_y};
    memcpy(u->lens, lens, sizeof lens);
    for (int i = 0; i < 3; i++) {
        const double right = s->axes.right[i], up = s->axes.up[i], forward = s->axes.forward[i];
        u->ray[0][i] = (float)(right * wide);
        u->ray[1][i] = (float)(up * high);
        u->ray[2][i] = (float)(forward + 0.5 * (s->left + s->right) * right + 0.5 * (s->bottom + s->top) * up);
        u->pixel[0][i] = (float)right;
        u->pixel[1][i] = (float)up;
        u->pixel[2][i] = (float)forward;
    }
}

/* The sun at the eye's place, and what is there without it: light enough to see the ground by, and stars. By day, where
 * it is 1, shaders find each of these as if there were none. */
static void set_sun(tc_frame_uniforms *u, const tc_surface *surface, const tc_camera *camera, const tc_sun *sun)
{
    const double place[3] = {camera->x, camera->y, camera->z};
    const double NIGHT = 0.06, BY_DAY = 0.4, AT_NIGHT = 0.06; /* light; extinction of stars by the air */
    double d[3];
    tc_sun_direction(sun, &surface->body, place, d);
    const double day = tc_sun_day(d[2]);
    tc_set4(u->sun, d[0], d[1], d[2], 1.1);
    tc_set4(u->dusk, day, NIGHT * (1 - day), tc_stars_at_dusk(day), AT_NIGHT + (BY_DAY - AT_NIGHT) * day);
}

/* On a plane all of the air is as light as at the eye; around a globe shaders know where it is day. */
static void set_sky(float sky[3], const float by_day[3], const double by_night[3], double day)
{
    for (int i = 0; i < 3; i++)
        sky[i] = (float)(by_night[i] + ((double)by_day[i] - by_night[i]) * day * day);
}

static void set_air(tc_frame_uniforms *u, const tc_surface *surface, const tc_palette *palette, double above_lowest,
                    bool inverse)
{
    static const double horizon[] = {0.0045, 0.006, 0.010}, zenith[] = {0.0010, 0.0017, 0.0036};
    const bool globe = surface->body.class && surface->body.class->solid;
    const double day = globe || !palette->air ? 1 : (double)u->dusk[0];
    double distance = 0.65 * surface->extent + 4 * fmax(0, above_lowest); /* half of what one sees there is haze */
    /* Over the nearness that shaders have at hand: near / distance, or 1 / distance. */
    double near = inverse ? surface->near_plane : 1;
    set_sky(u->haze, palette->horizon, horizon, day);
    u->haze[3] = (float)(near / distance);
    if (surface->own_haze) /* which knows how far one sees */
        u->haze[3] = (float)near;
    set_sky(u->zenith, palette->zenith, zenith, day);
}

/* Numbers of lines are told modulo that of those from one heavy line to the next, so that they keep their digits. */
static void set_contours(tc_frame_uniforms *u, double eye, double metres)
{
    enum { HEAVY = 5 };
    memset(u->contours, 0, sizeof u->contours);
    if (!(metres > 0))
        return;
    double at = fmod(eye / metres, HEAVY);
    u->contours[0] = (float)(1 / metres);
    u->contours[1] = (float)(at < 0 ? at + HEAVY : at);
    u->contours[2] = (float)metres;
}

/* Around the map, of a flat terrain: its rectangle from the eye; heights of the sea and of the walls' foot. */
static void set_around(tc_frame_uniforms *u, const tc_view *view, const tc_scene_needs *needs,
                       const tc_palette *palette, double exaggeration)
{
    const double NOWHERE = -3e38, FARTHEST = 1e6; /* of what is seen: on the horizon by less than a pixel */
    memset(u->around, 0, sizeof u->around);
    if (!needs->walls && !needs->sea && !needs->plain && !needs->climate)
        return;
    const tc_field *field = view->surface->field;
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    const tc_surroundings *a = &needs->around;
    const tc_camera *c = &view->camera;
    const double z_base = tc_field_info(field)->z_base;
    const double east = (double)(finest.width - 1) * finest.spacing_x - c->x,
                 north = (double)(finest.height - 1) * finest.spacing_y - c->y;
    /* A little below shores of just that height, which it would lie in. */
    const double below = fmin(fmax(1e-5 * view->surface->extent, 1e-3), 0.5), sea = a->level - below;
    const double foot = needs->sea ? sea - below : a->foot; /* not deep: walls pass from below the sea to above it */
    tc_set4(u->around[0], -c->x, -c->y, east, north);
    tc_set4(u->around[1], needs->sea ? sea - c->z : NOWHERE, needs->sea ? sea - z_base : NOWHERE, foot - z_base,
            a->depth);
    tc_set4(u->around[2], FARTHEST * (view->surface->extent + fabs(c->z)), 1 / view->surface->extent,
            0.1 * fmin(finest.spacing_x, finest.spacing_y) + 5e-5 * view->surface->extent, needs->sea ? below : 0);
    const double by_metre = (a->north - a->south) / fmax(north + c->y, 1e-3);
    tc_set4(u->around[4], a->south + by_metre * c->y, by_metre, ((double)palette->heights[0] + z_base) / exaggeration,
            0);
    memcpy(u->around[3], palette->wall, sizeof palette->wall);
    u->around[3][3] = (float)(1 / fmax(z_base + (double)tc_field_info(field)->z_max - foot, 1e-3));
}

/* How far above a sea that is given ground still is its surface: heights between samples do not flicker on it. A share
 * of the relief, so that small terrains have shores, too; and what floats of such a size are off. */
static double shore_of(const tc_terrain_info *info, const tc_scene_needs *needs, double exaggeration)
{
    const double relief = ((double)info->z_max - (double)info->z_min) / exaggeration;
    const double size = fabs(needs->sea_level - info->z_base) / exaggeration;
    return exaggeration * (fmin(8e-4 * relief, 0.5) + 1e-6 * size);
}

static void set_space(tc_frame_uniforms *u, const tc_body *body, const tc_camera *camera)
{
    double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (body->class)
        body->class->axes(body, (const double[3]){camera->x, camera->y, camera->z}, axes);
    for (int i = 0; i < 3; i++)
        tc_set4(u->space[i], axes[i][0], axes[i][1], axes[i][2], 0);
}

void tc_frame_uniforms_set(tc_frame_uniforms *u, const tc_view *view, const tc_palette *palette, const tc_sight *sight,
                           const tc_target_place *place, const tc_frame *frame, const tc_layers *layers,
                           const tc_scene_needs *needs, double contours, double exaggeration, const tc_sun *sun)
{
    const tc_terrain_info *info = tc_field_info(view->surface->field);
    double eye = sight->camera.z - info->z_base;
    memcpy(u->view_projection, sight->matrix, sizeof u->view_projection);
    memcpy(u->surface, frame->surface, sizeof u->surface);
    memcpy(u->body, frame->body, sizeof u->body);
    memcpy(u->layer, frame->layer, sizeof u->layer);
    memcpy(u->whole, frame->integers, sizeof u->whole);
    set_windows(u, view->windows, layers);
    u->eye[0] = (float)eye;
    u->eye[1] = (float)(eye - (double)(float)eye);
    const double told_from = fmin(eye, (double)info->z_max);
    u->eye[2] = (float)told_from;
    u->eye[3] = (float)(told_from - (double)(float)told_from);
    set_rays(u, sight, place);
    memcpy(u->heights, palette->heights, sizeof u->heights);
    const tc_sun usual = {.kind = TC_SUN_USUAL}; /* it is day in what takes no light */
    set_sun(u, view->surface, &sight->camera, needs->light ? sun : &usual);
    set_air(u, view->surface, palette, eye - info->z_min, sight->inverse);
    u->beyond[0] = tc_depth_convention_of(place->depth)->sky;
    u->beyond[1] = (float)exaggeration;
    u->beyond[2] = (float)(needs->sea_level - info->z_base);
    u->beyond[3] = (float)shore_of(info, needs, exaggeration);
    set_contours(u, sight->camera.z, contours * exaggeration);
    set_around(u, view, needs, palette, exaggeration);
    if (needs->stars)
        set_space(u, &view->surface->body, &sight->camera);
}

/* test_watertight.c - no background shows through the terrain, from any view.
 *
 * Terrain is drawn in flat colours on magenta. In a vertical plane through an eye above a height field, sky begins
 * above the last hit and goes on for good. So a magenta pixel is suspect where terrain is drawn further up on the way
 * to the zenith's vanishing point; from outside the terrain's rectangle, where one can look below its rim, only if
 * there is terrain on the way down as well. Whether a suspect is a crack, and not sky in a gap between two spires less
 * than a pixel wide, the surface itself says: the pixel's ray must pass from clearly above to clearly below the drawn
 * surface, as computed in double, by more than a quarter of a pixel. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/core/clipmap/camera.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

enum { WIDTH = 320, HEIGHT = 240, SPACING = 30, TERRAINS = 4 };

/* Sizes of 2^k + 1 end on a sample of every level; others on edges between samples. */
static const struct {
    terrain_kind kind;
    int width, height;
} made[TERRAINS] = {
    {TERRAIN_CLIFF, 1025, 1025}, {TERRAIN_SMOOTH, 1025, 700}, {TERRAIN_DEFAULT, 1000, 1000}, {TERRAIN_CLIFF, 770, 765}};

static bool magenta(const uint8_t *rgb, int x, int y)
{
    const uint8_t *p = rgb + 3 * (y * WIDTH + x);
    return p[0] == 255 && p[1] == 0 && p[2] == 255;
}

static bool solid(const uint8_t *rgb, int x, int y)
{
    if (x < 1 || y < 1 || x >= WIDTH - 1 || y >= HEIGHT - 1)
        return false;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++)
            if (magenta(rgb, x + dx, y + dy))
                return false;
    return true;
}

/* Whether terrain is drawn between the pixel and the frame's edge, or the vanishing point (vx, vy, vw: homogeneous,
 * pixels) of the direction walked in. */
static bool terrain_towards(const uint8_t *rgb, int x, int y, double vx, double vy, double vw)
{
    double px = x + 0.5, py = y + 0.5;
    double dx = vx - vw * px, dy = vy - vw * py, length = hypot(dx, dy), most = 2 * (WIDTH + HEIGHT);
    if (length < 1e-9)
        return false;
    if (vw > 0) /* the vanishing point lies ahead: not beyond it */
        most = length / vw;
    for (double s = 1; s < most; s++) {
        int qx = (int)floor(px + s * dx / length), qy = (int)floor(py + s * dy / length);
        if (qx < 0 || qy < 0 || qx >= WIDTH || qy >= HEIGHT)
            return false;
        if (solid(rgb, qx, qy))
            return true;
    }
    return false;
}

/* Whether the ray through the middle of pixel (x, y) goes through the drawn surface. */
static bool ray_crosses(scene *s, const tc_camera *camera, const tc_frame_options *options, int x, int y)
{
    tc_basis b = tc_camera_basis(camera);
    double tx, ty, d[3], length = 0, margin = 0.25 / tc_camera_pixel_scale(camera);
    tc_camera_tangents(camera, &tx, &ty);
    double u = ((x + 0.5) / WIDTH * 2 - 1) * tx, v = (1 - (y + 0.5) / HEIGHT * 2) * ty;
    for (int i = 0; i < 3; i++) {
        d[i] = b.forward[i] + u * b.right[i] + v * b.up[i];
        length += d[i] * d[i];
    }
    length = sqrt(length);
    bool above = false, below = false;
    tc_level finest = tc_pyramid_level(s->pyramid, tc_pyramid_info(s->pyramid)->levels);
    double far = 4 * SPACING * (double)(finest.width + finest.height) + fabs(camera->z) * 4;
    for (double t = 0.01; t < far && !(above && below); t += fmax(0.002 * t, fmin(0.1 * SPACING, 0.1 * t))) {
        double p[3] = {camera->x + t * d[0] / length, camera->y + t * d[1] / length, camera->z + t * d[2] / length}, z;
        if (!s->surface->drawn_height(s->surface, camera, options, p[0], p[1], &z))
            continue;
        above = above || p[2] - z > margin * t;
        below = below || z - p[2] > margin * t;
    }
    return above && below;
}

static int count_cracks(scene *s, const uint8_t *rgb, const tc_camera *camera, const tc_frame_options *options,
                        bool outside)
{
    tc_basis b = tc_camera_basis(camera);
    double tx, ty;
    tc_camera_tangents(camera, &tx, &ty);
    /* Where the direction straight up vanishes, in pixels from the top left. */
    double w = b.forward[2], x = (b.right[2] / tx + w) * WIDTH / 2, y = (w - b.up[2] / ty) * HEIGHT / 2;
    int cracks = 0;
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++)
            if (magenta(rgb, i, j) && terrain_towards(rgb, i, j, x, y, w) &&
                (!outside || terrain_towards(rgb, i, j, -x, -y, -w)) && ray_crosses(s, camera, options, i, j))
                cracks++;
    return cracks;
}

typedef struct totals {
    int views, cracks, below_surface;
    int64_t terrain_pixels;
} totals;

static tc_camera random_view(test_random *r, const tc_pyramid *p)
{
    tc_level finest = tc_pyramid_level(p, tc_pyramid_info(p)->levels);
    const double w = (double)(finest.width - 1) * SPACING, h = (double)(finest.height - 1) * SPACING;
    tc_camera c = {.width = WIDTH, .height = HEIGHT};
    double where = test_random_unit(r);
    if (where < 0.55) { /* anywhere over it */
        c.x = test_random_range(r, 0, w), c.y = test_random_range(r, 0, h);
    } else if (where < 0.75) { /* near a corner or an edge */
        c.x = w * (double)test_random_int(r, 0, 1) + test_random_range(r, -300, 300);
        c.y = h * (double)test_random_int(r, 0, 2) / 2 + test_random_range(r, -300, 300);
    } else { /* outside */
        c.x = test_random_range(r, -1, 2) * w, c.y = test_random_range(r, -1, 2) * h;
    }
    double ground;
    tc_pyramid_height(p, c.x, c.y, &ground);
    c.z = ground + pow(10, test_random_range(r, 0, log10(50e3)));
    c.heading = test_random_range(r, 0, 2 * M_PI);
    c.pitch = where < 0.1 ? -M_PI / 2 : test_random_range(r, -M_PI / 2, M_PI / 6);
    c.fov = test_random_range(r, 20, 110) * M_PI / 180;
    return c;
}

static bool over(const tc_pyramid *p, const tc_camera *c)
{
    tc_level finest = tc_pyramid_level(p, tc_pyramid_info(p)->levels);
    return c->x >= 0 && c->y >= 0 && c->x <= (double)(finest.width - 1) * SPACING &&
           c->y <= (double)(finest.height - 1) * SPACING;
}

/* What is left open, for the test to find. */
typedef enum fault { SOUND, NO_CLOSERS, NO_STITCH } fault;

static void run(const tc_context *context, const tc_pyramid *p, int n, int views, bool lagging, fault f, uint64_t seed,
                totals *t)
{
    tc_scene_options options = {.unlit = true,
                                .background_set = true,
                                .background = {255, 0, 255},
                                .frame.no_closers = f == NO_CLOSERS,
                                .frame.no_stitch = f == NO_STITCH,
                                .frame.no_morph = f == SOUND && (seed & 3) == 3};
    scene s = scene_create(context, p, n, &options);
    test_random r = {seed};
    for (int v = 0; v < views; v++) {
        tc_camera camera = random_view(&r, p);
        if (lagging) {
            options.budget = test_random_int(&r, n, (int64_t)n * n);
            tc_renderer_set_options(s.renderer, &options);
            for (int64_t frames = test_random_int(&r, 0, 3); frames > 0; frames--)
                scene_draw(&s, &camera, false);
        }
        scene_draw(&s, &camera, !lagging);
        double z;
        if (over(p, &camera) && s.surface->drawn_height(s.surface, &camera, &options.frame, camera.x, camera.y, &z) &&
            z >=
                camera.z) { /* a level that lags may stand higher than the eye: it looks up at the surface from below */
            t->below_surface++;
            continue;
        }
        uint8_t *rgb = scene_pixels(&s, &camera);
        int cracks = count_cracks(&s, rgb, &camera, &options.frame, !over(p, &camera));
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            t->terrain_pixels += !magenta(rgb, i % WIDTH, i / WIDTH);
        if (cracks && f == SOUND)
            printf("view %d: %d cracks: x %.17g y %.17g z %.17g heading %.17g pitch %.17g fov %.17g lagging %d\n", v,
                   cracks, camera.x, camera.y, camera.z, camera.heading, camera.pitch, camera.fov, lagging);
        free(rgb);
        t->views++;
        t->cracks += cracks;
    }
    scene_destroy(&s);
}

static tc_context *context;
static tc_pyramid *terrain[TERRAINS];

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    for (int k = 0; k < TERRAINS; k++)
        terrain[k] = terrain_pyramid(made[k].kind, made[k].width, made[k].height, SPACING, 7);
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < TERRAINS; k++)
        tc_pyramid_destroy(terrain[k]);
    tc_context_destroy(context);
    return 0;
}

static void no_background_shows_through(void **state)
{
    (void)state;
    totals t = {0};
    for (int k = 0; k < TERRAINS; k++) {
        run(context, terrain[k], 63, 220, false, SOUND, 10 + (uint64_t)k, &t);
        run(context, terrain[k], 63, 220, true, SOUND, 20 + (uint64_t)k, &t);
        run(context, terrain[k], 31, 100, true, SOUND, 30 + (uint64_t)k, &t);
        run(context, terrain[k], 255, 40, (k & 1) != 0, SOUND, 40 + (uint64_t)k, &t);
    }
    printf("watertight: %d views (%d more from below a lagging surface not counted), %lld terrain pixels, %d cracks\n",
           t.views, t.below_surface, (long long)t.terrain_pixels, t.cracks);
    assert_true(t.views >= 2000);
    assert_int_equal(t.cracks, 0);
}

/* Open T-junctions are as wide as rounding makes them: now and then a pixel. Edges of levels that are not brought
 * together are open wide. */
static void the_test_finds_cracks(void **state)
{
    (void)state;
    for (int k = 0; k < TERRAINS; k++) {
        totals t = {0};
        run(context, terrain[k], 63, 60, k & 1, NO_STITCH, 50 + (uint64_t)k, &t);
        printf("watertight: no stitching: %d cracks in %d views of %s\n", t.cracks, t.views,
               made[k].kind == TERRAIN_CLIFF    ? "cliffs"
               : made[k].kind == TERRAIN_SMOOTH ? "smooth hills"
                                                : "the default terrain");
        assert_true(t.cracks > (made[k].kind == TERRAIN_SMOOTH ? 0 : 100));
    }
    totals t = {0};
    for (int k = 0; k < TERRAINS; k++)
        run(context, terrain[k], 63, 150, false, NO_CLOSERS, 60 + (uint64_t)k, &t);
    printf("watertight: open T-junctions alone: %d cracks in %d views\n", t.cracks, t.views);
    assert_true(t.cracks > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_background_shows_through),
        cmocka_unit_test(the_test_finds_cracks),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

/* viewer_change.c - what is shown and how, while it is shown: another way of drawing, other pictures, another terrain.
 * A change that fails leaves all as it was. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "common/chart/atlas.h"

#include <stdlib.h>
#include <string.h>

/* ---- Texts ------------------------------------------------------------------------------------------------------- */

struct tc_kept_text {
    struct tc_kept_text *next;
    char text[];
};

const char *tc_viewer_keep(tc_viewer *v, const char *text)
{
    const size_t size = strlen(text) + 1;
    struct tc_kept_text *kept = malloc(sizeof *kept + size);
    if (!kept)
        return NULL;
    memcpy(kept->text, text, size);
    kept->next = v->kept;
    v->kept = kept;
    return kept->text;
}

void tc_viewer_forget_kept(tc_viewer *v)
{
    while (v->kept) {
        struct tc_kept_text *next = v->kept->next;
        free(v->kept);
        v->kept = next;
    }
}

/* ---- Changes ----------------------------------------------------------------------------------------------------- */

tc_viewer_wish tc_viewer_wish_now(const tc_viewer *v)
{
    return (tc_viewer_wish){v->options, v->scene};
}

static bool same_pictures(const tc_options *a, const tc_options *b)
{
    return a->imagery_count == b->imagery_count &&
           memcmp(a->imagery, b->imagery, (size_t)a->imagery_count * sizeof *a->imagery) == 0;
}

static const tc_scheme *scheme_of(const tc_viewer *v, const tc_options *o)
{
    return o->scheme ? o->scheme : tc_scheme_at(v->program->schemes, NULL, 0);
}

/* Whether other options call for the file to be read anew. */
static bool other_map(const tc_viewer *v, const tc_options *o)
{
    return o->terrain != v->options.terrain || o->synthesis != v->options.synthesis ||
           (!o->scheme && v->options.scheme) || !tc_atlas_same(scheme_of(v, o)->atlas, tc_viewer_scheme(v)->atlas);
}

/* Of another map, which may say nothing of where it lies: then in the light of any map. */
static void settle_sun(tc_viewer *v)
{
    tc_error error;
    if (tc_viewer_settle_sun(v, &error) == TC_OK)
        return;
    v->options.date = NULL;
    v->scene.sun = (tc_sun){0};
    tc_viewer_tell(v, TC_TOLD_WARNING, "%s", error.text);
}

/* Loads what changes beside what there is, which goes only once the new can be drawn. */
static tc_status load_and_draw(tc_viewer *v, const tc_viewer_wish *wish, bool map, tc_error *error)
{
    const tc_viewer before = *v;
    v->options = wish->options, v->scene = wish->scene;
    v->halvings = 0;
    v->imagery = NULL, v->surface = NULL, v->renderer = NULL;
    v->imagery_credits.count = 0;
    if (map)
        v->map = NULL, v->scene.frame.cull_camera = NULL; /* which was of the old one's */
    tc_status status = TC_OK;
    if (map || v->options.imagery_count > 0)
        status = tc_viewer_wait(v, map ? tc_viewer_load : tc_viewer_load_imagery, &before, error);
    if (status == TC_OK) {
        v->scene.imagery = v->imagery;
        v->scene.around = v->around;
        v->scene.holes = v->map->voids == TC_VOIDS_HOLE;
        if (map)
            settle_sun(v);
        status = tc_viewer_make_surface(v, error);
    }
    tc_viewer gone = status == TC_OK ? before : *v;
    if (!map)
        gone.map = NULL;
    tc_viewer_destroy_scene(&gone);
    tc_viewer_unload(&gone);
    if (status != TC_OK) { /* but for what was kept, told and done meanwhile */
        struct tc_kept_text *kept = v->kept;
        const bool waited = v->waited, closed = v->closed;
        *v = before;
        v->kept = kept;
        v->waited = waited, v->closed = closed;
    }
    return status;
}

/* The same map drawn in another way; there may not be room for both. */
static tc_status draw_again(tc_viewer *v, const tc_viewer_wish *wish, tc_error *error)
{
    const tc_viewer_wish before = tc_viewer_wish_now(v);
    v->options = wish->options, v->scene = wish->scene;
    v->halvings = 0;
    tc_status status = tc_viewer_make_surface(v, error);
    tc_error unused;
    if (status != TC_OK) {
        v->options = before.options, v->scene = before.scene;
        if (tc_viewer_make_surface(v, &unused) != TC_OK) {
            tc_viewer_destroy_scene(v);
            return tc_fail(error, status, "%s: cannot be drawn any more", v->options.terrain);
        }
    }
    return status;
}

/* Whether no more is asked for than what a renderer changes while it runs. Bytes between members may differ: then it is
 * drawn anew without need. */
static bool quickly(const tc_viewer *v, const tc_viewer_wish *wish)
{
    tc_viewer_wish w = *wish;
    const bool by_error = v->surface && v->surface->by_error;
    w.scene.wireframe = v->scene.wireframe, w.scene.level_colours = v->scene.level_colours;
    w.scene.frame = v->scene.frame;
    w.scene.samples = v->scene.samples;
    w.scene.sun = v->scene.sun;
    w.options.date = v->options.date, w.options.julian = v->options.julian;
    w.options.scene.frame.error = v->options.scene.frame.error;
    return v->renderer && by_error == (wish->scene.frame.error > 0 && tc_viewer_scheme(v)->by_error) &&
           memcmp(&w.scene, &v->scene, sizeof w.scene) == 0 && memcmp(&w.options, &v->options, sizeof w.options) == 0;
}

tc_status tc_viewer_adopt(tc_viewer *v, const tc_viewer_wish *wish, tc_error *error)
{
    const bool map = other_map(v, &wish->options);
    if (map || !same_pictures(&wish->options, &v->options))
        return load_and_draw(v, wish, map, error);
    if (wish->options.exaggeration != v->options.exaggeration)
        return tc_viewer_exaggerate(v, wish->options.exaggeration, error);
    if (wish->options.sea.kind != v->options.sea.kind || wish->options.sea.level != v->options.sea.level)
        return tc_viewer_flood(v, wish->options.sea, error);
    if (quickly(v, wish)) {
        v->options = wish->options, v->scene = wish->scene;
        v->sized_for = (tc_camera){0}; /* the windows' size may follow from the error */
        tc_renderer_set_options(v->renderer, &v->scene);
        return TC_OK;
    }
    return draw_again(v, wish, error);
}

/* ---- Schemes ----------------------------------------------------------------------------------------------------- */

const tc_scheme *tc_viewer_scheme_after(const tc_viewer *v, const tc_scheme *scheme)
{
    const tc_scheme *const *lists = v->program->schemes, *next;
    int k = 0;
    while (tc_scheme_at(lists, NULL, k) != scheme)
        k++;
    next = tc_scheme_at(lists, NULL, k + 1);
    return next ? next : tc_scheme_at(lists, NULL, 0);
}

tc_status tc_viewer_change_scheme(tc_viewer *v, const tc_scheme *scheme, tc_error *error)
{
    tc_viewer_wish wish = tc_viewer_wish_now(v);
    wish.options.scheme = scheme;
    return tc_viewer_adopt(v, &wish, error);
}

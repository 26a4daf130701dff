/* panel.c - the table of what can be set while a viewer runs; see panel.h. */
#include "panel.h"
#include "common/render/canvas.h"

#include <math.h>
#include <string.h>

/* ---- Values: what a row is, and what is to be for it ------------------------------------------------------------- */

static double get_scheme(const tc_viewer *v)
{
    const tc_scheme *scheme;
    int k = 0;
    while ((scheme = tc_scheme_at(v->program->schemes, NULL, k)) && scheme != tc_viewer_scheme(v))
        k++;
    return k;
}
static void ask_scheme(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    wish->options.scheme = tc_scheme_at(v->program->schemes, NULL, (int)value);
    wish->scene.frame.cull_camera = NULL; /* of the scheme that it was frozen in */
}
static bool has_schemes(const tc_viewer *v)
{
    return tc_scheme_at(v->program->schemes, NULL, 1) != NULL;
}

static int most_levels(const tc_viewer *v)
{
    return tc_field_info(tc_map_field(v->map, 0))->levels;
}
static double get_levels(const tc_viewer *v)
{
    const int most = most_levels(v);
    return v->options.levels > 0 && v->options.levels < most ? v->options.levels : most;
}
static void ask_levels(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    wish->options.levels = value < most_levels(v) ? (int)value : 0;
}
static bool has_levels(const tc_viewer *v)
{
    return most_levels(v) > 1;
}

static double get_synthesis(const tc_viewer *v)
{
    return v->map->synthesised;
}
static void ask_synthesis(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->options.synthesis = (int)value;
}

static double get_exaggeration(const tc_viewer *v)
{
    return v->map->exaggeration;
}
static void ask_exaggeration(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->options.exaggeration = fabs(value - 1) < 0.05 ? 1 : value; /* the one that is to be hit */
}

static double get_error(const tc_viewer *v)
{
    return v->scene.frame.error;
}
static void ask_error(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->scene.frame.error = wish->options.scene.frame.error = value;
}
static bool has_error(const tc_viewer *v)
{
    return tc_viewer_scheme(v)->by_error;
}

static double get_shade(const tc_viewer *v)
{
    return v->scene.shade ? (double)(v->scene.shade - tc_shades) : TC_SHADE_NATURAL;
}
static void ask_shade(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->scene.shade = &tc_shades[(int)value];
    wish->scene.unlit &= wish->scene.shade->natural; /* a map's are without light already, or are light */
}

static double get_light(const tc_viewer *v)
{
    return !v->scene.unlit;
}
static void ask_light(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->scene.unlit = value == 0;
}
static bool has_light(const tc_viewer *v)
{
    return !v->scene.shade || v->scene.shade->natural;
}

/* Of an angle, in such steps that what was set is what is shown. */
static double degrees(double radians)
{
    return round(radians * 180 / M_PI * 1e6) / 1e6;
}

static void ask_sun(tc_viewer_wish *wish, tc_sun sun)
{
    wish->scene.sun = sun;
    wish->options.date = NULL;
}
static double get_sun_azimuth(const tc_viewer *v)
{
    return degrees(tc_viewer_sun(v).azimuth);
}
static void ask_sun_azimuth(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    tc_sun sun = tc_viewer_sun(v);
    sun.azimuth = value * M_PI / 180;
    ask_sun(wish, sun);
}
static double get_sun_elevation(const tc_viewer *v)
{
    return degrees(tc_viewer_sun(v).elevation);
}
static void ask_sun_elevation(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    tc_sun sun = tc_viewer_sun(v);
    sun.elevation = value * M_PI / 180;
    ask_sun(wish, sun);
}
static bool has_sun(const tc_viewer *v)
{
    return has_light(v) && !v->scene.unlit;
}

static double get_contours(const tc_viewer *v)
{
    return v->scene.contours;
}
static void ask_contours(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->scene.contours = value < 0.1 ? 0 : value;
}

static const char *const sea_names[] = {"where the edge is", "none", "at a height", NULL}; /* as tc_sea_kind */
static double get_sea(const tc_viewer *v)
{
    return v->map->sea.kind;
}
static void ask_sea(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->options.sea = (tc_sea){.kind = (tc_sea_kind)value};
}
static double get_sea_level(const tc_viewer *v)
{
    return v->map->sea.level;
}
static void ask_sea_level(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->options.sea = (tc_sea){.kind = TC_SEA_GIVEN, .level = value};
}
static bool has_sea_level(const tc_viewer *v)
{
    return v->map->sea.kind == TC_SEA_GIVEN;
}

static const char *const sample_names[] = {"1", "2", "4", "8", "16", NULL};
static double get_samples(const tc_viewer *v)
{
    double k = 0;
    while (k < 4 && 1 << (int)k < v->scene.samples)
        k++;
    return k;
}
static void ask_samples(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    wish->scene.samples = tc_canvas_samples(v->gl, 1 << (int)value);
}

static double get_morph(const tc_viewer *v)
{
    return !v->scene.frame.no_morph;
}
static void ask_morph(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->scene.frame.no_morph = value == 0;
}

static double get_wireframe(const tc_viewer *v)
{
    return v->scene.wireframe;
}
static void ask_wireframe(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->scene.wireframe = value != 0;
}

static double get_level_colours(const tc_viewer *v)
{
    return v->scene.level_colours;
}
static void ask_level_colours(const tc_viewer *v, tc_viewer_wish *wish, double value)
{
    (void)v;
    wish->scene.level_colours = value != 0;
}

/* ---- The table --------------------------------------------------------------------------------------------------- */

static const char *const *scheme_names(const tc_panel *panel)
{
    return panel->scheme;
}

static const char *const *shade_names(const tc_panel *panel)
{
    return panel->shade;
}

static const char *const *view_names(const tc_panel *panel)
{
    return panel->view;
}
static bool has_views(const tc_viewer *v)
{
    return v->listed_count > 0;
}

/* What a row does not say is none. */
static const struct panel_row {
    tc_display_row row;
    bool (*there)(const tc_viewer *v); /* NULL: always */
    double (*get)(const tc_viewer *v);
    void (*ask)(const tc_viewer *v, tc_viewer_wish *wish, double value);
    int (*most)(const tc_viewer *v);                    /* NULL: the row's */
    const char *const *(*names)(const tc_panel *panel); /* of a choice, likewise */
    bool file, picture;                                 /* an entry of a file, which is rather a picture */
    bool keys;                                          /* a choice of key 1 and on; 0 is none */
} table[] = {
    {.row = {.kind = TC_ROW_HEADING, .label = "Terrain"}},
    {.row = {.kind = TC_ROW_ENTRY, .label = "Open", .help = "a file, or let it fall here"}, .file = true},
    {.row = {.kind = TC_ROW_CHOICE, .label = "Fly to", .help = "a view of --views (keys 1 to 9)"},
     .there = has_views,
     .names = view_names,
     .keys = true},
    {.row = {.kind = TC_ROW_CHOICE, .label = "Scheme", .help = "the way of drawing, at the same view (key X)"},
     .there = has_schemes,
     .get = get_scheme,
     .ask = ask_scheme,
     .names = scheme_names},
    {.row = {.kind = TC_ROW_SLIDER,
             .label = "Exaggeration",
             .help = "of heights",
             .least = 0.1,
             .most = 100,
             .logarithmic = true,
             .late = true,
             .format = "%.2f"},
     .get = get_exaggeration,
     .ask = ask_exaggeration},
    {.row = {.kind = TC_ROW_COUNT, .label = "Levels", .help = "of detail at most", .least = 1, .late = true},
     .there = has_levels,
     .get = get_levels,
     .ask = ask_levels,
     .most = most_levels},
    {.row = {.kind = TC_ROW_COUNT,
             .label = "Synthesis",
             .help = "levels finer than the data, like its own",
             .most = 12,
             .late = true},
     .get = get_synthesis,
     .ask = ask_synthesis},
    {.row = {.kind = TC_ROW_SLIDER,
             .label = "Error",
             .help = "pixels that what is drawn may be off the data; 0: by distance alone",
             .most = 20,
             .late = true,
             .format = "%.1f px"},
     .there = has_error,
     .get = get_error,
     .ask = ask_error},
    {.row = {.kind = TC_ROW_SWITCH, .label = "Morph", .help = "levels pass into each other (key M)"},
     .get = get_morph,
     .ask = ask_morph},
    {.row = {.kind = TC_ROW_HEADING, .label = "Look"}},
    {.row = {.kind = TC_ROW_CHOICE, .label = "Shade", .help = "what colours say"},
     .get = get_shade,
     .ask = ask_shade,
     .names = shade_names},
    {.row = {.kind = TC_ROW_SWITCH, .label = "Light", .help = "off: colours as they are"},
     .there = has_light,
     .get = get_light,
     .ask = ask_light},
    {.row = {.kind = TC_ROW_SLIDER,
             .label = "Sun azimuth",
             .help = "clockwise from north; on a globe as from the ground below the eye",
             .most = 360,
             .format = "%.0f degrees"},
     .there = has_sun,
     .get = get_sun_azimuth,
     .ask = ask_sun_azimuth},
    {.row = {.kind = TC_ROW_SLIDER,
             .label = "Sun elevation",
             .help = "above the horizon; below it is night",
             .least = -90,
             .most = 90,
             .format = "%.0f degrees"},
     .there = has_sun,
     .get = get_sun_elevation,
     .ask = ask_sun_elevation},
    {.row = {.kind = TC_ROW_SLIDER,
             .label = "Contours",
             .help = "metres between lines of equal height; 0: none",
             .most = 1000,
             .logarithmic = true,
             .late = true,
             .format = "%.3g m"},
     .get = get_contours,
     .ask = ask_contours},
    {.row = {.kind = TC_ROW_CHOICE,
             .label = "Sea",
             .help = "where the map's edge lies at 0, none, or over all ground below a height",
             .names = sea_names},
     .get = get_sea,
     .ask = ask_sea},
    {.row = {.kind = TC_ROW_SLIDER,
             .label = "Sea level",
             .help = "metres above 0",
             .least = -1000,
             .most = 9000,
             .late = true,
             .format = "%.1f m"},
     .there = has_sea_level,
     .get = get_sea_level,
     .ask = ask_sea_level},
    {.row = {.kind = TC_ROW_CHOICE, .label = "Samples", .help = "a pixel, for smooth edges", .names = sample_names},
     .get = get_samples,
     .ask = ask_samples},
    {.row = {.kind = TC_ROW_SWITCH, .label = "Wireframe", .help = "lines instead of faces (key G)"},
     .get = get_wireframe,
     .ask = ask_wireframe},
    {.row = {.kind = TC_ROW_SWITCH, .label = "Level colours", .help = "a colour for each level of detail (key L)"},
     .get = get_level_colours,
     .ask = ask_level_colours},
    {.row = {.kind = TC_ROW_HEADING, .label = "Pictures"}},
    {.row = {.kind = TC_ROW_ENTRY, .label = "Add", .help = "a picture over the terrain"},
     .file = true,
     .picture = true},
};
enum { TABLE = sizeof table / sizeof *table };
_Static_assert((int)TABLE + (int)TC_MOST_IMAGERY <= (int)TC_DISPLAY_ROWS, "room for all rows");

/* ---- Pictures: a switch each, whose id follows the table's ------------------------------------------------------- */

static bool is_laid(const tc_options *o, const char *picture)
{
    bool laid = false;
    for (int i = 0; i < o->imagery_count; i++)
        laid |= strcmp(o->imagery[i], picture) == 0;
    return laid;
}

/* Keeps in mind what has been laid over the terrain, so that it can be laid there again. */
static void remember(tc_panel *panel, const tc_viewer *v)
{
    if (panel->terrain != v->options.terrain)
        panel->pictures = 0;
    panel->terrain = v->options.terrain;
    for (int i = 0; i < v->options.imagery_count && panel->pictures < TC_MOST_IMAGERY; i++) {
        bool known = false;
        for (int k = 0; k < panel->pictures; k++)
            known |= strcmp(panel->picture[k], v->options.imagery[i]) == 0;
        if (!known)
            panel->picture[panel->pictures++] = v->options.imagery[i];
    }
}

static void ask_picture(const tc_panel *panel, tc_viewer_wish *wish, int number, bool on)
{
    tc_options *o = &wish->options;
    int count = 0;
    const tc_options before = *o;
    for (int k = 0; k < panel->pictures; k++)
        if (k == number ? on : is_laid(&before, panel->picture[k]))
            o->imagery[count++] = panel->picture[k];
    o->imagery_count = count;
}

/* ---- Outside ----------------------------------------------------------------------------------------------------- */

static void name_choices(tc_panel *panel, const tc_viewer *v)
{
    const tc_scheme *scheme;
    for (int k = 0; k < TC_PANEL_SCHEMES && (scheme = tc_scheme_at(v->program->schemes, NULL, k)); k++)
        panel->scheme[k] = scheme->name;
    for (int k = 0; k < TC_SHADES; k++)
        panel->shade[k] = tc_shades[k].name;
    panel->view[0] = "...";
    for (int k = 0; k < v->listed_count; k++) {
        snprintf(panel->view_text[k], sizeof panel->view_text[k], "%d  %s", k + 1, v->listed[k].name);
        panel->view[k + 1] = panel->view_text[k];
    }
    panel->view[v->listed_count + 1] = NULL;
}

int tc_panel_rows(tc_panel *panel, const tc_viewer *v, tc_display_row rows[TC_DISPLAY_ROWS])
{
    int count = 0;
    name_choices(panel, v);
    remember(panel, v);
    for (int id = 0; id < TABLE; id++) {
        const struct panel_row *from = &table[id];
        if (from->there && !from->there(v))
            continue;
        tc_display_row *row = &rows[count++];
        *row = from->row;
        row->id = id;
        row->value = from->get ? from->get(v) : 0;
        row->most = from->most ? from->most(v) : row->most;
        row->names = from->names ? from->names(panel) : row->names;
    }
    for (int k = 0; k < panel->pictures; k++) {
        const char *path = panel->picture[k], *slash = strrchr(path, '/');
        rows[count++] = (tc_display_row){.kind = TC_ROW_SWITCH,
                                         .label = slash ? slash + 1 : path,
                                         .help = path,
                                         .id = TABLE + k,
                                         .value = is_laid(&v->options, path)};
    }
    return count;
}

bool tc_panel_is_file(int id, bool *picture_ret)
{
    const bool file = id >= 0 && id < TABLE && table[id].file;
    *picture_ret = file && table[id].picture;
    return file;
}

int tc_panel_key(int id, double value)
{
    return id >= 0 && id < TABLE && table[id].keys && value >= 1 ? '0' + (int)value : 0;
}

tc_status tc_panel_set(const tc_panel *panel, tc_viewer *v, int id, double value, tc_error *error)
{
    tc_viewer_wish wish = tc_viewer_wish_now(v);
    if (id >= TABLE && id < TABLE + panel->pictures)
        ask_picture(panel, &wish, id - TABLE, value != 0);
    else if (id >= 0 && id < TABLE && table[id].ask)
        table[id].ask(v, &wish, value);
    return tc_viewer_adopt(v, &wish, error);
}

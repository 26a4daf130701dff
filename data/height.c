/* height.c - `terraclip height`: heights at points, of a packed terrain or of any DEM.
 *
 * A point is taken to columns and rows by the file's transform, and from there to samples of a level. Heights are those
 * of the level's mesh of triangles, which planar-viewer draws. planet-viewer's ground is another one between samples:
 * it interpolates bilinearly, and mixes the polar caps in from 56 degrees of latitude on, as tc_map_height() does.
 *
 * Around the globe longitudes go on. Between its last row and the pole a packed planet has the polar cap's height; a
 * map that was not packed as one goes straight to the row's mean, at the pole. */
#include "height.h"
#include "points.h"
#include "ray.h"

#include "common/chart/lonlat.h"
#include "common/field/field.h"
#include "common/field/point.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/app/arguments.h"
#include "common/base/numbers.h"
#include "common/app/load.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

struct arguments {
    const char *file;
    const char *texts[2]; /* of the point */
    int count;            /* of them */
    const char *ray;      /* instead of a point */
    int level;            /* 0: the finest */
    int synthesis;        /* levels finer than the data, or TC_SYNTHESIS_AUTO; 0: none */
    bool quiet, verbose;
    tc_source_options source;
};

/* ---- Command line ----------------------------------------------------------------------------------------------- */

static const tc_option table[] = {
    {0, "level", "L", TC_EXPECTED_LEVEL, "of detail; 1 is the coarsest (the finest)", tc_read_level,
     offsetof(struct arguments, level)},
    {0, "synthesis", "LEVELS", TC_EXPECTED_SYNTHESIS, TC_SYNTHESIS_HELP, tc_read_synthesis,
     offsetof(struct arguments, synthesis)},
    {0, "voids", "POLICY", TC_EXPECTED_VOIDS,
     "where there is no height: fill, constant=V, or hole, which is told as nan (fill; as packed)", tc_read_voids,
     offsetof(struct arguments, source)},
    {0, "ray", "X,Y,Z,HEADING,PITCH", "a view, as the viewers' --view has it",
     "instead of a point: where a look in that direction from there meets the ground first, or the side of a flat "
     "terrain, as X Y Z DISTANCE in metres; of a packed planet LON,LAT,HEIGHT,HEADING,PITCH",
     tc_read_text, offsetof(struct arguments, ray)},
    {.help = "How a DEM is read; a packed terrain knows"},
    TC_READING_ROWS(struct arguments, source),
    {.help = "What is told"},
    TC_SWITCH(struct arguments, quiet, 'q', "quiet", "no warnings"),
    TC_SWITCH(struct arguments, verbose, 'v', "verbose", "how the file was understood"),
    TC_HELP_AND_VERSION,
};

static tc_status take_operand(void *arguments, const char *operand, tc_error *error)
{
    struct arguments *a = arguments;
    if (!a->file)
        a->file = operand;
    else if (a->count < 2)
        a->texts[a->count++] = operand;
    else
        return tc_fail(error, TC_ERR_USAGE, "point: expected two numbers, found also '%s'", operand);
    return TC_OK;
}

static const tc_command_line line = {.options = table,
                                     .count = sizeof table / sizeof *table,
                                     .help = "'terraclip height --help'",
                                     .numbers = true,
                                     .operand = take_operand};

void tc_height_help(FILE *file)
{
    fprintf(file,
            "Usage: terraclip height [OPTION]... FILE [X Y | LON LAT | --ray VIEW]\n"
            "Tells the height at a point in metres; without a point, at those of the standard input, one a line.\n"
            "FILE is a packed terrain, a DEM or a picture of heights. Where it has geographic coordinates a point is\n"
            "LON LAT in degrees; where it has projected ones X Y of its coordinate system; without a georeference\n"
            "metres east and north of its south-west sample. Heights are those of the mesh between samples;\n"
            "a planet's ground that --ray meets and viewers show is smooth between those of its map, and off them by\n"
            "as much as that is bent: by metres where samples are kilometres apart.\n"
            "Around a planet every longitude will do, and every latitude from pole to pole.\n"
            "A point outside is an error; one of the standard input is told as nan, and the exit code is 1.\n"
            "So is a line that is no point. Empty lines, those that begin with # and a first line of words are left\n"
            "out, and so are columns behind the two numbers.\n\n");
    tc_arguments_print(&line, file);
}

/* ---- Points ----------------------------------------------------------------------------------------------------- */

typedef struct place {
    const tc_map *map;
    const tc_field *field; /* of its first chart */
    int level;
    double stride_x, stride_y; /* finest samples between those of the level */
    int64_t around;            /* finest columns once around the globe, of a map whose levels do not go round; else 0 */
    double south, north;       /* rows from its first and its last one to the poles; 0 where they are not next to one */
} place;

/* Points may be off the border by so much of a sample: their decimals were rounded. */
static const double tolerance = 1e-6;

/* Beside the outermost samples of areas, as far as those go, there is the nearest sample's height. */
static bool inside(const place *p, double u, double v)
{
    double edge = tolerance + (p->map->georef.known && p->map->area_registered ? 0.5 : 0);
    return u >= -edge && u <= (double)(p->map->width - 1) + edge && v >= -edge &&
           v <= (double)(p->map->height - 1) + edge;
}

/* The point in finest samples; false: outside. */
static bool locate(const place *p, double x, double y, double *u, double *v)
{
    const tc_map *t = p->map;
    if (!t->georef.known) {
        const tc_level level = tc_field_level(p->field, p->level);
        *u = x / level.spacing_x * p->stride_x;
        *v = y / level.spacing_y * p->stride_y;
        return inside(p, *u, *v);
    }
    if (tc_field_info(p->field)->wraps_x || p->map->chart[0].class->seam) {
        tc_map_georef_samples(p->map, x, y, u, v);
        *u -= floor(*u / (double)t->width) * (double)t->width;
        return tc_map_radius(t) > 0 ? fabs(y) <= 90 : *v >= -tolerance && *v <= (double)(t->height - 1) + tolerance;
    }
    if (p->around > 0) {
        double turn = (double)p->around;
        tc_map_georef_samples(p->map, x, y, u, v);
        *u -= floor(*u / turn) * turn;
        return *v >= -tolerance - p->south && *v <= (double)(t->height - 1) + tolerance + p->north;
    }
    /* Longitudes repeat. */
    for (int turn = 0; turn < (t->georef.geographic ? 3 : 1); turn++) {
        tc_map_georef_samples(p->map, x + (turn == 1 ? 360 : turn == 2 ? -360 : 0), y, u, v);
        if (inside(p, *u, *v))
            return true;
    }
    return false;
}

/* Where a level's last column is not next to its first one, though the map goes around: the share of the way between
 * them that u, in samples of the level, has gone; else 0. */
static double seam_share(const place *p, int64_t width, double u)
{
    double last = (double)(width - 1), turn = (double)p->around / p->stride_x;
    return p->around > 0 && u > last && turn > last ? (u - last) / (turn - last) : 0;
}

/* A cell from the last column, a rectangle, to the first one. */
static tc_status read_seam(const tc_field *field, int level, tc_rect last, float z[4], uint8_t voids[4])
{
    tc_status status = tc_field_read(field, level, last, z, voids, 2);
    return status ? status : tc_field_read(field, level, (tc_rect){0, last.y0, 1, last.y1}, z + 1, voids + 1, 2);
}

/* Height of a level's mesh at a point in its samples; beyond its last samples that of the nearest point. NaN where a
 * void is left out. */
static tc_status read_mesh(const place *p, const tc_field *field, int level, double u, double v, double *z_ret)
{
    const tc_level l = tc_field_level(field, level);
    double share = seam_share(p, l.width, u);
    tc_cell cell;
    tc_status status = tc_field_cell(field, level, fmax(u, 0), v, true, &cell);
    if (status == TC_OK && share > 0) {
        int64_t i = l.width - 1, j = tc_clamp64((int64_t)v, 0, tc_max64(0, l.height - 2));
        cell.tx = share;
        status = read_seam(field, level, (tc_rect){i, j, i + 1, tc_min64(j + 2, l.height)}, cell.z, cell.voids);
    }
    if (status == TC_OK)
        *z_ret = p->map->voids == TC_VOIDS_HOLE && tc_cell_void(&cell)
                     ? NAN
                     : tc_cell_mesh(&cell) + tc_field_info(field)->z_base;
    return status;
}

/* The same on the chart laid over that place, a polar cap, at the level whose samples are about as far apart. */
static tc_status read_cap(const place *p, const tc_chart *cap, double longitude, double latitude, double *z_ret)
{
    const double degree = 3.141592653589793 / 180;
    int levels = tc_field_info(cap->field)->levels, missing = tc_field_packed_info(cap->field)->levels_missing;
    int like = levels - p->map->synthesised + missing; /* as far apart as the map's finest samples in the file */
    int level = (int)tc_clamp64(like - (int)lrint(log2(p->stride_y)), 1, levels);
    double x, y, spacing = ldexp(cap->dx, levels - level);
    cap->class->from_place(cap, longitude * degree, latitude * degree, &x, &y);
    return read_mesh(p, cap->field, level, (x - cap->x0) / spacing, (y - cap->y0) / spacing, z_ret);
}

/* The chart that has all of the height there, if it is none but the first; else NULL. */
static const tc_chart *chart_over(const place *p, double latitude)
{
    const double normal[3] = {0, 0, sin(latitude * 3.141592653589793 / 180)}; /* caps look at no more */
    for (int k = 1; k < p->map->charts; k++)
        if (p->map->chart[k].class->share(&p->map->chart[k], normal) >= 1)
            return &p->map->chart[k];
    return NULL;
}

/* Mean height of the level's first or last row, or where it is finer than the data of theirs; NaN where all of it are
 * voids that are left out. */
static tc_status read_row_mean(const place *p, int64_t row, double *z_ret)
{
    const tc_field *field = p->field;
    int level = (int)tc_min64(p->level, tc_field_info(field)->levels - p->map->synthesised);
    const tc_level l = tc_field_level(field, level);
    double stride = ldexp(p->stride_x, p->level - level);
    int64_t columns = tc_min64(l.width, (int64_t)ceil((double)p->around / stride)), count = 0;
    row = row > 0 ? l.height - 1 : 0;
    float *z = malloc((size_t)columns * sizeof *z);
    uint8_t *voids = malloc((size_t)columns);
    tc_rect rect = {0, row, columns, row + 1};
    tc_status status = z && voids ? tc_field_read(field, level, rect, z, voids, columns) : TC_ERR_MEMORY;
    double sum = 0;
    for (int64_t i = 0; i < columns && status == TC_OK; i++)
        if (p->map->voids != TC_VOIDS_HOLE || !voids[i])
            sum += (double)z[i], count++;
    free(z), free(voids);
    *z_ret = count > 0 ? sum / (double)count + tc_field_info(field)->z_base : NAN;
    return status;
}

/* Between a row and the pole beside it, `beyond` of `gap` rows away from it. */
static tc_status read_to_pole(const place *p, int64_t row, double u, double beyond, double gap, double *z_ret)
{
    double z = 0, pole = 0, share = fmin(beyond / gap, 1);
    tc_status status = read_mesh(p, p->field, p->level, u / p->stride_x, (double)row, &z);
    if (status == TC_OK)
        status = read_row_mean(p, row, &pole);
    *z_ret = share < 1 ? z + share * (pole - z) : pole;
    return status;
}

static bool on_faces(const place *p)
{
    return p->map->chart[0].class->seam != NULL;
}

/* On the face that has the place. */
static tc_status read_face(const place *p, double longitude, double latitude, double *z_ret)
{
    const double degree = 3.141592653589793 / 180, at[3] = {longitude * degree, latitude * degree, 0};
    double normal[3], share[TC_MAP_CHARTS], x, y, u, v;
    p->map->body.class->normal(&p->map->body, at, normal);
    tc_map_shares(p->map, normal, share);
    int k = 0;
    while (k < p->map->charts - 1 && !(share[k] > 0))
        k++;
    const tc_chart *c = &p->map->chart[k];
    c->class->from_place(c, at[0], at[1], &x, &y);
    tc_chart_samples(c, p->level, x, y, &u, &v);
    return read_mesh(p, c->field, p->level, u, v, z_ret);
}

/* Height of the level at (x, y), which lies at (u, v) in finest samples. */
static tc_status read_height(const place *p, double x, double y, double u, double v, double *z_ret)
{
    if (on_faces(p))
        return read_face(p, x, y, z_ret);
    double beyond = fmax(-v, v - (double)(p->map->height - 1)), gap = v < 0 ? p->south : p->north;
    if (beyond > 0 && gap > tolerance) {
        int64_t last = tc_field_level(p->field, p->level).height - 1;
        return read_to_pole(p, v < 0 ? 0 : last, u, beyond, gap, z_ret);
    }
    const tc_chart *over = beyond > 0 ? chart_over(p, y) : NULL;
    if (over)
        return read_cap(p, over, x, y, z_ret);
    return read_mesh(p, p->field, p->level, u / p->stride_x, v / p->stride_y, z_ret);
}

static void print_height(double z)
{
    if (isnan(z))
        printf("nan\n");
    else
        printf("%.10g\n", z == 0 ? 0 : z); /* no -0 */
}

/* ---- Running ---------------------------------------------------------------------------------------------------- */

static tc_status tell_one(const struct arguments *a, const place *p, double x, double y, tc_error *error)
{
    double u, v, z;
    if (!locate(p, x, y, &u, &v))
        return tc_fail(error, TC_ERR_IO,
                       "%s %s: expected a point of %s, found one outside, at column %.2f of %" PRId64
                       " and row %.2f of %" PRId64 " from the south-west",
                       a->texts[0], a->texts[1], a->file, u, p->map->width, v, p->map->height);
    tc_status status = read_height(p, x, y, u, v, &z);
    if (status != TC_OK)
        return tc_fail(error, status, "%s: cannot be read: %s", a->file, tc_status_text(status));
    print_height(z);
    return TC_OK;
}

/* Said at once, and whatever is said, since the answer in its place is none. */
static void tell_bad(const tc_points *points)
{
    fprintf(stderr, "terraclip: standard input: line %" PRId64 ": expected two numbers, found '%.80s'\n",
            points->number, points->text);
}

static tc_status tell_all(const struct arguments *a, const place *p, tc_error *error)
{
    tc_points points = {.file = stdin};
    int64_t outside = 0, bad = 0;
    double x, y, u, v;
    tc_points_line found;
    tc_status status = TC_OK;
    while (status == TC_OK && (found = tc_points_next(&points, &x, &y)) != TC_POINTS_END) {
        double z = NAN;
        if (found == TC_POINTS_BAD) {
            bad++;
            tell_bad(&points);
        } else if (!locate(p, x, y, &u, &v)) {
            outside++;
        } else {
            status = read_height(p, x, y, u, v, &z);
        }
        if (status == TC_OK)
            print_height(z);
        if (isatty(STDIN_FILENO))
            fflush(stdout);
    }
    free(points.text);
    if (status != TC_OK)
        return tc_fail(error, status, "%s: cannot be read: %s", a->file, tc_status_text(status));
    if (ferror(stdin))
        return tc_fail(error, TC_ERR_IO, "standard input: cannot be read");
    if (bad > 0)
        return tc_fail(error, TC_ERR_FORMAT,
                       "standard input: expected points of %s, found %" PRId64 " of %" PRId64 " lines bad and %" PRId64
                       " outside",
                       a->file, bad, points.number, outside);
    if (outside > 0)
        return tc_fail(error, TC_ERR_IO, "standard input: expected points of %s, found %" PRId64 " outside", a->file,
                       outside);
    return TC_OK;
}

static void say(void *context, bool warning, const char *text)
{
    const struct arguments *a = context;
    if (warning ? !a->quiet : a->verbose)
        fprintf(stderr, "terraclip: %s%s\n", warning ? "warning: " : "", text);
}

/* Whether the map goes around the globe, and ends next to the poles, where its levels do not know. */
static void find_around(place *p)
{
    const tc_map *m = p->map;
    tc_lonlat at;
    if (tc_field_info(p->field)->wraps_x || on_faces(p) || !tc_lonlat_of(&m->georef, m->width, m->height, &at))
        return;
    int64_t columns = (int64_t)fmin((double)m->width, floor(at.turn + 0.5));
    if (!tc_lonlat_round(columns, at.turn))
        return;
    p->around = columns;
    p->north = at.north > 0 && at.north < 1.001 ? at.north : 0;
    p->south = at.south > 0 && at.south < 1.001 ? at.south : 0;
}

static tc_status tell(const struct arguments *a, const tc_map *map, double x, double y, tc_error *error)
{
    const tc_field *field = tc_map_field(map, 0);
    int levels = tc_field_info(field)->levels;
    if (a->level > levels)
        return tc_fail(error, TC_ERR_USAGE, "--level: expected 1..%d, found %d", levels, a->level);
    place p = {.map = map, .field = field, .level = a->level ? a->level : levels};
    const tc_level level = tc_field_level(field, p.level);
    p.stride_x = tc_level_stride(level.spacing_x, map->spacing_x);
    p.stride_y = tc_level_stride(level.spacing_y, map->spacing_y);
    find_around(&p);
    tc_status status = a->ray     ? tc_ray_tell(map, a->file, a->ray, error)
                       : a->count ? tell_one(a, &p, x, y, error)
                                  : tell_all(a, &p, error);
    int64_t damaged = tc_map_damaged(map);
    if (status == TC_OK && damaged > 0)
        status = tc_fail(error, TC_ERR_FORMAT,
                         "%s: damaged: %" PRId64 " tiles could not be read; the next coarser level stood in", a->file,
                         damaged);
    return status;
}

tc_status tc_height_main(int argc, char **argv, tc_error *error)
{
    struct arguments a = {0};
    tc_action action;
    tc_status status = tc_arguments_read(&line, argc, argv, &a, &action, error);
    if (status != TC_OK)
        return status;
    if (!a.file)
        return tc_fail(error, TC_ERR_USAGE, "FILE: expected a terrain, found none");
    if (a.count == 1)
        return tc_fail(error, TC_ERR_USAGE, "point: expected two numbers, found one");
    if (a.ray && (a.count || a.level))
        return tc_fail(error, TC_ERR_USAGE, "--ray: expected no %s with it, found one", a.count ? "point" : "--level");
    double point[2] = {0};
    for (int i = 0; i < a.count; i++)
        if (!tc_read_number(a.texts[i], -1e12, 1e12, &point[i]))
            return tc_fail(error, TC_ERR_USAGE, "point: expected two numbers, found '%s'", a.texts[i]);
    a.source.say = say;
    a.source.say_context = &a;
    tc_map *map = NULL;
    status = tc_map_load(a.file, &a.source, NULL, &map, error);
    if (status == TC_OK)
        status = tc_map_synthesise(map, a.synthesis, error);
    if (status == TC_OK && a.ray && map->georef.known && tc_map_radius(map) == 0)
        say(&a, true,
            map->georef.geographic ? "--ray: X and Y are metres from the south-west sample of the map taken flat, as "
                                     "planar-viewer has it; "
                                     "'terraclip pack --planet' makes a globe of it, whose rays have degrees"
                                   : "--ray: X and Y are metres from the south-west sample, not the map's coordinates");
    if (status == TC_OK)
        status = tell(&a, map, point[0], point[1], error);
    tc_map_destroy(map);
    return status;
}

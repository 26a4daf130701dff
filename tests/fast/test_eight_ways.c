/* test_eight_ways.c - one terrain stored in eight ways has the same heights at the same places, and samples as far
 * apart on the ground: UTM, Web Mercator, degrees as areas and as points, grads from Paris, feet, south up, zipped. */
#include "tests/support/test.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/loading.h"

enum { SIDE = 201, PLACES = 20 };

static const double west = 2.3, south = 48.3, wide = 0.06, degree = 0.017453292519943295;

/* Metres, of a place in degrees on WGS 84: hills of some kilometres. */
static double relief(double longitude, double latitude)
{
    double x = (longitude - west) / wide, y = (latitude - south) / wide;
    return 300 + 120 * sin(5 * x + 1) * cos(4 * y) + 60 * sin(3 * y + 2 * x);
}

static const struct way {
    const char *name, *crs, *datum;
    double unit; /* metres per stored unit */
    bool point, south_up, zipped;
} ways[] = {
    {"utm.tif", "EPSG:32631", "EPSG:4326", 1, false, false, false},
    {"mercator.tif", "EPSG:3857", "EPSG:4326", 1, false, false, false},
    {"area.tif", "EPSG:4326", "EPSG:4326", 1, false, false, false},
    {"point.tif", "EPSG:4326", "EPSG:4326", 1, true, false, false},
    {"grads.tif", "EPSG:4807", "EPSG:4275", 1, false, false, false},
    {"feet.tif", "EPSG:32631+6360", "EPSG:4326", 1200. / 3937, false, false, false},
    {"south-up.tif", "EPSG:32631", "EPSG:4326", 1, false, true, false},
    {"zipped.zip", "EPSG:32631", "EPSG:4326", 1, false, false, true},
};
enum { WAYS = sizeof ways / sizeof *ways };

static OGRSpatialReferenceH system_of(const char *name)
{
    OGRSpatialReferenceH crs = OSRNewSpatialReference(NULL);
    assert_int_equal(OSRSetFromUserInput(crs, name), OGRERR_NONE);
    OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

/* From one system to another, heights left alone. */
static OGRCoordinateTransformationH between(const char *from, const char *to)
{
    OGRSpatialReferenceH a = system_of(from), b = system_of(to);
    OGRCoordinateTransformationH t = OCTNewCoordinateTransformation(a, b);
    assert_non_null(t);
    OSRDestroySpatialReference(a);
    OSRDestroySpatialReference(b);
    return t;
}

static void transformed(OGRCoordinateTransformationH t, double *x, double *y)
{
    assert_true(OCTTransform(t, 1, x, y, NULL));
}

/* The horizontal part of a way's system. */
static void horizontal(const struct way *way, char name[40])
{
    snprintf(name, 40, "%.*s", (int)strcspn(way->crs, "+"), way->crs);
}

/* Metres on the ground between two places near the middle, from their longitudes and latitudes. */
static double apart(OGRCoordinateTransformationH back, double x0, double y0, double x1, double y1)
{
    const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f), middle = (south + wide / 2) * degree;
    const double w2 = 1 - e2 * sin(middle) * sin(middle), east = a * cos(middle) / sqrt(w2) * degree;
    const double north = a * (1 - e2) / (w2 * sqrt(w2)) * degree;
    transformed(back, &x0, &y0), transformed(back, &x1, &y1);
    return hypot((x1 - x0) * east, (y1 - y0) * north);
}

/* spacing: of its samples on the ground. */
static void make(const struct way *way, const char *path, double spacing[2])
{
    char flat[40], tiff[4200];
    horizontal(way, flat);
    snprintf(tiff, sizeof tiff, way->zipped ? "/vsizip/%s/inside/a.tif" : "%s", path);
    OGRCoordinateTransformationH there = between("EPSG:4326", flat), back = between(flat, "EPSG:4326");
    double x0 = west, y0 = south, x1 = west + wide, y1 = south + wide;
    transformed(there, &x0, &y0), transformed(there, &x1, &y1);
    double dx = (x1 - x0) / SIDE, dy = (y1 - y0) / SIDE;
    const double t[6] = {x0, dx, 0, way->south_up ? y0 : y1, 0, way->south_up ? dy : -dy};
    static float z[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = t[0] + (i % SIDE + 0.5) * t[1], y = t[3] + (i / SIDE + 0.5) * t[5];
        transformed(back, &x, &y);
        z[i] = (float)(relief(x, y) / way->unit);
    }
    double x = t[0] + SIDE / 2 * t[1], y = t[3] + SIDE / 2 * t[5];
    spacing[0] = apart(back, x, y, x + 10 * t[1], y) / 10, spacing[1] = apart(back, x, y, x, y + 10 * t[5]) / 10;
    const char *options[] = {way->point ? "BIGTIFF=NO" : "BIGTIFF=IF_NEEDED", NULL};
    char memory[] = "/vsimem/a.tif";
    GDALDatasetH d = GDALCreate(GDALGetDriverByName("GTiff"), memory, SIDE, SIDE, 1, GDT_Float32, (char **)options);
    OGRSpatialReferenceH crs = system_of(way->crs);
    GDALSetSpatialRef(d, crs);
    if (way->point)
        GDALSetMetadataItem(d, "AREA_OR_POINT", "Point", NULL);
    GDALSetGeoTransform(d, (double *)t);
    assert_int_equal(
        GDALRasterIO(GDALGetRasterBand(d, 1), GF_Write, 0, 0, SIDE, SIDE, z, SIDE, SIDE, GDT_Float32, 0, 0), CE_None);
    GDALClose(d);
    assert_int_equal(CPLCopyFile(tiff, memory), 0);
    VSIUnlink(memory);
    OSRDestroySpatialReference(crs);
    OCTDestroyCoordinateTransformation(there);
    OCTDestroyCoordinateTransformation(back);
}

/* Points all over the terrain, degrees on WGS 84. */
static void place(int k, double *x, double *y)
{
    *x = west + wide * (0.08 + 0.84 * (k % 5) / 4), *y = south + wide * (0.07 + 0.86 * (double)(k / 5) / 3);
}

/* What `terraclip height` tells at the places, given in the file's own coordinates. */
static void ask(const struct way *way, const char *path, double heights[PLACES])
{
    char flat[40], program[4096] = "", command[13000];
    horizontal(way, flat);
    OGRCoordinateTransformationH there = between("EPSG:4326", flat);
    assert_true(readlink("/proc/self/exe", program, sizeof program - 1) > 0);
    *strrchr(program, '/') = '\0', *strrchr(program, '/') = '\0';
    FILE *points = fopen(made_path("points.txt"), "w");
    for (int k = 0; k < PLACES; k++) {
        double x, y;
        place(k, &x, &y);
        transformed(there, &x, &y);
        if (strcmp(flat, "EPSG:4807") == 0) /* asked for in degrees of Greenwich */
            x = 0.9 * (x + 2.5969213), y *= 0.9;
        fprintf(points, "%.10f %.10f\n", x, y);
    }
    fclose(points);
    OCTDestroyCoordinateTransformation(there);
    snprintf(command, sizeof command, "'%s/terraclip' height '%s' < '%s'", program, path, made_path("points.txt"));
    FILE *told = popen(command, "r");
    assert_non_null(told);
    for (int k = 0; k < PLACES; k++)
        assert_int_equal(fscanf(told, "%lf", &heights[k]), 1);
    assert_int_equal(pclose(told), 0);
}

/* The map as planets have it, in longitude and latitude: the most that a sample is off. */
static double off_on_globe(const struct way *way, const char *path)
{
    tc_grid g = load(path, (tc_source_options){.lonlat = true}, NULL);
    const double *t = g.georef.transform;
    double worst = 0;
    OGRCoordinateTransformationH wgs84 = between(way->datum, "EPSG:4326");
    const int64_t side = 8; /* where resampling has nothing beyond */
    for (int64_t j = side; j < g.height - side; j++)
        for (int64_t i = side; i < g.width - side; i++) {
            double longitude = t[0] + ((double)i + 0.5) * t[1];
            double latitude = t[3] + ((double)(g.height - 1 - j) + 0.5) * t[5];
            if (g.voids && g.voids[j * g.width + i])
                continue;
            transformed(wgs84, &longitude, &latitude);
            worst = fmax(worst, fabs(g.z_base + g.z[j * g.width + i] - relief(longitude, latitude)));
        }
    OCTDestroyCoordinateTransformation(wgs84);
    assert_true(g.void_count < g.width * g.height / 20);
    tc_grid_free(&g);
    return worst;
}

static void one_terrain_in_eight_ways(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i < WAYS; i++) {
        const char *path = made_path(ways[i].name);
        double heights[PLACES], spacing[2];
        make(&ways[i], path, spacing);
        ask(&ways[i], path, heights);
        for (int k = 0; k < PLACES; k++) {
            double x, y;
            place(k, &x, &y);
            double off = fabs(heights[k] - relief(x, y));
            worst = fmax(worst, off);
            /* A mesh of triangles 20 to 35 m wide over hills that curve by 1/5000 a metre. */
            if (off > 0.05)
                fail_msg("%s: place %d: expected %.3f, found %.3f", ways[i].name, k, relief(x, y), heights[k]);
        }
        tc_grid g = load(path, (tc_source_options){0}, NULL);
        if (fabs(g.spacing_x / spacing[0] - 1) > 0.002 || fabs(g.spacing_y / spacing[1] - 1) > 0.002)
            fail_msg("%s: expected samples %.3f x %.3f m apart, found %.3f x %.3f", ways[i].name, spacing[0],
                     spacing[1], g.spacing_x, g.spacing_y);
        tc_grid_free(&g);
        double off = off_on_globe(&ways[i], path);
        if (off > 0.2) /* a metre or two of place between the ways to a datum */
            fail_msg("%s: on a globe up to %.3f m off", ways[i].name, off);
    }
    print_message("at most %.4f m off\n", worst);
}

int main(void)
{
    /* The programs' plugin chooses drivers when it is first asked. */
    make_pgm(made_path("first.pgm"), W, H, samples_of(16, MADE_UINT, 1, 0));
    tc_grid first = load(made_path("first.pgm"), (tc_source_options){0}, NULL);
    tc_grid_free(&first);
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_terrain_in_eight_ways)};
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}

/* test_formats.c - every format that the GDAL of this machine can write is opened as GDAL itself reads it back, or
 * refused with a reason. TERRACLIP_FORMATS=FILE writes the table of docs/formats.md. */
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

#include "tests/support/loading.h"

enum { WIDTH = 121, HEIGHT = 61 };

static const double transform[6] = {8, 1. / 120, 0, 46.5, 0, -1. / 120};

/* Drivers that write no file of samples that could be opened again, or talk to servers. */
static const char *const left_out[] = {"MEM", "VRT", "PDF", "PostGISRaster", "WMTS", "MBTiles", "KMLSUPEROVERLAY",
                                       "GMT", "NULL"};

static GDALDatasetH make(GDALDataType type)
{
    GDALDatasetH d = GDALCreate(GDALGetDriverByName("MEM"), "", WIDTH, HEIGHT, 1, type, NULL);
    OGRSpatialReferenceH crs = OSRNewSpatialReference(NULL);
    OSRImportFromEPSG(crs, 4326);
    GDALSetSpatialRef(d, crs);
    OSRDestroySpatialReference(crs);
    GDALSetGeoTransform(d, (double *)transform);
    static float z[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        z[i] = type == GDT_Byte ? (float)(i % 251) : (float)(300 + 7 * (i % WIDTH) + 11 * (i / WIDTH) % 900);
    assert_int_equal(
        GDALRasterIO(GDALGetRasterBand(d, 1), GF_Write, 0, 0, WIDTH, HEIGHT, z, WIDTH, HEIGHT, GDT_Float32, 0, 0),
        CE_None);
    return d;
}

/* Writes a file of the driver's with the first type that it takes. */
static bool written(GDALDriverH driver, const char *path, GDALDataType *type_ret)
{
    static const GDALDataType types[] = {GDT_Int16, GDT_Float32, GDT_UInt16, GDT_Byte};
    for (int i = 0; i < 4; i++) {
        GDALDatasetH from = make(types[i]), to = GDALCreateCopy(driver, path, from, FALSE, NULL, NULL, NULL);
        CPLErrorReset();
        if (to)
            GDALClose(to);
        GDALClose(from);
        if (!to)
            continue;
        *type_ret = types[i];
        if (CPLGetLastErrorType() < CE_Failure)
            return true;
    }
    return false;
}

typedef struct outcome {
    bool by_gdal, opened;
    int differing;
    tc_error error;
    sayings said;
} outcome;

static outcome compare(const char *path)
{
    static float z[WIDTH * HEIGHT];
    outcome o = {.error = {.text = ""}};
    GDALDatasetH d = GDALOpen(path, GA_ReadOnly);
    int width = 0, height = 0;
    if (d && GDALGetRasterCount(d) > 0 && (width = GDALGetRasterXSize(d)) == WIDTH &&
        (height = GDALGetRasterYSize(d)) == HEIGHT)
        o.by_gdal = GDALRasterIO(GDALGetRasterBand(d, 1), GF_Read, 0, 0, WIDTH, HEIGHT, z, WIDTH, HEIGHT, GDT_Float32,
                                 0, 0) == CE_None;
    double scale = 1, offset = 0;
    if (o.by_gdal) {
        int given = 0;
        double v = GDALGetRasterScale(GDALGetRasterBand(d, 1), &given);
        scale = given && v != 0 ? v : 1;
        v = GDALGetRasterOffset(GDALGetRasterBand(d, 1), &given);
        offset = given ? v : 0;
    }
    double t[6] = {0, 1, 0, 0, 0, 1};
    if (d)
        GDALGetGeoTransform(d, t);
    if (d)
        GDALClose(d);
    tc_grid g = {0};
    o.opened = tc_grid_load(path, NULL, &g, &o.error) == TC_OK;
    if (!o.opened)
        return o;
    for (int i = 0; o.by_gdal && i < WIDTH * HEIGHT; i++) {
        int column = t[1] < 0 ? WIDTH - 1 - i % WIDTH : i % WIDTH,
            row = t[5] > 0 && t[5] != 1 ? HEIGHT - 1 - i / WIDTH : i / WIDTH;
        if (g.width != WIDTH || g.height != HEIGHT)
            o.differing++;
        else if (!void_at(&g, column, row))
            o.differing += fabs(at(&g, column, row) + g.z_base - (z[i] * scale + offset)) > 1e-3;
        else
            o.differing += isfinite(z[i]) && fabs(z[i]) < 1e6;
    }
    tc_grid_free(&g);
    return o;
}

static bool is_left_out(const char *name)
{
    for (size_t i = 0; i < sizeof left_out / sizeof *left_out; i++)
        if (EQUAL(name, left_out[i]))
            return true;
    return false;
}

static void formats_open_as_gdal_reads_them(void **state)
{
    (void)state;
    /* The programs' plugin chooses drivers when it is first asked. */
    make_pgm(made_path("first.pgm"), W, H, samples_of(16, MADE_UINT, 1, 0));
    tc_grid first = load(made_path("first.pgm"), (tc_source_options){0}, NULL);
    tc_grid_free(&first);
    const char *table = getenv("TERRACLIP_FORMATS");
    FILE *out = table ? fopen(table, "w") : NULL;
    int opened = 0, wrong = 0;
    CPLPushErrorHandler(CPLQuietErrorHandler);
    for (int k = 0; k < GDALGetDriverCount(); k++) {
        GDALDriverH driver = GDALGetDriver(k);
        const char *name = GDALGetDriverShortName(driver),
                   *ending = GDALGetMetadataItem(driver, GDAL_DMD_EXTENSION, NULL);
        if (!GDALGetMetadataItem(driver, GDAL_DCAP_RASTER, NULL) || is_left_out(name) ||
            !(GDALGetMetadataItem(driver, GDAL_DCAP_CREATECOPY, NULL) ||
              GDALGetMetadataItem(driver, GDAL_DCAP_CREATE, NULL)))
            continue;
        char file[300];
        snprintf(file, sizeof file, "%s%s%s", EQUAL(name, "SRTMHGT") ? "N46E008" : name, ending && *ending ? "." : "",
                 ending ? ending : "");
        const char *path = made_path(file);
        GDALDataType type = GDT_Unknown;
        if (!written(driver, path, &type))
            continue;
        outcome o = compare(path);
        if (o.by_gdal && !o.opened && o.error.status != TC_ERR_UNSUPPORTED)
            print_message("%s: %s\n", name, o.error.text), wrong++;
        if (o.opened && o.differing > 0)
            print_message("%s: %d samples differ from GDAL's\n", name, o.differing), wrong++;
        if (strchr(o.error.text, '\n'))
            print_message("%s: more than a line: %s\n", name, o.error.text), wrong++;
        opened += o.opened;
        const char *why = strstr(o.error.text, ": ");
        if (out)
            fprintf(out, "| %s | %s | %s | %s |\n", name, ending && *ending ? ending : "", GDALGetDataTypeName(type),
                    o.opened     ? "opens"
                    : !o.by_gdal ? "not read back by GDAL itself at this size"
                    : why        ? why + 2
                                 : o.error.text);
        VSIRmdirRecursive(path);
        VSIUnlink(path);
    }
    CPLPopErrorHandler();
    if (out)
        fclose(out);
    print_message("%d formats open\n", opened);
    assert_int_equal(wrong, 0);
    assert_true(opened >= 10);
    char **left = VSIReadDir(made_folder()); /* side files */
    for (char **file = left; file && *file; file++)
        if ((*file)[0] != '.')
            VSIUnlink(made_path(*file)), VSIRmdirRecursive(made_path(*file));
    CSLDestroy(left);
}

/* A file that is placed by control points alone has no place here; it says so, and how to come by one. */
static void control_points(void **state)
{
    (void)state;
    const char *path = made_path("points.tif");
    GDALDatasetH to = GDALCreate(GDALGetDriverByName("GTiff"), path, WIDTH, HEIGHT, 1, GDT_Int16, NULL);
    GDALDatasetH like = make(GDT_Int16);
    assert_non_null(to);
    assert_int_equal(GDALDatasetCopyWholeRaster(like, to, NULL, NULL, NULL), CE_None);
    GDAL_GCP point[4];
    GDALInitGCPs(4, point);
    for (int k = 0; k < 4; k++) {
        point[k].dfGCPPixel = k % 2 * WIDTH, point[k].dfGCPLine = k / 2 * HEIGHT;
        point[k].dfGCPX = 8 + k % 2, point[k].dfGCPY = 47 - k / 2;
    }
    assert_int_equal(GDALSetGCPs2(to, 4, point, GDALGetSpatialRef(like)), CE_None);
    GDALClose(to);
    GDALClose(like);
    GDALDeinitGCPs(4, point);
    sayings said;
    tc_grid g = load(path, (tc_source_options){0}, &said);
    assert_true(strstr(said.text, "no georeference but control points") && g.spacing_x == 1);
    tc_grid_free(&g);
}

int main(void)
{
    GDALAllRegister();
    const struct CMUnitTest tests[] = {cmocka_unit_test(control_points),
                                       cmocka_unit_test(formats_open_as_gdal_reads_them)};
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}

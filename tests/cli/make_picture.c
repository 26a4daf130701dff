/* make_picture.c - make-picture: pictures of places for the command-line tests, by GDAL, and what they show.
 *
 *   make-picture make FILE [NAME=VALUE]...
 *   make-picture at FILE X Y             the colour of a pixel: RED GREEN BLUE
 *   make-picture differ A B              mean difference of two pictures' colours, of 255
 *   make-picture spoil FILE X Y          damages the block of a TIFF that holds the pixel
 *
 * NAME:  size=WxH (300x200), driver=NAME (GTiff), co=KEY=VALUE (a creation option), overviews=N (halves),
 *        crs=DEF at=X,Y,DX,DY: the north-west corner and the pixels' sides, of that system; turn=DEGREES around the
 * corner, gcp=1: told by control points, named=0: without the system; none of it: a picture without a place,
 *        colour=RRGGBB; else waves of longitude and latitude, the same in every system (of the picture's own columns
 * and rows where it has no place), hole=1: nothing in the middle third, by alpha; nodata=V: there instead. Rows are
 * made as they are written: pictures of any size take little memory. */
#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 64, EVERY = 16 }; /* columns between places that are asked for */

typedef struct request {
    int width, height, overviews;
    char driver[32], crs[256];
    double at[4], turn;
    bool placed, gcp, nameless, hole;
    int nodata;  /* -1: none */
    long colour; /* -1: waves */
    char **options;
} request;

static void die(const char *what)
{
    fprintf(stderr, "make-picture: %s: %s\n", what, CPLGetLastErrorMsg());
    exit(2);
}

static void read_setting(request *r, const char *text)
{
    int gcp = 0, named = 1, hole = 0;
    if (sscanf(text, "size=%dx%d", &r->width, &r->height) == 2 || sscanf(text, "driver=%31s", r->driver) == 1 ||
        sscanf(text, "overviews=%d", &r->overviews) == 1 || sscanf(text, "turn=%lf", &r->turn) == 1 ||
        sscanf(text, "crs=%255[^\n]", r->crs) == 1 || sscanf(text, "nodata=%d", &r->nodata) == 1 ||
        sscanf(text, "colour=%lx", (unsigned long *)&r->colour) == 1)
        return;
    if (sscanf(text, "at=%lf,%lf,%lf,%lf", &r->at[0], &r->at[1], &r->at[2], &r->at[3]) == 4)
        r->placed = true;
    else if (sscanf(text, "gcp=%d", &gcp) == 1)
        r->gcp = gcp;
    else if (sscanf(text, "named=%d", &named) == 1)
        r->nameless = !named;
    else if (sscanf(text, "hole=%d", &hole) == 1)
        r->hole = hole;
    else if (strncmp(text, "co=", 3) == 0)
        r->options = CSLAddString(r->options, text + 3);
    else
        die(text);
}

static OGRSpatialReferenceH system_of(const char *name)
{
    OGRSpatialReferenceH crs = OSRNewSpatialReference(NULL);
    if (OSRSetFromUserInput(crs, name) != OGRERR_NONE)
        die(name);
    OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

static void transform_of(const request *r, double t[6])
{
    double c = cos(r->turn * M_PI / 180), s = sin(r->turn * M_PI / 180);
    const double turned[6] = {r->at[0], c * r->at[2], s * r->at[3], r->at[1], s * r->at[2], -c * r->at[3]};
    memcpy(t, turned, sizeof turned);
}

static void place(const request *r, GDALDatasetH d)
{
    double t[6];
    OGRSpatialReferenceH crs = system_of(r->crs);
    transform_of(r, t);
    if (r->gcp) {
        GDAL_GCP point[9];
        GDALInitGCPs(9, point);
        for (int k = 0; k < 9; k++) {
            double i = k % 3 * 0.5 * r->width, j = k / 3 * 0.5 * r->height;
            point[k].dfGCPPixel = i, point[k].dfGCPLine = j;
            point[k].dfGCPX = t[0] + i * t[1] + j * t[2], point[k].dfGCPY = t[3] + i * t[4] + j * t[5];
        }
        GDALSetGCPs2(d, 9, point, crs);
        GDALDeinitGCPs(9, point);
    } else {
        GDALSetGeoTransform(d, t);
        if (!r->nameless)
            GDALSetSpatialRef(d, crs);
    }
    OSRDestroySpatialReference(crs);
}

/* Longitude and latitude all along a row: asked for here and there, and straight between. some: room for what is asked.
 */
static void places_of_row(const request *r, OGRCoordinateTransformationH to_degrees, int row, double *some, double *x,
                          double *y)
{
    double t[6], *sx = some, *sy = some + r->width + EVERY;
    int asked = (r->width - 1) / EVERY + 2;
    transform_of(r, t);
    for (int k = 0; k < asked; k++) {
        double i = (double)k * EVERY + 0.5, j = row + 0.5;
        sx[k] = t[0] + i * t[1] + j * t[2], sy[k] = t[3] + i * t[4] + j * t[5];
    }
    if (!OCTTransform(to_degrees, asked, sx, sy, NULL))
        die("a place");
    for (int i = 0; i < r->width; i++) {
        int k = i / EVERY;
        double u = (double)(i % EVERY) / EVERY;
        x[i] = sx[k] + u * (sx[k + 1] - sx[k]), y[i] = sy[k] + u * (sy[k + 1] - sy[k]);
    }
}

/* By a table, or large pictures would take minutes. */
static uint8_t wave(double phase)
{
    enum { STEPS = 4096 };
    static uint8_t table[STEPS];
    for (int k = 0; k < STEPS && !table[STEPS - 1]; k++)
        table[k] = (uint8_t)(128 + 110 * sin(2 * M_PI * k / STEPS));
    return table[llrint(phase * (STEPS / (2 * M_PI))) & (STEPS - 1)];
}

static void make_row(const request *r, OGRCoordinateTransformationH to_degrees, int row, double *room, uint8_t *pixels,
                     int bands)
{
    double *x = room, *y = x + r->width;
    if (to_degrees)
        places_of_row(r, to_degrees, row, y + r->width, x, y);
    for (int i = 0; i < r->width; i++) {
        uint8_t *p = pixels + (size_t)i * (size_t)bands;
        double a = to_degrees ? 40 * x[i] : 9.0 * i / r->width, b = to_degrees ? 40 * y[i] : 9.0 * row / r->height;
        bool middle =
            i >= r->width / 3 && i < r->width - r->width / 3 && row >= r->height / 3 && row < r->height - r->height / 3;
        if (r->colour >= 0)
            p[0] = (uint8_t)(r->colour >> 16), p[1] = (uint8_t)(r->colour >> 8), p[2] = (uint8_t)r->colour;
        else
            p[0] = wave(a), p[1] = wave(b + 1), p[2] = wave(a * 0.7 - b * 0.6);
        if (bands == 4)
            p[3] = middle ? 0 : 255;
        if (r->nodata >= 0 && middle)
            p[0] = p[1] = p[2] = (uint8_t)r->nodata;
    }
}

static void make_file(const char *path, const request *r)
{
    const int bands = r->hole ? 4 : 3;
    GDALDriverH driver = GDALGetDriverByName(r->driver);
    bool direct = driver && GDALGetMetadataItem(driver, GDAL_DCAP_CREATE, NULL);
    GDALDatasetH d = GDALCreate(direct ? driver : GDALGetDriverByName("MEM"), path, r->width, r->height, bands,
                                GDT_Byte, direct ? r->options : NULL);
    if (!driver || !d)
        die(path);
    OGRCoordinateTransformationH to_degrees = NULL;
    if (r->placed) {
        OGRSpatialReferenceH own = system_of(r->crs), degrees = system_of("EPSG:4326");
        if (r->colour < 0) {
            CPLPushErrorHandler(CPLQuietErrorHandler);
            to_degrees = OCTNewCoordinateTransformation(own, degrees);
            CPLPopErrorHandler();
        }
        place(r, d);
        OSRDestroySpatialReference(own);
        OSRDestroySpatialReference(degrees);
    }
    for (int band = 1; band <= bands && !direct; band++)
        GDALSetRasterColorInterpretation(GDALGetRasterBand(d, band), (GDALColorInterp)(GCI_RedBand + band - 1));
    for (int band = 1; band <= bands && r->nodata >= 0; band++)
        GDALSetRasterNoDataValue(GDALGetRasterBand(d, band), r->nodata);
    const size_t row_bytes = (size_t)r->width * (size_t)bands;
    uint8_t *rows = malloc(row_bytes * ROWS);
    double *room = malloc((4 * (size_t)r->width + 2 * EVERY) * sizeof *room);
    for (int top = 0; top < r->height; top += ROWS) {
        int count = r->height - top < ROWS ? r->height - top : ROWS;
        for (int k = 0; k < count; k++)
            make_row(r, to_degrees, top + k, room, rows + (size_t)k * row_bytes, bands);
        if (GDALDatasetRasterIO(d, GF_Write, 0, top, r->width, count, rows, r->width, count, GDT_Byte, bands, NULL,
                                bands, (int)row_bytes, 1) != CE_None)
            die(path);
    }
    free(rows), free(room);
    if (!direct) {
        GDALDatasetH copy = GDALCreateCopy(driver, path, d, FALSE, r->options, NULL, NULL);
        if (!copy)
            die(path);
        GDALClose(copy);
    }
    int factors[30];
    for (int k = 0; k < r->overviews && k < 30; k++)
        factors[k] = 2 << k;
    if (r->overviews && GDALBuildOverviews(d, "AVERAGE", r->overviews, factors, 0, NULL, NULL, NULL) != CE_None)
        die(path);
    GDALClose(d);
}

/* All pixels, red, green and blue. */
static uint8_t *pixels_of(const char *path, int *width_ret, int *height_ret)
{
    GDALDatasetH d = GDALOpen(path, GA_ReadOnly);
    if (!d)
        die(path);
    int w = *width_ret = GDALGetRasterXSize(d), h = *height_ret = GDALGetRasterYSize(d);
    uint8_t *pixels = malloc((size_t)w * (size_t)h * 3);
    if (GDALDatasetRasterIO(d, GF_Read, 0, 0, w, h, pixels, w, h, GDT_Byte, 3, NULL, 3, 3 * w, 1) != CE_None)
        die(path);
    GDALClose(d);
    return pixels;
}

static void show_pixel(const char *path, int x, int y)
{
    int w, h;
    uint8_t *pixels = pixels_of(path, &w, &h), *p = pixels + 3 * ((size_t)y * (size_t)w + (size_t)x);
    if (x < 0 || x >= w || y < 0 || y >= h)
        die("a pixel within the picture");
    printf("%d %d %d\n", p[0], p[1], p[2]);
    free(pixels);
}

static void show_difference(const char *a, const char *b)
{
    int w, h, other_w, other_h;
    uint8_t *p = pixels_of(a, &w, &h), *q = pixels_of(b, &other_w, &other_h);
    double sum = 0;
    if (w != other_w || h != other_h)
        die("pictures of one size");
    for (size_t i = 0; i < (size_t)w * (size_t)h * 3; i++)
        sum += abs(p[i] - q[i]);
    printf("%.3f\n", sum / (3.0 * w * h));
    free(p), free(q);
}

static void spoil(const char *path, int x, int y)
{
    GDALDatasetH d = GDALOpen(path, GA_ReadOnly);
    int w, h;
    if (!d)
        die(path);
    GDALRasterBandH band = GDALGetRasterBand(d, 1);
    GDALGetBlockSize(band, &w, &h);
    const char *at = GDALGetMetadataItem(band, CPLSPrintf("BLOCK_OFFSET_%d_%d", x / w, y / h), "TIFF");
    long offset = at ? atol(at) : 0;
    GDALClose(d);
    FILE *file = fopen(path, "r+b");
    static const char damage[] = "This is no pixel, nor any block of such, and least of all a whole number of them.";
    if (!file || offset <= 0 || fseek(file, offset, SEEK_SET) != 0 || fwrite(damage, sizeof damage, 1, file) != 1 ||
        fclose(file) != 0)
        die(path);
}

int main(int argc, char **argv)
{
    GDALAllRegister();
    CPLSetConfigOption("GDAL_CACHEMAX", "64");
    if (argc >= 3 && strcmp(argv[1], "make") == 0) {
        request r = {.width = 300, .height = 200, .driver = "GTiff", .nodata = -1, .colour = -1};
        for (int i = 3; i < argc; i++)
            read_setting(&r, argv[i]);
        make_file(argv[2], &r);
        CSLDestroy(r.options);
    } else if (argc == 5 && strcmp(argv[1], "at") == 0) {
        show_pixel(argv[2], atoi(argv[3]), atoi(argv[4]));
    } else if (argc == 4 && strcmp(argv[1], "differ") == 0) {
        show_difference(argv[2], argv[3]);
    } else if (argc == 5 && strcmp(argv[1], "spoil") == 0) {
        spoil(argv[2], atoi(argv[3]), atoi(argv[4]));
    } else {
        fprintf(stderr, "make-picture: expected make FILE, at FILE X Y, differ A B or spoil FILE X Y\n");
        return 2;
    }
    return 0;
}

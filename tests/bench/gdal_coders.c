/* gdal_coders.c - the codecs of GDAL's drivers for heights. What a machine offers is asked of the drivers' own lists of
 * options. */
#include "coders.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How a bound of the error is kept. */
typedef enum bound_way {
    BY_QUANTISING, /* heights are coded as multiples of the largest step that keeps it, without loss */
    BY_OPTION      /* the codec keeps it */
} bound_way;

/* What a format holds beside integers of 32 bits. */
typedef enum holding { FLOATS, INTEGERS, INTEGERS32 /* no others */, UNSIGNED16 /* nothing else at all */ } holding;

typedef struct format {
    const char *driver;
    const char *compress; /* a value of the option COMPRESS; NULL: the driver has no such option */
    bound_way bound;
    holding holds;
    const char *options[6]; /* of creation; P: predictor of integers or floats; %: the bound in units of what is coded;
                               Q: per cent for the rate; R: reversible or not; N: number of resolutions; H: height */
} format;

#define TILED "TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256"
#define PREDICTED(COMPRESS, LEVEL)                                                                                     \
    {                                                                                                                  \
        "GTiff", COMPRESS, BY_QUANTISING, FLOATS,                                                                      \
        {                                                                                                              \
            TILED, "PREDICTOR=P", LEVEL                                                                                \
        }                                                                                                              \
    }
#define LERC(COMPRESS, ...)                                                                                            \
    {                                                                                                                  \
        "GTiff", COMPRESS, BY_OPTION, FLOATS,                                                                          \
        {                                                                                                              \
            "MAX_Z_ERROR=%", __VA_ARGS__                                                                               \
        }                                                                                                              \
    }
#define PLAIN(DRIVER, COMPRESS, HOLDS, ...)                                                                            \
    {                                                                                                                  \
        DRIVER, COMPRESS, BY_QUANTISING, HOLDS,                                                                        \
        {                                                                                                              \
            __VA_ARGS__                                                                                                \
        }                                                                                                              \
    }
static const format deflate6 = PREDICTED("DEFLATE", "ZLEVEL=6"), deflate9 = PREDICTED("DEFLATE", "ZLEVEL=9"),
                    lzw = PREDICTED("LZW", NULL), lzma = PLAIN("GTiff", "LZMA", FLOATS, TILED),
                    zstd9 = PREDICTED("ZSTD", "ZSTD_LEVEL=9"), zstd19 = PREDICTED("ZSTD", "ZSTD_LEVEL=19");
static const format lerc = LERC("LERC", TILED), lerc_deflate = LERC("LERC_DEFLATE", TILED),
                    lerc_zstd = LERC("LERC_ZSTD", TILED), lerc_zstd_whole = LERC("LERC_ZSTD", "BLOCKYSIZE=H"),
                    mrf_lerc = {"MRF", "LERC", BY_OPTION, FLOATS, {"BLOCKSIZE=256", "OPTIONS=LERC_PREC=%"}};
static const format jxl = PLAIN("GTiff", "JXL", UNSIGNED16, TILED, "JXL_LOSSLESS=YES", "JXL_EFFORT=7"),
                    jp2 = PLAIN("JP2OpenJPEG", NULL, INTEGERS, "QUALITY=Q", "REVERSIBLE=R", "RESOLUTIONS=N"),
                    png = PLAIN("PNG", NULL, UNSIGNED16, "ZLEVEL=9"),
                    mrf_zstd = PLAIN("MRF", "ZSTD", FLOATS, "BLOCKSIZE=256"),
                    mrf_png = PLAIN("MRF", "PNG", UNSIGNED16, "BLOCKSIZE=256"),
                    zarr = PLAIN("Zarr", "BLOSC", FLOATS, "BLOSC_CNAME=zstd", "BLOSC_CLEVEL=9", "BLOSC_SHUFFLE=BIT",
                                 "BLOCKSIZE=256,256"),
                    netcdf = PLAIN("netCDF", "DEFLATE", FLOATS, "FORMAT=NC4", "ZLEVEL=9"),
                    rmf_dem = PLAIN("RMF", "RMF_DEM", INTEGERS32, "MTW=ON");
#undef TILED

/* ---- What is offered -------------------------------------------------------------------------------------------- */

void gdal_coders_set_up(void)
{
    if (GDALGetDriverCount() == 0 || !GDALGetDriverByName("MEM"))
        GDALAllRegister();
    CPLSetConfigOption("GDAL_NUM_THREADS", "1"); /* loading terrains has asked for all processors */
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");
}

/* The part of a driver's list that is about COMPRESS; NULL: there is none. To be freed. */
static char *compress_values(GDALDriverH driver)
{
    const char *list = driver ? GDALGetMetadataItem(driver, GDAL_DMD_CREATIONOPTIONLIST, NULL) : NULL, *begin = NULL;
    static const char *const names[] = {"name='COMPRESS'", "name=\"COMPRESS\""};
    for (int i = 0; list && !begin && i < 2; i++)
        begin = strstr(list, names[i]);
    const char *end = begin ? strstr(begin, "</Option>") : NULL;
    return end ? strndup(begin, (size_t)(end - begin)) : NULL;
}

static bool offered(const coder *c, char why[CODER_WHY])
{
    const format *f = c->format;
    gdal_coders_set_up();
    GDALDriverH driver = GDALGetDriverByName(f->driver);
    if (!driver || (!GDALGetMetadataItem(driver, GDAL_DCAP_CREATECOPY, NULL) &&
                    !GDALGetMetadataItem(driver, GDAL_DCAP_CREATE, NULL))) {
        snprintf(why, CODER_WHY, "GDAL has no driver %s that writes", f->driver);
        return false;
    }
    if (!f->compress)
        return true;
    char value[64], *values = compress_values(driver);
    snprintf(value, sizeof value, ">%s</Value>", f->compress);
    bool found = values && strstr(values, value);
    free(values);
    if (!found)
        snprintf(why, CODER_WHY, "%s does not offer COMPRESS=%s", f->driver, f->compress);
    return found;
}

static bool used(const char *value, size_t length)
{
    for (int n = 0; n < gdal_coders_count; n++) {
        const format *f = gdal_coders[n].format;
        if (f->compress && strcmp(f->driver, "GTiff") == 0 && strlen(f->compress) == length &&
            strncmp(f->compress, value, length) == 0)
            return true;
    }
    return false;
}

const char *gdal_coders_unused(void)
{
    static char unused[512];
    gdal_coders_set_up();
    char *values = compress_values(GDALGetDriverByName("GTiff"));
    *unused = '\0';
    for (const char *v = values; v && (v = strstr(v, "<Value>"));) {
        v += strlen("<Value>");
        size_t length = strcspn(v, "<"), at = strlen(unused);
        if (!used(v, length) && strncmp(v, "NONE", length) != 0)
            snprintf(unused + at, sizeof unused - at, "%s%.*s", at ? " " : "", (int)length, v);
    }
    free(values);
    return unused;
}

/* ---- What is coded ---------------------------------------------------------------------------------------------- */

typedef struct source {
    GDALDatasetH memory;
    char **options;
} source;

static GDALDataType gdal_type(coded_type type)
{
    static const GDALDataType types[] = {[CODED_INT16] = GDT_Int16,
                                         [CODED_UINT16] = GDT_UInt16,
                                         [CODED_INT32] = GDT_Int32,
                                         [CODED_UINT32] = GDT_UInt32,
                                         [CODED_FLOAT32] = GDT_Float32};
    return types[type];
}

/* What GDAL said last, in one line. */
static bool failed(coded *c, const char *what)
{
    snprintf(c->why, sizeof c->why, "%s: %s", what, CPLGetLastErrorMsg());
    for (char *p = c->why; *p; p++)
        if (*p == '\n' || *p == ',')
            *p = ';';
    return false;
}

/* Integers to be coded, their unit settled in *c; NULL: floats are. To be freed. */
static int32_t *integers(coded *c)
{
    const coder_input *in = c->input;
    const format *f = c->coder->format;
    int64_t count = in->grid.width * in->grid.height;
    int32_t *v = malloc((size_t)count * sizeof *v);
    if (!v)
        puts("coders: no memory"), exit(99);
    c->quantised = c->goal.aim == CODER_BOUND && f->bound == BY_QUANTISING;
    if (c->goal.aim == CODER_RATE) {
        memcpy(v, in->image.v, (size_t)count * sizeof *v);
        c->unit = 1.0 / J2K_SCALE, c->base = in->image.base;
    } else if (in->stored) {
        int64_t most = c->quantised ? (int64_t)floor(c->goal.value / in->about.unit * (1 + 1e-9)) : 0;
        for (int64_t i = 0; i < count; i++) {
            int64_t at = in->stored[i] + most, step = 2 * most + 1;
            v[i] = (int32_t)(at >= 0 ? at / step : -((step - 1 - at) / step));
        }
        c->unit = in->about.unit * (double)(2 * most + 1);
    } else if (c->quantised) {
        c->unit = 2 * c->goal.value;
        for (int64_t i = 0; i < count; i++)
            v[i] = (int32_t)fmax(fmin(rint(in->grid.z[i] / c->unit), INT32_MAX / 2), -INT32_MAX / 2);
    } else {
        free(v), v = NULL;
        c->unit = 1;
    }
    return v;
}

/* The smallest type that holds them; unsigned ones are made so where that is asked for. */
static bool settle_type(coded *c, int32_t *v)
{
    const format *f = c->coder->format;
    int64_t count = c->input->grid.width * c->input->grid.height, least = INT32_MAX, most = INT32_MIN;
    for (int64_t i = 0; i < count; i++) {
        least = v[i] < least ? v[i] : least;
        most = v[i] > most ? v[i] : most;
    }
    if (f->holds == UNSIGNED16 && (least < 0 || most > UINT16_MAX)) {
        for (int64_t i = 0; i < count; i++)
            v[i] -= (int32_t)least;
        c->base += (double)least * c->unit, most -= least, least = 0;
    }
    c->type = f->holds == INTEGERS32                           ? CODED_INT32
              : least >= 0 && most <= UINT16_MAX               ? CODED_UINT16
              : least >= INT16_MIN && most <= INT16_MAX        ? CODED_INT16
              : c->goal.aim == CODER_RATE /* from 0 upwards */ ? CODED_UINT32
                                                               : CODED_INT32;
    if (f->holds != UNSIGNED16 || c->type == CODED_UINT16)
        return true;
    snprintf(c->why, sizeof c->why, "more than 16 bits");
    return false;
}

/* An option with what depends on the goal put in. */
static const char *option(const coded *c, const char *text)
{
    static char whole[128];
    const tc_grid *g = &c->input->grid;
    size_t key = strlen(text) - 1; /* of what comes before the last letter */
    double rate = 100 * c->goal.value / c->input->image.precision, bound = c->goal.value;
    bool floats = c->type == CODED_FLOAT32, lossless = c->goal.aim != CODER_RATE;
    switch (text[key] == '%' || (text[key - 1] == '=' && strchr("PQRNH", text[key])) ? text[key] : 0) {
    case 'P': snprintf(whole, sizeof whole, "%.*s%d", (int)key, text, floats ? 3 : 2); break;
    case 'Q': snprintf(whole, sizeof whole, "%.*s%.6g", (int)key, text, lossless ? 100 : fmin(rate, 99)); break;
    case 'R': snprintf(whole, sizeof whole, "%.*s%s", (int)key, text, lossless ? "YES" : "NO"); break;
    case 'N': snprintf(whole, sizeof whole, "%.*s%d", (int)key, text, j2k_resolutions(&c->input->image)); break;
    case 'H': snprintf(whole, sizeof whole, "%.*s%d", (int)key, text, (int)g->height); break;
    case '%': snprintf(whole, sizeof whole, "%.*s%.17g", (int)key, text, bound / (floats ? 1 : c->unit)); break;
    default: return text;
    }
    return whole;
}

static void settle_options(coded *c, source *s)
{
    const format *f = c->coder->format;
    if (f->compress)
        s->options = CSLSetNameValue(s->options, "COMPRESS", f->compress);
    for (int n = 0; n < 6 && f->options[n]; n++)
        s->options = CSLAddString(s->options, option(c, f->options[n]));
    if (c->goal.aim == CODER_RATE && c->input->image.precision != (c->type == CODED_UINT16 ? 16 : 32))
        s->options = CSLSetNameValue(s->options, "NBITS", CPLSPrintf("%d", c->input->image.precision));
}

static bool prepare(coded *c)
{
    const format *f = c->coder->format;
    const tc_grid *g = &c->input->grid;
    int width = (int)g->width, height = (int)g->height;
    source *s = c->source = calloc(1, sizeof *s);
    int32_t *v = integers(c);
    if (!v && f->holds != FLOATS) {
        snprintf(c->why, sizeof c->why, "holds no floats");
        return false;
    }
    c->type = CODED_FLOAT32;
    if (v && !settle_type(c, v)) {
        free(v);
        return false;
    }
    settle_options(c, s);
    s->memory = GDALCreate(GDALGetDriverByName("MEM"), "", width, height, 1, gdal_type(c->type), NULL);
    bool done = s->memory &&
                GDALRasterIO(GDALGetRasterBand(s->memory, 1), GF_Write, 0, 0, width, height,
                             v ? (void *)v : (void *)g->z, width, height, v ? GDT_Int32 : GDT_Float32, 0, 0) == CE_None;
    free(v);
    return done || failed(c, "memory");
}

/* ---- Coding ----------------------------------------------------------------------------------------------------- */

static bool encode(coded *c)
{
    const format *f = c->coder->format;
    source *s = c->source;
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
    GDALDatasetH file =
        GDALCreateCopy(GDALGetDriverByName(f->driver), c->path, s->memory, FALSE, s->options, NULL, NULL);
    if (file)
        GDALClose(file);
    bool done = file && CPLGetLastErrorType() < CE_Failure;
    CPLPopErrorHandler();
    return done || failed(c, f->driver);
}

/* Only its own driver looks at the file, which is quicker than asking all of them. */
static bool read_back(const coded *c, tc_rect rect, void *samples_ret)
{
    const format *f = c->coder->format;
    const char *const drivers[] = {f->driver, NULL};
    int width = (int)(rect.x1 - rect.x0), height = (int)(rect.y1 - rect.y0);
    CPLPushErrorHandler(CPLQuietErrorHandler);
    GDALDatasetH file = GDALOpenEx(c->path, GDAL_OF_READONLY | GDAL_OF_RASTER, drivers, NULL, NULL);
    bool done = file && GDALRasterIO(GDALGetRasterBand(file, 1), GF_Read, (int)rect.x0, (int)rect.y0, width, height,
                                     samples_ret, width, height, gdal_type(c->type), 0, 0) == CE_None;
    if (file)
        GDALClose(file);
    CPLPopErrorHandler();
    return done;
}

static void release(coded *c)
{
    source *s = c->source;
    if (s && s->memory)
        GDALClose(s->memory);
    if (s)
        CSLDestroy(s->options);
    free(s);
}

#define CODER(NAME, LAYOUT, EXTENSION, AIMS, EFFORT, FORMAT)                                                           \
    {                                                                                                                  \
        .name = NAME, .layout = LAYOUT, .extension = EXTENSION, .aims = AIMS, .effort = EFFORT, .format = &FORMAT,     \
        .offered = offered, .prepare = prepare, .encode = encode, .read = read_back, .release = release                \
    }
enum { EXACT = 1 << CODER_LOSSLESS, BOTH = EXACT | 1 << CODER_BOUND };
const coder gdal_coders[] = {
    CODER("jpeg2000-gdal", "tiles 1024", "jp2", EXACT | 1 << CODER_RATE, CODER_ALWAYS, jp2),
    CODER("lerc", "tiles 256", "tif", BOTH, CODER_ALWAYS, lerc),
    CODER("lerc-deflate", "tiles 256", "tif", BOTH, CODER_IN_FULL, lerc_deflate),
    CODER("lerc-zstd", "tiles 256", "tif", BOTH, CODER_ALWAYS, lerc_zstd),
    CODER("lerc-zstd-whole", "one block", "tif", BOTH, CODER_IN_FULL, lerc_zstd_whole),
    CODER("deflate6", "tiles 256", "tif", EXACT, CODER_ALWAYS, deflate6),
    CODER("deflate9", "tiles 256", "tif", BOTH, CODER_ALWAYS, deflate9),
    CODER("lzw", "tiles 256", "tif", EXACT, CODER_ALWAYS, lzw),
    CODER("zstd9", "tiles 256", "tif", BOTH, CODER_ALWAYS, zstd9),
    CODER("zstd19", "tiles 256", "tif", EXACT, CODER_IN_FULL, zstd19),
    CODER("lzma", "tiles 256 no predictor", "tif", EXACT, CODER_IN_FULL, lzma),
    CODER("jxl", "tiles 256", "tif", BOTH, CODER_ALWAYS, jxl),
    CODER("png16", "rows", "png", EXACT, CODER_ALWAYS, png),
    CODER("mrf-lerc", "tiles 256", "mrf", BOTH, CODER_IN_FULL, mrf_lerc),
    CODER("mrf-zstd", "tiles 256", "mrf", EXACT, CODER_IN_FULL, mrf_zstd),
    CODER("mrf-png", "tiles 256", "mrf", EXACT, CODER_IN_FULL, mrf_png),
    CODER("zarr-blosc", "tiles 256", "zarr", EXACT, CODER_IN_FULL, zarr),
    CODER("netcdf4", "chunks by the driver", "nc", EXACT, CODER_IN_FULL, netcdf),
    CODER("rmf-dem", "tiles by the driver", "rsw", EXACT, CODER_IN_FULL, rmf_dem),
};
const int gdal_coders_count = sizeof gdal_coders / sizeof *gdal_coders;

/* test_image_formats.c - pictures of every kind that files hold, as `--imagery` reads them: each pixel is what the file
 * means by its bands, bits, palette, masks and nodata. */
#include "tests/support/test.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/input/image.h"
#include "tests/support/loading.h"

enum { BANDS = 8 };

typedef uint8_t rgba[4];

/* ---- What is stored ----------------------------------------------------------------------------------------------
 */

/* What its numbers mean. */
typedef enum meaning { GREY, INVERTED, RGB, CMYK, ADOBE_CMYK, PALETTE } meaning;

typedef struct picture {
    const char *file, *driver;
    const char *options[8]; /* and NULL */
    meaning meaning;
    int white;       /* the number that is; 0: 255. Above 255: 16 bits */
    bool wide;       /* 16 bits for smaller ones */
    bool alpha;      /* the last band is */
    bool multiplied; /* colours are, by alpha */
    int more;        /* bands that mean nothing */
    bool mask;       /* every third pixel is none */
    int nodata;      /* stored value, of all bands, of every fifth pixel; 0: none */
    int clear, half; /* entries of the palette that are transparent and half so; 0: none */
    bool smooth;     /* for what loses: values that do not jump */
    int off;         /* of a colour, at most, for what loses */
} picture;

static int bands_of(const picture *p)
{
    return (p->meaning == RGB ? 3 : p->meaning == CMYK || p->meaning == ADOBE_CMYK ? 4 : 1) + p->more + p->alpha;
}

/* 0: none. */
static int alpha_of(const picture *p)
{
    return p->alpha ? bands_of(p) : 0;
}

static int white_of(const picture *p)
{
    return p->white ? p->white : 255;
}

/* Stored value of a band (from 1 on) of a pixel. */
static int stored(const picture *p, int band, int x, int y)
{
    int white = white_of(p);
    if (p->nodata && (x + 2 * y) % 5 == 0)
        return p->nodata;
    if (p->smooth)
        return (int)(white * (0.5 + 0.45 * sin(0.03 * x * band + 0.05 * y + band)));
    uint32_t noise = (uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)band * 83492791u;
    noise = (noise ^ noise >> 13) * 0x5bd1e995u;
    noise ^= noise >> 15;
    if (p->multiplied && band != alpha_of(p)) { /* at most its alpha */
        int alpha = stored(p, alpha_of(p), x, y);
        return (int)(noise % (uint32_t)(alpha + 1));
    }
    int value = (int)(noise % (uint32_t)(white + 1));
    return p->nodata && value == p->nodata ? value - 1 : value;
}

static const uint8_t *palette_entry(const picture *p, int index)
{
    static rgba entry;
    entry[0] = (uint8_t)(index * 37 + 11), entry[1] = (uint8_t)(255 - index * 5), entry[2] = (uint8_t)(index * index);
    entry[3] = p->clear && index == p->clear ? 0 : p->half && index == p->half ? 128 : 255;
    return entry;
}

static int eighth(const picture *p, int value)
{
    return (int)floor(value * 255.0 / white_of(p) + 0.5);
}

/* The pixel as it is to be shown; colours where alpha is 0 do not matter. */
static void shown(const picture *p, int x, int y, rgba out)
{
    int v[BANDS + 1];
    const double white = white_of(p);
    for (int band = 1; band <= bands_of(p); band++)
        v[band] = stored(p, band, x, y);
    int alpha = p->alpha ? v[alpha_of(p)] : white_of(p);
    switch (p->meaning) {
    case GREY:
    case INVERTED:
        for (int k = 0; k < 3; k++)
            out[k] = (uint8_t)eighth(p, p->meaning == GREY ? v[1] : white_of(p) - v[1]);
        break;
    case RGB:
        for (int k = 0; k < 3; k++)
            out[k] = (uint8_t)eighth(p, v[k + 1]);
        break;
    case CMYK:
        for (int k = 0; k < 3; k++)
            out[k] = (uint8_t)floor((white - v[k + 1]) / white * (white - v[4]) / white * 255 + 0.5);
        break;
    case ADOBE_CMYK: /* as JPEG has it: inks are stored inverted */
        for (int k = 0; k < 3; k++)
            out[k] = (uint8_t)floor(v[k + 1] * v[4] / 255.0 + 0.5);
        break;
    case PALETTE: memcpy(out, palette_entry(p, v[1]), 4); break;
    }
    if (p->multiplied && alpha > 0)
        for (int k = 0; k < 3; k++)
            out[k] = (uint8_t)floor(fmin(1, v[p->meaning == RGB ? k + 1 : 1] / (double)alpha) * 255 + 0.5);
    if (p->meaning != PALETTE)
        out[3] = (uint8_t)eighth(p, alpha);
    if ((p->mask && (x + y) % 3 == 0) || (p->nodata && v[1] == p->nodata))
        out[3] = 0;
}

/* ---- Files -------------------------------------------------------------------------------------------------------
 */

static GDALColorInterp called(const picture *p, int band)
{
    static const GDALColorInterp cmyk[] = {GCI_CyanBand, GCI_MagentaBand, GCI_YellowBand, GCI_BlackBand};
    if (band == alpha_of(p))
        return GCI_AlphaBand;
    if (p->meaning == RGB && band <= 3)
        return (GDALColorInterp)(GCI_RedBand + band - 1);
    if ((p->meaning == CMYK || p->meaning == ADOBE_CMYK) && band <= 4)
        return cmyk[band - 1];
    return p->meaning == PALETTE ? GCI_PaletteIndex : band == 1 ? GCI_GrayIndex : GCI_Undefined;
}

static GDALDatasetH in_memory(const picture *p)
{
    GDALDataType type = p->wide || p->white > 255 ? GDT_UInt16 : GDT_Byte;
    GDALDatasetH d = GDALCreate(GDALGetDriverByName("MEM"), "", W, H, bands_of(p), type, NULL);
    assert_non_null(d);
    if (p->mask)
        assert_int_equal(GDALCreateDatasetMaskBand(d, GMF_PER_DATASET), CE_None);
    for (int band = 1; band <= bands_of(p); band++) {
        GDALRasterBandH b = GDALGetRasterBand(d, band);
        GDALSetRasterColorInterpretation(b, called(p, band));
        if (p->nodata)
            GDALSetRasterNoDataValue(b, p->nodata);
        if (p->white && p->white != 65535) {
            char bits[8];
            snprintf(bits, sizeof bits, "%d", (int)log2(p->white + 1));
            GDALSetMetadataItem(b, "NBITS", bits, "IMAGE_STRUCTURE");
        }
        int value[COUNT];
        for (int i = 0; i < COUNT; i++)
            value[i] = stored(p, band, i % W, i / W);
        assert_int_equal(GDALRasterIO(b, GF_Write, 0, 0, W, H, value, W, H, GDT_Int32, 0, 0), CE_None);
    }
    if (p->nodata && bands_of(p) == 3) { /* PNG has it of the picture */
        char values[48];
        snprintf(values, sizeof values, "%d %d %d", p->nodata, p->nodata, p->nodata);
        GDALSetMetadataItem(d, "NODATA_VALUES", values, NULL);
    }
    if (p->meaning == PALETTE) {
        GDALColorTableH table = GDALCreateColorTable(GPI_RGB);
        for (int i = 0; i <= white_of(p) && i < 256; i++) {
            const uint8_t *e = palette_entry(p, i);
            GDALSetColorEntry(table, i, &(GDALColorEntry){e[0], e[1], e[2], e[3]});
        }
        GDALSetRasterColorTable(GDALGetRasterBand(d, 1), table);
        GDALDestroyColorTable(table);
    }
    if (p->mask) {
        uint8_t there[COUNT];
        for (int i = 0; i < COUNT; i++)
            there[i] = (i % W + i / W) % 3 ? 255 : 0;
        assert_int_equal(
            GDALRasterIO(GDALGetMaskBand(GDALGetRasterBand(d, 1)), GF_Write, 0, 0, W, H, there, W, H, GDT_Byte, 0, 0),
            CE_None);
    }
    return d;
}

/* False where this GDAL cannot write such a file. */
static bool write_file(const picture *p, const char *path)
{
    GDALDriverH driver = GDALGetDriverByName(p->driver);
    if (!driver)
        return false;
    GDALDatasetH from = in_memory(p);
    GDALDatasetH to = GDALCreateCopy(driver, path, from, FALSE, (char **)p->options, NULL, NULL);
    GDALClose(from);
    if (to)
        GDALClose(to);
    return to != NULL;
}

/* ---- Reading -----------------------------------------------------------------------------------------------------
 */

static char said[1024];

static void hear(void *context, bool warning, const char *line)
{
    (void)context, (void)warning;
    snprintf(said + strlen(said), sizeof said - strlen(said), "%s\n", line);
}

static tc_status open_picture(const char *path, tc_image **image_ret, tc_error *error)
{
    const tc_source_options source = {.say = hear};
    const tc_image_options options = {.source = &source};
    const tc_image_map map = {0};
    *said = '\0';
    return tc_image_open(path, &map, &options, image_ret, error);
}

/* All pixels of a picture of W x H. */
static const rgba *pixels_of(const char *path)
{
    static rgba pixels[COUNT];
    tc_image *image;
    tc_error error = {0};
    memset(pixels, 77, sizeof pixels);
    if (open_picture(path, &image, &error) != TC_OK)
        fail_msg("%s", error.text);
    assert_true(image->level[0].width == W && image->level[0].height == H);
    assert_int_equal(image->read(image, 0, (tc_rect){0, 0, W, H}, pixels, W, &error), TC_OK);
    /* A part of it, with gaps between rows, is the same. */
    rgba part[5 * 9];
    assert_int_equal(image->read(image, 0, (tc_rect){W - 7, 3, W, 8}, part, 9, &error), TC_OK);
    for (int j = 0; j < 5; j++)
        assert_memory_equal(part[j * 9], pixels[(3 + j) * W + W - 7], 7 * 4);
    image->close(image);
    return pixels;
}

/* How many pixels are not as they should be; says the first one. */
static int compare(const picture *p, const rgba *pixels)
{
    int wrong = 0;
    for (int i = 0; i < COUNT; i++) {
        rgba want;
        if (p->smooth && (i % W >= W / 16 * 16 || i / W >= H / 16 * 16))
            continue; /* blocks of 16 that are not whole are filled up with what does not fit the rest */
        shown(p, i % W, i / W, want);
        bool bad = pixels[i][3] != want[3];
        for (int k = 0; k < 3 && want[3] > 0; k++)
            bad |= abs(pixels[i][k] - want[k]) > p->off;
        if (bad && wrong++ == 0)
            print_message("%s: pixel %d, %d: expected %d %d %d %d, found %d %d %d %d\n", p->file, i % W, i / W, want[0],
                          want[1], want[2], want[3], pixels[i][0], pixels[i][1], pixels[i][2], pixels[i][3]);
    }
    return wrong;
}

/* ---- The kinds --------------------------------------------------------------------------------------------------- */

/* clang-format off */
static const picture pictures[] = {
    {"grey.tif", "GTiff", .white = 255},
    {"grey-alpha.tif", "GTiff", .alpha = true},
    {"rgb.tif", "GTiff", .meaning = RGB},
    {"rgb-tiled.tif", "GTiff", {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16", "COMPRESS=LZW"}, .meaning = RGB},
    {"rgb-planar.tif", "GTiff", {"INTERLEAVE=BAND", "COMPRESS=DEFLATE"}, .meaning = RGB},
    {"rgba.tif", "GTiff", .meaning = RGB, .alpha = true},
    {"rgba-tiled.tif", "GTiff", {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"}, .meaning = RGB, .alpha = true},
    {"multiplied.tif", "GTiff", {"ALPHA=PREMULTIPLIED"}, .meaning = RGB, .alpha = true, .multiplied = true},
    {"multiplied-grey.tif", "GTiff", {"ALPHA=PREMULTIPLIED"}, .alpha = true, .multiplied = true},
    {"multiplied16.tif", "GTiff", {"ALPHA=PREMULTIPLIED"}, .meaning = RGB, .white = 65535, .alpha = true, .multiplied = true},
    {"grey16.tif", "GTiff", .white = 65535},
    {"rgb16.tif", "GTiff", .meaning = RGB, .white = 65535},
    {"rgba16.tif", "GTiff", .meaning = RGB, .white = 65535, .alpha = true},
    {"grey12.tif", "GTiff", {"NBITS=12"}, .white = 4095},
    {"rgb12.tif", "GTiff", {"NBITS=12"}, .meaning = RGB, .white = 4095},
    {"grey4.tif", "GTiff", {"NBITS=4"}, .white = 15},
    {"grey2.tif", "GTiff", {"NBITS=2"}, .white = 3},
    {"bits.tif", "GTiff", {"NBITS=1"}, .white = 1},
    {"fax.tif", "GTiff", {"NBITS=1", "COMPRESS=CCITTFAX4"}, .white = 1},
    {"white0-bits.tif", "GTiff", {"NBITS=1", "PHOTOMETRIC=MINISWHITE"}, .meaning = INVERTED, .white = 1},
    {"white0-fax.tif", "GTiff", {"NBITS=1", "PHOTOMETRIC=MINISWHITE", "COMPRESS=CCITTFAX4"}, .meaning = INVERTED, .white = 1},
    {"white0.tif", "GTiff", {"PHOTOMETRIC=MINISWHITE"}, .meaning = INVERTED},
    {"white0-16.tif", "GTiff", {"PHOTOMETRIC=MINISWHITE"}, .meaning = INVERTED, .white = 65535, .off = 1}, /* GDAL cuts */
    {"palette.tif", "GTiff", .meaning = PALETTE},
    {"palette4.tif", "GTiff", {"NBITS=4"}, .meaning = PALETTE, .white = 15},
    {"palette1.tif", "GTiff", {"NBITS=1"}, .meaning = PALETTE, .white = 1},
    {"palette16.tif", "GTiff", .meaning = PALETTE, .white = 250, .wide = true},
    {"palette-nodata.tif", "GTiff", .meaning = PALETTE, .nodata = 9},
    {"palette.png", "PNG", .meaning = PALETTE},
    {"palette-clear.png", "PNG", .meaning = PALETTE, .clear = 5},
    {"palette-half.png", "PNG", .meaning = PALETTE, .clear = 5, .half = 9},
    {"palette.gif", "GIF", .meaning = PALETTE},
    {"palette-clear.gif", "GIF", .meaning = PALETTE, .nodata = 17},
    {"palette.bmp", "BMP", .meaning = PALETTE},
    {"cmyk.tif", "GTiff", {"PHOTOMETRIC=CMYK"}, .meaning = CMYK, .off = 1},
    {"cmyk-planar.tif", "GTiff", {"PHOTOMETRIC=CMYK", "INTERLEAVE=BAND"}, .meaning = CMYK, .off = 1},
    {"cmyk16.tif", "GTiff", {"PHOTOMETRIC=CMYK"}, .meaning = CMYK, .white = 65535, .off = 1},
    {"cmyk.jpg", "JPEG", {"QUALITY=100"}, .meaning = ADOBE_CMYK, .smooth = true, .off = 6},
    {"ycbcr.tif", "GTiff", {"COMPRESS=JPEG", "PHOTOMETRIC=YCBCR", "JPEG_QUALITY=100"}, .meaning = RGB, .smooth = true, .off = 8},
    {"ycbcr-tiled.tif", "GTiff", {"COMPRESS=JPEG", "PHOTOMETRIC=YCBCR", "JPEG_QUALITY=100", "TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"}, .meaning = RGB, .smooth = true, .off = 12},
    {"grey.jpg", "JPEG", {"QUALITY=100"}, .smooth = true, .off = 3},
    {"rgb.jpg", "JPEG", {"QUALITY=100"}, .meaning = RGB, .smooth = true, .off = 8},
    {"mask.jpg", "JPEG", {"QUALITY=100"}, .meaning = RGB, .mask = true, .smooth = true, .off = 8},
    {"mask.tif", "GTiff", .meaning = RGB, .mask = true},
    {"mask-grey16.tif", "GTiff", .white = 65535, .mask = true},
    {"nodata-grey.tif", "GTiff", .nodata = 17},
    {"nodata-rgb.tif", "GTiff", .meaning = RGB, .nodata = 17},
    {"nodata-16.tif", "GTiff", .meaning = RGB, .white = 65535, .nodata = 300},
    {"grey.png", "PNG", .white = 255},
    {"grey-alpha.png", "PNG", .alpha = true},
    {"rgb.png", "PNG", .meaning = RGB},
    {"rgba.png", "PNG", .meaning = RGB, .alpha = true},
    {"rgba16.png", "PNG", .meaning = RGB, .white = 65535, .alpha = true},
    {"bits.png", "PNG", {"NBITS=1"}, .white = 1},
    {"trns-grey.png", "PNG", .nodata = 17},
    {"trns-rgb.png", "PNG", .meaning = RGB, .nodata = 17},
    {"rgb.webp", "WEBP", {"LOSSLESS=YES"}, .meaning = RGB},
    {"rgba.webp", "WEBP", {"LOSSLESS=YES", "EXACT=YES"}, .meaning = RGB, .alpha = true},
    {"rgb.jp2", "JP2OpenJPEG", {"QUALITY=100", "REVERSIBLE=YES", "YCBCR420=NO"}, .meaning = RGB},
    {"rgba.jp2", "JP2OpenJPEG", {"QUALITY=100", "REVERSIBLE=YES", "YCBCR420=NO"}, .meaning = RGB, .alpha = true},
    {"grey16.jp2", "JP2OpenJPEG", {"QUALITY=100", "REVERSIBLE=YES"}, .white = 65535},
    {"grey12.jp2", "JP2OpenJPEG", {"QUALITY=100", "REVERSIBLE=YES", "NBITS=12"}, .white = 4095},
    {"bands5.tif", "GTiff", {"PHOTOMETRIC=RGB"}, .meaning = RGB, .more = 2},
    {"bands5-alpha.tif", "GTiff", {"PHOTOMETRIC=RGB"}, .meaning = RGB, .alpha = true, .more = 1},
    {"bands7.tif", "GTiff", {"PHOTOMETRIC=RGB", "INTERLEAVE=BAND"}, .meaning = RGB, .white = 65535, .more = 4},
};
/* clang-format on */

static void pixels_are_what_the_file_means(void **state)
{
    (void)state;
    int wrong = 0, not_written = 0;
    for (size_t k = 0; k < sizeof pictures / sizeof *pictures; k++) {
        const picture *p = &pictures[k];
        const char *path = made_path(p->file);
        CPLPushErrorHandler(CPLQuietErrorHandler);
        bool written = write_file(p, path);
        CPLPopErrorHandler();
        if (!written) {
            print_message("%s: cannot be written here: %s\n", p->file, CPLGetLastErrorMsg());
            not_written++;
            continue;
        }
        wrong += compare(p, pixels_of(path)) > 0;
        VSIUnlink(path);
        VSIUnlink(CPLSPrintf("%s.aux.xml", path));
        VSIUnlink(CPLSPrintf("%s.msk", path));
    }
    assert_int_equal(wrong, 0);
    assert_true(not_written <= 4); /* what the GDAL of another machine may lack: GIF, WEBP, JPEG 2000 */
    assert_int_equal(made_folder_count(), 0);
}

/* ---- VRT ---------------------------------------------------------------------------------------------------------
 */

static void write_text(const char *path, const char *text)
{
    make_bytes(path, text, strlen(text));
}

/* A VRT of W x H, its bands as given. */
static const char *write_vrt(const char *name, const char *bands)
{
    static char text[8192];
    const char *path = made_path(name);
    snprintf(text, sizeof text, "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\">%s</VRTDataset>", W, H, bands);
    write_text(path, text);
    return path;
}

/* Columns x0 on of a band of a file, as many, at the same place. */
static const char *part_of(const char *file, int band, int x0, int count)
{
    static char text[8][512];
    static int next;
    char *t = text[next++ % 8];
    snprintf(t, sizeof text[0],
             "<SimpleSource><SourceFilename relativeToVRT=\"1\">%s</SourceFilename><SourceBand>%d</SourceBand>"
             "<SrcRect xOff=\"%d\" yOff=\"0\" xSize=\"%d\" ySize=\"%d\"/><DstRect xOff=\"%d\" yOff=\"0\" "
             "xSize=\"%d\" ySize=\"%d\"/></SimpleSource>",
             file, band, x0, count, H, x0, count, H);
    return t;
}

/* Two pictures with a gap between them, which is nodata by a number of its own in each band. */
static void vrt_of_two(void **state)
{
    (void)state;
    const picture p = {"two.vrt", "GTiff", .meaning = RGB};
    static char bands[8000];
    *bands = '\0';
    assert_true(write_file(&p, made_path("left.tif")) && write_file(&p, made_path("right.tif")));
    for (int k = 1; k <= 3; k++) {
        static const char *const names[] = {"Red", "Green", "Blue"};
        snprintf(
            bands + strlen(bands), sizeof bands - strlen(bands),
            "<VRTRasterBand dataType=\"Byte\" band=\"%d\"><NoDataValue>%d</NoDataValue><ColorInterp>%s</ColorInterp>"
            "%s%s</VRTRasterBand>",
            k, 10 + k, names[k - 1], part_of("left.tif", k, 0, 15), part_of("right.tif", k, 20, W - 20));
    }
    const rgba *found = pixels_of(write_vrt("two.vrt", bands));
    for (int i = 0; i < COUNT; i++) {
        rgba want;
        int x = i % W, y = i / W;
        shown(&p, x, y, want);
        want[3] = (x >= 15 && x < 20) || (want[0] == 11 && want[1] == 12 && want[2] == 13) ? 0 : 255;
        assert_int_equal(found[i][3], want[3]);
        if (want[3])
            assert_memory_equal(found[i], want, 3); /* also where one band happens to store its nodata */
    }
}

/* Bands are what they are called, in whatever order and type. */
static void vrt_of_mixed_bands(void **state)
{
    (void)state;
    const picture eight = {"eight.tif", "GTiff", .white = 255}, sixteen = {"sixteen.tif", "GTiff", .white = 65535};
    assert_true(write_file(&eight, made_path(eight.file)) && write_file(&sixteen, made_path(sixteen.file)));
    static const struct {
        const char *called, *type, *file;
    } order[] = {{"Blue", "Byte", "eight.tif"},
                 {"Alpha", "UInt16", "sixteen.tif"},
                 {"Red", "UInt16", "sixteen.tif"},
                 {"Green", "Byte", "eight.tif"}};
    static char bands[8000];
    *bands = '\0';
    for (int k = 0; k < 4; k++)
        snprintf(bands + strlen(bands), sizeof bands - strlen(bands),
                 "<VRTRasterBand dataType=\"%s\" band=\"%d\"><ColorInterp>%s</ColorInterp>%s</VRTRasterBand>",
                 order[k].type, k + 1, order[k].called, part_of(order[k].file, 1, 0, W));
    const rgba *found = pixels_of(write_vrt("mixed.vrt", bands));
    for (int i = 0; i < COUNT; i++) {
        rgba a, b;
        shown(&eight, i % W, i / W, a), shown(&sixteen, i % W, i / W, b);
        const rgba want = {b[0], a[0], a[0], b[0]};
        assert_memory_equal(found[i], want, 4);
    }
}

static void bands_that_are_not_called_colours(void **state)
{
    (void)state;
    const picture p = {"plain.tif", "GTiff", {"PHOTOMETRIC=MINISBLACK"}, .more = 2};
    const picture colours = {"", "", .meaning = RGB};
    assert_true(write_file(&p, made_path(p.file)));
    assert_int_equal(compare(&colours, pixels_of(made_path(p.file))), 0);
    assert_non_null(strstr(said, "3 bands of which none is called red, green or blue"));
    const picture two = {"pair.tif", "GTiff", {"ALPHA=NO"}, .more = 1}, grey = {"", "", .white = 255};
    assert_true(write_file(&two, made_path(two.file)));
    assert_int_equal(compare(&grey, pixels_of(made_path(two.file))), 0);
    assert_non_null(strstr(said, "two bands of which none is called alpha"));
}

/* ---- What is no picture ------------------------------------------------------------------------------------------ */

static void refuses_picture(const char *path, tc_status status, const char *word)
{
    tc_image *image = NULL;
    tc_error error = {0};
    tc_status found = open_picture(path, &image, &error);
    if (found != status || !strstr(error.text, word) || strchr(error.text, '\n') || image)
        fail_msg("%s: expected status %d and \"%s\", found %d: %s", path, (int)status, word, (int)found, error.text);
}

static void measurements_are_refused(void **state)
{
    (void)state;
    static const GDALDataType types[] = {GDT_Int16, GDT_UInt32, GDT_Int32, GDT_Float32, GDT_Float64, GDT_CFloat32};
    for (size_t k = 0; k < sizeof types / sizeof *types; k++)
        for (int bands = 1; bands <= 4; bands += 3) {
            const char *path = made_path("measured.tif");
            GDALClose(GDALCreate(GDALGetDriverByName("GTiff"), path, W, H, bands, types[k], NULL));
            char word[80];
            snprintf(word, sizeof word, "expected colours of 8 or 16 bits, found samples of type %s",
                     GDALGetDataTypeName(types[k]));
            refuses_picture(path, TC_ERR_UNSUPPORTED, word);
        }
}

/* ---- By OpenImageIO ---------------------------------------------------------------------------------------------- */

static void tga(void **state)
{
    (void)state;
    for (int channels = 3; channels <= 4; channels++) {
        const picture p = {"a.tga", "", .meaning = RGB, .alpha = channels == 4};
        static uint8_t samples[COUNT * 4];
        for (int i = 0; i < COUNT * channels; i++)
            samples[i] = (uint8_t)stored(&p, i % channels + 1, i / channels % W, i / channels / W);
        make_tga(made_path("a.tga"), W, H, channels, samples);
        assert_int_equal(compare(&p, pixels_of(made_path("a.tga"))), 0);
    }
    cut_file(made_path("a.tga"), 900);
    refuses_picture(made_path("a.tga"), TC_ERR_FORMAT, "a.tga: ");
}

/* As shown, of light. */
static double of_light(double light)
{
    light = fmin(fmax(light, 0), 1);
    return 255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055);
}

/* OpenEXR holds light, times alpha. */
static void exr(void **state)
{
    (void)state;
    static float samples[COUNT * 4];
    for (int i = 0; i < COUNT; i++) {
        float alpha = (float)(i % 5) / 4, *s = samples + 4 * i;
        s[0] = alpha, s[1] = alpha * (float)(i % 97) / 96, s[2] = alpha * (float)(i % 31) / 20;
        s[3] = i % 7 ? alpha * (float)(i / W) / H : NAN;
    }
    make_exr_channels(made_path("a.exr"), W, H, "ABGR", samples);
    const rgba *found = pixels_of(made_path("a.exr"));
    for (int i = 0; i < COUNT; i++) {
        const float *s = samples + 4 * i;
        assert_true(fabs(found[i][3] - 255 * s[0]) <= 0.51);
        for (int k = 0; k < 3 && s[0] > 0; k++) {
            float light = s[3 - k] / s[0];
            assert_true(fabs(found[i][k] - (isnan(light) ? 0 : of_light(light))) <= 0.51);
        }
    }
    static float grey[COUNT];
    for (int i = 0; i < COUNT; i++)
        grey[i] = (float)(1.2 * i / COUNT - 0.1);
    make_exr(made_path("grey.exr"), W, H, grey);
    found = pixels_of(made_path("grey.exr"));
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < 4; k++)
            assert_true(fabs(found[i][k] - (k < 3 ? of_light(grey[i]) : 255)) <= 0.51);
    cut_file(made_path("grey.exr"), -100); /* which OpenEXR does not notice */
    refuses_picture(made_path("grey.exr"), TC_ERR_FORMAT, "damaged or truncated");
}

int main(void)
{
    GDALAllRegister();
    const struct CMUnitTest tests[] = {cmocka_unit_test(pixels_are_what_the_file_means),
                                       cmocka_unit_test(vrt_of_two),
                                       cmocka_unit_test(vrt_of_mixed_bands),
                                       cmocka_unit_test(bands_that_are_not_called_colours),
                                       cmocka_unit_test(measurements_are_refused),
                                       cmocka_unit_test(tga),
                                       cmocka_unit_test(exr)};
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}

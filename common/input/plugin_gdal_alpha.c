/* plugin_gdal_alpha.c - whether a picture's colours are stored times alpha. GDAL (3.6) does not tell it of TIFF, whose
 * tag ExtraSamples does: 1 is such an alpha, 2 one that leaves colours alone. */
#include "plugin_gdal_image.h"

#include <cpl_string.h>
#include <cpl_vsi.h>

#include <string.h>

enum { EXTRA_SAMPLES = 338, SHORT = 3, MOST_ENTRIES = 4096, MOST_EXTRA = 16 };

typedef struct tiff {
    VSILFILE *file;
    bool little, big; /* byte order; BigTIFF */
} tiff;

static bool read_at(const tiff *t, uint64_t at, void *bytes, size_t count)
{
    return VSIFSeekL(t->file, at, SEEK_SET) == 0 && VSIFReadL(bytes, 1, count, t->file) == count;
}

static uint64_t number(const tiff *t, const uint8_t *bytes, int count)
{
    uint64_t value = 0;
    for (int k = 0; k < count; k++)
        value |= (uint64_t)bytes[t->little ? k : count - 1 - k] << 8 * k;
    return value;
}

/* Whether an entry of a directory, the one of extra samples, names such an alpha. */
static bool names_multiplied(const tiff *t, const uint8_t *entry)
{
    int wide = t->big ? 8 : 4;
    uint64_t count = number(t, entry + 4, wide);
    uint8_t far[2 * MOST_EXTRA];
    const uint8_t *values = entry + 4 + wide;
    if (number(t, entry + 2, 2) != SHORT)
        return false;
    count = count < MOST_EXTRA ? count : MOST_EXTRA;
    if (2 * count > (uint64_t)wide) {
        if (!read_at(t, number(t, values, wide), far, 2 * (size_t)count))
            return false;
        values = far;
    }
    for (uint64_t k = 0; k < count; k++) {
        uint64_t kind = number(t, values + 2 * k, 2);
        if (kind == 1 || kind == 2)
            return kind == 1;
    }
    return false;
}

static bool tiff_multiplied(tiff *t)
{
    uint8_t head[16], entry[20];
    if (!read_at(t, 0, head, sizeof head))
        return false;
    t->little = head[0] == 'I';
    t->big = number(t, head + 2, 2) == 43;
    int wide = t->big ? 8 : 4, size = t->big ? 20 : 12;
    uint64_t at = number(t, head + (t->big ? 8 : 4), wide);
    if (!read_at(t, at, head, t->big ? 8 : 2))
        return false;
    uint64_t entries = number(t, head, t->big ? 8 : 2);
    at += t->big ? 8 : 2;
    for (uint64_t k = 0; k < entries && k < MOST_ENTRIES; k++) {
        if (!read_at(t, at + k * (uint64_t)size, entry, (size_t)size))
            return false;
        if (number(t, entry, 2) == EXTRA_SAMPLES)
            return names_multiplied(t, entry);
    }
    return false;
}

bool tc_gdal_alpha_multiplied(GDALDatasetH dataset, int alpha)
{
    const char *of_band = GDALGetMetadataItem(GDALGetRasterBand(dataset, alpha), "ALPHA", "IMAGE_STRUCTURE"),
               *of_all = GDALGetMetadataItem(dataset, "ALPHA", "IMAGE_STRUCTURE"), *how = of_band ? of_band : of_all;
    GDALDriverH driver = GDALGetDatasetDriver(dataset);
    if (how || !driver || !EQUAL(GDALGetDriverShortName(driver), "GTiff"))
        return how && EQUAL(how, "PREMULTIPLIED");
    tiff t = {.file = VSIFOpenL(GDALGetDescription(dataset), "rb")};
    bool multiplied = t.file && tiff_multiplied(&t);
    if (t.file)
        VSIFCloseL(t.file);
    return multiplied;
}

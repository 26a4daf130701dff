/* plugin_gdal_pixels.c - a raster's bands as colours: which of them are red, green, blue and alpha, and pixels by that.
 *
 * Palettes are looked up; grey is all three; CMYK is brought to RGB as paper without a profile would show it; more bits
 * than eight are cut to eight. Where a pixel is nodata, masked or transparent its alpha tells. */
#include "plugin_gdal_image.h"

#include "common/base/status.h"

#include <cpl_string.h>

#include <stdlib.h>
#include <string.h>

/* ---- Which bands ------------------------------------------------------------------------------------------------- */

static GDALColorInterp meaning_of(GDALDatasetH dataset, int band)
{
    return GDALGetRasterColorInterpretation(GDALGetRasterBand(dataset, band));
}

/* The first band of a meaning; 0: none. */
static int band_of(GDALDatasetH dataset, GDALColorInterp meaning)
{
    for (int band = 1; band <= GDALGetRasterCount(dataset); band++)
        if (meaning_of(dataset, band) == meaning)
            return band;
    return 0;
}

/* Bands that all of these meanings have; false where one is missing. */
static bool bands_of(GDALDatasetH dataset, const GDALColorInterp *meaning, int count, int *band)
{
    for (int k = 0; k < count; k++)
        if (!(band[k] = band_of(dataset, meaning[k])))
            return false;
    return true;
}

static void choose_bands(GDALDatasetH dataset, const tc_source_options *options, tc_gdal_pixels *p)
{
    static const GDALColorInterp rgb[] = {GCI_RedBand, GCI_GreenBand, GCI_BlueBand};
    static const GDALColorInterp cmyk[] = {GCI_CyanBand, GCI_MagentaBand, GCI_YellowBand, GCI_BlackBand};
    int bands = GDALGetRasterCount(dataset), colours;
    p->alpha = band_of(dataset, GCI_AlphaBand);
    colours = bands - (p->alpha > 0);
    p->kind = TC_PIXELS_RGB, p->count = 3;
    if (bands_of(dataset, cmyk, 4, p->band)) {
        p->kind = TC_PIXELS_CMYK, p->count = 4;
    } else if (bands_of(dataset, rgb, 3, p->band)) {
        if (colours > 3)
            tc_say(options, false, "%d bands: red, green and blue are %d, %d and %d of them", bands, p->band[0],
                   p->band[1], p->band[2]);
    } else if (colours >= 3) {
        for (int k = 0, band = 1; k < 3; band++)
            if (band != p->alpha)
                p->band[k++] = band;
        tc_say(options, true, "%d bands of which none is called red, green or blue: the first three are taken for them",
               bands);
    } else {
        p->band[0] = p->alpha == 1 ? 2 : 1;
        p->kind = TC_PIXELS_GREY, p->count = 1;
        if (colours > 1)
            tc_say(options, true, "two bands of which none is called alpha: the first one is shown, as grey");
    }
}

/* ---- What their numbers mean ------------------------------------------------------------------------------------- */

static bool read_palette(GDALRasterBandH band, tc_gdal_pixels *p)
{
    GDALColorTableH table = GDALGetRasterColorTable(band);
    if (!table || GDALGetPaletteInterpretation(table) != GPI_RGB)
        return false;
    int entries = GDALGetColorEntryCount(table);
    p->entries = entries < 65536 ? entries : 65536;
    p->palette = calloc((size_t)p->entries + 1, sizeof *p->palette); /* the last one: what has no entry, transparent */
    for (int i = 0; p->palette && i < p->entries; i++) {
        const GDALColorEntry *e = GDALGetColorEntry(table, i);
        const short rgba[4] = {e->c1, e->c2, e->c3, e->c4};
        for (int k = 0; k < 4; k++)
            p->palette[i][k] = (uint8_t)(rgba[k] < 0 ? 0 : rgba[k] > 255 ? 255 : rgba[k]);
    }
    return p->palette != NULL;
}

/* The number that is white; 0: the band's are none that could be colours. */
static double white_of(GDALRasterBandH band)
{
    GDALDataType type = GDALGetRasterDataType(band);
    const char *bits = GDALGetMetadataItem(band, "NBITS", "IMAGE_STRUCTURE");
    int count = bits ? atoi(bits) : 0, all = type == GDT_Byte ? 8 : 16;
    if (type != GDT_Byte && type != GDT_UInt16)
        return 0;
    return (double)((1 << (count > 0 && count <= all ? count : all)) - 1);
}

/* White of all bands that are read, and whether colours are stored times alpha. */
static tc_status choose_white(const char *name, GDALDatasetH dataset, tc_gdal_pixels *p, tc_error *error)
{
    for (int k = 0; k < 5; k++) {
        int number = k == 4 ? p->alpha : k < p->count ? p->band[k] : 0;
        GDALRasterBandH band = number ? GDALGetRasterBand(dataset, number) : NULL;
        if (band && !(p->white[k] = white_of(band)))
            return tc_fail(error, TC_ERR_UNSUPPORTED,
                           "%s: expected colours of 8 or 16 bits, found samples of type %s: heights or measurements?",
                           name, GDALGetDataTypeName(GDALGetRasterDataType(band)));
    }
    p->multiplied = p->alpha && tc_gdal_alpha_multiplied(dataset, p->alpha);
    return TC_OK;
}

/* Which mask tells where there is no colour. */
static void choose_mask(GDALDatasetH dataset, tc_gdal_pixels *p)
{
    int flags = GDALGetMaskFlags(GDALGetRasterBand(dataset, p->band[0]));
    p->masks = p->alpha || (flags & GMF_ALL_VALID) ? 0 : (flags & GMF_PER_DATASET) ? 1 : p->count;
}

tc_status tc_gdal_pixels_of(const char *name, GDALDatasetH dataset, const tc_source_options *options,
                            tc_gdal_pixels *pixels_ret, tc_error *error)
{
    tc_gdal_pixels p = {0};
    if (GDALGetRasterCount(dataset) < 1)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected a picture, found none in it", name);
    choose_bands(dataset, options, &p);
    GDALRasterBandH first = GDALGetRasterBand(dataset, p.band[0]);
    tc_status status = choose_white(name, dataset, &p, error);
    if (status != TC_OK)
        return status;
    if (p.kind == TC_PIXELS_GREY && read_palette(first, &p))
        p.kind = TC_PIXELS_PALETTE;
    if (p.kind != TC_PIXELS_PALETTE && p.white[0] > 255)
        tc_say(options, false, "%s: more than 8 bits a colour: 0 is taken for black, %.0f for white", name, p.white[0]);
    choose_mask(dataset, &p);
    *pixels_ret = p;
    return TC_OK;
}

void tc_gdal_pixels_free(tc_gdal_pixels *pixels)
{
    free(pixels->palette);
    pixels->palette = NULL;
}

/* ---- Reading ------------------------------------------------------------------------------------------------------
 */

/* A band of the raster or of one of its overviews. */
static GDALRasterBandH band_at(GDALDatasetH dataset, int band, int overview)
{
    GDALRasterBandH b = GDALGetRasterBand(dataset, band);
    return overview < 0 ? b : GDALGetOverview(b, overview);
}

/* What a band stores. */
static bool read_wide(GDALRasterBandH band, tc_rect r, uint16_t *wide)
{
    int w = (int)(r.x1 - r.x0), h = (int)(r.y1 - r.y0);
    return GDALRasterIO(band, GF_Read, (int)r.x0, (int)r.y0, w, h, wide, w, h, GDT_UInt16, 0, 0) == CE_None;
}

/* Component k of the pixels as eight bits, whose white is white[which]. alpha: what is stored of it, where colours
 * are to be divided by it. */
static bool read_component(const tc_gdal_pixels *p, GDALRasterBandH band, int which, tc_rect r, uint16_t *wide,
                           const uint16_t *alpha, uint8_t (*rgba)[4], ptrdiff_t stride, int k)
{
    int x = (int)r.x0, y = (int)r.y0, w = (int)(r.x1 - r.x0), h = (int)(r.y1 - r.y0);
    const double scale = 255 / p->white[which];
    if (p->white[which] == 255 && !alpha)
        return GDALRasterIO(band, GF_Read, x, y, w, h, &rgba[0][k], w, h, GDT_Byte, 4, (int)(4 * stride)) == CE_None;
    if (!read_wide(band, r, wide))
        return false;
    for (int j = 0; j < h; j++)
        for (int i = 0; i < w; i++) {
            size_t n = (size_t)j * (size_t)w + (size_t)i;
            double v = wide[n] * scale;
            if (alpha)
                v = alpha[n] > 0 ? v * p->white[4] / alpha[n] : 0;
            rgba[j * stride + i][k] = (uint8_t)(v > 254.5 ? 255 : v + 0.5);
        }
    return true;
}

static bool read_palette_pixels(const tc_gdal_pixels *p, GDALRasterBandH band, tc_rect r, uint16_t *wide,
                                uint8_t (*rgba)[4], ptrdiff_t stride)
{
    int w = (int)(r.x1 - r.x0), h = (int)(r.y1 - r.y0);
    if (!read_wide(band, r, wide))
        return false;
    for (int j = 0; j < h; j++)
        for (int i = 0; i < w; i++) {
            int index = wide[(size_t)j * (size_t)w + (size_t)i];
            memcpy(rgba[j * stride + i], p->palette[index < p->entries ? index : p->entries], 4);
        }
    return true;
}

/* Alpha from masks: a pixel is there where any of them says so. */
static bool read_masks(const tc_gdal_pixels *p, GDALDatasetH dataset, int overview, tc_rect r, uint8_t *mask,
                       uint8_t (*rgba)[4], ptrdiff_t stride)
{
    int w = (int)(r.x1 - r.x0), h = (int)(r.y1 - r.y0);
    bool palette = p->kind == TC_PIXELS_PALETTE;
    uint8_t *any = mask + (size_t)w * (size_t)h;
    memset(any, 0, (size_t)w * (size_t)h);
    for (int k = 0; k < p->masks; k++) {
        GDALRasterBandH band = GDALGetMaskBand(band_at(dataset, p->band[k], overview));
        if (GDALRasterIO(band, GF_Read, (int)r.x0, (int)r.y0, w, h, mask, w, h, GDT_Byte, 0, 0) != CE_None)
            return false;
        for (int i = 0; i < w * h; i++)
            any[i] = mask[i] > any[i] ? mask[i] : any[i];
    }
    for (int j = 0; j < h; j++)
        for (int i = 0; i < w; i++) {
            uint8_t there = any[(size_t)j * (size_t)w + (size_t)i], *a = &rgba[j * stride + i][3];
            *a = palette && there ? *a : there;
        }
    return true;
}

static void from_cmyk(uint8_t pixel[4])
{
    int black = 255 - pixel[3];
    for (int k = 0; k < 3; k++)
        pixel[k] = (uint8_t)(((255 - pixel[k]) * black + 127) / 255);
}

/* Why pixels cannot be read: messages of the threads that decode many blocks at once are lost, so that a pixel of each
 * is read until one fails here. */
static void find_damage(const tc_gdal_pixels *p, GDALDatasetH dataset, int overview, tc_rect r, tc_gdal_messages *said)
{
    for (int k = 0; k <= p->count; k++) {
        int number = k < p->count ? p->band[k] : p->alpha, w, h;
        GDALRasterBandH band = number ? band_at(dataset, number, overview) : NULL;
        if (!band)
            continue;
        GDALGetBlockSize(band, &w, &h);
        for (int64_t y = r.y0; y < r.y1 && h > 0; y = (y / h + 1) * h)
            for (int64_t x = r.x0; x < r.x1 && w > 0; x = (x / w + 1) * w) {
                uint16_t pixel;
                if (GDALRasterIO(band, GF_Read, (int)x, (int)y, 1, 1, &pixel, 1, 1, GDT_UInt16, 0, 0) || *said->failure)
                    return;
            }
    }
}

bool tc_gdal_pixels_read(const tc_gdal_pixels *p, GDALDatasetH dataset, int overview, tc_rect r, uint8_t (*rgba)[4],
                         ptrdiff_t stride, tc_gdal_messages *said)
{
    size_t pixels = (size_t)((r.x1 - r.x0) * (r.y1 - r.y0));
    uint16_t *wide = malloc((p->multiplied ? 2 : 1) * pixels * sizeof *wide); /* also two masks */
    uint16_t *alpha = p->multiplied && wide ? wide + pixels : NULL;
    bool good = wide && (!alpha || read_wide(band_at(dataset, p->alpha, overview), r, alpha));
    if (good && p->kind == TC_PIXELS_PALETTE)
        good = read_palette_pixels(p, band_at(dataset, p->band[0], overview), r, wide, rgba, stride);
    for (int k = 0; k < p->count && good && p->kind != TC_PIXELS_PALETTE; k++)
        good = read_component(p, band_at(dataset, p->band[k], overview), k, r, wide, alpha, rgba, stride, k);
    for (int64_t j = 0; j < r.y1 - r.y0 && good; j++)
        for (int64_t i = 0; i < r.x1 - r.x0; i++) {
            uint8_t *pixel = rgba[j * stride + i];
            if (p->kind == TC_PIXELS_GREY)
                pixel[1] = pixel[2] = pixel[0];
            else if (p->kind == TC_PIXELS_CMYK)
                from_cmyk(pixel);
            if (p->kind != TC_PIXELS_PALETTE)
                pixel[3] = 255;
        }
    if (good && p->alpha)
        good = read_component(p, band_at(dataset, p->alpha, overview), 4, r, wide, NULL, rgba, stride, 3);
    if (good && p->masks)
        good = read_masks(p, dataset, overview, r, (uint8_t *)wide, rgba, stride);
    if (!good && wide && !*said->failure)
        find_damage(p, dataset, overview, r, said);
    free(wide);
    return good;
}

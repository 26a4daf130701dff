/* lerc.c - LERC by GDAL. */
#include "lerc.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char path[] = "/vsimem/lerc.tif";

static void must(bool done, const char *what)
{
    if (!done) {
        fprintf(stderr, "LERC: %s failed\n", what);
        exit(99);
    }
}

int64_t lerc_bytes(const tc_grid *grid, double unit, double max_error)
{
    int width = (int)grid->width, height = (int)grid->height;
    size_t count = (size_t)width * (size_t)height;
    int32_t *v = malloc(count * sizeof *v), *back = malloc(count * sizeof *back);
    must(v && back, "memory");
    for (size_t i = 0; i < count; i++)
        v[i] = (int32_t)lrint(grid->z[i] / unit);

    GDALAllRegister();
    GDALDriverH tiff = GDALGetDriverByName("GTiff");
    const char *about = tiff ? GDALGetMetadataItem(tiff, GDAL_DMD_CREATIONOPTIONLIST, NULL) : NULL;
    int64_t bytes = 0;
    if (about && strstr(about, "LERC_ZSTD")) {
        GDALDatasetH memory = GDALCreate(GDALGetDriverByName("MEM"), "", width, height, 1, GDT_Int32, NULL);
        must(memory && GDALRasterIO(GDALGetRasterBand(memory, 1), GF_Write, 0, 0, width, height, v, width, height,
                                    GDT_Int32, 0, 0) == CE_None,
             "writing");
        char **options = CSLSetNameValue(NULL, "COMPRESS", "LERC_ZSTD");
        options = CSLSetNameValue(options, "MAX_Z_ERROR", CPLSPrintf("%.17g", max_error / unit));
        options = CSLSetNameValue(options, "BLOCKYSIZE", CPLSPrintf("%d", height)); /* one block: the fewest bytes */
        GDALDatasetH file = GDALCreateCopy(tiff, path, memory, FALSE, options, NULL, NULL);
        CSLDestroy(options);
        GDALClose(memory);
        must(file != NULL, "encoding");
        GDALClose(file);
        VSIStatBufL stat;
        must(VSIStatL(path, &stat) == 0 && (file = GDALOpen(path, GA_ReadOnly)), "opening");
        bytes = (int64_t)stat.st_size;
        must(GDALRasterIO(GDALGetRasterBand(file, 1), GF_Read, 0, 0, width, height, back, width, height, GDT_Int32, 0,
                          0) == CE_None,
             "reading");
        GDALClose(file);
        VSIUnlink(path);
        for (size_t i = 0; i < count; i++)
            must(abs(v[i] - back[i]) * unit <= max_error * 1.000001, "keeping the bound");
    }
    free(v), free(back);
    return bytes;
}

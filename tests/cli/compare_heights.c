/* compare_heights.c - compare-heights: whether two elevation files hold the same samples in the same place.
 *
 *   compare-heights A B [SETTING]...
 *
 * SETTING: at=X,Y: B is the part of A whose north-west sample is column X, row Y of A; within=M: heights may differ by
 * M metres; stored: also the samples' type, unit and nodata value are to be the same; nowhere: places are not compared.
 * Prints the first difference and ends with 1. */
#include "common/input/source.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct file {
    const char *path;
    tc_source *source;
    const tc_source_info *info;
    float *z;
    uint8_t *voids;
} file;

static file load(const char *path)
{
    file f = {.path = path};
    tc_error error;
    if (tc_source_open(path, NULL, &f.source, &error) == TC_OK) {
        f.info = tc_source_get_info(f.source);
        size_t samples = (size_t)(f.info->width * f.info->height);
        f.z = malloc(samples * sizeof *f.z);
        f.voids = malloc(samples);
        if (f.z && f.voids && tc_source_read(f.source, 0, f.info->height, f.z, f.voids, &error) == TC_OK)
            return f;
    }
    printf("compare-heights: %s\n", error.text);
    exit(99);
}

static int differ(const char *what, double a, double b)
{
    printf("%s: %.17g and %.17g\n", what, a, b);
    return 1;
}

/* Type, unit, offset, nodata. */
static int compare_storage(const tc_source_info *a, const tc_source_info *b)
{
    if (a->type != b->type) {
        printf("types: %s and %s\n", a->sample_type, b->sample_type);
        return 1;
    }
    if (a->unit != b->unit)
        return differ("unit", a->unit, b->unit);
    if (a->offset != b->offset)
        return differ("offset", a->offset, b->offset);
    if (a->has_nodata != b->has_nodata || (a->has_nodata && a->nodata != b->nodata))
        return differ("nodata", a->has_nodata ? a->nodata : NAN, b->has_nodata ? b->nodata : NAN);
    return 0;
}

static int compare_place(const tc_source_info *a, const tc_source_info *b, int x, int y)
{
    const double *t = a->georef.transform, *u = b->georef.transform;
    if (a->georef.known != b->georef.known)
        return differ("georeference known", a->georef.known, b->georef.known);
    if (a->georef.geographic != b->georef.geographic)
        return differ("geographic", a->georef.geographic, b->georef.geographic);
    if (!a->georef.crs_wkt != !b->georef.crs_wkt)
        return differ("coordinate system", a->georef.crs_wkt != NULL, b->georef.crs_wkt != NULL);
    if (a->georef.known && a->area_registered != b->area_registered)
        return differ("area-registered", a->area_registered, b->area_registered);
    for (int k = 0; k < 6; k++) {
        double wanted = k % 3 ? t[k] : t[k] + x * t[k + 1] + y * t[k + 2];
        if (a->georef.known && fabs(wanted - u[k]) > 1e-6 * hypot(t[1], t[5]))
            return differ("transform", wanted, u[k]);
    }
    return 0;
}

int main(int argc, char **argv)
{
    int x = 0, y = 0, stored = 0, nowhere = 0;
    double within = 0;
    for (int i = 3; i < argc; i++)
        if (strcmp(argv[i], "stored") == 0)
            stored = 1;
        else if (strcmp(argv[i], "nowhere") == 0)
            nowhere = 1;
        else if (sscanf(argv[i], "at=%d,%d", &x, &y) != 2 && sscanf(argv[i], "within=%lf", &within) != 1)
            argc = 0;
    if (argc < 3) {
        fprintf(stderr, "compare-heights: expected A B [at=X,Y] [within=M] [stored] [nowhere]\n");
        return 2;
    }
    file a = load(argv[1]), b = load(argv[2]);
    bool part = x > 0 || y > 0;
    if (part ? x + b.info->width > a.info->width || y + b.info->height > a.info->height
             : a.info->width != b.info->width || a.info->height != b.info->height) {
        printf("sizes: %" PRId64 " x %" PRId64 " and %" PRId64 " x %" PRId64 "\n", a.info->width, a.info->height,
               b.info->width, b.info->height);
        return 1;
    }
    if ((stored && compare_storage(a.info, b.info)) || (!nowhere && compare_place(a.info, b.info, x, y)))
        return 1;
    for (int64_t row = 0; row < b.info->height; row++)
        for (int64_t column = 0; column < b.info->width; column++) {
            int64_t i = (a.info->height - 1 - (row + y)) * a.info->width + column + x;
            int64_t k = (b.info->height - 1 - row) * b.info->width + column;
            double za = a.z[i] + a.info->z_base, zb = b.z[k] + b.info->z_base;
            if (a.voids[i] == b.voids[k] && (a.voids[i] || fabs(za - zb) <= within))
                continue;
            printf("column %" PRId64 ", row %" PRId64 ": %s %.9g and %s %.9g\n", column, row,
                   a.voids[i] ? "void" : "height", za, b.voids[k] ? "void" : "height", zb);
            return 1;
        }
    tc_source_close(a.source);
    tc_source_close(b.source);
    free(a.z);
    free(a.voids);
    free(b.z);
    free(b.voids);
    return 0;
}

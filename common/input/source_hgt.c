/* source_hgt.c - .hgt, the format of SRTM tiles: big-endian int16 heights, rows north to south, -32768 void, and
 * nothing else.
 *
 * The size says how many samples there are, the file's name where they lie (N46E008: the south-west sample; tiles share
 * their border samples with their neighbours). GDAL reads it too, but only by that name; here a file that was renamed
 * opens as well, its place unknown, and so simple a file needs no library. */
#include "source_internal.h"

#include "common/base/status.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* The tiles there are: 3", 1", and 1" beyond 50 degrees north, where columns are 2" apart. */
static const struct {
    int width, height;
} tiles[] = {{1201, 1201}, {3601, 3601}, {1801, 3601}};

static const char wgs84[] = "GEOGCRS[\"WGS 84\",DATUM[\"World Geodetic System 1984\","
                            "ELLIPSOID[\"WGS 84\",6378137,298.257223563,LENGTHUNIT[\"metre\",1]]],"
                            "PRIMEM[\"Greenwich\",0,ANGLEUNIT[\"degree\",0.0174532925199433]],CS[ellipsoidal,2],"
                            "AXIS[\"geodetic latitude (Lat)\",north,ORDER[1],ANGLEUNIT[\"degree\",0.0174532925199433]],"
                            "AXIS[\"geodetic longitude (Lon)\",east,ORDER[2],ANGLEUNIT[\"degree\",0.0174532925199433]],"
                            "ID[\"EPSG\",4326]]";

typedef struct hgt_raster {
    tc_raster base;
    FILE *file;
    char path[];
} hgt_raster;

static tc_status read_rows(tc_raster *raster, int64_t row, int64_t rows, void *samples, uint8_t *mask, tc_error *error)
{
    (void)mask;
    hgt_raster *r = (hgt_raster *)raster;
    int64_t width = r->base.info.width;
    size_t count = (size_t)(rows * width);
    if (fseeko(r->file, (off_t)(row * width * 2), SEEK_SET) != 0 || fread(samples, 2, count, r->file) != count)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be read to its end: %s", r->path,
                       ferror(r->file) ? strerror(errno) : "it has become shorter");
    uint16_t *s = samples;
    for (size_t i = 0; i < count; i++) {
        unsigned char bytes[2];
        memcpy(bytes, s + i, 2);
        s[i] = (uint16_t)(bytes[0] << 8 | bytes[1]);
    }
    return TC_OK;
}

static void close_raster(tc_raster *raster)
{
    hgt_raster *r = (hgt_raster *)raster;
    fclose(r->file);
    free(r->base.info.crs_wkt);
    free(r);
}

/* N46E008..., in either case: degrees of the south-west sample. */
static bool parse_name(const char *path, int *latitude, int *longitude)
{
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    for (int i = 0; i < 7; i++)
        if (i != 0 && i != 3 && !isdigit((unsigned char)name[i]))
            return false;
    int ns = toupper((unsigned char)name[0]), ew = toupper((unsigned char)name[3]);
    if ((ns != 'N' && ns != 'S') || (ew != 'E' && ew != 'W'))
        return false;
    *latitude = 10 * (name[1] - '0') + (name[2] - '0');
    *longitude = 100 * (name[4] - '0') + 10 * (name[5] - '0') + (name[6] - '0');
    *latitude = ns == 'S' ? -*latitude : *latitude;
    *longitude = ew == 'W' ? -*longitude : *longitude;
    return *latitude >= -90 && *latitude < 90 && *longitude >= -180 && *longitude < 180;
}

static void settle_place(tc_raster_info *info, const char *path, const tc_source_options *options)
{
    static const double radians = 0.017453292519943295, equator = 6378137;
    double dx = 1. / (double)(info->width - 1), dy = 1. / (double)(info->height - 1);
    int latitude = 0, longitude = 0;
    if (!parse_name(path, &latitude, &longitude)) {
        info->nominal_x = dx * radians * equator;
        info->nominal_y = dy * radians * equator;
        if (options->spacing <= 0)
            tc_say(
                options, true,
                "the file's name says no place (as N46E008.hgt would): samples taken %.0f arc-s apart on the equator",
                3600 * dy);
        return;
    }
    /* Samples are points on the degree lines; GDAL's transform is that of pixel corners, half a sample outside. */
    const double transform[6] = {longitude - dx / 2, dx, 0, latitude + 1 + dy / 2, 0, -dy};
    memcpy(info->transform, transform, sizeof transform);
    info->has_transform = true;
    info->crs = TC_CRS_GEOGRAPHIC;
    info->crs_unit = radians;
    info->semi_major = equator;
    info->inverse_flattening = 298.257223563;
    info->crs_wkt = strdup(wgs84);
}

tc_status tc_hgt_open(const char *path, const tc_source_options *options, bool *recognised, tc_raster **raster_ret,
                      tc_error *error)
{
    *recognised = false;
    const char *dot = strrchr(path, '.');
    if (!dot || strcasecmp(dot, ".hgt") != 0)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: not an .hgt file", path);
    *recognised = true;
    FILE *file = fopen(path, "rb");
    struct stat about;
    if (!file || fstat(fileno(file), &about) != 0) {
        int why = errno;
        if (file)
            fclose(file);
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(why));
    }
    size_t tile = 0;
    const size_t count = sizeof tiles / sizeof *tiles;
    while (tile < count && about.st_size != (off_t)tiles[tile].width * tiles[tile].height * 2)
        tile++;
    if (tile == count) {
        fclose(file);
        return tc_fail(
            error, TC_ERR_FORMAT,
            "%s: damaged or truncated: expected 2884802, 12967202 or 25934402 bytes (SRTM tiles), found %lld", path,
            (long long)about.st_size);
    }
    hgt_raster *r = calloc(1, sizeof *r + strlen(path) + 1);
    if (!r) {
        fclose(file);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
    }
    r->file = file;
    strcpy(r->path, path);
    r->base.read = read_rows;
    r->base.close = close_raster;
    r->base.info = (tc_raster_info){.width = tiles[tile].width,
                                    .height = tiles[tile].height,
                                    .type = TC_SAMPLE_INT16,
                                    .type_name = "int16",
                                    .integer = true,
                                    .block_rows = 1,
                                    .has_nodata = true,
                                    .nodata = -32768,
                                    .scale = 1,
                                    .unit_name = "m"};
    settle_place(&r->base.info, path, options);
    *raster_ret = &r->base;
    return TC_OK;
}

/* source_hgt.c - .hgt, the format of SRTM tiles: big-endian int16 heights, rows north to south, -32768 void, and
 * nothing else.
 *
 * The size says how many samples there are, the file's name where they lie (N46E008: the south-west sample; tiles share
 * their border samples with their neighbours). GDAL reads it too, but only by that name and in few sizes; here a file
 * that was renamed opens as well, its place unknown, and so simple a file needs no library.
 *
 * A name is understood whole or not at all: N45W074T86 is not where N45W074 is. */
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

static const char wgs84[] = "GEOGCRS[\"WGS 84\",DATUM[\"World Geodetic System 1984\","
                            "ELLIPSOID[\"WGS 84\",6378137,298.257223563,LENGTHUNIT[\"metre\",1]]],"
                            "PRIMEM[\"Greenwich\",0,ANGLEUNIT[\"degree\",0.0174532925199433]],CS[ellipsoidal,2],"
                            "AXIS[\"geodetic latitude (Lat)\",north,ORDER[1],ANGLEUNIT[\"degree\",0.0174532925199433]],"
                            "AXIS[\"geodetic longitude (Lon)\",east,ORDER[2],ANGLEUNIT[\"degree\",0.0174532925199433]],"
                            "ID[\"EPSG\",4326]]";

typedef struct hgt_raster {
    tc_raster base;
    FILE *file;
    void *bytes; /* that it reads; NULL: a file on disk */
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
    free(r->bytes);
    free(r->base.info.crs_wkt);
    free(r);
}

/* ---- Size ------------------------------------------------------------------------------------------------------- */

/* Any square, and tiles whose columns are farther apart than their rows, since meridians converge: SRTM's beyond 50
 * degrees of latitude, with half the columns, and those cut from models whose columns thin out poleward as those of
 * Copernicus do. None of these has a square number of samples, and no two the same, so that a size has one reading. */
static bool find_size(int64_t bytes, int64_t *width_ret, int64_t *height_ret)
{
    static const int heights[] = {3601, 1201};
    static const struct {
        int columns, rows;
    } shares[] = {{2, 3}, {1, 2}, {1, 3}, {1, 5}, {1, 10}};
    int64_t samples = bytes / 2, side = llrint(sqrt((double)samples));
    if (bytes % 2 != 0)
        return false;
    *width_ret = *height_ret = side;
    if (side >= 2 && side * side == samples)
        return true;
    for (size_t h = 0; h < sizeof heights / sizeof *heights; h++)
        for (size_t s = 0; s < sizeof shares / sizeof *shares; s++) {
            *height_ret = heights[h];
            *width_ret = (heights[h] - 1) / shares[s].rows * shares[s].columns + 1;
            if (*width_ret * *height_ret == samples)
                return true;
        }
    return false;
}

/* Whether so many samples are likely to be those of a degree: minutes fall on samples, as in every tile that is known.
 */
static bool is_degree(const tc_raster_info *info)
{
    return (info->height - 1) % 60 == 0;
}

/* ---- Name ------------------------------------------------------------------------------------------------------- */

typedef struct place {
    double south, west, extent; /* degrees, of the border samples */
} place;

/* Takes a letter and digits off the front of *text; the second letter is that of negative degrees. */
static bool take_degrees(const char **text, const char letters[2], int digits, int *degrees_ret)
{
    const char *t = *text;
    int letter = toupper((unsigned char)t[0]), degrees = 0;
    if (letter != letters[0] && letter != letters[1])
        return false;
    for (int i = 1; i <= digits; i++) {
        if (!isdigit((unsigned char)t[i]))
            return false;
        degrees = 10 * degrees + (t[i] - '0');
    }
    *text = t + 1 + digits;
    *degrees_ret = letter == letters[1] ? -degrees : degrees;
    return true;
}

/* A word behind the place that leaves it what it is: the product, its version, its kind, or its spacing, which must
 * then be the file's. */
static bool is_known_word(const char *word, size_t length, const tc_raster_info *info)
{
    static const struct {
        const char *text;
        int height; /* samples; 0: any */
    } words[] = {{"SRTMGL1", 3601}, {"SRTMGL3", 1201}, {"SRTMGL3S", 1201}, {"SRTM1", 3601},
                 {"SRTM3", 1201},   {"NASADEM", 3601}, {"1arc", 3601},     {"3arc", 1201},
                 {"DEM", 0},        {"DSM", 0},        {"DTM", 0}};
    size_t digits = strspn(word, "0123456789");
    if (length > 0 && digits == length)
        return strtoll(word, NULL, 10) == info->height;
    if (length > 1 && toupper((unsigned char)word[0]) == 'V' && strspn(word + 1, "0123456789") == length - 1)
        return true;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strlen(words[i].text) == length && strncasecmp(words[i].text, word, length) == 0)
            return words[i].height == 0 || words[i].height == info->height;
    return false;
}

/* .SRTMGL1, _7201, _1arc_v3 and the like. */
static bool is_known_ending(const char *text, size_t length, const tc_raster_info *info)
{
    static const char marks[] = "._-";
    for (size_t i = 0; i < length;) {
        size_t word = i + 1;
        if (!strchr(marks, text[i]))
            return false;
        for (i = word; i < length && !strchr(marks, text[i]);)
            i++;
        if (!is_known_word(text + word, i - word, info))
            return false;
    }
    return true;
}

/* T86: Radio Mobile's tiles of 1/3 arc-second, nine by nine to a degree, here the eighth from the south and the sixth
 * from the west. */
static bool is_ninth(const char *text, size_t length, const tc_raster_info *info)
{
    return length == 3 && toupper((unsigned char)text[0]) == 'T' && text[1] >= '1' && text[1] <= '9' &&
           text[2] >= '1' && text[2] <= '9' && info->width == 1201 && info->height == 1201;
}

/* The place that a name says. *begun: it begins with one, whatever follows. */
static bool parse_name(const char *path, const tc_raster_info *info, place *place_ret, bool *begun)
{
    const char *text = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    int latitude, longitude;
    *begun = false;
    if (!take_degrees(&text, "NS", 2, &latitude))
        return false;
    text += *text == '_'; /* n46_e008 */
    if (!take_degrees(&text, "EW", 3, &longitude))
        return false;
    *begun = true;
    if (latitude < -90 || latitude >= 90 || longitude < -180 || longitude >= 180)
        return false;
    *place_ret = (place){latitude, longitude, 1};
    size_t length = strlen(text) - strlen(".hgt");
    if (is_ninth(text, length, info))
        *place_ret = (place){latitude + (text[1] - '1') / 9., longitude + (text[2] - '1') / 9., 1 / 9.};
    else if (!is_known_ending(text, length, info))
        return false;
    return true;
}

static const double equator = 6378137;

static void settle_nowhere(tc_raster_info *info, bool begun, const tc_source_options *options)
{
    const char *why = begun ? " that is understood" : " (as N46E008.hgt would)";
    double dx = 1. / (double)(info->width - 1), dy = 1. / (double)(info->height - 1);
    bool degree = is_degree(info);
    info->nominal_x = degree ? dx * TC_RADIANS_PER_DEGREE * equator : 1;
    info->nominal_y = degree ? dy * TC_RADIANS_PER_DEGREE * equator : 1;
    if (options->spacing > 0)
        return;
    if (degree)
        tc_say(options, true,
               "the file's name says no place%s: samples taken %.4g x %.4g arc-s apart on the equator; --spacing sets "
               "the distance",
               why, 3600 * dx, 3600 * dy);
    else
        tc_say(options, true, "the file's name says no place%s: samples taken 1 m apart; --spacing sets the distance",
               why);
}

static void settle_place(tc_raster_info *info, const char *path, const tc_source_options *options)
{
    place at;
    bool begun;
    if (!parse_name(path, info, &at, &begun)) {
        settle_nowhere(info, begun, options);
        return;
    }
    double dx = at.extent / (double)(info->width - 1), dy = at.extent / (double)(info->height - 1);
    if (at.extent < 1)
        tc_say(options, false, "the file's name says a ninth of a degree, from %.6f degrees north and %.6f east",
               at.south, at.west);
    else if (!is_degree(info))
        tc_say(options, true,
               "%lld x %lld samples are taken for the whole degree of the file's name, but no such tiles are known: it "
               "may be truncated",
               (long long)info->width, (long long)info->height);
    /* Samples are points on the degree lines; GDAL's transform is that of pixel corners, half a sample outside. */
    const double transform[6] = {at.west - dx / 2, dx, 0, at.south + at.extent + dy / 2, 0, -dy};
    memcpy(info->transform, transform, sizeof transform);
    info->has_transform = true;
    info->crs = TC_CRS_GEOGRAPHIC;
    info->crs_unit = TC_RADIANS_PER_DEGREE;
    info->semi_major = equator;
    info->inverse_flattening = 298.257223563;
    info->crs_wkt = strdup(wgs84);
}

/* ---- Opening ---------------------------------------------------------------------------------------------------- */

/* Takes the stream of `size` bytes over, and what it reads, freed on closing; NULL: a file. name: that says the place.
 */
static tc_status open_stream(FILE *file, int64_t size, void *bytes, const char *path, const char *name,
                             const tc_source_options *options, tc_raster **raster_ret, tc_error *error)
{
    int64_t width, height;
    hgt_raster *r = find_size(size, &width, &height) ? calloc(1, sizeof *r + strlen(path) + 1) : NULL;
    if (!r) {
        bool odd = size % 2 != 0; /* which no tile has, whatever its sides */
        fclose(file);
        free(bytes);
        if (find_size(size, &width, &height))
            return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: %sexpected a square or known rectangular number of 16-bit samples, found %lld bytes%s",
                       path, odd ? "damaged or truncated: " : "", (long long)size, odd ? "" : "; it may be truncated");
    }
    r->file = file;
    r->bytes = bytes;
    strcpy(r->path, path);
    r->base.read = read_rows;
    r->base.close = close_raster;
    r->base.info = (tc_raster_info){.width = width,
                                    .height = height,
                                    .type = TC_SAMPLE_INT16,
                                    .type_name = "int16",
                                    .integer = true,
                                    .block_rows = 1,
                                    .has_nodata = true,
                                    .nodata = -32768,
                                    .scale = 1,
                                    .unit_name = "m"};
    settle_place(&r->base.info, name, options);
    *raster_ret = &r->base;
    return TC_OK;
}

tc_status tc_hgt_open_bytes(const char *path, const char *name, void *bytes, size_t size,
                            const tc_source_options *options, tc_raster **raster_ret, tc_error *error)
{
    FILE *file = size > 0 ? fmemopen(bytes, size, "rb") : NULL;
    if (file)
        return open_stream(file, (int64_t)size, bytes, path, name, options, raster_ret, error);
    free(bytes);
    return tc_fail(error, TC_ERR_FORMAT, "%s: expected heights, found an empty file", path);
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
    if (file && fstat(fileno(file), &about) == 0)
        return open_stream(file, about.st_size, NULL, path, path, options, raster_ret, error);
    int why = errno;
    if (file)
        fclose(file);
    return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(why));
}

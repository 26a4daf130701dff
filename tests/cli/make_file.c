/* make_file.c - make-file: elevation files for the command-line tests, made byte by byte (tests/support/made_files.h).
 *
 *   make-file FORMAT PATH [NAME=VALUE]...
 *
 * FORMAT: tiff, png, exr, pgm, hgt, jp2 (always 16 x 12 samples of heights=plane).
 * NAME:   size=WxH (1201x1201), type=u8|u16|i16|i32|f32|f64 (i16; of tiff, and u8 or u16 of png),
 *         heights=hills|plane|towers|voids|nan|inf (hills): whole metres above 0; towers are single samples on hills;
 *         the last three are void everywhere but in a few places, nan and inf of floats only; all=1: void everywhere,
 *         tile=N (tiff: square tiles), channels=N, palette=1, place=LON,LAT (tiff: the degree square north-east of it),
 *         metres=M (tiff: projected, M between samples; 30, 0 for no place at all), nodata=V,
 *         from=X,Y: columns and rows of a larger map before this part of it; lift=M: added to all heights,
 *         epsg=N, area=1: of a projected tiff,
 *         globe=LON,W,H: tiff of longitude and latitude, (part of) W x H samples once around from LON on, from pole to
 *         pole; area=1: samples half a row from them. */
#include "tests/support/made_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct request {
    int width, height, tile, channels;
    char type[8], heights[8];
    bool palette, all, placed, area;
    int globe_width, globe_height; /* 0: no globe */
    int from_x, from_y, lift, epsg;
    double longitude, latitude, metres;
    const char *nodata;
} request;

static void usage(const char *what)
{
    fprintf(stderr, "make-file: %s: not understood\n", what);
    exit(2);
}

static double height_at(const request *r, int x, int y)
{
    if (strcmp(r->heights, "plane") == 0)
        return 1000 + 10 * x + y;
    bool valid = !r->all && (x * 7 + y * 13) % 11 == 0;
    if (strcmp(r->heights, "voids") == 0 && !valid)
        return -32768;
    if (strcmp(r->heights, "nan") == 0 && !valid)
        return NAN;
    if (strcmp(r->heights, "inf") == 0 && !valid)
        return (x + y) % 2 ? INFINITY : -INFINITY;
    double u = 6.3 * x / r->width, v = 6.3 * y / r->height;
    double z = 1200 + 700 * sin(u + 0.4) * cos(1.3 * v) + 200 * sin(5 * u + 3 * v) + 60 * cos(17 * v - 11 * u);
    if (strcmp(r->heights, "towers") == 0 && (x * 31 + y * 57) % 1009 == 0)
        z += 20 + (x + y) % 130;
    return strcmp(r->type, "u8") == 0 ? round(z / 10) : round(z);
}

/* All samples in the type asked for. */
static void *make_samples(const request *r)
{
    int channels = r->channels ? r->channels : 1;
    size_t count = (size_t)r->width * (size_t)r->height * (size_t)channels;
    double *samples = malloc(count * sizeof *samples); /* room for any type */
    if (!samples)
        exit(99);
    for (size_t i = 0; i < count; i++) {
        size_t pixel = i / (size_t)channels;
        double z =
            height_at(r, r->from_x + (int)(pixel % (size_t)r->width), r->from_y + (int)(pixel / (size_t)r->width)) +
            r->lift;
        if (strcmp(r->type, "u8") == 0)
            ((uint8_t *)samples)[i] = (uint8_t)z;
        else if (strcmp(r->type, "u16") == 0)
            ((uint16_t *)samples)[i] = (uint16_t)z;
        else if (strcmp(r->type, "i16") == 0)
            ((int16_t *)samples)[i] = (int16_t)z;
        else if (strcmp(r->type, "i32") == 0)
            ((int32_t *)samples)[i] = (int32_t)z;
        else if (strcmp(r->type, "f32") == 0)
            ((float *)samples)[i] = (float)z;
        else if (strcmp(r->type, "f64") == 0)
            samples[i] = z;
        else
            usage(r->type);
    }
    return samples;
}

static void make_tiff_file(const char *path, const request *r, const void *samples)
{
    double dx = 1. / (r->width - 1), dy = 1. / (r->height - 1); /* point samples on the degree lines */
    double degrees[6] = {r->longitude, dx, 0, r->latitude + 1, 0, -dy};
    double metres[6] = {500000 + r->from_x * r->metres, r->metres, 0, 5200000 - r->from_y * r->metres, 0, -r->metres};
    double across = r->globe_width ? 360. / r->globe_width : 0;
    double up = r->globe_width ? 180. / (r->area ? r->globe_height : r->globe_height - 1) : 0;
    double globe[6] = {r->longitude + r->from_x * across, across, 0, 90 - r->from_y * up, 0, -up};
    made_format format = r->type[0] == 'f' ? MADE_FLOAT : r->type[0] == 'i' ? MADE_INT : MADE_UINT;
    make_tiff(path, &(made_tiff){.width = r->width,
                                 .height = r->height,
                                 .bits = atoi(r->type + 1),
                                 .format = format,
                                 .samples = samples,
                                 .channels = r->channels,
                                 .tile = r->tile,
                                 .palette = r->palette,
                                 .transform = r->globe_width  ? globe
                                              : r->placed     ? degrees
                                              : r->metres > 0 ? metres
                                                              : NULL,
                                 .epsg = r->placed || r->globe_width ? 4326 : r->epsg,
                                 .point = !r->area,
                                 .nodata = r->nodata});
}

static void read_setting(request *r, const char *text)
{
    if (sscanf(text, "size=%dx%d", &r->width, &r->height) == 2 || sscanf(text, "type=%7s", r->type) == 1 ||
        sscanf(text, "heights=%7s", r->heights) == 1 || sscanf(text, "tile=%d", &r->tile) == 1 ||
        sscanf(text, "channels=%d", &r->channels) == 1 || sscanf(text, "metres=%lf", &r->metres) == 1 ||
        sscanf(text, "from=%d,%d", &r->from_x, &r->from_y) == 2 || sscanf(text, "lift=%d", &r->lift) == 1 ||
        sscanf(text, "epsg=%d", &r->epsg) == 1)
        return;
    if (sscanf(text, "globe=%lf,%d,%d", &r->longitude, &r->globe_width, &r->globe_height) == 3)
        return;
    if (sscanf(text, "place=%lf,%lf", &r->longitude, &r->latitude) == 2)
        r->placed = true;
    else if (strncmp(text, "nodata=", 7) == 0)
        r->nodata = text + 7;
    else if (strcmp(text, "palette=1") == 0)
        r->palette = true;
    else if (strcmp(text, "area=1") == 0)
        r->area = true;
    else if (strcmp(text, "all=1") == 0)
        r->all = true;
    else
        usage(text);
}

int main(int argc, char **argv)
{
    if (argc < 3)
        usage("FORMAT PATH");
    request r = {.width = 1201, .height = 1201, .type = "i16", .heights = "hills", .metres = 30, .epsg = 32632};
    for (int i = 3; i < argc; i++)
        read_setting(&r, argv[i]);
    const char *format = argv[1], *path = argv[2];
    if (strcmp(format, "exr") == 0)
        strcpy(r.type, "f32");
    else if (strcmp(format, "pgm") == 0 || (strcmp(format, "png") == 0 && strcmp(r.type, "u8") != 0))
        strcpy(r.type, "u16");
    void *samples = make_samples(&r);
    if (strcmp(format, "tiff") == 0)
        make_tiff_file(path, &r, samples);
    else if (strcmp(format, "png") == 0)
        make_png(path, r.width, r.height, atoi(r.type + 1), r.palette ? 3 : r.channels == 3 ? 2 : 0, samples);
    else if (strcmp(format, "exr") == 0)
        make_exr(path, r.width, r.height, samples);
    else if (strcmp(format, "pgm") == 0)
        make_pgm(path, r.width, r.height, samples);
    else if (strcmp(format, "hgt") == 0)
        make_hgt(path, r.width, samples);
    else if (strcmp(format, "jp2") == 0)
        make_jp2(path);
    else
        usage(format);
    free(samples);
    return 0;
}

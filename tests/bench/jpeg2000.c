/* jpeg2000.c - JPEG 2000 by OpenJPEG. */
#include "jpeg2000.h"

#include <math.h>
#include <openjpeg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/curves.h"

enum { TRIES = 6, RESOLUTIONS = 8 };
static const double near_enough = 0.01; /* rms on both sides, before interpolating */

static void must(bool done, const char *what)
{
    if (!done) {
        fprintf(stderr, "OpenJPEG: %s failed\n", what);
        exit(99);
    }
}

static void complain(const char *text, void *context)
{
    (void)context;
    fprintf(stderr, "OpenJPEG: %s", text);
}

j2k_image j2k_image_of(const tc_grid *grid)
{
    int64_t count = grid->width * grid->height;
    j2k_image image = {grid->width, grid->height, malloc((size_t)count * sizeof *image.v), 1, 0};
    float least = INFINITY, most = -INFINITY;
    for (int64_t i = 0; i < count; i++)
        least = fminf(least, grid->z[i]), most = fmaxf(most, grid->z[i]);
    must(image.v != NULL, "memory");
    image.base = least;
    for (int64_t i = 0; i < count; i++)
        image.v[i] = (int32_t)lrint((grid->z[i] - image.base) * J2K_SCALE);
    while ((most - image.base) * J2K_SCALE >= ldexp(1, image.precision))
        image.precision++;
    return image;
}

void j2k_image_free(j2k_image *image)
{
    free(image->v);
    *image = (j2k_image){0};
}

int j2k_resolutions(const j2k_image *image)
{
    int n = 1;
    while (n < RESOLUTIONS && (image->width >> n) > 0 && (image->height >> n) > 0)
        n++;
    return n;
}

int64_t j2k_encode(const j2k_image *image, double bits, int threads, const char *path)
{
    opj_cparameters_t p;
    opj_set_default_encoder_parameters(&p);
    p.irreversible = 1, p.numresolution = j2k_resolutions(image), p.cp_disto_alloc = 1, p.tcp_numlayers = 1;
    p.tcp_rates[0] = (float)(image->precision / bits);
    opj_image_cmptparm_t component = {.dx = 1,
                                      .dy = 1,
                                      .w = (OPJ_UINT32)image->width,
                                      .h = (OPJ_UINT32)image->height,
                                      .prec = (OPJ_UINT32)image->precision};
    opj_image_t *picture = opj_image_create(1, &component, OPJ_CLRSPC_GRAY);
    must(picture != NULL, "memory");
    picture->x1 = component.w, picture->y1 = component.h;
    memcpy(picture->comps[0].data, image->v, (size_t)(image->width * image->height) * sizeof *image->v);
    opj_codec_t *codec = opj_create_compress(OPJ_CODEC_J2K);
    opj_set_error_handler(codec, complain, NULL);
    opj_stream_t *stream = NULL;
    bool done = opj_setup_encoder(codec, &p, picture) && (threads == 1 || opj_codec_set_threads(codec, threads)) &&
                (stream = opj_stream_create_default_file_stream(path, OPJ_FALSE)) &&
                opj_start_compress(codec, picture, stream) && opj_encode(codec, stream) &&
                opj_end_compress(codec, stream);
    opj_stream_destroy(stream);
    opj_destroy_codec(codec);
    opj_image_destroy(picture);
    struct stat about;
    return done && stat(path, &about) == 0 ? about.st_size : 0;
}

bool j2k_decode(const char *path, tc_rect rect, int32_t *v)
{
    opj_dparameters_t p;
    opj_set_default_decoder_parameters(&p);
    opj_image_t *picture = NULL;
    opj_codec_t *codec = opj_create_decompress(OPJ_CODEC_J2K);
    opj_stream_t *stream = opj_stream_create_default_file_stream(path, OPJ_TRUE);
    opj_set_error_handler(codec, complain, NULL);
    bool done = stream && opj_setup_decoder(codec, &p) && opj_read_header(stream, codec, &picture) &&
                opj_set_decode_area(codec, picture, (int)rect.x0, (int)rect.y0, (int)rect.x1, (int)rect.y1) &&
                opj_decode(codec, stream, picture) && opj_end_decompress(codec, stream) &&
                picture->comps[0].w == rect.x1 - rect.x0 && picture->comps[0].h == rect.y1 - rect.y0;
    if (done)
        memcpy(v, picture->comps[0].data, (size_t)picture->comps[0].w * picture->comps[0].h * sizeof *v);
    opj_stream_destroy(stream);
    opj_destroy_codec(codec);
    opj_image_destroy(picture);
    return done;
}

/* ---- The rate of an rms ----------------------------------------------------------------------------------------- */

static curve_point encode(const j2k_image *image, const tc_grid *grid, double bits, const char *path)
{
    int64_t count = image->width * image->height, valid = 0;
    int64_t bytes = j2k_encode(image, bits, (int)sysconf(_SC_NPROCESSORS_ONLN), path);
    must(bytes > 0, "encoding");
    curve_point p = {8 * (double)bytes / (double)count, 0};
    int32_t *v = malloc((size_t)count * sizeof *v);
    must(v != NULL, "memory");
    must(j2k_decode(path, (tc_rect){0, 0, image->width, image->height}, v), "decoding");
    for (int64_t i = 0; i < count; i++) {
        if (grid->voids && grid->voids[i])
            continue;
        double e = (double)v[i] / J2K_SCALE + image->base - grid->z[i];
        p.rms += e * e, valid++;
    }
    p.rms = sqrt(p.rms / (double)valid);
    free(v);
    return p;
}

j2k_match j2k_at_rms(const j2k_image *image, const tc_grid *grid, double rms, double seed, const char *path)
{
    curve_point best = encode(image, grid, seed, path), second = {0};
    for (int n = 1;; n++) {
        double off = fabs(log(best.rms / rms));
        bool known = second.bits > 0 && second.rms != best.rms && second.bits != best.bits;
        if (n == TRIES || off < 0.0003 || (known && off < 0.003 && fabs(log(second.rms / rms)) < 5 * near_enough))
            return (j2k_match){known ? curve_between(best, second, rms) : best.bits, best.rms, n};
        double fall = 0.55 + 0.25 * best.bits; /* of the rms with the rate, in logarithms: a usual one */
        double bits = known ? curve_between(best, second, rms) : best.bits * pow(best.rms / rms, 1 / fall);
        curve_point next = encode(image, grid, fmin(fmax(bits, 0.6 * best.bits), 1.7 * best.bits), path);
        if (fabs(log(next.rms / rms)) < off)
            second = best, best = next;
        else
            second = next;
    }
}

/* coders.c - our codecs and OpenJPEG behind one interface, and what all coders have in common. */
#include "coders.h"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/made_files.h"

/* ---- Input ------------------------------------------------------------------------------------------------------ */

coder_input coder_input_of(const terrain_file *about, tc_grid *grid)
{
    coder_input input = {.about = *about, .grid = *grid, .image = j2k_image_of(grid)};
    *grid = (tc_grid){0};
    int64_t count = input.grid.width * input.grid.height;
    bool integers = about->unit > 0;
    input.stored = malloc((size_t)count * sizeof *input.stored);
    if (!input.stored)
        puts("coders: no memory"), exit(99);
    for (int64_t i = 0; integers && i < count; i++) {
        double v = rint(input.grid.z[i] / about->unit);
        integers = fabs(v) < ldexp(1, 30); /* others are held as floats */
        if (integers)
            input.stored[i] = (int32_t)v;
    }
    if (!integers) {
        free(input.stored), input.stored = NULL;
        input.about.type = TC_SAMPLE_FLOAT32, input.about.unit = 0;
    }
    return input;
}

void coder_input_free(coder_input *input)
{
    j2k_image_free(&input->image);
    tc_grid_free(&input->grid);
    free(input->stored), input->stored = NULL;
}

/* ---- Ours ------------------------------------------------------------------------------------------------------- */

static bool ours_offered(const coder *c, char why[CODER_WHY])
{
    (void)c, (void)why;
    return true;
}

static bool ours_prepare(coded *c)
{
    c->type = CODED_FLOAT32, c->unit = 1;
    return true;
}

static bool ours_encode(coded *c)
{
    const tc_pack_options options = {.mode = c->goal.aim == CODER_RMS     ? TC_PACK_RMS
                                             : c->goal.aim == CODER_BOUND ? TC_PACK_MAX_ERROR
                                                                          : TC_PACK_LOSSLESS,
                                     .codec = *(const tc_pack_codec *)c->coder->format,
                                     .error = c->goal.value,
                                     .threads = 1};
    terrain_packed packed;
    tc_error error;
    if (terrain_try_pack(&c->input->grid, &c->input->about, &options, c->path, &packed, &error) == TC_OK)
        return true;
    snprintf(c->why, sizeof c->why, "%.*s", CODER_WHY - 1, error.text);
    return false;
}

/* The whole in blocks, as bench_pack reads it. */
static bool ours_read(const coded *c, tc_rect rect, void *samples_ret)
{
    tc_field *field = NULL;
    tc_status status = tc_field_open(c->path, NULL, &field, NULL);
    if (status == TC_OK && rect.x1 - rect.x0 == c->input->grid.width && rect.y1 - rect.y0 == c->input->grid.height)
        terrain_read(field, samples_ret, NULL);
    else if (status == TC_OK)
        status = tc_field_read(field, tc_field_info(field)->levels, rect, samples_ret, NULL, rect.x1 - rect.x0);
    bool whole = status == TC_OK && tc_field_tell(field).damaged == 0;
    tc_field_destroy(field);
    return whole;
}

/* ---- OpenJPEG --------------------------------------------------------------------------------------------------- */

static bool openjpeg_prepare(coded *c)
{
    c->type = CODED_INT32, c->unit = 1.0 / J2K_SCALE, c->base = c->input->image.base;
    return true;
}

static bool openjpeg_encode(coded *c)
{
    return j2k_encode(&c->input->image, fmin(c->goal.value, c->input->image.precision), 1, c->path) > 0;
}

static bool openjpeg_read(const coded *c, tc_rect rect, void *samples_ret)
{
    return j2k_decode(c->path, rect, samples_ret);
}

/* ---- All of them ------------------------------------------------------------------------------------------------ */

static const tc_pack_codec lifting = TC_CODEC_LIFTING, lh04 = TC_CODEC_LH04;

static const coder coders[] = {
    {.name = "terraclip",
     .layout = "tiles 128",
     .extension = "tclip",
     .aims = 1 << CODER_RMS | 1 << CODER_BOUND | 1 << CODER_LOSSLESS,
     .format = &lifting,
     .offered = ours_offered,
     .prepare = ours_prepare,
     .encode = ours_encode,
     .read = ours_read},
    {.name = "lh04",
     .layout = "tiles 128",
     .extension = "tclip",
     .aims = 1 << CODER_RMS,
     .effort = CODER_SLOW,
     .format = &lh04,
     .offered = ours_offered,
     .prepare = ours_prepare,
     .encode = ours_encode,
     .read = ours_read},
    {.name = "jpeg2000",
     .layout = "9/7 one tile",
     .extension = "j2k",
     .aims = 1 << CODER_RATE,
     .offered = ours_offered,
     .prepare = openjpeg_prepare,
     .encode = openjpeg_encode,
     .read = openjpeg_read},
};
enum { OWN = sizeof coders / sizeof *coders };

int coder_count(void)
{
    return OWN + gdal_coders_count;
}

const coder *coder_at(int n)
{
    return n < OWN ? &coders[n] : &gdal_coders[n - OWN];
}

const coder *coder_named(const char *name)
{
    for (int n = 0; n < coder_count(); n++)
        if (strcmp(coder_at(n)->name, name) == 0)
            return coder_at(n);
    fprintf(stderr, "coders: no %s\n", name);
    exit(99);
}

bool coder_offered(const coder *c, char why[CODER_WHY])
{
    *why = '\0';
    return c->offered(c, why);
}

/* ---- Encodings -------------------------------------------------------------------------------------------------- */

/* Codecs leave one file or several, or a folder: each encoding has a folder to itself. */
static const char *place(void)
{
    return made_path("coded");
}

static double bytes_there(void)
{
    char **names = VSIReadDirRecursive(place());
    double bytes = 0;
    for (int i = 0; i < CSLCount(names); i++) {
        char path[1024];
        VSIStatBufL stat;
        snprintf(path, sizeof path, "%s/%s", place(), names[i]);
        if (VSIStatL(path, &stat) == 0 && VSI_ISREG(stat.st_mode))
            bytes += (double)stat.st_size;
    }
    CSLDestroy(names);
    return bytes;
}

static void clear_place(void)
{
    VSIRmdirRecursive(place());
    VSIMkdir(place(), 0700);
}

bool coded_begin(coded *c, const coder *with, const coder_input *input, coder_goal goal)
{
    *c = (coded){.coder = with, .input = input, .goal = goal};
    gdal_coders_set_up();
    snprintf(c->path, sizeof c->path, "%s/heights.%s", place(), with->extension);
    return with->prepare(c);
}

bool coded_encode(coded *c)
{
    clear_place(); /* some drivers add to an old file */
    if (!c->coder->encode(c))
        return false;
    c->bytes = bytes_there();
    return true;
}

static double number(const void *samples, coded_type type, int64_t i)
{
    switch (type) {
    case CODED_INT16: return ((const int16_t *)samples)[i];
    case CODED_UINT16: return ((const uint16_t *)samples)[i];
    case CODED_INT32: return ((const int32_t *)samples)[i];
    case CODED_UINT32: return ((const uint32_t *)samples)[i];
    default: return ((const float *)samples)[i];
    }
}

terrain_error coded_error(coded *c)
{
    const tc_grid *g = &c->input->grid;
    int64_t count = g->width * g->height;
    void *samples = calloc((size_t)count, sizeof(int32_t));
    if (!samples)
        puts("coders: no memory"), exit(99);
    terrain_error e = {NAN, NAN};
    if (c->coder->read(c, (tc_rect){0, 0, g->width, g->height}, samples)) {
        e = (terrain_error){0, 0};
        for (int64_t i = 0; i < count; i++) {
            /* As floats, which the heights are: a codec that keeps integers is not blamed for their rounding. */
            double d = (double)(float)(c->base + c->unit * number(samples, c->type, i)) - g->z[i];
            d = isnan(d) ? INFINITY : d; /* which fmax() would leave out */
            e.rms += d * d, e.max = fmax(e.max, fabs(d));
        }
        e.rms = sqrt(e.rms / (double)count);
    }
    free(samples);
    return e;
}

bool coded_kept(const coded *c, terrain_error e)
{
    const tc_grid *g = &c->input->grid;
    double rounding = ldexp(fmax(fabs((double)g->z_min), fabs((double)g->z_max)), -23);
    switch (c->goal.aim) {
    case CODER_LOSSLESS: return e.max == 0;
    case CODER_BOUND: return e.max <= c->goal.value + rounding;
    default: return true;
    }
}

void coded_end(coded *c)
{
    if (c->coder->release)
        c->coder->release(c);
    VSIRmdirRecursive(place());
    c->source = NULL;
}

void coders_clean_up(void)
{
    VSIRmdirRecursive(place());
    made_folder_remove();
}

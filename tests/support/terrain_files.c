/* terrain_files.c - terrains packed into files by the public interface alone. */
#include "terrain_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "common/base/rect.h"
#include "common/input/source.h"

enum { BLOCK = 1024 };

void terrain_must(tc_status status, const tc_error *error)
{
    if (status != TC_OK) {
        fprintf(stderr, "%s\n", error->text);
        exit(99);
    }
}

static void *take(int64_t count, size_t size)
{
    void *memory = malloc((size_t)count * size);
    if (!memory)
        terrain_must(TC_ERR_MEMORY, &(tc_error){.text = "not enough memory"});
    return memory;
}

static double seconds(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double terrain_cpu(void)
{
    return seconds(CLOCK_PROCESS_CPUTIME_ID);
}

double terrain_wall(void)
{
    return seconds(CLOCK_MONOTONIC);
}

/* ---- Nearest heights -------------------------------------------------------------------------------------------- */

/* Takes over the neighbour's nearest sample where that is nearer than the one known so far. */
static void pass_on(int64_t *nearest, int64_t width, int64_t at, int64_t neighbour)
{
    int64_t from = nearest[neighbour], old = nearest[at];
    if (from < 0 || from == old)
        return;
    int64_t dx = at % width - from % width, dy = at / width - from / width;
    int64_t ox = at % width - old % width, oy = at / width - old / width;
    if (old < 0 || dx * dx + dy * dy < ox * ox + oy * oy)
        nearest[at] = from;
}

/* Two sweeps that hand on nearest samples (Danielsson 1980): exact but for rare ties. */
static void fill_nearest(float *z, const uint8_t *voids, int64_t width, int64_t height)
{
    int64_t count = width * height, *nearest = take(count, sizeof *nearest);
    for (int64_t i = 0; i < count; i++)
        nearest[i] = voids[i] ? -1 : i;
    for (int sweep = 0; sweep < 2; sweep++) {
        int64_t back = sweep ? 1 : -1; /* towards the row already swept */
        for (int64_t n = 0; n < height; n++) {
            int64_t y = sweep ? height - 1 - n : n, *row = nearest + y * width;
            for (int64_t x = 0; n > 0 && x < width; x++)
                for (int64_t k = tc_max64(x - 1, 0); k <= tc_min64(x + 1, width - 1); k++)
                    pass_on(nearest, width, y * width + x, (y + back) * width + k);
            for (int64_t x = 1; x < width; x++)
                pass_on(nearest, width, row + x - nearest, row + x - 1 - nearest);
            for (int64_t x = width - 2; x >= 0; x--)
                pass_on(nearest, width, row + x - nearest, row + x + 1 - nearest);
        }
    }
    for (int64_t i = 0; i < count; i++)
        z[i] = nearest[i] >= 0 && voids[i] ? z[nearest[i]] : z[i];
    free(nearest);
}

tc_grid terrain_crop(const tc_grid *grid, int64_t x0, int64_t y0, int64_t size)
{
    tc_grid g = {.spacing_x = grid->spacing_x, .spacing_y = grid->spacing_y, .z_base = grid->z_base};
    g.width = tc_min64(size, grid->width), g.height = tc_min64(size, grid->height);
    int64_t bottom = tc_max64(grid->height - y0 - g.height, 0), count = g.width * g.height;
    g.z = take(count, sizeof *g.z);
    uint8_t *voids = take(count, 1);
    memset(voids, 0, (size_t)count);
    for (int64_t y = 0; y < g.height; y++) {
        int64_t from = (bottom + y) * grid->width + x0;
        memcpy(g.z + y * g.width, grid->z + from, (size_t)g.width * sizeof *g.z);
        if (grid->voids)
            memcpy(voids + y * g.width, grid->voids + from, (size_t)g.width);
    }
    fill_nearest(g.z, voids, g.width, g.height);
    free(voids);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t i = 0; i < count; i++)
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    return g;
}

/* ---- Datasets as their files store them ------------------------------------------------------------------------- */

/* What the dataset's file stores, and metres of the stored 0. */
static terrain_file about_file(const dataset *set, double *base_ret)
{
    terrain_file about = {*set, TC_SAMPLE_FLOAT32, 0};
    const char *folder = getenv("TERRACLIP_DATA");
    char path[4096];
    tc_source *source;
    tc_error error;
    *base_ret = 0;
    if (strcmp(set->name, "default") == 0)
        return about;
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "", set->name);
    const tc_source_options options = {.spacing = set->spacing, .unit = set->unit};
    terrain_must(tc_source_open(path, &options, &source, &error), &error);
    const tc_source_info *info = tc_source_get_info(source);
    if (info->integer)
        about.type = info->type, about.unit = fabs(info->unit), *base_ret = info->offset - info->z_base;
    tc_source_close(source);
    return about;
}

bool terrain_file_crop(const dataset *set, int64_t size, terrain_file *about_ret, tc_grid *crop_ret)
{
    tc_grid whole;
    if (!dataset_load(set, &whole))
        return false;
    double base;
    terrain_file about = about_file(set, &base);
    tc_grid crop =
        terrain_crop(&whole, tc_max64(whole.width - size, 0) / 2, tc_max64(whole.height - size, 0) / 2, size);
    tc_grid_free(&whole);
    for (int64_t i = 0; about.unit > 0 && i < crop.width * crop.height; i++)
        crop.z[i] = (float)(rint((crop.z[i] - base) / about.unit) * about.unit);
    if (about.unit > 0)
        crop.z_base = 0, crop.z_min = (float)(crop.z_min - base), crop.z_max = (float)(crop.z_max - base);
    *about_ret = about, *crop_ret = crop;
    return true;
}

tc_rect terrain_place(test_random *random, int64_t width, int64_t height, int64_t side)
{
    int64_t x = test_random_int(random, 0, width - side), y = test_random_int(random, 0, height - side);
    return (tc_rect){x, y, x + side, y + side};
}

tc_rect terrain_coarser_place(tc_rect place, tc_level coarser)
{
    enum { REACH = 8 };
    tc_rect r = {place.x0 / 2 - REACH, place.y0 / 2 - REACH, place.x1 / 2 + REACH, place.y1 / 2 + REACH};
    return tc_rect_intersect(r, (tc_rect){0, 0, coarser.width, coarser.height});
}

/* ---- Packing and reading back ----------------------------------------------------------------------------------- */

tc_status terrain_try_pack(const tc_grid *grid, const terrain_file *about, const tc_pack_options *options,
                           const char *path, terrain_packed *packed_ret, tc_error *error)
{
    const tc_pack_terrain terrain = {.width = grid->width,
                                     .height = grid->height,
                                     .spacing_x = grid->spacing_x,
                                     .spacing_y = grid->spacing_y,
                                     .z_base = grid->z_base,
                                     .georef = grid->georef,
                                     .sample_type = about->type,
                                     .unit = about->unit > 0 ? about->unit : 1};
    tc_pack_options o = *options;
    tc_packer *packer = NULL;
    tc_pack_result result;
    if (o.mode == TC_PACK_LOSSLESS)
        o.lattice = about->unit;
    terrain_packed p = {.wall = -terrain_wall(), .cpu = -terrain_cpu()};
    tc_status status = tc_packer_create(path, &terrain, &o, &packer, error);
    for (int64_t y = 0; status == TC_OK && y < grid->height; y += 64) { /* in bands, as the packing command does */
        tc_rect band = {0, y, grid->width, tc_min64(y + 64, grid->height)};
        const uint8_t *voids = grid->voids ? grid->voids + y * grid->width : NULL;
        status = tc_packer_put(packer, band, grid->z + y * grid->width, voids, grid->width, error);
    }
    if (status == TC_OK)
        status = tc_packer_finish(packer, &result, error);
    tc_packer_destroy(packer);
    p.wall += terrain_wall(), p.cpu += terrain_cpu();
    struct stat stats;
    if (status == TC_OK && stat(path, &stats) != 0)
        terrain_must(TC_ERR_IO, &(tc_error){.text = "no packed file"});
    if (status == TC_OK)
        p.bytes = (double)stats.st_size, *packed_ret = p;
    return status;
}

terrain_packed terrain_pack(const tc_grid *grid, const terrain_file *about, const tc_pack_options *options,
                            const char *path)
{
    terrain_packed packed;
    tc_error error;
    terrain_must(terrain_try_pack(grid, about, options, path, &packed, &error), &error);
    return packed;
}

tc_field *terrain_open(const char *path)
{
    tc_field *field = NULL;
    tc_error error;
    terrain_must(tc_field_open(path, NULL, &field, &error), &error);
    return field;
}

void terrain_read(const tc_field *field, float *z, uint8_t *voids)
{
    int finest = tc_field_info(field)->levels;
    tc_level level = tc_field_level(field, finest);
    for (int64_t y = 0; y < level.height; y += BLOCK) {
        for (int64_t x = 0; x < level.width; x += BLOCK) {
            tc_rect r = {x, y, tc_min64(x + BLOCK, level.width), tc_min64(y + BLOCK, level.height)};
            int64_t at = y * level.width + x;
            terrain_must(tc_field_read(field, finest, r, z + at, voids ? voids + at : NULL, level.width),
                         &(tc_error){.text = "reading a packed terrain failed"});
        }
    }
}

terrain_error terrain_compare(const tc_grid *grid, const char *path)
{
    int64_t count = grid->width * grid->height, valid = 0;
    float *z = take(count, sizeof *z);
    uint8_t *voids = take(count, 1);
    tc_field *field = terrain_open(path);
    terrain_read(field, z, voids);
    terrain_error e = {0, 0};
    for (int64_t i = 0; i < count; i++) {
        if (voids[i] != (grid->voids && grid->voids[i]))
            terrain_must(TC_ERR_FORMAT, &(tc_error){.text = "voids came back otherwise than they were given"});
        if (voids[i])
            continue;
        double d = (double)z[i] - grid->z[i];
        d = isnan(d) ? INFINITY : d; /* which fmax() would leave out */
        e.rms += d * d, e.max = fmax(e.max, fabs(d)), valid++;
    }
    e.rms = sqrt(e.rms / (double)valid);
    if (tc_field_tell(field).damaged > 0)
        terrain_must(TC_ERR_FORMAT, &(tc_error){.text = "a tile came back damaged"});
    tc_field_destroy(field);
    free(z), free(voids);
    return e;
}

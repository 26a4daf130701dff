/* load_grid.c - a whole file as a grid: heights, voids filled, extremes. */
#include "load.h"

#include "common/input/folder.h"
#include "common/input/source_internal.h"

#include "common/field/fill.h"
#include "common/base/status.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>

/* ---- Memory ----------------------------------------------------------------------------------------------------- */

/* A number of a file in /proc or /sys: the one after key, or the first one where key is NULL. false: none. */
static bool read_number(const char *path, const char *key, double *number_ret)
{
    FILE *file = fopen(path, "r");
    if (!file)
        return false;
    char line[256];
    bool found = false;
    while (!found && fgets(line, sizeof line, file)) {
        size_t length = key ? strlen(key) : 0;
        char *end = line + length;
        if (key && strncmp(line, key, length) != 0)
            continue;
        double number = strtod(line + length, &end);
        found = end > line + length;
        if (found)
            *number_ret = number;
        else if (!key)
            break; /* "max" */
    }
    fclose(file);
    return found;
}

/* Bytes that this process may still take: what the machine has free or can free, within the limits of its address space
 * and of its control group. Infinite where the system does not say. */
static double available_memory(void)
{
    double available = INFINITY, number = 0, used = 0, cached = 0;
    if (read_number("/proc/meminfo", "MemAvailable:", &number))
        available = 1024 * number;
    struct rlimit limit;
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        read_number("/proc/self/status", "VmSize:", &used))
        available = fmin(available, (double)limit.rlim_cur - 1024 * used);
    if (read_number("/sys/fs/cgroup/memory.max", NULL, &number) &&
        read_number("/sys/fs/cgroup/memory.current", NULL, &used)) {
        read_number("/sys/fs/cgroup/memory.stat", "inactive_file ", &cached);
        available = fmin(available, number - used + cached);
    }
    return fmax(available, 0);
}

/* The grid, its pyramid (a third more) and the working memory of building it. */
static tc_status check_memory(const char *path, const tc_grid *grid, tc_error *error)
{
    const double gib = 1 << 30;
    double needed = 1.6 * sizeof(float) * (double)grid->width * (double)grid->height, available = available_memory();
    if (needed > available || needed > (double)PTRDIFF_MAX)
        return tc_fail(error, TC_ERR_MEMORY,
                       "%s: %" PRId64 " x %" PRId64 " samples need %.1f GiB in memory, %.1f available", path,
                       grid->width, grid->height, needed / gib, available / gib);
    return TC_OK;
}

/* ---- Loading ---------------------------------------------------------------------------------------------------- */

/* Heights are written once, front to back: huge pages save most of the page faults, a tenth of the loading time. */
static float *allocate_heights(size_t count)
{
    const size_t huge = (size_t)2 << 20, bytes = count * sizeof(float);
    if (bytes < 4 * huge)
        return malloc(bytes);
    void *z = aligned_alloc(huge, (bytes + huge - 1) / huge * huge);
    if (z)
        madvise(z, bytes, MADV_HUGEPAGE);
    return z;
}

tc_status tc_grid_room(const char *path, tc_grid *grid, tc_error *error)
{
    tc_status status = check_memory(path, grid, error);
    if (status != TC_OK)
        return status;
    size_t samples = (size_t)grid->width * (size_t)grid->height;
    grid->z = allocate_heights(samples);
    return grid->z ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for %zu samples", path, samples);
}

void tc_grid_measure(tc_grid *grid)
{
    grid->z_min = INFINITY, grid->z_max = -INFINITY;
    grid->void_count = 0;
    for (int64_t i = 0; i < grid->width * grid->height; i++) {
        if (grid->voids && grid->voids[i]) {
            grid->void_count++;
            continue;
        }
        grid->z_min = fminf(grid->z_min, grid->z[i]);
        grid->z_max = fmaxf(grid->z_max, grid->z[i]);
    }
}

/* Reads all rows, the file's first ones first. The mask comes into being with the first void. */
static tc_status read_all(tc_source *source, const char *path, const tc_source_options *options, tc_grid *grid,
                          tc_statistics *statistics, tc_error *error)
{
    int64_t chunk = tc_source_chunk_rows(source);
    size_t width = (size_t)grid->width, samples = width * (size_t)grid->height;
    uint8_t *voids = malloc((size_t)chunk * width);
    tc_status status = tc_grid_room(path, grid, error);
    if (status == TC_OK && !voids)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for %zu samples", path, samples);
    for (int64_t end = grid->height; end > 0 && status == TC_OK; end -= chunk) {
        int64_t start = end > chunk ? end - chunk : 0;
        int64_t before = statistics->voids;
        status = tc_tell_progress(options, "reading", 1 - (double)end / (double)grid->height, error);
        if (status == TC_OK)
            status = tc_source_read_counted(source, start, end - start, grid->z + (size_t)start * width, voids,
                                            statistics, error);
        if (status != TC_OK || statistics->voids == before)
            continue;
        if (!grid->voids)
            grid->voids = calloc(samples, 1);
        if (grid->voids)
            memcpy(grid->voids + (size_t)start * width, voids, (size_t)(end - start) * width);
        else
            status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for the voids of %zu samples", path, samples);
    }
    free(voids);
    return status;
}

static tc_status fill_voids(const char *path, const tc_source_options *options, tc_grid *grid, tc_error *error)
{
    static const char *const what[] = {"filled from their surroundings", "left out", "set to a constant height"};
    size_t samples = (size_t)grid->width * (size_t)grid->height;
    tc_say(options, false, "%" PRId64 " of %zu samples are void: %s", grid->void_count, samples, what[options->voids]);
    grid->voids_flat = options->voids == TC_VOIDS_CONSTANT;
    grid->void_height = (float)(options->void_constant - grid->z_base);
    tc_status status = tc_tell_progress(options, "filling voids", -1, error);
    if (status != TC_OK)
        return status;
    status = tc_fill_voids(grid->z, grid->voids, grid->width, grid->height);
    return status == TC_OK ? TC_OK
                           : tc_fail(error, status, "%s: its voids cannot be filled: %s", path, tc_status_text(status));
}

static tc_status read_file(const char *path, const tc_source_options *options, tc_grid *grid, tc_error *error)
{
    tc_source *source = NULL;
    tc_status status = tc_source_open(path, options, &source, error);
    if (status != TC_OK)
        return status;
    const tc_source_info *info = tc_source_get_info(source);
    *grid = (tc_grid){.width = info->width,
                      .height = info->height,
                      .spacing_x = info->spacing_x,
                      .spacing_y = info->spacing_y,
                      .area_registered = info->area_registered,
                      .georef = info->georef,
                      .z_base = info->z_base};
    grid->georef.crs_wkt = info->georef.crs_wkt ? strdup(info->georef.crs_wkt) : NULL;
    tc_statistics statistics = TC_STATISTICS_NONE;
    status = read_all(source, path, options, grid, &statistics, error);
    tc_source_close(source);
    grid->void_count = statistics.voids;
    grid->z_min = statistics.low;
    grid->z_max = statistics.high;
    return status;
}

tc_status tc_grid_load(const char *path, const tc_source_options *options, tc_grid *grid_ret, tc_error *error)
{
    static const tc_source_options defaults = {0};
    options = options ? options : &defaults;
    tc_grid grid = {0};
    tc_status status =
        tc_is_folder(path) ? tc_grid_read_folder(path, options, &grid, error) : read_file(path, options, &grid, error);
    if (status == TC_OK && grid.void_count == grid.width * grid.height)
        status = tc_fail(error, TC_ERR_FORMAT, "%s: expected heights, found %" PRId64 " samples that are all void",
                         path, grid.void_count);
    if (status == TC_OK && grid.void_count > 0)
        status = fill_voids(path, options, &grid, error);
    if (status == TC_OK)
        *grid_ret = grid;
    else
        tc_grid_free(&grid);
    return status;
}

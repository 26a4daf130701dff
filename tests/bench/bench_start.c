/* bench_start.c - time to the first finished frame of a large terrain against reading its file alone.
 *
 * Read: the file opened and all its rows read as heights. Start: that, voids, pyramid, context, clipmap, renderer and
 * the first 640x480 frame that has all its view needs. Each in a process of its own, which is this program run again;
 * the median of several, in turns, after one of each that is not counted. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "common/base/clock.h"
#include "common/view/camera.h"
#include "common/view/flight.h"
#include "common/app/load.h"
#include "tests/support/measure.h"
#include "tests/support/made_files.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

enum { SIZE = 4097, WIDTH = 640, HEIGHT = 480, RUNS = 5 };

static void must(tc_status status, const tc_error *error)
{
    if (status != TC_OK) {
        fprintf(stderr, "bench_start: %s\n", error->text);
        exit(99);
    }
}

/* ---- What is measured ------------------------------------------------------------------------------------------- */

static void read_alone(const char *path)
{
    tc_source *source = NULL;
    tc_error error;
    must(tc_source_open(path, NULL, &source, &error), &error);
    const tc_source_info *info = tc_source_get_info(source);
    size_t samples = (size_t)info->width * (size_t)info->height;
    float *z = malloc(samples * sizeof *z);
    uint8_t *voids = malloc(samples);
    if (!z || !voids)
        exit(99);
    must(tc_source_read(source, 0, info->height, z, voids, &error), &error);
    tc_source_close(source);
    free(z);
    free(voids);
}

static void first_frame(const char *path)
{
    tc_grid grid;
    tc_error error;
    tc_field *field;
    must(tc_grid_load(path, NULL, &grid, &error), &error);
    must(tc_field_build(&grid, 0, &field, &error), &error);
    const tc_terrain_info *info = tc_field_info(field);
    const tc_level finest = tc_field_level(field, info->levels);
    const tc_flight_box box = {.east = (double)(finest.width - 1) * finest.spacing_x,
                               .north = (double)(finest.height - 1) * finest.spacing_y,
                               .z_min = info->z_base + info->z_min,
                               .z_max = info->z_base + info->z_max};
    tc_camera camera = {.fov = 75 * M_PI / 180, .width = WIDTH, .height = HEIGHT};
    tc_pose view = tc_plane_navigation.whole(&box, camera.fov, WIDTH, HEIGHT);
    tc_pose_to_camera(&view, &camera);
    tc_context *context;
    must(tc_context_create(TC_BACKEND_AUTO, &context, &error), &error);
    scene s = scene_create(context, field, tc_clipmap_n_for(&camera), &(tc_scene_options){.budget = -1});
    scene_draw(&s, &camera, true);
}

/* ---- Measuring -------------------------------------------------------------------------------------------------- */

/* Runs this program again to do one of the two; milliseconds that it says it took. */
static double measure(const char *program, const char *what, const char *path)
{
    int ends[2];
    if (pipe(ends) != 0)
        exit(99);
    pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        execl(program, "bench_start", what, path, (char *)NULL);
        _exit(99);
    }
    close(ends[1]);
    FILE *file = fdopen(ends[0], "r");
    double ms = NAN;
    int status = 0, got = file ? fscanf(file, "%lf", &ms) : 0;
    if (file)
        fclose(file);
    if (child < 0 || waitpid(child, &status, 0) != child || status != 0 || got != 1) {
        fprintf(stderr, "bench_start: %s of %s failed\n", what, path);
        exit(99);
    }
    return ms;
}

static void compare(const char *program, const char *path, const char *name)
{
    double reads[RUNS], starts[RUNS];
    for (int i = -1; i < RUNS; i++) { /* -1 warms the caches */
        double read = measure(program, "read", path), start = measure(program, "start", path);
        if (i >= 0) {
            reads[i] = read;
            starts[i] = start;
        }
    }
    double read = measure_of(reads, RUNS).median, start = measure_of(starts, RUNS).median;
    printf("start: %s: read %.0f ms, first frame %.0f ms, ratio %.2f (at most 3)\n", name, read, start, start / read);
    fflush(stdout);
}

static tc_status give_row(void *context, int64_t y, double *values)
{
    const tc_grid *grid = context;
    for (int64_t i = 0; i < grid->width; i++)
        values[i] = grid->z[y * grid->width + i];
    return TC_OK;
}

int main(int argc, char **argv)
{
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    if (argc == 3) {
        double start = tc_clock_ms();
        (strcmp(argv[1], "read") == 0 ? read_alone : first_frame)(argv[2]);
        printf("%.3f\n", tc_clock_ms() - start);
        fflush(stdout);
        _exit(0); /* taking it all down is not part of the start */
    }

    char program[4096] = "";
    if (readlink("/proc/self/exe", program, sizeof program - 1) < 0)
        return 99;
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, SIZE, SIZE, 30, 1);
    test_random r = {1};
    uint16_t *stored = malloc((size_t)SIZE * SIZE * sizeof *stored);
    for (size_t i = 0; stored && i < (size_t)SIZE * SIZE; i++) { /* rough enough for a codec to have work */
        grid.z[i] = roundf(grid.z[i] + (float)test_random_range(&r, -4, 4));
        stored[i] = (uint16_t)grid.z[i];
    }
    if (!stored)
        return 99;
    tc_error error;
    const char *tiff = made_path("start.tif"), *pgm = made_path("start.pgm");
    must(tc_write_tiff(tiff, &(tc_tiff_options){.width = SIZE, .height = SIZE, .spacing = 30, .type = TC_SAMPLE_INT16},
                       give_row, &grid, &error),
         &error);
    make_pgm(pgm, SIZE, SIZE, stored);
    free(stored);
    tc_grid_free(&grid);
    compare(program, tiff, "4097x4097, 16-bit TIFF (compressed)");
    compare(program, pgm, "4097x4097, 16-bit PGM (not compressed)");
    made_folder_remove();

    const char *data = getenv("TERRACLIP_DATA"), *moon = "moon_gld100_256ppd_ne_4097.png";
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", data ? data : "", moon);
    if (data && access(path, R_OK) == 0)
        compare(program, path, moon);
    else
        printf("start: %s: skipped, TERRACLIP_DATA is not set\n", moon);
    return 0;
}

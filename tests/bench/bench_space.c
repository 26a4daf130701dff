/* bench_space.c - LH04's table 3 for our terrains: what memory a view takes. space.csv.
 *
 * Each flat terrain (quick: the default one and those of at most 4 million samples) is packed with the rms that the
 * packing command would take. A fresh process then opens the file and draws a view of it with n = 255, and says what it
 * holds: clipmap and vertex textures, geometry, the pyramid's caches, and its resident set before there is a context,
 * with one, and with the view drawn. What a view takes is the packed file and all of the first; the caches hold, beside
 * decoded tiles, the pages of the file that were read, which so count twice: LH04 keeps all compressed data in memory.
 * Raw bytes are 16 bits a sample, as in the paper. What packing took is processor time, once. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/flat_data.h"
#include "tests/support/made_files.h"
#include "tests/support/measure.h"
#include "tests/support/process.h"
#include "tests/support/scene.h"
#include "tests/support/terrain_files.h"

enum { WINDOW = 255, WIDTH = 640, HEIGHT = 480, QUICK = 4000000 };

/* What the drawing process says; bytes. */
typedef struct held {
    int levels;
    double clip_heights, clip_normals, gpu_heights, gpu_normals, geometry, field;
    double resident_start, resident_context, resident_view;
} held;

/* Draws the packed terrain from 500 m above its middle. */
static int draw(const char *path)
{
    held h = {.resident_start = process_resident()};
    tc_context *context = scene_context();
    if (!context)
        return 1;
    h.resident_context = process_resident();
    tc_field *field = terrain_open(path);
    int finest = tc_field_info(field)->levels;
    tc_level top = tc_field_level(field, finest);
    scene s = scene_create(context, field, WINDOW, &(tc_scene_options){.budget = -1});
    tc_camera c = {.x = (double)top.width * top.spacing_x / 2,
                   .y = (double)top.height * top.spacing_y / 2,
                   .pitch = -10 * M_PI / 180,
                   .fov = M_PI / 2,
                   .width = WIDTH,
                   .height = HEIGHT};
    terrain_must(tc_field_height(field, c.x, c.y, &c.z), &(tc_error){.text = "the ground cannot be read"});
    c.z += tc_field_info(field)->z_base + 500;
    scene_draw(&s, &c, true);
    h.resident_view = process_resident();
    tc_memory_stats m;
    size_t heights, normals;
    tc_renderer_memory(s.renderer, &m);
    tc_ground_bytes(s.clipmap, &heights, &normals);
    h.levels = tc_clipmap_levels(s.clipmap);
    h.clip_heights = (double)heights, h.clip_normals = (double)normals;
    h.gpu_heights = (double)(m.heights - heights), h.gpu_normals = (double)(m.normals - normals);
    h.geometry = (double)m.geometry, h.field = (double)m.field;
    printf("held %d %.0f %.0f %.0f %.0f %.0f %.0f %.0f %.0f %.0f\n", h.levels, h.clip_heights, h.clip_normals,
           h.gpu_heights, h.gpu_normals, h.geometry, h.field, h.resident_start, h.resident_context, h.resident_view);
    fflush(stdout);
    _exit(0); /* taking it down is not measured */
}

/* Runs this program again for that. */
static bool draw_afresh(const char *path, held *h)
{
    char program[4096] = "", line[512];
    int ends[2], status = 0;
    if (readlink("/proc/self/exe", program, sizeof program - 1) < 0 || pipe(ends) != 0)
        return false;
    pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        execl(program, "bench_space", "draw", path, (char *)NULL);
        _exit(99);
    }
    close(ends[1]);
    FILE *f = fdopen(ends[0], "r");
    bool got = false;
    while (f && fgets(line, sizeof line, f)) {
        got |= sscanf(line, "held %d %lf %lf %lf %lf %lf %lf %lf %lf %lf", &h->levels, &h->clip_heights,
                      &h->clip_normals, &h->gpu_heights, &h->gpu_normals, &h->geometry, &h->field, &h->resident_start,
                      &h->resident_context, &h->resident_view) == 10;
        if (!got)
            fputs(line, stderr);
    }
    if (f)
        fclose(f);
    return child > 0 && waitpid(child, &status, 0) == child && status == 0 && got;
}

static bool measure(const measure_options *o, const dataset *d)
{
    tc_grid grid;
    if (!flat_data_load(d, o->quick ? QUICK : 0, &grid))
        return true;
    const char *path = made_path("space.tclip");
    const terrain_file about = {*d, TC_SAMPLE_FLOAT32, 0};
    double rms = fmin(10, 0.06 * fmin(grid.spacing_x, grid.spacing_y)); /* that of the packing command's default */
    terrain_packed packed = terrain_pack(&grid, &about, &(tc_pack_options){.mode = TC_PACK_RMS, .error = rms}, path);
    terrain_error e = terrain_compare(&grid, path);
    double samples = (double)(grid.width * grid.height), raw = 2 * samples;
    held h = {0};
    bool drawn = draw_afresh(path, &h);
    unlink(path);
    if (drawn) {
        double clip = h.clip_heights + h.clip_normals, gpu = h.gpu_heights + h.gpu_normals + h.geometry;
        double view = packed.bytes + clip + gpu + h.field;
        printf("%-38s %11.0f %10.0f %7.4f %6.2f %3d %9.0f %9.0f %9.0f %9.0f %8.0f %9.0f %7.1f %7.1f %7.1f %7.3f\n",
               d->name, raw, packed.bytes, 8 * packed.bytes / samples, e.rms, h.levels, h.clip_heights, h.clip_normals,
               h.gpu_heights, h.gpu_normals, h.geometry, h.field, h.resident_start / 1048576,
               h.resident_context / 1048576, h.resident_view / 1048576, view / raw);
        if (o->csv) {
            measure_put_text(o->csv, d->name);
            fprintf(o->csv,
                    ",%lld,%lld,%d,%.0f,%.0f,%.5f,%.3f,%.2f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.5f,%g,%"
                    "g,%.2f\n",
                    (long long)grid.width, (long long)grid.height, h.levels, raw, packed.bytes,
                    8 * packed.bytes / samples, e.rms, e.max, h.clip_heights, h.clip_normals, h.gpu_heights,
                    h.gpu_normals, h.geometry, h.field, view, h.resident_start, h.resident_context, h.resident_view,
                    view / raw, fmin(grid.spacing_x, grid.spacing_y), grid.z_max - grid.z_min, packed.cpu);
        }
    }
    fflush(stdout);
    tc_grid_free(&grid);
    return drawn;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "draw") == 0)
        return draw(argv[2]);
    measure_options o = measure_begin(
        argc, argv,
        "terrain,width,height,levels,raw_bytes,packed_bytes,bits_per_sample,rms_m,max_error_m,clipmap_height_bytes,"
        "clipmap_normal_bytes,texture_height_bytes,texture_normal_bytes,geometry_bytes,pyramid_bytes,view_bytes,"
        "resident_start_bytes,resident_context_bytes,resident_view_bytes,view_over_raw,spacing_m,range_m,pack_cpu_s");
    printf("%-38s %11s %10s %7s %6s %3s %9s %9s %9s %9s %8s %9s %7s %7s %7s %7s\n", "terrain", "raw bytes", "packed",
           "bits", "rms m", "L", "heights", "normals", "textures", "(normals)", "geometry", "pyramid", "MiB", "context",
           "view", "of raw");
    dataset sets[DATASETS_MAX];
    int count = dataset_list(sets, DATASETS_MAX);
    bool measured = true;
    for (int i = 0; i < count; i++)
        measured &= measure(&o, &sets[i]);
    made_folder_remove();
    return measure_end(&o) || !measured;
}

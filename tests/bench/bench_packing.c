/* bench_packing.c - what packing and opening packed terrains cost: time, balance of threads, memory; and upsampling.
 *
 * Sections: pack (through the library), memory (the packing command over sources of two sizes, one twice the other),
 * open (of what that made), upsample. Arguments: none for all of them, or the name of one; `memory large` does that and
 * opening with 32769 x 32769 and 32769 x 65537 samples, which takes minutes and 15 GB in TMPDIR. Needs
 * TERRACLIP_DATA, but for upsample. */
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "tests/support/made_files.h"
#include "tests/support/packed.h"
#include "tests/support/terrain_files.h"
#include "tests/support/terrains.h"

static const terrain_file tatra = {{"srtm3_tatra_poland_4801.tif", 0, 0}, TC_SAMPLE_INT16, 1},
                          moon_large = {{"moon_gld100_256ppd_ne_8193.tif", 0, 0}, TC_SAMPLE_INT16, 1};

static void fail(const char *what)
{
    fprintf(stderr, "bench_packing: %s failed\n", what);
    exit(99);
}

/* ---- Time ------------------------------------------------------------------------------------------------------- */

static double thread_cpu(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void pack_row(const terrain_file *file)
{
    enum { RUNS = 3 };
    tc_grid grid;
    if (!dataset_load(&file->set, &grid))
        return;
    const char *path = made_path("speed.tclip");
    terrain_packed best[2] = {{.wall = INFINITY, .cpu = INFINITY}, {.wall = INFINITY, .cpu = INFINITY}};
    double balance = 0, share = 1;
    for (int run = 0; run < RUNS; run++) { /* in turns */
        for (int n = 0; n < 2; n++) {
            tc_pack_options options = {.mode = TC_PACK_RMS, .error = 1, .threads = n + 1};
            double own = thread_cpu();
            terrain_packed p = terrain_pack(&grid, file, &options, path);
            own = thread_cpu() - own;
            best[n].wall = fmin(best[n].wall, p.wall), best[n].cpu = fmin(best[n].cpu, p.cpu);
            if (n == 1)
                balance = fmax(balance, p.cpu / p.wall), share = fmin(share, own / p.cpu);
        }
    }
    unlink(path);
    double m = 1e-6 * (double)(grid.width * grid.height);
    printf("%-34s %8.2f %8.2f %8.2f %8.2f %8.2f %9.2f %9.0f\n", file->set.name, m / best[0].wall, m / best[0].cpu,
           m / best[1].wall, m / best[1].cpu, best[0].wall / best[1].wall, balance, 100 * share);
    fflush(stdout);
    tc_grid_free(&grid);
}

static void pack_section(void)
{
    printf(
        "\nPacking at rms 1 m, Msamples/s of wall-clock and of processor time, best of 3; how many times as fast two\n"
        "threads are; processors that they kept busy; the calling thread's share of their processor time, %%\n");
    printf("%-34s %8s %8s %8s %8s %8s %9s %9s\n", "", "1 wall", "1 cpu", "2 wall", "2 cpu", "faster", "busy", "caller");
    pack_row(&moon_large);
    pack_row(&tatra);
}

/* ---- Memory ----------------------------------------------------------------------------------------------------- */

/* A raster of a real one's copies side by side: across x down of them, whose edges are shared. */
static bool write_vrt(const char *path, int across, int down)
{
    enum { STEP = 8192 };
    const char *data = getenv("TERRACLIP_DATA");
    char source[4096];
    snprintf(source, sizeof source, "%s/%s", data, moon_large.set.name);
    if (access(source, R_OK) != 0) {
        printf("%s: skipped: not in TERRACLIP_DATA\n", moon_large.set.name);
        return false;
    }
    FILE *f = fopen(path, "w");
    if (!f)
        fail("writing");
    fprintf(f,
            "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\">\n"
            "<GeoTransform>0, 100, 0, 0, 0, -100</GeoTransform>\n<VRTRasterBand dataType=\"Int16\" band=\"1\">\n",
            across * STEP + 1, down * STEP + 1);
    for (int y = 0; y < down; y++)
        for (int x = 0; x < across; x++)
            fprintf(f,
                    "<SimpleSource><SourceFilename relativeToVRT=\"0\">%s</SourceFilename><SourceBand>1</SourceBand>"
                    "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"%d\" ySize=\"%d\"/>"
                    "<DstRect xOff=\"%d\" yOff=\"%d\" xSize=\"%d\" ySize=\"%d\"/></SimpleSource>\n",
                    source, STEP + 1, STEP + 1, x * STEP, y * STEP, STEP + 1, STEP + 1);
    fputs("</VRTRasterBand></VRTDataset>\n", f);
    if (fclose(f) != 0)
        fail("writing");
    return true;
}

/* Where this program is. */
static const char *beside(const char *name)
{
    static char path[4200];
    ssize_t length = readlink("/proc/self/exe", path, 4096);
    if (length < 0)
        fail("/proc/self/exe");
    path[length] = '\0';
    if (name)
        strcpy(strrchr(path, '/') + 1, name);
    return path;
}

typedef struct process {
    double seconds, mebibytes; /* peak of the resident set */
    char said[8192];
} process;

/* Runs a program with up to five arguments. The peak starts at what this process holds itself, which is little. */
static process run(const char *program, char *const arguments[])
{
    process p = {0};
    int ends[2], status;
    double start = terrain_wall();
    if (pipe(ends) != 0)
        fail("pipe");
    pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]), close(ends[1]);
        execv(program, arguments);
        _exit(99);
    }
    close(ends[1]);
    size_t size = 0;
    for (ssize_t n; size + 1 < sizeof p.said && (n = read(ends[0], p.said + size, sizeof p.said - 1 - size)) > 0;)
        size += (size_t)n;
    close(ends[0]);
    struct rusage used;
    if (child < 0 || wait4(child, &status, 0, &used) != child || status != 0)
        fail(program);
    p.seconds = terrain_wall() - start, p.mebibytes = (double)used.ru_maxrss / 1024;
    return p;
}

/* Packs a raster of copies; peak in MiB, 0 without the data. */
static double memory_row(int across, int down, const char *file_path)
{
    const char *vrt = made_path("copies.vrt");
    if (!write_vrt(vrt, across, down))
        return 0;
    char out[512];
    snprintf(out, sizeof out, "%s", file_path);
    char *arguments[] = {"terraclip", "pack", (char *)vrt, "--rms", "1", "-q", "-o", out, NULL};
    process p = run(beside("../terraclip"), arguments);
    unlink(vrt);
    double m = 1e-6 * (8192. * across + 1) * (8192. * down + 1);
    struct stat about;
    if (stat(file_path, &about) != 0)
        fail("packing");
    printf("%6d x %-6d %10.0f %10.1f %10.2f %12.1f %10.0f\n", across * 8192 + 1, down * 8192 + 1, m, p.seconds,
           m / p.seconds, 1e-6 * (double)about.st_size, p.mebibytes);
    fflush(stdout);
    return p.mebibytes;
}

static bool memory_section(bool large, const char *file_path)
{
    printf("\nMemory of `terraclip pack --rms 1`, all processors, copies of %s\n", moon_large.set.name);
    printf("%15s %10s %10s %10s %12s %10s\n", "samples", "millions", "s", "Ms/s", "packed MB", "peak MiB");
    double once = memory_row(large ? 4 : 1, large ? 4 : 2, file_path);
    double twice = once > 0 ? memory_row(large ? 4 : 1, large ? 8 : 4, file_path) : 0;
    if (once > 0)
        printf("peak of twice the size against once: %.3f (bar 1.10; 512 MiB at most)\n", twice / once);
    return once > 0;
}

/* ---- Opening ---------------------------------------------------------------------------------------------------- */

static double resident_mebibytes(void)
{
    long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (!f || fscanf(f, "%*s %ld", &pages) != 1)
        fail("/proc/self/statm");
    fclose(f);
    return (double)pages * (double)sysconf(_SC_PAGESIZE) / 1048576;
}

/* What a fresh process does with a packed file: opens it, asks, and, where wanted, reads every level. */
static int child_main(const char *path, bool reads)
{
    double before = resident_mebibytes(), start = terrain_wall();
    tc_field *field = terrain_open(path);
    int levels = tc_field_info(field)->levels;
    double ms = 1e3 * (terrain_wall() - start), opened = resident_mebibytes();
    static float z[1024 * 1024];
    for (int l = 1; l <= levels && reads; l++) {
        tc_level level = tc_field_level(field, l);
        for (int64_t y = 0; y < level.height; y += 1024)
            for (int64_t x = 0; x < level.width; x += 1024) {
                tc_rect r = {x, y, tc_min64(x + 1024, level.width), tc_min64(y + 1024, level.height)};
                terrain_must(tc_field_read(field, l, r, z, NULL, 1024), &(tc_error){.text = "reading"});
            }
    }
    double read = resident_mebibytes();
    int libraries = 0, readers = 0;
    char line[4096];
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps && fgets(line, sizeof line, maps)) {
        libraries += strstr(line, ".so") && strstr(line, " r-xp ");
        readers += strstr(line, "gdal") || strstr(line, "OpenImageIO") || strstr(line, "terraclip-");
    }
    printf("%f %f %f %f %d %d\n", ms, before, opened, read, libraries, readers);
    return 0;
}

static void open_section(const char *file_path)
{
    enum { RUNS = 7 };
    char path[512];
    snprintf(path, sizeof path, "%s", file_path);
    double info_ms = INFINITY, info_mib = 0, ms = INFINITY, before = 0, opened = 0, read = 0;
    int libraries = 0, readers = 0;
    for (int n = 0; n < RUNS; n++) {
        int file = open(file_path, O_RDONLY); /* out of the page cache, where the system lets go of it */
        if (file < 0 || posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED) != 0)
            fail("opening");
        close(file);
        process info = run(beside("../terraclip"), (char *[]){"terraclip", "info", path, NULL});
        info_ms = fmin(info_ms, 1e3 * info.seconds), info_mib = fmax(info_mib, info.mebibytes);
    }
    for (int n = 0; n < RUNS; n++) {
        double t, more;
        int more_readers;
        process p = run(beside(NULL), (char *[]){"bench_packing", "child", path, n == 0 ? "read" : NULL, NULL});
        if (sscanf(p.said, "%lf %lf %lf %lf %d %d", &t, &before, &opened, &more, &libraries, &more_readers) != 6)
            fail("opening");
        ms = fmin(ms, t), read = fmax(read, more), readers += more_readers;
    }
    printf(
        "\nOpening that file in fresh processes, best of %d: tc_pyramid_open and the first info %.2f ms (bar 20);\n"
        "resident %.1f MiB before, %.1f after opening (bar 10 MB), %.1f after all levels were read; %d libraries\n"
        "mapped then, of GDAL, OpenImageIO or plug-ins %d. `terraclip info`, whole process, file not cached: %.1f ms,\n"
        "peak %.1f MiB\n",
        RUNS, ms, before, opened, read, libraries, readers, info_ms, info_mib);
    fflush(stdout);
}

/* ---- Upsampling ------------------------------------------------------------------------------------------------- */

static tc_status no_tile(void *context, int64_t tx, int64_t ty, const uint8_t **bytes, size_t *size)
{
    (void)context, (void)tx, (void)ty;
    *bytes = NULL, *size = 0;
    return TC_OK;
}

static double least(const double *values, int count)
{
    double v = INFINITY;
    for (int n = 0; n < count; n++)
        v = fmin(v, values[n]);
    return v;
}

static void upsample_section(void)
{
    enum { SIDE = 255, SIZE = 4097, RUNS = 2001 };
    enum { HALF = (SIDE + 1) / 2, STRIDE = HALF + 3 };
    static double copy[RUNS], filter[RUNS], up[RUNS], whole[RUNS];
    static float half[STRIDE * STRIDE], twice[4 * HALF * HALF], rows[2 * HALF * STRIDE];
    static float from[SIDE * SIDE], to[SIDE * SIDE];
    /* The codec's step from a level to the next one. */
    tc_lifting_level level = {SIZE, SIZE, false};
    tc_detail_model model;
    tc_codec *codec = malloc(sizeof *codec);
    if (!codec)
        fail("memory");
    tc_detail_model_builtin(0, &model);
    for (int b = 0; b < TC_BANDS; b++)
        model.step[b] = 64;
    tc_codec_init(codec, &level, &model);
    tc_rect rect = {1001, 2001, 1001 + SIDE, 2001 + SIDE};
    tc_plane fine = packed_plane(rect), coarse = packed_plane(tc_codec_read_needs(codec, rect));
    test_random random = {3};
    for (int64_t i = 0; i < tc_rect_area(coarse.rect); i++)
        coarse.z[i] = (int32_t)test_random_int(&random, 0, 100000);
    void *scratch = malloc(tc_codec_read_scratch(codec, rect));
    /* The same by reading a packed terrain whose finest levels are empty. */
    const terrain_file file = {{"smooth", 0, 0}, TC_SAMPLE_FLOAT32, 0};
    const char *path = made_path("smooth.tclip");
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, SIZE, SIZE, 30, 1);
    terrain_pack(&grid, &file, &(tc_pack_options){.mode = TC_PACK_RMS, .error = 0.5}, path);
    tc_grid_free(&grid);
    tc_field *field = terrain_open(path);
    int finest = tc_field_info(field)->levels;
    for (int n = 0; n < RUNS; n++) {
        double t = terrain_wall();
        memcpy(to, from, sizeof to);
        __asm__ volatile("" : : "r"(to) : "memory");
        copy[n] = terrain_wall() - t;
        t = terrain_wall();
        tc_upsample(half + STRIDE + 1, STRIDE, HALF, HALF, twice, rows);
        filter[n] = terrain_wall() - t;
        t = terrain_wall();
        tc_codec_read(codec, &coarse, no_tile, NULL, &fine, scratch, NULL, TC_SIMD_AUTO);
        up[n] = terrain_wall() - t;
        t = terrain_wall();
        terrain_must(tc_field_read(field, finest, rect, to, NULL, SIDE), &(tc_error){.text = "reading"});
        whole[n] = terrain_wall() - t;
    }
    double c = 1e6 * least(copy, RUNS), f = 1e6 * least(filter, RUNS), u = 1e6 * least(up, RUNS);
    double w = 1e6 * least(whole, RUNS);
    printf("\nUpsampling to %d x %d samples, best of %d: copying them %.1f us; U %.1f us, %.2f times as long (bar 3);\n"
           "the codec's step with tiles that are empty %.1f us, %.1f times; read from a packed terrain, through all of "
           "its\n"
           "levels (%" PRId64 " bytes in the finest) %.1f us, %.1f times\n",
           SIDE, SIDE, RUNS, c, f, f / c, u, u / c, tc_field_packed_level(field, finest).bytes, w, w / c);
    tc_field_destroy(field);
    unlink(path);
    free(codec), free(scratch), free(fine.z), free(coarse.z);
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "", *data = getenv("TERRACLIP_DATA");
    if (strcmp(what, "child") == 0 && argc > 2)
        return child_main(argv[2], argc > 3);
    bool large = argc > 2 && strcmp(argv[2], "large") == 0;
    if (!data || !*data) {
        printf("packing: skipped but for upsampling: TERRACLIP_DATA is not set\n");
        what = "upsample";
    }
    if (!*what || strcmp(what, "memory") == 0 || strcmp(what, "open") == 0) { /* first: nothing is held yet */
        const char *file_path = made_path("copies.tclip");
        if (memory_section(large, file_path))
            open_section(file_path);
    }
    if (!*what || strcmp(what, "pack") == 0)
        pack_section();
    if (!*what || strcmp(what, "upsample") == 0)
        upsample_section();
    made_folder_remove();
    return 0;
}

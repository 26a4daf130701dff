/* extreme_imagery.c - a picture of 40,000 x 20,000 pixels (where sweeps are not whole, half as wide) without overviews,
 * in strips and in tiles, over a terrain and over a planet: what the programs take of memory and read of the file, the
 * first time, when its levels are made, and afterwards.
 *
 * Memory is the most that the whole program had at once, with the libraries and what OpenGL in software takes, over a
 * terrain; over a planet, where that alone is more than the limit, what it had more than without a picture, by a limit
 * of its own. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/extreme.h"
#include "tests/support/made_files.h"
#include "tests/support/sweep.h"

enum { MOST_MEMORY = 300, MOST_MORE = 80 };
#define MB 1e6

typedef struct taken {
    double memory, read; /* MB; NAN: the program failed */
} taken;

static const char *build;

/* Runs a command of the shell; whether it succeeded. */
static bool run(const char *format, ...) __attribute__((format(printf, 1, 2)));
static bool run(const char *format, ...)
{
    char command[4096];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    return system(command) == 0;
}

static double bytes_of(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 ? (double)about.st_size : NAN;
}

/* What a viewer takes for one picture of a view, by tests/cli/used.c. with: options, or "". */
static taken show(const char *viewer, const char *terrain, const char *with)
{
    taken t = {NAN, NAN};
    if (!run("'%s/tests/used' used.txt '%s/%s' '%s' -o seen.png -q --size 320x240 %s", build, build, viewer, terrain,
             with))
        return t;
    FILE *file = fopen("used.txt", "r");
    if (!file || fscanf(file, "%lf %lf", &t.memory, &t.read) != 2)
        t.memory = t.read = NAN;
    if (file)
        fclose(file);
    return t;
}

typedef struct surface {
    const char *viewer, *terrain, *view;
    bool whole; /* memory is counted as a whole */
} surface;
static const surface plane = {"planar-viewer", "terrain.tif", "", true},
                     planet = {"planet-viewer", "globe.tif", "--view 10,20,2e7,0,-90", false};

static void look(const char *name, const surface *s, const char *picture, bool first)
{
    char with[256], row[128];
    double size = bytes_of(picture) / MB;
    snprintf(with, sizeof with, "%s --imagery %s", s->view, picture);
    snprintf(row, sizeof row, "%s, %s, %s", name, s == &plane ? "terrain" : "planet", first ? "first time" : "again");
    taken with_it = show(s->viewer, s->terrain, with), without = show(s->viewer, s->terrain, s->view);
    double more = with_it.memory - without.memory;
    extreme_at_most(row, s->whole ? "memory, MB" : "memory more than without, MB", s->whole ? with_it.memory : more,
                    s->whole ? MOST_MEMORY : MOST_MORE, "%.0f MB, without a picture %.0f", with_it.memory,
                    without.memory);
    extreme_at_most(row, "read, of the file's size", (with_it.read - without.read) / size, first ? 1.1 : 0.15,
                    "%.0f MB of a file of %.0f MB", with_it.read - without.read, size);
}

/* Made by make-picture with these options. */
static void picture(const char *name, const char *options, const surface *first, const surface *second)
{
    if (!run("'%s/tests/make-picture' make large.tif size=%s co=COMPRESS=DEFLATE co=ZLEVEL=1 %s", build,
             sweep_whole() ? "40000x20000" : "20000x10000", options)) {
        extreme_at_most(name, "made", NAN, 0, "%s", "make-picture has failed");
        return;
    }
    look(name, first, "large.tif", true);
    look(name, first, "large.tif", false);
    look(name, second, "large.tif", false);
    remove("large.tif");
    run("rm -rf cache");
}

int main(void)
{
    char here[4096], cache[4096];
    const char *given = getenv("TERRACLIP_BUILD");
    extreme_begin("imagery");
    given = given && *given ? given : "build";
    build = realpath(given, here);
    snprintf(cache, sizeof cache, "%s/cache", made_folder());
    setenv("XDG_CACHE_HOME", cache, 1);
    setenv("LP_NUM_THREADS", "2", 1); /* of OpenGL in software: each takes memory */
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    if (strstr(given, "sanitize") || strstr(given, "thread")) {
        extreme_skipped("large", "sanitizers take memory of their own");
        made_folder_remove();
        return 0;
    }
    if (!build || chdir(made_folder()) != 0 ||
        !run("'%s/tests/make-file' tiff terrain.tif size=121x121 place=8,46", build) ||
        !run("'%s/tests/make-file' tiff globe.tif size=256x128 globe=-180,256,128 area=1", build)) {
        extreme_at_most("large", "made", NAN, 0, "%s", "make-file has failed");
    } else {
        picture("large, in strips", "", &plane, &planet);
        picture("large, in tiles", "co=TILED=YES", &planet, &plane);
    }
    if (chdir("/") != 0)
        return 1;
    made_folder_remove();
    return extreme_end();
}

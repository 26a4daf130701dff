/* default_terrain.c - see default_terrain.h. It is made in a folder beside its place, which one viewer at a time has
 * locked; the lock goes with the viewer, and what was left in the folder is no one's. */
#include "default_terrain.h"
#include "interrupt.h"
#include "common/base/cache_folder.h"
#include "common/base/status.h"
#include "common/input/plugin.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MOST_ARGUMENTS = 24, MOST_PATH = TC_DEFAULT_PATH + 32 };

extern char **environ;

bool tc_display_there(void)
{
    const char *x = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
    return (x && *x) || (wayland && *wayland);
}

/* The grid's own charts need not be named. */
static const char *atlas_name(const tc_atlas *atlas)
{
    return atlas && atlas != &tc_atlas_lonlat ? atlas->name : NULL;
}

tc_status tc_default_terrain_path(const tc_default_terrain *which, const tc_atlas *atlas, char path[TC_DEFAULT_PATH],
                                  tc_error *error)
{
    char name[128];
    const char *charts = atlas_name(atlas);
    snprintf(name, sizeof name, "%s%s%s-%s.tclip", which->name, charts ? "-" : "", charts ? charts : "", tc_version());
    tc_cache_path(name, path, TC_DEFAULT_PATH);
    return *path ? TC_OK
                 : tc_fail(error, TC_ERR_IO,
                           "TERRAIN: expected a file, or $XDG_CACHE_HOME or $HOME to keep the default one there, found "
                           "none of them");
}

/* ---- Running terraclip ------------------------------------------------------------------------------------------- */

static void wait_a_moment(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 50 * 1000 * 1000}, NULL);
}

static tc_status hear_end(int how, const char *command, tc_error *error)
{
    if (WIFEXITED(how) && WEXITSTATUS(how) == 0)
        return TC_OK;
    if (tc_interrupted())
        return tc_fail(error, TC_ERR_IO, "interrupted");
    if (WIFEXITED(how) && WEXITSTATUS(how) < 127)
        return tc_fail(error, TC_ERR_IO, "%s", "");
    return tc_fail(error, TC_ERR_IO, "the default terrain cannot be made: terraclip %s ended by %s %d", command,
                   WIFEXITED(how) ? "code" : "signal", WIFEXITED(how) ? WEXITSTATUS(how) : WTERMSIG(how));
}

/* Runs it until it ends, or ends it where the viewer is to end. What it would print is left out; its progress and what
 * it says of failures are not. */
static tc_status run(const char *program, const char *const *arguments, tc_error *error)
{
    posix_spawn_file_actions_t actions;
    pid_t child, ended;
    int how = 0;
    if (tc_interrupted())
        return tc_fail(error, TC_ERR_IO, "interrupted");
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const int failed = posix_spawn(&child, program, &actions, NULL, (char *const *)arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        return tc_fail(error, TC_ERR_IO, "the default terrain cannot be made: %s: %s", program, strerror(failed));
    while ((ended = waitpid(child, &how, WNOHANG)) == 0) {
        if (tc_interrupted())
            kill(child, SIGTERM);
        wait_a_moment();
    }
    return ended == child ? hear_end(how, arguments[1], error)
                          : tc_fail(error, TC_ERR_IO, "the default terrain cannot be made: %s", strerror(errno));
}

/* A command line; those that are NULL are left out. */
typedef struct line {
    const char *argument[MOST_ARGUMENTS + 1];
    int count;
} line;

static void add(line *l, const char *argument)
{
    if (argument && l->count < MOST_ARGUMENTS)
        l->argument[l->count++] = argument;
}

static line line_of(const char *program, const char *command, const char *const *arguments, const char *output)
{
    line l = {{program, command, "-o", output}, 4};
    for (; *arguments; arguments++)
        add(&l, *arguments);
    return l;
}

static tc_status make_in(const tc_default_terrain *which, const tc_atlas *atlas, const char *folder, const char *path,
                         bool quiet, tc_error *error)
{
    char source[MOST_PATH + 16], packed[MOST_PATH + 16], beside[PATH_MAX], program[PATH_MAX + 16];
    const char *charts = atlas_name(atlas), *silence = quiet ? "-q" : NULL;
    tc_program_folder(beside);
    snprintf(program, sizeof program, "%s/terraclip", beside);
    snprintf(source, sizeof source, "%s/source.tif", folder);
    snprintf(packed, sizeof packed, "%s/packed.tclip", folder);
    line synth = line_of(program, "synth", which->synth, source), pack = line_of(program, "pack", which->pack, packed);
    add(&synth, silence);
    add(&pack, silence);
    add(&pack, charts ? "--atlas" : NULL);
    add(&pack, charts);
    add(&pack, source);
    tc_status status = run(program, synth.argument, error);
    if (status == TC_OK)
        status = run(program, pack.argument, error);
    if (status == TC_OK && rename(packed, path) != 0)
        status = tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    return status;
}

/* ---- The folder -------------------------------------------------------------------------------------------------- */

static void empty(const char *folder)
{
    DIR *list = opendir(folder);
    for (struct dirent *entry; list && (entry = readdir(list));)
        unlinkat(dirfd(list), entry->d_name, 0); /* which the folder itself and the one above refuse */
    if (list)
        closedir(list);
}

/* Makes it where it is not there; a descriptor of it that the caller closes. */
static int open_folder(const char *folder)
{
    int file = -1;
    for (int tries = 0; file < 0 && tries < 100; tries++) { /* another viewer may take it away between the two */
        if (mkdir(folder, 0700) != 0 && errno != EEXIST)
            return -1;
        file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (file < 0 && errno != ENOENT)
            return -1;
    }
    return file;
}

/* Whether an open folder is still that of its name: who had the lock before takes it away in the end. */
static bool is_named(int file, const char *folder)
{
    struct stat open, named;
    return fstat(file, &open) == 0 && stat(folder, &named) == 0 && open.st_dev == named.st_dev &&
           open.st_ino == named.st_ino;
}

/* Waits for the lock of an open folder. */
static tc_status wait_for_lock(int file, const char *folder, bool *said, tc_error *error)
{
    while (flock(file, LOCK_EX | LOCK_NB) != 0) {
        const int why = errno;
        if (tc_interrupted())
            return tc_fail(error, TC_ERR_IO, "interrupted");
        if (why != EWOULDBLOCK && why != EINTR)
            return tc_fail(error, TC_ERR_IO, "the default terrain cannot be kept in %s: %s", folder, strerror(why));
        if (!*said)
            fprintf(stderr, "another viewer is making the default terrain\n");
        *said = true;
        wait_a_moment();
    }
    return TC_OK;
}

/* The folder, locked: a descriptor that the caller closes. */
static tc_status lock(const char *folder, bool quiet, int *lock_ret, tc_error *error)
{
    bool said = quiet, held = false;
    while (!held) {
        const int file = open_folder(folder);
        if (file < 0)
            return tc_fail(error, TC_ERR_IO, "the default terrain cannot be kept in %s: %s", folder, strerror(errno));
        const tc_status status = wait_for_lock(file, folder, &said, error);
        held = status == TC_OK && is_named(file, folder);
        if (held)
            *lock_ret = file;
        else
            close(file);
        if (status != TC_OK)
            return status;
    }
    return TC_OK;
}

tc_status tc_default_terrain_make(const tc_default_terrain *which, const tc_atlas *atlas,
                                  const char path[TC_DEFAULT_PATH], bool quiet, tc_error *error)
{
    char folder[MOST_PATH];
    tc_error why;
    int held = -1;
    if (access(path, R_OK) == 0)
        return TC_OK;
    if (tc_cache_make_folder(path, &why) != TC_OK)
        return tc_fail(error, TC_ERR_IO, "the default terrain cannot be kept in %s", why.text);
    snprintf(folder, sizeof folder, "%s.making", path);
    tc_status status = lock(folder, quiet, &held, error);
    if (status != TC_OK)
        return status;
    if (access(path, R_OK) != 0) { /* else another viewer has made it meanwhile */
        empty(folder);             /* of what one that was killed left */
        status = make_in(which, atlas, folder, path, quiet, error);
        empty(folder);
    }
    rmdir(folder); /* who waits for its lock makes another */
    close(held);
    return status;
}

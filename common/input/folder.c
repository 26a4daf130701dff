/* folder.c - lists the elevation files of a folder. */
#include "folder.h"

#include "common/base/status.h"
#include "plugin.h"
#include "source_internal.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

bool tc_is_folder(const char *path)
{
    struct stat about;
    const void *table = NULL;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode) &&
           !(tc_plugin_load("gdal", &table, NULL) == TC_OK && ((const struct tc_gdal_plugin *)table)->recognises(path));
}

/* Files that go with others: georeferences, statistics, overviews, headers, notes. */
static bool is_beside(const char *name)
{
    static const char *const endings[] = {".aux", ".xml",  ".prj", ".tfw",    ".wld", ".hdr",
                                          ".ovr", ".msk",  ".txt", ".md",     ".pdf", ".html",
                                          ".csv", ".json", ".clr", ".sha256", ".md5", ".tclip"};
    const char *dot = strrchr(name, '.');
    if (name[0] == '.' || !dot)
        return name[0] == '.';
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (strcasecmp(dot, endings[i]) == 0)
            return true;
    return false;
}

static int take(const struct dirent *entry)
{
    return !is_beside(entry->d_name);
}

static int by_bytes(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

/* Whether a file is one of heights; where it is and cannot be opened that is an error. */
static tc_status look_at(const char *path, const tc_source_options *options, bool *is_one_ret, tc_error *error)
{
    tc_source_options quiet = *options;
    quiet.say = NULL;
    tc_source *source = NULL;
    tc_status status = tc_source_open(path, &quiet, &source, error);
    *is_one_ret = status == TC_OK;
    tc_source_close(source);
    if (status == TC_ERR_UNSUPPORTED) {
        tc_say(options, false, "passed over: %s", error->text);
        return TC_OK;
    }
    return status;
}

tc_status tc_folder_list(const char *path, const tc_source_options *options, tc_folder *folder_ret, tc_error *error)
{
    struct dirent **entries = NULL;
    tc_error own = {0};
    error = error ? error : &own;
    *folder_ret = (tc_folder){0};
    int count = scandir(path, &entries, take, by_bytes);
    if (count < 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
    tc_folder folder = {.file = calloc((size_t)count + 1, sizeof *folder.file)};
    tc_status status = folder.file ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to list it", path);
    for (int i = 0; i < count; i++) {
        size_t length = strlen(path) + strlen(entries[i]->d_name) + 2;
        char *file = status == TC_OK ? malloc(length) : NULL;
        struct stat about;
        bool is_one = false;
        if (status == TC_OK && !file)
            status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to list it", path);
        if (file) {
            size_t end = strlen(path);
            snprintf(file, length, "%s%s%s", path, end > 0 && path[end - 1] == '/' ? "" : "/", entries[i]->d_name);
            if (stat(file, &about) == 0 && S_ISREG(about.st_mode))
                status = look_at(file, options, &is_one, error);
        }
        if (is_one && status == TC_OK)
            folder.file[folder.count++] = file;
        else
            free(file);
        free(entries[i]);
    }
    free(entries);
    if (status == TC_OK && folder.count == 0)
        status = tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected a folder of elevation files, found none in it", path);
    if (status == TC_OK)
        *folder_ret = folder;
    else
        tc_folder_free(&folder);
    return status;
}

void tc_folder_free(tc_folder *folder)
{
    for (int i = 0; i < folder->count; i++)
        free(folder->file[i]);
    free(folder->file);
    *folder = (tc_folder){0};
}

/* plugin.c - finding and loading the shared objects of plugin.h.
 *
 * A plugin is looked for beside the program, one directory above it (test programs lie in tests/ of the build), under
 * ../lib/terraclip of it (installed, also when the whole tree was moved) and where the build was to be installed.
 * RTLD_LOCAL keeps the symbols of the hundreds of libraries behind GDAL and OpenImageIO out of each other's way;
 * RTLD_NOW makes a missing library an error here and not a crash later. */
#include "plugin.h"

#include "common/base/status.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#ifndef TC_PLUGIN_DIR
#define TC_PLUGIN_DIR "/usr/local/lib/terraclip"
#endif

/* The one mutable global: what has been loaded. A plugin stays loaded until the process ends, since neither GDAL nor
 * OpenImageIO can be unloaded safely. */
static struct {
    pthread_mutex_t lock;
    struct {
        char name[16];
        const void *table;
    } entries[8];
    int count;
} loaded = {.lock = PTHREAD_MUTEX_INITIALIZER};

void tc_program_folder(char directory[PATH_MAX])
{
    ssize_t length = readlink("/proc/self/exe", directory, PATH_MAX - 1);
    directory[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(directory, '/');
    if (slash)
        *slash = '\0';
}

static tc_status find_and_load(const char *name, const void **table_ret, tc_error *error)
{
    char program[PATH_MAX], path[PATH_MAX + 64];
    tc_program_folder(program);
    static const char *const places[] = {"%s/terraclip-%s.so", "%s/../terraclip-%s.so",
                                         "%s/../lib/terraclip/terraclip-%s.so"};
    const int count = (int)(sizeof places / sizeof *places);
    bool found = false;
    for (int i = 0; i <= count && !found; i++) {
        if (i < count && !*program)
            continue;
        if (i < count)
            snprintf(path, sizeof path, places[i], program, name);
        else
            snprintf(path, sizeof path, "%s/terraclip-%s.so", TC_PLUGIN_DIR, name);
        found = access(path, R_OK) == 0;
    }
    if (!found)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "terraclip-%s.so: not found, expected in %.120s, its parent, its ../lib/terraclip or %.120s",
                       name, *program ? program : "the program's directory", TC_PLUGIN_DIR);

    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "terraclip-%s.so: cannot be loaded: %s", name, dlerror());
    const void *table = dlsym(library, "tc_plugin");
    if (!table) {
        dlclose(library);
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: not a Terraclip plugin, expected the symbol tc_plugin", path);
    }
    *table_ret = table;
    return TC_OK;
}

tc_status tc_plugin_load(const char *name, const void **table_ret, tc_error *error)
{
    tc_status status = TC_OK;
    pthread_mutex_lock(&loaded.lock);
    int i = 0;
    while (i < loaded.count && strcmp(loaded.entries[i].name, name) != 0)
        i++;
    if (i < loaded.count) {
        *table_ret = loaded.entries[i].table;
    } else if (i == (int)(sizeof loaded.entries / sizeof *loaded.entries) ||
               strlen(name) >= sizeof loaded.entries[0].name) {
        status = tc_fail(error, TC_ERR_USAGE, "plugin %s: no such plugin", name);
    } else {
        status = find_and_load(name, &loaded.entries[i].table, error);
        if (status == TC_OK) {
            strcpy(loaded.entries[i].name, name);
            *table_ret = loaded.entries[i].table;
            loaded.count++;
        }
    }
    pthread_mutex_unlock(&loaded.lock);
    return status;
}

bool tc_plugin_loaded(const char *name)
{
    bool found = false;
    pthread_mutex_lock(&loaded.lock);
    for (int i = 0; i < loaded.count; i++)
        found = found || strcmp(loaded.entries[i].name, name) == 0;
    pthread_mutex_unlock(&loaded.lock);
    return found;
}

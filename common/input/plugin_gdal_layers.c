/* plugin_gdal_layers.c - one raster of a file that holds several things: archives (.gz, .zip, .tar), which GDAL's
 * virtual file systems read, and formats that are lists of layers. Nothing is unpacked, nothing leaves the machine. */
#include "plugin_gdal.h"

#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES = 300 }; /* bytes of a list of names in a message */

/* Adds a name to a list of them, as far as there is room. */
static void list(char text[NAMES], const char *name)
{
    size_t used = strlen(text);
    if (used + strlen(name) + 3 < NAMES - 4)
        snprintf(text + used, NAMES - used, "%s%s", used ? ", " : "", name);
    else if (used < 3 || strcmp(text + used - 3, "...") != 0)
        snprintf(text + used, NAMES - used, ", ...");
}

/* ---- Archives --------------------------------------------------------------------------------------------------- */

/* The file system that reads an archive, by its content; NULL for another file. */
static const char *file_system_of(const char *path, bool *several_ret)
{
    unsigned char head[512] = {0};
    FILE *file = fopen(path, "rb");
    size_t got = file ? fread(head, 1, sizeof head, file) : 0;
    if (file)
        fclose(file);
    size_t length = strlen(path);
    *several_ret = true;
    if (got > 4 && memcmp(head, "PK\3\4", 4) == 0)
        return "/vsizip/";
    if (got == sizeof head && memcmp(head + 257, "ustar", 5) == 0)
        return "/vsitar/";
    if (got > 4 && head[0] == 0x1f && head[1] == 0x8b) {
        const char *tar[] = {".tgz", ".tar.gz"};
        for (int i = 0; i < 2; i++)
            if (length > strlen(tar[i]) && EQUAL(path + length - strlen(tar[i]), tar[i]))
                return "/vsitar/";
        *several_ret = false;
        return "/vsigzip/";
    }
    return NULL;
}

static bool is_hgt(const char *name)
{
    size_t length = strlen(name);
    return length > 4 && EQUAL(name + length - 4, ".hgt");
}

tc_status tc_gdal_look_inside(const char *path, const tc_source_options *options, char **inner_ret,
                              bool *layer_taken_ret, tc_error *error)
{
    bool several;
    const char *system = file_system_of(path, &several);
    *inner_ret = NULL;
    *layer_taken_ret = false;
    if (!system)
        return TC_OK;
    char root[4096];
    /* Braces tell the archive's own name from the names within. */
    if (snprintf(root, sizeof root, several ? "%s{%s}" : "%s%s", system, path) >= (int)sizeof root)
        return tc_fail(error, TC_ERR_IO, "%s: expected a shorter name", path);
    if (!several) {
        *inner_ret = CPLStrdup(root);
        return TC_OK;
    }
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    char **entries = VSIReadDirRecursive(root), names[NAMES] = "";
    int rasters = 0;
    const char *found = NULL;
    for (char **entry = entries; entry && *entry; entry++) {
        char name[8192];
        snprintf(name, sizeof name, "%s/%s", root, *entry);
        size_t length = strlen(*entry);
        if (length == 0 || (*entry)[length - 1] == '/' ||
            (!is_hgt(*entry) && !GDALIdentifyDriverEx(name, GDAL_OF_RASTER, NULL, NULL)))
            continue;
        if (options->layer && strcmp(options->layer, *entry) != 0 &&
            strcmp(options->layer, CPLGetFilename(*entry)) != 0) {
            list(names, *entry);
            continue;
        }
        list(names, *entry);
        found = *entry;
        rasters++;
    }
    tc_status status = TC_OK;
    if (rasters == 1) {
        char name[8192];
        snprintf(name, sizeof name, "%s/%s", root, found);
        *inner_ret = CPLStrdup(name);
        *layer_taken_ret = options->layer != NULL;
    } else if (!*names) {
        status =
            tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected an archive of an elevation file, found none in it", path);
    } else if (options->layer) {
        status = tc_fail(error, TC_ERR_USAGE, "--layer: expected one of %s, which are in %s, found '%.100s'", names,
                         path, options->layer);
    } else {
        status = tc_fail(error, TC_ERR_UNSUPPORTED,
                         "%s: expected an archive of one elevation file, found %d: --layer NAME takes one of %s", path,
                         rasters, names);
    }
    CSLDestroy(entries);
    tc_gdal_heard(&said);
    return status;
}

tc_status tc_gdal_unpack_hgt(const char *path, const tc_source_options *options, char **name_ret, bool *layer_taken_ret,
                             void **bytes_ret, size_t *size_ret, tc_error *error)
{
    enum { MOST = 1 << 30 };
    char *inner = NULL;
    *name_ret = NULL, *bytes_ret = NULL, *size_ret = 0;
    tc_gdal_start();
    tc_status status = tc_gdal_look_inside(path, options, &inner, layer_taken_ret, error);
    size_t length = inner ? strlen(inner) : 0;
    if (length > 3 && EQUAL(inner + length - 3, ".gz"))
        length -= 3; /* a .gz is named as what it holds */
    char *name = status == TC_OK && inner ? strndup(inner, length) : NULL;
    if (!name || !is_hgt(name)) {
        free(name);
        CPLFree(inner);
        return status;
    }
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    VSIStatBufL about;
    VSILFILE *file = VSIStatL(inner, &about) == 0 && about.st_size <= MOST ? VSIFOpenL(inner, "rb") : NULL;
    void *bytes = file ? malloc((size_t)about.st_size + 1) : NULL;
    size_t got = bytes ? VSIFReadL(bytes, 1, (size_t)about.st_size, file) : 0;
    if (file)
        VSIFCloseL(file);
    tc_gdal_heard(&said);
    CPLFree(inner);
    if (!bytes || got != (size_t)about.st_size) {
        free(bytes);
        free(name);
        return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be unpacked, damaged or too large", path);
    }
    *name_ret = name, *bytes_ret = bytes, *size_ret = got;
    return TC_OK;
}

/* ---- Layers ----------------------------------------------------------------------------------------------------- */

/* What users call a layer: the last part of FORMAT:"file":name. */
static void name_of(const char *subdataset, char name[256])
{
    const char *colon = strrchr(subdataset, ':');
    snprintf(name, 256, "%s", colon ? colon + 1 : subdataset);
    while (*name == '/')
        memmove(name, name + 1, strlen(name));
}

tc_status tc_gdal_take_layer(const char *path, const tc_source_options *options, bool layer_taken,
                             GDALDatasetH *dataset, tc_error *error)
{
    char **sets = GDALGetMetadata(*dataset, "SUBDATASETS"), names[NAMES] = "";
    int count = 0;
    const char *found = NULL;
    for (int i = 1; sets && i <= CSLCount(sets) / 2; i++) {
        char key[40], name[256];
        snprintf(key, sizeof key, "SUBDATASET_%d_NAME", i);
        const char *set = CSLFetchNameValue(sets, key);
        if (!set)
            continue;
        name_of(set, name);
        list(names, name);
        count++;
        if (options->layer && strcmp(options->layer, name) == 0)
            found = set;
        else if (!options->layer && count == 1)
            found = set;
    }
    int bands = GDALGetRasterCount(*dataset);
    if (count == 0) {
        if (options->layer && !layer_taken)
            return tc_fail(error, TC_ERR_USAGE, "--layer: expected none for %s, which has no layers, found '%.100s'",
                           path, options->layer);
        return bands > 0 ? TC_OK
                         : tc_fail(error, TC_ERR_UNSUPPORTED,
                                   "%s: holds no raster of its own, expected one channel of heights", path);
    }
    if (options->layer && !found && !layer_taken)
        return tc_fail(error, TC_ERR_USAGE, "--layer: expected one of %s, which are in %s, found '%.100s'", names, path,
                       options->layer);
    bool own = bands > 0 && (!options->layer || layer_taken);
    if (own) {
        if (count > 1)
            tc_say(options, true,
                   "the file holds several rasters, of which its own is taken; --layer NAME takes one of %s", names);
        return TC_OK;
    }
    if (!options->layer && count > 1)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected one layer, found %d: --layer NAME takes one of %s",
                       path, count, names);
    char *name = CPLStrdup(found);
    GDALClose(*dataset);
    *dataset = GDALOpenEx(name, GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, NULL, NULL, NULL);
    CPLFree(name);
    return *dataset ? TC_OK : tc_fail(error, TC_ERR_FORMAT, "%s: its layer cannot be opened", path);
}

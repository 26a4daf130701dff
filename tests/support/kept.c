/* kept.c - heights that take long to make, kept from one program to the next. */
#include "kept.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static bool read_kept(const char *path, float *z, size_t samples)
{
    FILE *f = fopen(path, "rb");
    bool whole = f && fread(z, sizeof *z, samples, f) == samples && fgetc(f) == EOF;
    if (f)
        fclose(f);
    return whole;
}

/* Where they cannot be written they are made again the next time. */
static void keep(const char *path, const char *temporary, const float *z, size_t samples)
{
    FILE *f = fopen(temporary, "wb");
    if (!f)
        return;
    bool whole = fwrite(z, sizeof *z, samples, f) == samples;
    if (fclose(f) == 0 && whole)
        rename(temporary, path);
    else
        remove(temporary);
}

void kept_heights(const char *name, size_t samples, void (*make)(void *context, float *z), void *context, float *z)
{
    const char *folder = getenv("TERRACLIP_TERRAINS");
    char path[4096], temporary[4200];
    bool kept = folder && *folder && snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path;
    if (kept && read_kept(path, z, samples))
        return;
    make(context, z);
    if (kept) {
        snprintf(temporary, sizeof temporary, "%s.new", path);
        keep(path, temporary, z, samples);
    }
}

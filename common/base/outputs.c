/* outputs.c - files compared by device and inode. */
#include "outputs.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "status.h"

struct tc_output {
    char *name;
    bool there;
    dev_t device; /* of the file; of its folder where it is not there */
    ino_t inode;
};

static const char *last_part(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? slash + 1 : name;
}

/* False for what cannot be lost: a device, a pipe, a folder, a file in a folder that is not there. */
static bool identify(const char *name, struct tc_output *o)
{
    struct stat about;
    o->there = stat(name, &about) == 0;
    if (o->there && !S_ISREG(about.st_mode))
        return false;
    if (!o->there) {
        size_t length = (size_t)(last_part(name) - name);
        char *folder = length ? strndup(name, length) : strdup(".");
        bool found = folder && stat(folder, &about) == 0;
        free(folder);
        if (!found)
            return false;
    }
    o->device = about.st_dev, o->inode = about.st_ino;
    return true;
}

static const struct tc_output *find(const tc_outputs *outputs, const struct tc_output *o, const char *name)
{
    for (int i = 0; i < outputs->count; i++) {
        const struct tc_output *other = &outputs->list[i];
        if (other->there == o->there && other->device == o->device && other->inode == o->inode &&
            (o->there || strcmp(last_part(other->name), last_part(name)) == 0))
            return other;
    }
    return NULL;
}

static tc_status append(tc_outputs *outputs, const struct tc_output *o, const char *name, tc_error *error)
{
    if (outputs->count == outputs->room) {
        int room = outputs->room ? 2 * outputs->room : 8;
        struct tc_output *list = realloc(outputs->list, (size_t)room * sizeof *list);
        if (!list)
            return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
        outputs->list = list, outputs->room = room;
    }
    struct tc_output *own = &outputs->list[outputs->count];
    *own = *o;
    own->name = strdup(name);
    if (!own->name)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    outputs->count++;
    return TC_OK;
}

tc_status tc_outputs_add(tc_outputs *outputs, const char *name, tc_error *error)
{
    struct tc_output o;
    if (!identify(name, &o))
        return TC_OK;
    const struct tc_output *other = find(outputs, &o, name);
    if (other)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected another file than the output %s, found the same", name,
                       other->name);
    return append(outputs, &o, name, error);
}

tc_status tc_outputs_add_frame(tc_outputs *outputs, const char *name, tc_error *error)
{
    struct tc_output o;
    return identify(name, &o) && o.there ? append(outputs, &o, name, error) : TC_OK;
}

bool tc_same_place(const char *name, const char *other)
{
    struct tc_output a, b;
    bool alike = strcmp(last_part(name), last_part(other)) == 0; /* most are not; without asking the system */
    return alike && identify(name, &a) && identify(other, &b) && a.there == b.there && a.device == b.device &&
           a.inode == b.inode;
}

tc_status tc_outputs_spare(const tc_outputs *outputs, const char *input, tc_error *error)
{
    struct tc_output o;
    if (!outputs || outputs->count == 0 || !identify(input, &o) || !o.there)
        return TC_OK;
    const struct tc_output *same = find(outputs, &o, input);
    if (same)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected another file than the input %s, found the same", same->name,
                       input);
    return TC_OK;
}

void tc_outputs_free(tc_outputs *outputs)
{
    for (int i = 0; i < outputs->count; i++)
        free(outputs->list[i].name);
    free(outputs->list);
    *outputs = (tc_outputs){0};
}

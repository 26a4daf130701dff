/* outfile.c - writing beside the target, flushing, renaming: a failure or a crash leaves an old file as it was. */
#include "outfile.h"

#include "common/core/base/status.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void release(tc_outfile *outfile)
{
    free(outfile->target);
    free(outfile->temporary);
    *outfile = (tc_outfile){0};
}

tc_status tc_outfile_begin(const char *path, tc_outfile *outfile_ret, tc_error *error)
{
    struct stat about;
    bool exists = stat(path, &about) == 0;
    if (exists && !S_ISREG(about.st_mode))
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: expected a regular file, found a %s", path,
                       S_ISDIR(about.st_mode) ? "directory" : "device or pipe");
    /* Renaming onto an old file needs no right to write it, but who took that right away meant it. */
    if (exists && access(path, W_OK) != 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));

    tc_outfile outfile = {0};
    outfile.target = exists ? realpath(path, NULL) : strdup(path);
    const char *target = outfile.target ? outfile.target : path;
    size_t room = strlen(target) + 64;
    outfile.temporary = malloc(room);
    if (!outfile.target || !outfile.temporary) {
        release(&outfile);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to write it", path);
    }
    const char *slash = strrchr(target, '/'), *name = slash ? slash + 1 : target;
    const char *dot = strrchr(name, '.');
    const char *extension = dot && dot > name ? dot : "";
    int file = -1;
    for (int n = 0; n < 100 && file < 0; n++) {
        snprintf(outfile.temporary, room, "%.*s.terraclip-%ld-%d%s", (int)(name - target), target, (long)getpid(), n,
                 extension);
        file = open(outfile.temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); /* the umask applies */
        if (file < 0 && errno != EEXIST)
            break;
    }
    if (file < 0) {
        int why = errno;
        release(&outfile);
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(why));
    }
    if (exists)
        (void)!fchmod(file, about.st_mode & 07777); /* what cannot be kept is not worth failing for */
    close(file);
    *outfile_ret = outfile;
    return TC_OK;
}

tc_status tc_outfile_end(tc_outfile *outfile, tc_status status, tc_error *error)
{
    if (status == TC_OK) {
        /* Flushed before the rename: else a power cut could leave the name with nothing behind it. */
        int file = open(outfile->temporary, O_RDWR | O_CLOEXEC);
        bool done = file >= 0 && fsync(file) == 0;
        int why = errno;
        if (file >= 0 && close(file) != 0 && done) {
            done = false;
            why = errno;
        }
        if (done && rename(outfile->temporary, outfile->target) != 0) {
            done = false;
            why = errno;
        }
        if (!done)
            status = tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", outfile->target, strerror(why));
    }
    if (status != TC_OK)
        unlink(outfile->temporary);
    release(outfile);
    return status;
}

tc_status tc_outfile_probe(const char *path, tc_error *error)
{
    tc_outfile probe;
    tc_status status = tc_outfile_begin(path, &probe, error);
    if (status == TC_OK)
        tc_outfile_end(&probe, TC_ERR_IO, NULL);
    return status;
}

/* outfile.c - writing beside the target, flushing, renaming: a failure or a crash leaves an old file as it was. */
#include "outfile.h"

#include "status.h"

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

/* ---- Files without a name ------------------------------------------------------------------------------------ */

int tc_outfile_nameless(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *name = malloc(strlen(path) + 32);
    if (!name)
        return -1;
    if (slash)
        snprintf(name, (size_t)(slash - path) + 2, "%s", path);
    else
        strcpy(name, "./");
    int file = open(name, O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (file < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
        /* A file system that has none: a name that is taken away at once. */
        strcat(name, ".terraclip-XXXXXX");
        file = mkostemp(name, O_CLOEXEC);
        if (file >= 0)
            unlink(name);
    }
    int why = errno;
    free(name);
    errno = why;
    return file;
}

/* For file systems that cannot give a nameless file a name. */
static bool copy_file(int from, const char *to_name)
{
    char block[1 << 16];
    int to = open(to_name, O_WRONLY | O_TRUNC | O_CLOEXEC);
    bool good = to >= 0;
    for (off_t at = 0; good;) {
        ssize_t n = pread(from, block, sizeof block, at);
        if (n <= 0) {
            good = n == 0;
            break;
        }
        for (ssize_t done = 0; done < n && good;) {
            ssize_t written = write(to, block + done, (size_t)(n - done));
            good = written > 0;
            done += written;
        }
        at += n;
    }
    int why = errno;
    if (to >= 0 && close(to) != 0 && good)
        good = false;
    else
        errno = why;
    return good;
}

tc_status tc_outfile_adopt(const tc_outfile *outfile, int nameless, tc_error *error)
{
    struct stat about;
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", nameless);
    bool good = stat(outfile->temporary, &about) == 0 && fsync(nameless) == 0;
    if (good)
        (void)!fchmod(nameless, about.st_mode & 07777);
    if (good && unlink(outfile->temporary) == 0 &&
        linkat(AT_FDCWD, link, AT_FDCWD, outfile->temporary, AT_SYMLINK_FOLLOW) == 0)
        return TC_OK;
    if (good) { /* the name may be gone by now */
        int file = open(outfile->temporary, O_WRONLY | O_CREAT | O_CLOEXEC, about.st_mode & 07777);
        good = file >= 0;
        if (good)
            close(file);
    }
    if (good && copy_file(nameless, outfile->temporary))
        return TC_OK;
    return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", outfile->target, strerror(errno));
}

tc_status tc_outfile_probe(const char *path, tc_error *error)
{
    tc_outfile probe;
    tc_status status = tc_outfile_begin(path, &probe, error);
    if (status == TC_OK)
        tc_outfile_end(&probe, TC_ERR_IO, NULL);
    return status;
}

/* spool.c - rows on disk by pread and pwrite: not by mmap, so that what the system keeps of them in its cache does not
 * count as this process's memory; but for what is too small to tell, or is touched all over. */
#include "spool.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "common/base/outfile.h"
#include "common/base/rect.h"
#include "common/base/status.h"

tc_status tc_spool_create(const char *path, int64_t width, int64_t height, size_t element, tc_spool *spool_ret,
                          tc_error *error)
{
    double size = (double)width * (double)height * (double)element;
    if (size > 0x1p62)
        return tc_fail(error, TC_ERR_IO, "%s: no temporary file of %.1f GiB can be made beside it", path,
                       size / (1 << 30));
    int file = tc_outfile_nameless(path);
    if (file < 0)
        return tc_fail(error, TC_ERR_IO, "%s: no temporary file can be made beside it: %s", path, strerror(errno));
    if (ftruncate(file, width * height * (off_t)element) != 0) {
        tc_status status = tc_fail(error, TC_ERR_IO, "%s: no temporary file of %.1f GiB can be made beside it: %s",
                                   path, size / (1 << 30), strerror(errno));
        close(file);
        return status;
    }
    *spool_ret = (tc_spool){file, width, height, element, path};
    return TC_OK;
}

void tc_spool_close(tc_spool *spool)
{
    if (spool->file >= 0)
        close(spool->file);
    *spool = TC_SPOOL_NONE;
}

/* One run of bytes; write: from `bytes` into the file. */
static tc_status transfer(const tc_spool *s, int64_t offset, char *bytes, size_t size, bool write, tc_error *error)
{
    while (size > 0) {
        ssize_t n = write ? pwrite(s->file, bytes, size, offset) : pread(s->file, bytes, size, offset);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return tc_fail(error, TC_ERR_IO, "%s: the temporary file beside it cannot be %s: %s", s->path,
                           write ? "written" : "read", n < 0 ? strerror(errno) : "it is too short");
        bytes += n, offset += n, size -= (size_t)n;
    }
    return TC_OK;
}

static tc_status move_rect(const tc_spool *s, tc_rect r, char *memory, ptrdiff_t stride, bool write, tc_error *error)
{
    int64_t count = r.x1 - r.x0, rows = r.y1 - r.y0;
    if (count <= 0 || rows <= 0)
        return TC_OK;
    if (count == s->width && stride == s->width) /* one piece */
        return transfer(s, r.y0 * s->width * (int64_t)s->size, memory, (size_t)(rows * count) * s->size, write, error);
    for (int64_t j = 0; j < rows; j++) {
        tc_status status = transfer(s, ((r.y0 + j) * s->width + r.x0) * (int64_t)s->size,
                                    memory + j * stride * (ptrdiff_t)s->size, (size_t)count * s->size, write, error);
        if (status)
            return status;
    }
    return TC_OK;
}

tc_status tc_spool_read(const tc_spool *spool, tc_rect rect, void *to, ptrdiff_t stride, tc_error *error)
{
    return move_rect(spool, rect, to, stride, false, error);
}

tc_status tc_spool_read_round(const tc_spool *spool, tc_rect rect, void *to, ptrdiff_t stride, tc_error *error)
{
    tc_status status = TC_OK;
    for (int64_t x = rect.x0, x1; x < rect.x1 && !status; x = x1) {
        int64_t turn = tc_turn(x, spool->width);
        x1 = tc_min64(rect.x1, turn + spool->width);
        tc_rect part = {x - turn, rect.y0, x1 - turn, rect.y1};
        status = tc_spool_read(spool, part, (char *)to + (x - rect.x0) * (int64_t)spool->size, stride, error);
    }
    return status;
}

tc_status tc_spool_write(const tc_spool *spool, tc_rect rect, const void *from, ptrdiff_t stride, tc_error *error)
{
    return move_rect(spool, rect, (char *)from, stride, true, error);
}

tc_status tc_spool_map(const char *path, size_t size, void **bytes_ret, tc_error *error)
{
    int file = tc_outfile_nameless(path), why = errno;
    void *bytes = MAP_FAILED;
    /* All of its room at once: a disk that is full while a mapping is written to would be a signal, not an error. */
    if (file >= 0 && (why = posix_fallocate(file, 0, (off_t)size)) == 0) {
        bytes = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        why = errno;
    }
    if (file >= 0)
        close(file);
    if (bytes == MAP_FAILED)
        return tc_fail(error, TC_ERR_IO, "%s: no temporary file of %.1f GiB can be made beside it: %s", path,
                       (double)size / (1 << 30), strerror(why));
    *bytes_ret = bytes;
    return TC_OK;
}

/* pack_file.c - what has been packed into one file, and the file into its place. */
#include <errno.h>
#include <unistd.h>

#include "common/base/outfile.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_internal.h"

static tc_status write_all(int file, const void *bytes, size_t size, int64_t at, const char *path, tc_error *error)
{
    const char *from = bytes;
    for (size_t done = 0; done < size;) {
        ssize_t n = pwrite(file, from + done, size - done, at + (int64_t)done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
        done += (size_t)n;
    }
    return TC_OK;
}

/* The head, and with it where the levels come to lie in the container. beyond: bytes that follow the levels. */
static tc_status make_head(tc_packer *p, int64_t beyond, tc_byte_writer *head, tc_error *error)
{
    tc_container *c = &p->container;
    tc_status status = tc_container_write(c, head); /* for its size */
    int64_t at = (int64_t)head->size;
    for (int l = c->base; l < c->levels; l++)
        c->record[l].begin += at, c->record[l].end += at;
    c->info.bytes = p->result.bytes = at + p->body_size + beyond;
    head->size = 0;
    if (!status)
        status = tc_container_write(c, head);
    if (status)
        return tc_fail(error, status, "%s: not enough memory", p->path);
    /* What a reader would refuse shall not replace an old file. */
    tc_container check = {0};
    size_t size;
    status = tc_container_read(p->path, head->bytes, head->size, &check, &size, error);
    if (status == TC_ERR_FORMAT)
        tc_fail(error, status = TC_ERR_UNSUPPORTED, "%s: the terrain's numbers are beyond what the format holds",
                p->path);
    tc_container_free(&check);
    return status;
}

/* Head and body, from `begin` on. */
static tc_status write_container(const tc_packer *p, const tc_byte_writer *head, int file, int64_t begin,
                                 tc_error *error)
{
    enum { BLOCK = 1 << 20 };
    tc_status status = write_all(file, head->bytes, head->size, begin, p->path, error);
    char *block = malloc(BLOCK);
    if (!status && !block)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (int64_t done = 0; done < p->body_size && !status;) {
        ssize_t n = pread(p->body, block, (size_t)tc_min64(BLOCK, p->body_size - done), done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            status = tc_fail(error, TC_ERR_IO, "%s: its temporary file cannot be read", p->path);
        else
            status = write_all(file, block, (size_t)n, begin + (int64_t)head->size + done, p->path, error);
        done += n;
    }
    free(block);
    return status;
}

/* All containers into one file. */
static tc_status assemble(tc_packer *p, tc_packer *const cap[TC_CAP_CHARTS], int file, tc_error *error)
{
    tc_byte_writer head = {0}, cap_head[TC_CAP_CHARTS] = {{0}, {0}};
    tc_container *c = &p->container;
    int64_t beyond = 0;
    tc_status status = TC_OK;
    c->info.charts = 1;
    for (int n = 0; n < TC_CAP_CHARTS && cap[0] && !status; n++) {
        status = make_head(cap[n], 0, &cap_head[n], error);
        c->info.charts++;
        beyond += c->cap_bytes[n] = cap[n]->container.info.bytes;
    }
    if (!status)
        status = make_head(p, beyond, &head, error);
    if (!status)
        status = write_container(p, &head, file, 0, error);
    for (int n = 0; n < TC_CAP_CHARTS && cap[0] && !status; n++)
        status = write_container(cap[n], &cap_head[n], file, tc_container_cap_begin(c, n), error);
    free(head.bytes);
    for (int n = 0; n < TC_CAP_CHARTS; n++)
        free(cap_head[n].bytes);
    return status;
}

tc_status tc_pack_put_in_place(tc_packer *p, tc_packer *const cap[TC_CAP_CHARTS], tc_error *error)
{
    int file = tc_outfile_nameless(p->path);
    if (file < 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", p->path, strerror(errno));
    tc_status status = assemble(p, cap, file, error);
    /* Now rather than while a name stands beside the target, which a kill would leave there. */
    if (!status && fsync(file) != 0)
        status = tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", p->path, strerror(errno));
    tc_outfile outfile;
    if (!status && !(status = tc_outfile_begin(p->path, &outfile, error)))
        status = tc_outfile_end(&outfile, tc_outfile_adopt(&outfile, file, error), error);
    close(file);
    return status;
}

/* pack_file.c - what has been packed into one file, and the file into its place. */
#include <errno.h>
#include <unistd.h>

#include "common/base/outfile.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/packed/file/envelope.h"
#include "pack_internal.h"

tc_status tc_pack_write(int file, const void *bytes, size_t size, int64_t at, const char *path, tc_error *error)
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

/* Charts of a file. */
typedef struct file_charts {
    const tc_packer *packer[TC_MOST_CHARTS];
    tc_envelope envelope;                                 /* borrows the packers' containers */
    int64_t body_at[TC_MOST_CHARTS][TC_MAX_FIELD_LEVELS]; /* where levels begin in the packers' bodies; [l - 1] */
} file_charts;

static void add_chart(file_charts *all, const tc_packer *p)
{
    int n = all->envelope.charts++;
    const tc_container *c = &p->container;
    all->packer[n] = p;
    all->envelope.chart[n].container = *c;
    for (int l = c->base; l < c->levels; l++)
        all->body_at[n][l] = c->record[l].begin;
}

/* The head, and with it where the levels come to lie; into the file. */
static tc_status write_head(file_charts *all, int file, const char *path, tc_error *error)
{
    tc_byte_writer head = {0};
    tc_envelope_place(&all->envelope);
    tc_status status = tc_envelope_write(&all->envelope, &head); /* for its size */
    tc_envelope_lay_out(&all->envelope, head.size);
    head.size = 0;
    if (!status)
        status = tc_envelope_write(&all->envelope, &head);
    if (status)
        tc_fail(error, status, "%s: not enough memory", path);
    /* What a reader would refuse shall not replace an old file. */
    tc_envelope *check = NULL;
    size_t size;
    if (!status)
        status = tc_envelope_read(path, head.bytes, head.size, &check, &size, error);
    if (status == TC_ERR_FORMAT)
        tc_fail(error, status = TC_ERR_UNSUPPORTED, "%s: the terrain's numbers are beyond what the format holds", path);
    tc_envelope_free(check);
    if (!status)
        status = tc_pack_write(file, head.bytes, head.size, 0, path, error);
    free(head.bytes);
    return status;
}

/* A level from its packer's body to its place in the file. */
static tc_status copy_level(const file_charts *all, int n, int l, int file, char *block, size_t room, tc_error *error)
{
    const tc_packer *p = all->packer[n];
    const tc_level_record *r = &all->envelope.chart[n].container.record[l - 1];
    tc_status status = TC_OK;
    for (int64_t done = 0, size = r->end - r->begin; done < size && !status;) {
        ssize_t got =
            pread(p->body, block, (size_t)tc_min64((int64_t)room, size - done), all->body_at[n][l - 1] + done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return tc_fail(error, TC_ERR_IO, "%s: its temporary file cannot be read", p->path);
        status = tc_pack_write(file, block, (size_t)got, r->begin + done, p->path, error);
        done += got;
    }
    return status;
}

/* All charts into one file. */
static tc_status assemble(tc_packer *p, tc_packer *const chart[], int charts, int file, tc_error *error)
{
    enum { BLOCK = 1 << 20 };
    file_charts *all = calloc(1, sizeof *all);
    char *block = malloc(BLOCK);
    tc_status status = TC_OK;
    if (!all || !block)
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    if (!status) {
        for (int n = 0; n < charts; n++)
            add_chart(all, chart[n]);
        all->envelope.errors = true;
        status = write_head(all, file, p->path, error);
    }
    for (int n = 0; !status && n < all->envelope.charts; n++) {
        const tc_container *c = &all->envelope.chart[n].container;
        for (int l = c->base + 1; l <= c->levels && !status; l++)
            status = copy_level(all, n, l, file, block, BLOCK, error);
    }
    if (!status)
        status = tc_pack_errors(p, file, &all->envelope, error);
    if (!status)
        status = write_head(all, file, p->path, error);
    if (!status)
        p->result.bytes = all->envelope.bytes;
    free(block), free(all);
    return status;
}

tc_status tc_pack_put_in_place(tc_packer *p, tc_packer *const chart[], int charts, tc_error *error)
{
    int file = tc_outfile_nameless(p->path);
    if (file < 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", p->path, strerror(errno));
    tc_status status = assemble(p, chart, charts, file, error);
    /* Now rather than while a name stands beside the target, which a kill would leave there. */
    if (!status && fsync(file) != 0)
        status = tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", p->path, strerror(errno));
    tc_outfile outfile;
    if (!status && !(status = tc_outfile_begin(p->path, &outfile, error)))
        status = tc_outfile_end(&outfile, tc_outfile_adopt(&outfile, file, error), error);
    close(file);
    return status;
}

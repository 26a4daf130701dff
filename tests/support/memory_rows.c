/* memory_rows.c - rows in memory (memory_rows.h). */
#include "memory_rows.h"

#include <stdlib.h>
#include <string.h>

static bool fails(row_store *s)
{
    return ++s->calls == s->fail_at;
}

static tc_status check(const memory_rows *m, int64_t y0, int64_t rows)
{
    return y0 < 0 || rows < 1 || y0 + rows > m->height ? TC_ERR_CONTEXT : TC_OK;
}

static tc_status read_rows(void *context, int64_t y0, int64_t rows, float *z)
{
    memory_rows *m = context;
    if (fails(m->store))
        return m->store->failure;
    if (check(m, y0, rows))
        return TC_ERR_CONTEXT;
    memcpy(z, m->z + y0 * m->width, (size_t)(rows * m->width) * sizeof *z);
    if (m == &m->store->levels[0])
        m->store->rows_read += rows;
    return TC_OK;
}

static tc_status write_rows(void *context, int64_t y0, int64_t rows, const float *z)
{
    memory_rows *m = context;
    if (fails(m->store))
        return m->store->failure;
    if (check(m, y0, rows))
        return TC_ERR_CONTEXT;
    memcpy(m->z + y0 * m->width, z, (size_t)(rows * m->width) * sizeof *z);
    if (m == &m->store->levels[0])
        m->store->rows_written += rows;
    return TC_OK;
}

static tc_fill_rows add_level(row_store *s, float *z, int64_t width, int64_t height)
{
    memory_rows *m = &s->levels[s->count++];
    *m = (memory_rows){s, width, height, z};
    return (tc_fill_rows){m, width, height, read_rows, write_rows};
}

tc_fill_rows row_store_begin(row_store *store, float *z, int64_t width, int64_t height)
{
    memset(store, 0, sizeof *store);
    return add_level(store, z, width, height);
}

tc_status row_store_scratch(void *context, int64_t width, int64_t height, tc_fill_rows *rows_ret)
{
    row_store *s = context;
    if (fails(s))
        return s->failure;
    float *z = malloc((size_t)(width * height) * sizeof *z);
    if (!z)
        return TC_ERR_MEMORY;
    memset(z, 0x7b, (size_t)(width * height) * sizeof *z); /* something large that nobody may see */
    s->scratch_samples += width * height;
    *rows_ret = add_level(s, z, width, height);
    return TC_OK;
}

void row_store_end(row_store *store)
{
    for (int k = 1; k < store->count; k++)
        free(store->levels[k].z);
}

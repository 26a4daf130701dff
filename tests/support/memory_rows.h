/* memory_rows.h - the row interface of fill_rows.h over memory, with books kept and failures on demand. */
#ifndef MEMORY_ROWS_H
#define MEMORY_ROWS_H

#include "common/field/fill_rows.h"

typedef struct row_store row_store;

/* One level: z is not owned where it is given. */
typedef struct memory_rows {
    row_store *store;
    int64_t width, height;
    float *z;
} memory_rows;

/* All levels of one filling. */
struct row_store {
    memory_rows levels[40]; /* 0: the finest */
    int count;
    int64_t rows_read, rows_written; /* of the finest */
    int64_t scratch_samples;
    int64_t calls, fail_at; /* the call with this number fails, where above 0 */
    tc_status failure;
};

/* Sets up *store and gives the rows of z. */
tc_fill_rows row_store_begin(row_store *store, float *z, int64_t width, int64_t height);
tc_status row_store_scratch(void *store, int64_t width, int64_t height, tc_fill_rows *rows_ret);
/* Frees the coarser levels. */
void row_store_end(row_store *store);

#endif

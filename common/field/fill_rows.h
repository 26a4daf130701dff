/* fill_rows.h - smooth surfaces over the voids of a height field that does not fit memory. */
#ifndef TC_FILL_ROWS_H
#define TC_FILL_ROWS_H

#include "common/terraclip.h"

/* A height field somewhere else, read and written by rows; z[(y - y0) * width + x], NaN where void. */
typedef struct tc_fill_rows {
    void *context;
    int64_t width, height;
    tc_status (*read)(void *context, int64_t y0, int64_t rows, float *z);
    tc_status (*write)(void *context, int64_t y0, int64_t rows, const float *z);
} tc_fill_rows;

/* Sets *rows_ret to room for a coarser level, of a quarter of the samples of the level before. What it holds does not
 * matter; every row is written before it is read. The maker frees it after the filling. */
typedef tc_status (*tc_fill_scratch)(void *context, int64_t width, int64_t height, tc_fill_rows *rows_ret);

/* Zero is the default everywhere. */
typedef struct tc_fill_options {
    int64_t memory_samples; /* levels of at most so many are filled in memory; 0: 4 million. Changes the result */
    int64_t block_rows;     /* rows read or written at once at most; 0: about 1 MiB. Does not change the result */
} tc_fill_options;

/* Replaces the voids of *rows by a surface much like that of tc_fill_voids() (fill.h), and exactly that where all
 * fits options->memory_samples. Valid samples stay as they are, bit for bit; filled ones lie within the range of the
 * valid ones, which must be finite. Rows without voids are not written.
 *
 * Reads all once, and rows with voids and those beside them once more; in memory are, beside the level filled at once,
 * about 30 rows, and a byte for every row. Coarser levels take up to a third of the finest one's room in scratch.
 * TC_ERR_USAGE where all samples are void; statuses of the functions given are passed on, and the rows are then partly
 * filled. options may be NULL. */
tc_status tc_fill_void_rows(const tc_fill_rows *rows, tc_fill_scratch scratch, void *scratch_context,
                            const tc_fill_options *options);

#endif

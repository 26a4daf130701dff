/* outfile.h - files that appear whole or not at all. */
#ifndef TC_OUTFILE_H
#define TC_OUTFILE_H

#include "common/terraclip.h"

/* A file being written: temporary lies beside the target and has its extension, so that a library can open it by
 * name. */
typedef struct tc_outfile {
    char *target;    /* what the temporary file will replace: path, or what it links to; owned */
    char *temporary; /* owned */
} tc_outfile;

/* Makes an empty temporary file beside path. TC_ERR_IO where that is not possible or path is no regular file. */
tc_status tc_outfile_begin(const char *path, tc_outfile *outfile_ret, tc_error *error);

/* Ends the writing. status TC_OK: flushes the temporary file to the disk and renames it to the target; else removes it.
 * Returns status, or why the last steps failed. */
tc_status tc_outfile_end(tc_outfile *outfile, tc_status status, tc_error *error);

/* Whether path could be written: begins, and takes the temporary file away again. */
tc_status tc_outfile_probe(const char *path, tc_error *error);

#endif

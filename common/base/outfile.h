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

/* A file without a name in the folder of path: gone with the process unless adopted. -1 and errno where there can be
 * none. */
int tc_outfile_nameless(const char *path);

/* Makes a file of tc_outfile_nameless() the temporary file, so that a process killed before this leaves nothing. The
 * descriptor stays the caller's. */
tc_status tc_outfile_adopt(const tc_outfile *outfile, int nameless, tc_error *error);

/* Whether path could be written: begins, and takes the temporary file away again. */
tc_status tc_outfile_probe(const char *path, tc_error *error);

#endif

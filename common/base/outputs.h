/* outputs.h - what a program writes is nothing that it reads, and no two things that it writes are one file. Files are
 * compared by device and inode, so through links; those that are not there yet by folder and name. Devices and pipes
 * may be both. */
#ifndef TC_OUTPUTS_H
#define TC_OUTPUTS_H

#include "common/terraclip.h"

/* The files that a program is going to write; zero is none. */
typedef struct tc_outputs {
    struct tc_output *list; /* owned */
    int count, room;
} tc_outputs;
void tc_outputs_free(tc_outputs *outputs);

/* Adds a file; name is copied. TC_ERR_USAGE where it is one of those added before. */
tc_status tc_outputs_add(tc_outputs *outputs, const char *name, tc_error *error);

/* Adds one of a million files of different names (frames of a flight): it is not looked for among those before, and
 * costs nothing where it is not there yet. */
tc_status tc_outputs_add_frame(tc_outputs *outputs, const char *name, tc_error *error);

/* Whether two names are of one file, or would be: the same name in the same folder. */
bool tc_same_place(const char *name, const char *other);

/* TC_ERR_USAGE where a file that is read is among the outputs. outputs may be NULL. */
tc_status tc_outputs_spare(const tc_outputs *outputs, const char *input, tc_error *error);

#endif

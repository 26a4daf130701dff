/* folder.h - the elevation files of a folder, as inputs of a mosaic. */
#ifndef TC_FOLDER_H
#define TC_FOLDER_H

#include "source.h"

/* Paths of files, sorted by name. */
typedef struct tc_folder {
    char **file;
    int count;
} tc_folder;

/* Whether it is one, and no raster of a format that is a folder. */
bool tc_is_folder(const char *path);

/* Lists what can be read as heights, without folders within; what is of no elevation format is passed over (said as a
 * note). TC_ERR_UNSUPPORTED where nothing is left; errors of a file that is one, but damaged, are passed on. Freed with
 * tc_folder_free. */
tc_status tc_folder_list(const char *path, const tc_source_options *options, tc_folder *folder_ret, tc_error *error);
void tc_folder_free(tc_folder *folder);

#endif

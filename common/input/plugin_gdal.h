/* plugin_gdal.h - what the files of terraclip-gdal.so share. */
#ifndef TC_PLUGIN_GDAL_H
#define TC_PLUGIN_GDAL_H

#include "plugin_tables.h"

/* GDAL's messages during one call: the first failure is the cause, later ones are its echo. */
typedef struct tc_gdal_messages {
    char failure[256];
    char warning[256];
} tc_gdal_messages;

/* Sets GDAL up, once. */
void tc_gdal_start(void);

/* From here on this thread's messages are kept instead of printed; ends that and returns what GDAL said. */
void tc_gdal_listen(tc_gdal_messages *messages);
const char *tc_gdal_heard(const tc_gdal_messages *messages);

tc_status tc_gdal_write_tiff(const char *path, const char *temporary, const tc_tiff_options *options,
                             tc_sample_row_function row, void *context, tc_error *error);

#endif

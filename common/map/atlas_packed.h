/* atlas_packed.h - the charts of a planet in a packed file. */
#ifndef TC_ATLAS_PACKED_H
#define TC_ATLAS_PACKED_H

#include "atlas.h"

/* Opens all charts of a packed planet; reads their heads only. A file that was cut short opens with the levels that are
 * whole, and without caps where the head of one is missing. Its chart 0 is what tc_field_open() gives. *atlas_ret is
 * freed with tc_atlas_free(). TC_ERR_UNSUPPORTED for a flat terrain, TC_ERR_FORMAT also for heights that its radius is
 * too small for. options->cache_bytes: for all charts together. */
tc_status tc_atlas_open(const char *path, const tc_open_options *options, tc_atlas *atlas_ret, tc_error *error);

/* The same from any bytes; name is what errors call it. */
tc_status tc_atlas_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                              tc_atlas *atlas_ret, tc_error *error);

#endif

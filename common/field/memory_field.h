/* memory_field.h - a field in memory whose levels somebody else filters: levels of charts that go on across seams. */
#ifndef TC_MEMORY_FIELD_H
#define TC_MEMORY_FIELD_H

#include "field.h"

/* A field over the grid, which it takes over (it is zeroed, also on failure freed): its finest level is the grid, the
 * others are there and hold nothing. It can be read from now on, but not asked for ranges. */
tc_status tc_memory_field_begin(tc_grid *grid, tc_field **field_ret, tc_error *error);

/* Where a level's samples are written: z[j * width + i], voids the same, NULL where the field has none. */
void tc_memory_field_level(tc_field *field, int level, float **z_ret, uint8_t **voids_ret);

/* Once all levels are written: voids that are shown flat become so, and ranges are found. */
tc_status tc_memory_field_finish(tc_field *field, int threads, tc_error *error);

#endif

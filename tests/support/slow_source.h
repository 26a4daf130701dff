/* slow_source.h - a packed terrain's bytes that take their time, cannot all be read, and know who reads them. */
#ifndef SLOW_SOURCE_H
#define SLOW_SOURCE_H

#include <pthread.h>

#include "common/terraclip.h"

typedef struct slow_source {
    uint8_t *bytes;
    size_t size;
    _Atomic int delay_ms;
    _Atomic int64_t broken, broken_end; /* what touches bytes broken .. broken_end - 1 cannot be read; none where 0 */
    _Atomic int reads;
    pthread_t own; /* the thread that opened it: it must not read */
    _Atomic int own_reads;
} slow_source;

/* Its field or map; reading is counted from then on. */
tc_field *slow_field(slow_source *s, const tc_open_options *options);
tc_map *slow_map(slow_source *s, const tc_open_options *options);

#endif

/* slow_source.c - bytes in memory. */
#include "slow_source.h"

#include <string.h>
#include <unistd.h>

#include "test.h"

static tc_status read_slowly(void *context, int64_t offset, void *to, size_t size)
{
    slow_source *s = context;
    s->reads++;
    s->own_reads += pthread_equal(pthread_self(), s->own) != 0;
    if (s->delay_ms)
        usleep((useconds_t)s->delay_ms * 1000);
    if (offset < s->broken_end && offset + (int64_t)size > s->broken)
        return TC_ERR_IO;
    memcpy(to, s->bytes + offset, size);
    return TC_OK;
}

static tc_byte_source source_of(slow_source *s)
{
    s->own = pthread_self();
    return (tc_byte_source){s, (int64_t)s->size, read_slowly, NULL};
}

tc_field *slow_field(slow_source *s, const tc_open_options *options)
{
    const tc_byte_source source = source_of(s);
    tc_field *field;
    assert_int_equal(tc_field_open_bytes("slow", &source, options, &field, NULL), TC_OK);
    s->own_reads = 0;
    return field;
}

tc_map *slow_map(slow_source *s, const tc_open_options *options)
{
    const tc_byte_source source = source_of(s);
    tc_map *map;
    assert_int_equal(tc_map_open_bytes("slow", &source, options, &map, NULL), TC_OK);
    s->own_reads = 0;
    return map;
}

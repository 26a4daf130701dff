/* head.h - how every head of a packed file begins, of whatever version: magic, version, its size, its checksum. */
#ifndef TC_HEAD_H
#define TC_HEAD_H

#include "common/base/byte_order.h"

enum {
    TC_HEAD_FIXED = 20, /* bytes that every head begins with; from TC_HEAD_SIZE_AT on, its size */
    TC_HEAD_SIZE_AT = 12
};

/* Whether bytes start as packed terrains do, and which version they name; at least TC_HEAD_FIXED of them for that. */
bool tc_head_is(const uint8_t *bytes, size_t size);
uint64_t tc_head_version(const uint8_t *bytes);

/* Begins a head at the writer's end, and seals the one that began at `start` once all of it is written: TC_ERR_MEMORY
 * where it could not be. */
void tc_head_begin(tc_byte_writer *writer, int version);
tc_status tc_head_seal(tc_byte_writer *writer, size_t start);

/* Checks size and checksum of a head of which `size` bytes are at hand. *head_size_ret, also where TC_ERR_FORMAT says
 * that they are too few: how many are needed. subject is named in errors. */
tc_status tc_head_check(const char *subject, const uint8_t *bytes, size_t size, size_t *head_size_ret, tc_error *error);

#endif

/* head.c - the first bytes of a head. docs/format.md is the specification. */
#include "head.h"

#include <inttypes.h>

#include "common/base/crc32c.h"
#include "common/base/status.h"

static const uint8_t magic[8] = {0x89, 'T', 'C', 'L', 'I', 'P', '\r', '\n'};
enum { CRC_AT = 16, MOST_HEAD = 1 << 24 };

bool tc_head_is(const uint8_t *bytes, size_t size)
{
    return size >= sizeof magic && memcmp(bytes, magic, sizeof magic) == 0;
}

uint64_t tc_head_version(const uint8_t *bytes)
{
    return tc_load(bytes + sizeof magic, 4);
}

void tc_head_begin(tc_byte_writer *w, int version)
{
    tc_put_bytes(w, magic, sizeof magic);
    tc_put(w, (uint64_t)version, 4);
    tc_put(w, 0, 4), tc_put(w, 0, 4); /* size and checksum, when it is sealed */
}

tc_status tc_head_seal(tc_byte_writer *w, size_t start)
{
    if (w->failed)
        return TC_ERR_MEMORY;
    uint8_t *head = w->bytes + start;
    size_t size = w->size - start;
    tc_store(head + TC_HEAD_SIZE_AT, size, 4);
    tc_store(head + CRC_AT, tc_crc32c(0, head, size), 4);
    return TC_OK;
}

/* The checksum is that of the head with zeros in its own place. */
static bool check_sum(const uint8_t *bytes, size_t size)
{
    static const uint8_t zeros[4];
    uint32_t crc = tc_crc32c(0, bytes, CRC_AT);
    crc = tc_crc32c(crc, zeros, sizeof zeros);
    crc = tc_crc32c(crc, bytes + TC_HEAD_FIXED, size - TC_HEAD_FIXED);
    return crc == tc_load(bytes + CRC_AT, 4);
}

tc_status tc_head_check(const char *subject, const uint8_t *bytes, size_t size, size_t *head_size_ret, tc_error *error)
{
    uint64_t head = tc_load(bytes + TC_HEAD_SIZE_AT, 4);
    if (head < TC_HEAD_FIXED || head > MOST_HEAD)
        return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: a head of %" PRIu64 " bytes", subject, head);
    *head_size_ret = (size_t)head;
    if (size < head)
        return tc_fail(error, TC_ERR_FORMAT, "%s: cut short: expected a head of %" PRIu64 " bytes, found %zu", subject,
                       head, size);
    if (!check_sum(bytes, (size_t)head))
        return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: its head's checksum is wrong", subject);
    return TC_OK;
}

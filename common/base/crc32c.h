/* crc32c.h - the checksum of packed terrains: CRC-32C (Castagnoli), as iSCSI (RFC 3720) and ext4 use it. */
#ifndef TC_CRC32C_H
#define TC_CRC32C_H

#include "common/terraclip.h"

/* Checksum of `size` bytes that follow bytes of checksum `crc` (0: none). */
uint32_t tc_crc32c(uint32_t crc, const void *bytes, size_t size);

#endif

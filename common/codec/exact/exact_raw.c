/* exact_raw.c - tiles that prediction does not help: every sample in as many bits as the tile's range takes. */
#include "common/base/byte_order.h"
#include "common/codec/entropy/raw_bits.h"
#include "exact_tile.h"

/* The first byte says how many bytes the lowest sample takes, which follows. No coded stream begins with 0 to 7: the
 * list of values that it would stand for would begin 2^25 steps or more above the base (docs/format.md). How many bits
 * a sample takes follows from the size. */
enum { MARKS = 8, MOST_FIRST = 4, MOST_BITS = 32 };

static size_t stream_size(int first_bytes, int64_t samples, int64_t bits)
{
    return 1 + (size_t)first_bytes + (size_t)((samples * bits + 7) / 8);
}

/* Of a tile of so many bytes; as many as they have room for. */
static int64_t bits_of(size_t size, int first_bytes, int64_t samples)
{
    return 8 * ((int64_t)size - 1 - first_bytes) / samples;
}

size_t tc_exact_raw_size(const tc_plane *fine, tc_rect tile, int32_t step, tc_exact_raw *raw_ret)
{
    int32_t least = INT32_MAX, most = INT32_MIN;
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        const int32_t *z = tc_plane_at(fine, tile.x0, y);
        for (int64_t x = 0; x < tile.x1 - tile.x0; x++)
            least = z[x] < least ? z[x] : least, most = z[x] > most ? z[x] : most;
    }
    tc_exact_raw raw = {.first = least / step};
    while (raw.first_bytes < MOST_FIRST && (raw.first < -(1LL << 8 * raw.first_bytes >> 1) ||
                                            raw.first > (1LL << 8 * raw.first_bytes >> 1) - (raw.first_bytes > 0)))
        raw.first_bytes++;
    uint32_t range = (uint32_t)(most / step - raw.first);
    raw.size = stream_size(raw.first_bytes, tc_rect_area(tile), range ? 32 - __builtin_clz(range) : 0);
    *raw_ret = raw;
    return raw.size;
}

void tc_exact_raw_encode(const tc_plane *fine, tc_rect tile, int32_t step, const tc_exact_raw *raw, uint8_t *bytes)
{
    int bits = (int)bits_of(raw->size, raw->first_bytes, tc_rect_area(tile));
    bytes[0] = (uint8_t)raw->first_bytes;
    tc_store(bytes + 1, (uint64_t)(int64_t)raw->first, raw->first_bytes);
    tc_raw_writer w = {.bytes = bytes + 1 + raw->first_bytes};
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        const int32_t *z = tc_plane_at(fine, tile.x0, y);
        for (int64_t x = 0; x < tile.x1 - tile.x0; x++)
            tc_raw_put(&w, (uint32_t)(z[x] / step - raw->first), bits);
    }
    tc_raw_finish(&w, raw->size - 1 - (size_t)raw->first_bytes);
}

bool tc_exact_is_raw(const uint8_t *bytes, size_t size)
{
    return size > 0 && bytes[0] < MARKS;
}

tc_status tc_exact_raw_decode(const tc_plane *fine, tc_rect tile, int32_t step, const uint8_t *bytes, size_t size)
{
    int first_bytes = bytes[0];
    if (first_bytes > MOST_FIRST || size < 1 + (size_t)first_bytes)
        return TC_ERR_FORMAT;
    int64_t bits = bits_of(size, first_bytes, tc_rect_area(tile)), most = TC_LIFTING_LIMIT / step, first = 0;
    if (bits > MOST_BITS || size != stream_size(first_bytes, tc_rect_area(tile), bits))
        return TC_ERR_FORMAT;
    if (first_bytes > 0)
        first = (int64_t)(tc_load(bytes + 1, first_bytes) << (64 - 8 * first_bytes)) >> (64 - 8 * first_bytes);
    tc_raw_reader r = {.at = bytes + 1 + first_bytes, .end = bytes + size};
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        int32_t *z = tc_plane_at(fine, tile.x0, y);
        for (int64_t x = 0; x < tile.x1 - tile.x0; x++) {
            int64_t k = first + tc_raw_take(&r, (int)bits);
            if (k < -most || k > most)
                return TC_ERR_FORMAT;
            z[x] = (int32_t)(k * step);
        }
    }
    return tc_raw_finished(&r) ? TC_OK : TC_ERR_FORMAT;
}

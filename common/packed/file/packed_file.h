/* packed_file.h - a packed file, open: its head, its index pages, the bytes of its tiles. Everything is read as a
 * bounded range of bytes and checked. Thread-safe once open. */
#ifndef TC_PACKED_FILE_H
#define TC_PACKED_FILE_H

#include "block_cache.h"
#include "envelope.h"

typedef struct tc_packed_file {
    char *path;
    tc_byte_source source;
    tc_container container;                /* of the chart; levels: as far as the file is whole */
    int64_t rank_end[TC_MAX_FIELD_LEVELS]; /* [finest - l]: where the level, and those of other charts as fine, end */
    tc_block_cache pages;
} tc_packed_file;

/* A file as a source of bytes. */
tc_status tc_file_source(const char *path, tc_byte_source *source_ret, tc_error *error);

/* Opens chart 0, or a chart of a file of version 3, in older ones of which each is a range of bytes of its own. The
 * finest levels that are missing, of any chart, are taken off container.levels and counted in info.levels_missing. The
 * second one takes over the source, also where it fails. */
tc_status tc_packed_file_open(const char *path, tc_packed_file *file_ret, tc_error *error);
tc_status tc_packed_file_open_bytes(const char *name, const tc_byte_source *source, int chart, tc_packed_file *file_ret,
                                    tc_error *error);
void tc_packed_file_close(tc_packed_file *file);

/* Entry of tile (tx, ty) of level l. TC_ERR_FORMAT where the index is damaged there, TC_ERR_IO, TC_ERR_MEMORY. */
tc_status tc_packed_file_entry(tc_packed_file *file, int l, int64_t tx, int64_t ty, tc_tile_entry *entry_ret);

/* Whether that is at hand, without reading the file. */
bool tc_packed_file_known(tc_packed_file *file, int l, int64_t tx, int64_t ty);

/* The bytes of a tile, tc_tile_bytes(entry) of them, which must not be more than room. TC_ERR_FORMAT: damaged. */
tc_status tc_packed_file_tile(tc_packed_file *file, const tc_tile_entry *entry, uint8_t *bytes, size_t room);

/* As tc_field_open_bytes(), of a chart of a file of version 3; of older files chart 0 alone. */
tc_status tc_packed_open_chart(const char *name, const tc_byte_source *source, int chart,
                               const tc_open_options *options, tc_field **field_ret, tc_error *error);

/* Bytes of a packed pyramid's own container, whatever follows it in the file. */
int64_t tc_packed_chart_bytes(const tc_field *field);

#endif

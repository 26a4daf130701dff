/* packed_file.h - a packed file, open: its head, its index pages, the bytes of its tiles. Everything is read as a
 * bounded range of bytes and checked. Thread-safe once open. */
#ifndef TC_PACKED_FILE_H
#define TC_PACKED_FILE_H

#include "block_cache.h"
#include "common/field/range_pyramid.h"
#include "envelope.h"

typedef struct tc_packed_file {
    char *path;
    tc_byte_source source;
    tc_container container;                /* of the chart; levels: as far as the file is whole */
    int64_t rank_end[TC_MAX_FIELD_LEVELS]; /* [finest - l]: where the level, and those of other charts as fine, end */
    tc_block_cache pages, errors;
    pthread_mutex_t mutex; /* of ranges */
    struct {
        tc_range_pyramid pages; /* of heights, metres; the level's whole range where a page has not been read yet */
        uint8_t *read;          /* [page] */
        int64_t missing;
    } range[TC_MAX_FIELD_LEVELS]; /* [l - 1]; made with the first page */
    size_t range_bytes;
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

/* Pages of the index that would make a range narrower. */
enum { TC_MISSING_PAGES = 64 };
typedef struct tc_missing_pages {
    int count;
    int64_t page[TC_MISSING_PAGES][2];
} tc_missing_pages;

/* Bounds of a coded level's heights over tiles (not empty, within the level), metres above z_base: from what has been
 * read of the index, at most most_x x 2 reads of memory, none of the file. */
tc_range tc_packed_file_range(tc_packed_file *file, int l, tc_rect tiles, int64_t most_x, int *reads,
                              tc_missing_pages *missing);

/* Reads a page of the index, if it is not at hand. */
tc_status tc_packed_file_page(tc_packed_file *file, int l, int64_t px, int64_t py);

/* Errors (measured_errors.h) of a level over samples (not empty, within it), from what has been read of them, at most
 * most_x x 2 reads of memory, none of the file; INFINITY where some has not been. Only of files that tell them, of
 * which no level is missing. */
float tc_packed_file_error(tc_packed_file *file, int l, tc_rect samples, int64_t most_x, int *reads,
                           tc_missing_pages *missing);

/* Reads a page of a coded level's errors, if it is not at hand. What is damaged counts as the level's largest. */
tc_status tc_packed_file_error_page(tc_packed_file *file, int l, int64_t px, int64_t py);

/* The bytes of page `number` of `count` that the directory in bytes begin .. end - 1 lists, to be freed, and where they
 * end. TC_ERR_FORMAT: damaged. */
tc_status tc_packed_file_listed(const tc_packed_file *file, int64_t begin, int64_t end, int64_t count, int64_t number,
                                uint8_t **bytes_ret, size_t *size_ret, int64_t *end_ret);

/* Bytes of memory held, beside the head's. */
size_t tc_packed_file_memory(tc_packed_file *file);

/* The bytes of a tile, tc_tile_bytes(entry) of them, which must not be more than room. TC_ERR_FORMAT: damaged. */
tc_status tc_packed_file_tile(tc_packed_file *file, const tc_tile_entry *entry, uint8_t *bytes, size_t room);

/* Bytes of a packed pyramid's own container, whatever follows it in the file; without errors, of all levels at hand. */
int64_t tc_packed_chart_bytes(const tc_field *field);

#endif

/* envelope.h - what a packed file of version 3 begins with: its charts, where they lie, and the heads of their
 * containers. docs/format.md says it byte by byte.
 *
 *     envelope head | charts' heads | rank r | rank r - 1 | ... | rank 0
 *     rank k: the levels of all charts that are k above their finest, in the order of the charts
 *
 * So a prefix that ends with a rank is a coarser map, with all of its charts. */
#ifndef TC_ENVELOPE_H
#define TC_ENVELOPE_H

#include "common/chart/atlas.h"
#include "container.h"

enum { TC_ENVELOPE_VERSION = TC_NEWEST_VERSION, TC_MOST_CHARTS = 8, TC_CREDITS_BYTES = 65535 };

typedef struct tc_envelope_chart {
    tc_chart_kind kind;    /* as of the container */
    double x0, y0, dx, dy; /* of the finest level's first sample and between samples, in the chart's coordinates */
    tc_seam side[TC_SIDES];
    tc_container container; /* offsets are those of the file */
} tc_envelope_chart;

typedef struct tc_envelope {
    int64_t bytes; /* of the whole file */
    int charts;
    tc_envelope_chart chart[TC_MOST_CHARTS];
    int64_t rank_end[TC_MAX_FIELD_LEVELS]; /* where the last level of a rank ends, without errors; of ranks beyond all,
                                              the head's end */
    bool errors; /* writing: the head has room for where errors stand, if the containers have them */
} tc_envelope;

/* Whether bytes begin a file of version 3; at least TC_HEAD_FIXED of them. */
bool tc_envelope_is(const uint8_t *bytes);

/* Kind, place and seams of the charts, from the containers' terrains: the first one is the terrain's own, a planet's
 * others are its caps. Where the first one's container is a face of an atlas so are all others. */
void tc_envelope_place(tc_envelope *envelope);

/* The atlas whose faces charts of a kind are; NULL: those of another kind. */
const tc_atlas *tc_kind_faces(tc_chart_kind kind);
tc_chart_kind tc_faces_kind(const tc_atlas *atlas);

/* Lays all levels out rank by rank behind the head, by their sizes, end - begin: sets begin, end, rank_end and bytes.
 */
void tc_envelope_lay_out(tc_envelope *envelope, size_t head_size);

/* Lets the level that lies last, if any is coded, have so many more bytes; for laying out again. */
void tc_envelope_append(tc_envelope *envelope, int64_t bytes);

/* The head as bytes. Its size does not depend on where things lie. */
tc_status tc_envelope_write(const tc_envelope *envelope, tc_byte_writer *writer);

/* Reads a head; as tc_container_read(). *envelope_ret is freed with tc_envelope_free(). */
tc_status tc_envelope_read(const char *subject, const uint8_t *bytes, size_t size, tc_envelope **envelope_ret,
                           size_t *head_size_ret, tc_error *error);
void tc_envelope_free(tc_envelope *envelope);

#endif

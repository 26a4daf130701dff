/* field.h - what a kind of field implements: levels of samples, read by rectangles. Fields are in memory, packed, or
 * decorate another one. */
#ifndef TC_FIELD_H
#define TC_FIELD_H

#include <math.h>

#include "common/terraclip.h"

/* What a sample is. */
typedef enum tc_field_sample {
    TC_FIELD_HEIGHTS, /* float, metres above z_base */
    TC_FIELD_COLOURS  /* RGBA8: sRGB of the colour times alpha, and alpha */
} tc_field_sample;

struct tc_container;

/* Rectangles are not empty and lie within the level's rows; of read and read_ready also within its columns (what goes
 * round is cut into pieces before), else they may stick out of a level that wraps, by less than once around. Of fields
 * that can be read beyond their sides those of read, read_ready and ready may stick out by as much. */
typedef struct tc_field_class {
    tc_field_sample sample;
    tc_status (*read)(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids, ptrdiff_t stride);
    /* The same without waiting; false where that cannot be. NULL: reading never waits. */
    bool (*read_ready)(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids, ptrdiff_t stride);
    tc_ready (*ready)(const tc_field *field, int level, tc_rect rect, tc_urgency urgency); /* NULL: always */
    /* What was asked for with that rectangle is not wanted any more. NULL: nothing to be done. */
    void (*overtaken)(const tc_field *field, int level, tc_rect rect);
    tc_range (*range)(const tc_field *field, int level, tc_rect rect);
    void (*know_errors)(const tc_field *field);                                   /* NULL: it never does */
    bool (*changed)(const tc_field *field, uint64_t *since, tc_rect *finest_ret); /* NULL: never */
    void (*tell)(const tc_field *field, tc_field_stats *stats);                   /* adds to what is there */
    /* Head of the packed file that this is read from. NULL: none. */
    const struct tc_container *(*container)(const tc_field *field);
    void (*destroy)(tc_field *field);
} tc_field_class;

enum { TC_MAX_FIELD_LEVELS = 48 };

/* The head of every kind of field. What decorates another one begins with a copy of its head. */
struct tc_field {
    const tc_field_class *class;
    tc_terrain_info info;
    int beyond;                          /* samples that can be read beyond each side, on all levels */
    tc_georef georef;                    /* crs_wkt: owned by the kind of field */
    tc_level level[TC_MAX_FIELD_LEVELS]; /* [l - 1] */
};

/* Fills in the sizes and spacings of all levels and info.levels from the finest. */
void tc_field_set_levels(tc_field *field, tc_level finest);

/* Samples `finest` metres apart between those that are `spacing` apart: a power of two, below 1 where they are finer.
 */
static inline double tc_level_stride(double spacing, double finest)
{
    return exp2(rint(log2(spacing / finest)));
}

/* As tc_field_read() and tc_field_read_ready(), of whatever samples the field has. */
tc_status tc_field_read_samples(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                                ptrdiff_t stride);
tc_ready tc_field_samples_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                                ptrdiff_t stride, tc_urgency urgency);

/* What tc_field_ready() was asked about with the same rectangle, and said to be coming, is not wanted any more: what
 * has not been decoded of it by now is not. Another reader that wants it has to ask again. */
void tc_field_overtaken(const tc_field *field, int level, tc_rect rect);

/* Its packed file's head, through what decorates it; NULL where there is none. */
const struct tc_container *tc_field_container(const tc_field *field);

/* Whether the body that the georeference is on is clearly not the Earth: its radius tells. */
bool tc_is_other_body(const tc_georef *georef);

#endif

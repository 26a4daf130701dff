/* stats.h - figures of many frames: what --stats and --json write. No allocation after creation. */
#ifndef TC_STATS_H
#define TC_STATS_H

#include "common/terraclip.h"
#include "common/render/renderer.h"

#include <stdio.h>

typedef struct tc_stats tc_stats;

/* Times of the last `capacity` (> 0) frames are kept; of more frames the older are forgotten, their work stays counted.
 */
tc_status tc_stats_create(int capacity, tc_stats **stats_ret, tc_error *error);
void tc_stats_destroy(tc_stats *stats);

/* Counts a measured frame. frame_ms: what the whole of it took. */
void tc_stats_frame(tc_stats *stats, double frame_ms, const tc_frame_stats *frame);

/* Counts only the work of a frame that was drawn to get the terrain loaded. */
void tc_stats_load(tc_stats *stats, const tc_frame_stats *frame);

typedef struct tc_stats_summary {
    int64_t frames;                            /* measured */
    double frame_median, frame_p95, frame_max; /* ms; the maximum is of all, 95 % of frames took no longer than p95 */
    double update_ms, draw_ms;                 /* medians */
    int64_t triangles, draws, levels_active;   /* medians */
    int64_t samples_updated, bytes_uploaded;   /* totals, with those of loading */
    double throttle_median, throttle_max;      /* octaves; the maximum is of all */
    double tolerance, error_bound;             /* pixels; the bound is the largest of all; 0: none was asked for */
    int blocks[TC_DRAWN_LEVELS], levels;       /* of the last frame, coarse to fine, and how many are told */
} tc_stats_summary;

void tc_stats_summarise(tc_stats *stats, tc_stats_summary *summary_ret);

/* What a report says beside the figures. */
typedef struct tc_stats_context {
    const char *renderer, *backend;
    tc_memory_stats memory;
    int64_t bytes_decoded;       /* of a packed terrain's tiles */
    int synthesised;             /* levels finer than the data */
    double exaggeration;         /* heights drawn over the true ones */
    tc_sun sun;                  /* from the eye's place; zero: it lights nothing */
    tc_sea sea;                  /* where it is */
    int imagery;                 /* levels that hold colours of pictures */
    const char *const *left_out; /* NULL-terminated */
} tc_stats_context;

/* Writes the report as JSON. */
void tc_stats_print(const tc_stats_summary *summary, const tc_stats_context *context, FILE *file);

/* The same to a file, written beside it and renamed. */
tc_status tc_stats_write(const char *path, const tc_stats_summary *summary, const tc_stats_context *context,
                         tc_error *error);

#endif

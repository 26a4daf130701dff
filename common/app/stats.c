/* stats.c - collects and reports the figures of frames; see stats.h. */
#include "stats.h"
#include "common/base/status.h"
#include "common/base/outfile.h"
#include "json.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What is kept of every frame. */
enum { FRAME_MS, UPDATE_MS, DRAW_MS, TRIANGLES, DRAWS, LEVELS, THROTTLE, SERIES };

struct tc_stats {
    int capacity;
    int64_t frames, samples_updated, bytes_uploaded;
    double max_ms, max_throttle, max_bound;
    tc_frame_stats last;
    double *series[SERIES]; /* rings of capacity values; frame f lies at f mod capacity */
    double *sorted;         /* room for one of them */
    double values[];        /* all of the above */
};

tc_status tc_stats_create(int capacity, tc_stats **stats_ret, tc_error *error)
{
    size_t values = (size_t)capacity * (SERIES + 1);
    tc_stats *stats = calloc(1, sizeof *stats + values * sizeof(double));
    if (!stats)
        return tc_fail(error, TC_ERR_MEMORY, "statistics: not enough memory for %d frames", capacity);
    stats->capacity = capacity;
    for (int i = 0; i < SERIES; i++)
        stats->series[i] = stats->values + (size_t)i * (size_t)capacity;
    stats->sorted = stats->values + (size_t)SERIES * (size_t)capacity;
    *stats_ret = stats;
    return TC_OK;
}

void tc_stats_destroy(tc_stats *stats)
{
    free(stats);
}

void tc_stats_load(tc_stats *stats, const tc_frame_stats *frame)
{
    stats->samples_updated += frame->samples_updated;
    stats->bytes_uploaded += frame->bytes_uploaded;
}

void tc_stats_frame(tc_stats *stats, double frame_ms, const tc_frame_stats *frame)
{
    const double values[SERIES] = {[FRAME_MS] = frame_ms,       [UPDATE_MS] = frame->update_ms,
                                   [DRAW_MS] = frame->draw_ms,  [TRIANGLES] = (double)frame->triangles,
                                   [DRAWS] = frame->draws,      [LEVELS] = frame->levels_active,
                                   [THROTTLE] = frame->throttle};
    for (int i = 0; i < SERIES; i++)
        stats->series[i][stats->frames % stats->capacity] = values[i];
    stats->frames++;
    stats->max_ms = fmax(stats->max_ms, frame_ms);
    stats->max_throttle = fmax(stats->max_throttle, frame->throttle);
    stats->max_bound =
        fmax(stats->max_bound,
             frame->tolerance > 0 && (isfinite(frame->error_bound) || frame->resident) ? frame->error_bound : 0);
    stats->last = *frame;
    tc_stats_load(stats, frame);
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The value that a share (0 .. 1) of the kept frames does not exceed; 0 without frames. */
static double quantile(tc_stats *stats, int series, double share)
{
    int count = stats->frames < stats->capacity ? (int)stats->frames : stats->capacity;
    if (count == 0)
        return 0;
    memcpy(stats->sorted, stats->series[series], (size_t)count * sizeof(double));
    qsort(stats->sorted, (size_t)count, sizeof(double), compare);
    int rank = (int)ceil(share * count) - 1;
    return stats->sorted[rank < 0 ? 0 : rank];
}

void tc_stats_summarise(tc_stats *stats, tc_stats_summary *summary_ret)
{
    *summary_ret = (tc_stats_summary){
        .frames = stats->frames,
        .frame_median = quantile(stats, FRAME_MS, 0.5),
        .frame_p95 = quantile(stats, FRAME_MS, 0.95),
        .frame_max = stats->max_ms,
        .update_ms = quantile(stats, UPDATE_MS, 0.5),
        .draw_ms = quantile(stats, DRAW_MS, 0.5),
        .triangles = (int64_t)quantile(stats, TRIANGLES, 0.5),
        .draws = (int64_t)quantile(stats, DRAWS, 0.5),
        .levels_active = (int64_t)quantile(stats, LEVELS, 0.5),
        .samples_updated = stats->samples_updated,
        .bytes_uploaded = stats->bytes_uploaded,
        .throttle_median = quantile(stats, THROTTLE, 0.5),
        .throttle_max = stats->max_throttle,
        .tolerance = stats->last.tolerance,
        .error_bound = stats->max_bound,
        .levels = stats->last.levels_active + stats->last.levels_fine + stats->last.levels_beyond,
    };
    memcpy(summary_ret->blocks, stats->last.blocks_of, sizeof summary_ret->blocks);
}

void tc_stats_print(const tc_stats_summary *s, const tc_stats_context *context, FILE *file)
{
    const tc_memory_stats *m = &context->memory;
    fprintf(file, "{\n  \"frames\": %" PRId64 ",\n", s->frames);
    fprintf(file, "  \"frame_ms\": {\"median\": %.3f, \"p95\": %.3f, \"max\": %.3f},\n", s->frame_median, s->frame_p95,
            s->frame_max);
    fprintf(file, "  \"update_ms\": %.3f,\n  \"draw_ms\": %.3f,\n", s->update_ms, s->draw_ms);
    fprintf(file, "  \"triangles\": %" PRId64 ",\n  \"draws\": %" PRId64 ",\n  \"levels_active\": %" PRId64 ",\n",
            s->triangles, s->draws, s->levels_active);
    fprintf(file, "  \"samples_updated\": %" PRId64 ",\n  \"bytes_uploaded\": %" PRId64 ",\n", s->samples_updated,
            s->bytes_uploaded);
    fprintf(file, "  \"bytes_decoded\": %" PRId64 ",\n  \"synthesised_levels\": %d,\n  \"imagery_levels\": %d,\n",
            context->bytes_decoded, context->synthesised, context->imagery);
    fprintf(
        file,
        "  \"memory\": {\"geometry\": %zu, \"heights\": %zu, \"normals\": %zu, \"imagery\": %zu, \"pyramid\": %zu},\n",
        m->geometry, m->heights, m->normals, m->imagery, m->field);
    fprintf(file, "  \"renderer\": ");
    tc_json_string(context->renderer, file);
    fprintf(file, ",\n  \"backend\": ");
    tc_json_string(context->backend, file);
    fprintf(file, ",\n  \"left_out\": [");
    for (int i = 0; context->left_out && context->left_out[i]; i++) {
        fprintf(file, i ? ",\n    " : "\n    ");
        tc_json_string(context->left_out[i], file);
    }
    fprintf(file, context->left_out && context->left_out[0] ? "\n  ],\n" : "],\n");
    fprintf(file, "  \"throttle\": {\"median\": %.3f, \"max\": %.3f},\n", s->throttle_median, s->throttle_max);
    fprintf(file, "  \"tolerance_px\": %.3f,\n  \"error_bound_px\": ", s->tolerance);
    fprintf(file, s->tolerance > 0 && isfinite(s->error_bound) ? "%.3f" : "null", s->error_bound);
    fprintf(file, ",\n  \"blocks_by_level\": [");
    for (int level = 0; level < s->levels && level < TC_DRAWN_LEVELS; level++)
        fprintf(file, level ? ", %d" : "%d", s->blocks[level]);
    if (context->sun.kind == TC_SUN_LOCAL)
        fprintf(file, "],\n  \"sun\": {\"azimuth\": %.3f, \"elevation\": %.3f},\n", context->sun.azimuth * 180 / M_PI,
                context->sun.elevation * 180 / M_PI);
    else
        fprintf(file, "],\n  \"sun\": null,\n");
    if (context->sea.kind == TC_SEA_GIVEN)
        fprintf(file, "  \"sea\": %.9g,\n", context->sea.level);
    else
        fprintf(file, "  \"sea\": %s,\n", context->sea.kind == TC_SEA_NONE ? "\"none\"" : "\"auto\"");
    fprintf(file, "  \"exaggeration\": %g\n}\n", context->exaggeration);
}

static tc_status print_to(const char *name, const char *path, const tc_stats_summary *summary,
                          const tc_stats_context *context, tc_error *error)
{
    FILE *file = fopen(name, "w");
    if (!file)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    tc_stats_print(summary, context, file);
    bool written = fflush(file) == 0 && !ferror(file);
    if (fclose(file) != 0 || !written)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    return TC_OK;
}

tc_status tc_stats_write(const char *path, const tc_stats_summary *summary, const tc_stats_context *context,
                         tc_error *error)
{
    /* A pipe or a device is written to, not replaced. */
    struct stat old;
    if (stat(path, &old) == 0 && !S_ISREG(old.st_mode))
        return print_to(path, path, summary, context, error);
    tc_outfile outfile;
    tc_status status = tc_outfile_begin(path, &outfile, error);
    if (status != TC_OK)
        return status;
    status = print_to(outfile.temporary, path, summary, context, error);
    return tc_outfile_end(&outfile, status, error);
}

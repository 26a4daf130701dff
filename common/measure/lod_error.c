/* lod_error.c - levels against the finest one. */
#include "lod_error.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "error_stats.h"
#include "common/base/mesh.h"
#include "common/base/parallel.h"
#include "common/base/rect.h"

enum { ROWS = 64 }; /* finest rows of a task */

typedef struct measurement {
    const tc_field *field;
    int level;
    tc_error_stats total;
    pthread_mutex_t lock;
    tc_status status;
} measurement;

/* Rows j0 .. j1 - 1 of the finest level against the mesh of the coarse one. */
static tc_status measure_rows(const measurement *m, int64_t j0, int64_t j1, tc_error_stats *stats)
{
    int finest = tc_field_info(m->field)->levels, shift = finest - m->level;
    tc_level top = tc_field_level(m->field, finest), coarse = tc_field_level(m->field, m->level);
    int64_t c0 = tc_min64(j0 >> shift, tc_max64(0, coarse.height - 2));
    int64_t c1 = tc_min64(((j1 - 1) >> shift) + 2, coarse.height), g = (int64_t)1 << shift;
    size_t fine_count = (size_t)(top.width * (j1 - j0)), coarse_count = (size_t)(coarse.width * (c1 - c0));
    float *fine = malloc(fine_count * sizeof *fine), *mesh = malloc(coarse_count * sizeof *mesh);
    uint8_t *voids = malloc(fine_count);
    tc_status status = fine && mesh && voids ? TC_OK : TC_ERR_MEMORY;
    if (!status)
        status = tc_field_read(m->field, finest, (tc_rect){0, j0, top.width, j1}, fine, voids, top.width);
    if (!status)
        status = tc_field_read(m->field, m->level, (tc_rect){0, c0, coarse.width, c1}, mesh, NULL, coarse.width);
    for (int64_t j = j0; j < j1 && !status; j++) {
        /* Beyond the coarse level's last sample its last cell goes on, as it is drawn (clipmap.h). */
        int64_t b = tc_min64(j >> shift, tc_max64(0, coarse.height - 2));
        const float *south = mesh + (b - c0) * coarse.width, *north = coarse.height > 1 ? south + coarse.width : south;
        double ty = (double)(j - b * g) / (double)g;
        for (int64_t i = 0; i < top.width; i++) {
            if (voids[(j - j0) * top.width + i])
                continue;
            int64_t a = tc_min64(i >> shift, tc_max64(0, coarse.width - 2)), e = coarse.width > 1 ? a + 1 : a;
            double tx = (double)(i - a * g) / (double)g, z;
            if (tx <= 1 && ty <= 1)
                z = tc_triangle_height(south[a], south[e], north[a], north[e], tx, ty);
            else
                z = (1 - ty) * ((1 - tx) * south[a] + tx * south[e]) + ty * ((1 - tx) * north[a] + tx * north[e]);
            tc_error_stats_add(stats, z - (double)fine[(j - j0) * top.width + i]);
        }
    }
    free(fine);
    free(mesh);
    free(voids);
    return status;
}

static void measure_task(void *context, int64_t i)
{
    measurement *m = context;
    int64_t height = tc_field_level(m->field, tc_field_info(m->field)->levels).height;
    tc_error_stats stats;
    tc_status status = tc_error_stats_init(&stats);
    if (!status)
        status = measure_rows(m, i * ROWS, tc_min64((i + 1) * ROWS, height), &stats);
    pthread_mutex_lock(&m->lock);
    if (status)
        m->status = status;
    else
        tc_error_stats_merge(&m->total, &stats);
    pthread_mutex_unlock(&m->lock);
    tc_error_stats_free(&stats);
}

tc_status tc_lod_error_measure(const tc_field *field, int level, int n, int width_px, double fov, int threads,
                               tc_lod_error *error_ret)
{
    measurement m = {.field = field, .level = level, .lock = PTHREAD_MUTEX_INITIALIZER};
    tc_status status = tc_error_stats_init(&m.total);
    if (status)
        return status;
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels), own = tc_field_level(field, level);
    tc_parallel_for(threads, (finest.height + ROWS - 1) / ROWS, measure_task, &m);
    if (!m.status) {
        double g = fmin(own.spacing_x, own.spacing_y), pixels = width_px / (2 * tan(fov / 2)) / (0.4 * n * g);
        tc_lod_error e = {.spacing_m = g,
                          .rms_m = tc_error_stats_rms(&m.total),
                          .p999_m = tc_error_stats_percentile(&m.total, 0.999),
                          .max_m = m.total.max};
        e.rms_px = e.rms_m * pixels, e.p999_px = e.p999_m * pixels, e.max_px = e.max_m * pixels;
        *error_ret = e;
    }
    tc_error_stats_free(&m.total);
    return m.status;
}

/* joined.h - charts joined along their seams: fields that can be read beyond their sides.
 *
 * A sample on a side belongs to several charts; that of the chart of the lowest number is all of theirs, on every
 * level, so that heights there are the same bits whichever chart is read. What is up to TC_BEYOND samples beyond a side
 * is where the chart's formulas go on (chart.h), and its height is interpolated from the chart that has the place: by
 * cubics, or the sample itself where one is there. So filters and slopes go across seams as if there were none. */
#ifndef TC_JOINED_H
#define TC_JOINED_H

#include "chart.h"
#include "common/field/field.h"

enum { TC_BEYOND = 8 };

/* Puts fields that are joined in the place of the charts' own, which they take over. All charts, six at most, are of
 * one class, whose fields are of one size, and chart[k] is face k; they keep their numbers. apart: of level l in
 * [l - 1], how far a chart's own sample on a side may be from the owner's, metres; INFINITY where that is not known,
 * and ranges next to sides take more reads and are wide; NULL: nowhere (tc_joined_settle()). What is told of the
 * terrain is then that of all charts together: extremes, the number of voids. False: no memory, and all is as it was.
 */
bool tc_charts_join(tc_chart *chart, int charts, const float *apart);

/* ---- While fields are made ----------------------------------------------------------------------------------------
 */

/* Reads of a level as joined fields do; rect may stick out by TC_BEYOND. */
tc_status tc_joined_read(const tc_chart *chart, int charts, int face, int level, tc_rect rect, float *z, uint8_t *voids,
                         ptrdiff_t stride);

/* Makes a level's samples on the sides, in fields in memory (memory_field.h), those of the chart that they belong to.
 */
tc_status tc_joined_settle(const tc_chart *chart, int charts, int level);

/* Heights of a level at places, radians, each by the cubic through the four samples around in each direction; voids
 * where the nearest sample is one. */
tc_status tc_joined_heights(const tc_chart *chart, int charts, int level, int64_t count, const double *longitude,
                            const double *latitude, float *z_ret, uint8_t *voids_ret);

/* The chart that has sample (*i, *j) of a face of so many cells, and the sample's numbers there. */
void tc_joined_owner(const tc_chart_class *class, int64_t cells, int *face, int64_t *i, int64_t *j);

#endif

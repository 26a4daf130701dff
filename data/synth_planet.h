/* synth_planet.h - a planet out of a seed. */
#ifndef TC_SYNTH_PLANET_H
#define TC_SYNTH_PLANET_H

#include "common/terraclip.h"

enum { TC_SYNTH_PLANET_MIN = 4, TC_SYNTH_PLANET_MAX = 65536 };
#define TC_SYNTH_PLANET_RADIUS 6371000.0 /* metres */

typedef struct tc_synth_planet tc_synth_planet;

/* A grid of longitude and latitude, size columns by size / 2 rows (size is even, TC_SYNTH_PLANET_MIN .. _MAX), whose
 * samples stand for areas: sample (i, j), rows south to north, lies at longitude -180 + (i + 1/2) 360 / size and
 * latitude -90 + (j + 1/2) 360 / size. threads: 0 is as many as there are processors; no result depends on it.
 *
 * A larger size is the same planet with finer detail. */
tc_status tc_synth_planet_open(int64_t size, uint64_t seed, int threads, tc_synth_planet **planet_ret, tc_error *error);
void tc_synth_planet_close(tc_synth_planet *planet);

/* Fills z[(j - y0) * size + i] for rows y0 .. y0 + rows - 1 with metres; sea level is 0. Rows do not depend on which
 * others are asked for, and have the same bits on every machine. */
void tc_synth_planet_rows(const tc_synth_planet *planet, int64_t y0, int64_t rows, float *z);

#endif

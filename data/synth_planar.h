/* synth_planar.h - a landscape out of a seed. */
#ifndef TC_SYNTH_PLANAR_H
#define TC_SYNTH_PLANAR_H

#include "common/terraclip.h"

/* Zero is the default everywhere. */
typedef struct tc_synth_planar_options {
    uint64_t seed;
    double spacing; /* metres between samples, TC_SYNTH_SPACING_MIN .. _MAX; 0: TC_SYNTH_SPACING */
    int threads;    /* 0: as many as there are processors; the result does not depend on it */
    void (*progress)(void *context, double done); /* 0..1, from the calling thread; NULL: not told */
    void *progress_context;
} tc_synth_planar_options;

enum { TC_SYNTH_SIZE_MIN = 2, TC_SYNTH_SIZE_MAX = 65537 };
#define TC_SYNTH_SPACING 30.0
#define TC_SYNTH_SPACING_MIN 1e-3
#define TC_SYNTH_SPACING_MAX 1e5

/* Fills z[j * size + i], the caller's, with metres, rows south to north; sea level is 0. The same bits for a size, seed
 * and spacing on every machine.
 *
 * Terrains up to 123 km wide (4097 samples at 30 m) show one landscape, mountains, plains and a coast, whatever their
 * size: a smaller one is a smaller landscape with lower mountains, not a part or a coarser copy of a larger one. A
 * wider one has more ranges and coasts of that same size. */
tc_status tc_synth_planar(int64_t size, const tc_synth_planar_options *options, float *z, tc_error *error);

/* Bytes of memory that tc_synth_planar takes at its peak, without z. */
size_t tc_synth_planar_bytes(int64_t size, double spacing);

#endif

/* parallel.h - one loop over several threads. */
#ifndef TC_PARALLEL_H
#define TC_PARALLEL_H

#include "common/terraclip.h"

/* Calls body(context, i) once for every 0 <= i < count from up to `threads` threads (0: as many as there are
 * processors), the calling one among them, and returns when all are done. Works with fewer threads where no more can
 * be started. */
void tc_parallel_for(int threads, int64_t count, void (*body)(void *context, int64_t i), void *context);

#endif

/* timed.h - work repeated for its median time. */
#ifndef TIMED_H
#define TIMED_H

#include "measure.h"

/* How often: `least` times at least; no more than `most` times, or once `seconds` have passed. */
typedef struct timed_limits {
    int least, most;
    double seconds;
} timed_limits;

/* Processor milliseconds of work(context, n), n = 0, 1, ...; false once it returns that. */
enum { TIMED_MOST = 256 };
bool timed_repeat(timed_limits limits, bool (*work)(void *context, int n), void *context, measure_spread *ms_ret);

#endif

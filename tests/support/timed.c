/* timed.c - work repeated for its median time. */
#include "timed.h"

#include "terrain_files.h"

bool timed_repeat(timed_limits limits, bool (*work)(void *context, int n), void *context, measure_spread *ms_ret)
{
    double ms[TIMED_MOST], begin = terrain_wall();
    int count = 0;
    while (count < TIMED_MOST &&
           (count < limits.least || (count < limits.most && terrain_wall() - begin < limits.seconds))) {
        double start = terrain_cpu();
        if (!work(context, count))
            return false;
        ms[count++] = 1e3 * (terrain_cpu() - start);
    }
    *ms_ret = measure_of(ms, count);
    return true;
}

/* sweep.h - sweeps over random cases: `make test` looks at a sixth of them, `make test-extreme` at all, `make
 * gpu-report` at a smaller part. */
#ifndef SWEEP_H
#define SWEEP_H

#include <stdbool.h>

/* Whether all of each sweep is asked for (TERRACLIP_SWEEP=whole). */
bool sweep_whole(void);

/* So many of that many cases: TERRACLIP_SWEEP=K asks for a K-th of them, rounded up. */
int sweep_of(int cases);

#endif

/* moody.h - a field over another one that cannot always be read, and is not always ready: as one whose tiles a thread
 * decodes, in steps that a test takes. */
#ifndef MOODY_H
#define MOODY_H

#include "common/field/field.h"
#include "terrains.h"

enum { MOODY_TILE = 32 }; /* samples along a side */

typedef struct moody_field {
    tc_field head;
    const tc_field *base;
    bool on;           /* else all can be read, and nothing is counted */
    int failing_level; /* levels from this one on cannot be read; 0: all can */
    bool says_so;      /* and are not said to be coming: a field that has tried by itself */
    double failing;    /* share of other reads that fail, too */
    int most;          /* tiles of a level that can be decoded at once; 0: all is always ready */
    int tries;         /* reads that failed, and answers that they would */
    int waits;         /* reads of tiles that were not decoded */
    bool *decoded[TC_MAX_FIELD_LEVELS];
    tc_rect wish[TC_MAX_FIELD_LEVELS]; /* the last one of each level */
    test_random random;
} moody_field;

moody_field *moody_create(const tc_field *base, uint64_t seed); /* in good mood */
void moody_destroy(moody_field *m);

/* What the thread does between two frames: decodes what is wished, unless it is more than there is room for. */
void moody_work(moody_field *m);

#endif

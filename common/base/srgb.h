/* srgb.h - between eight bits as shown (IEC 61966-2-1) and linear light, by tables. */
#ifndef TC_SRGB_H
#define TC_SRGB_H

#include <stdint.h>

typedef struct tc_srgb {
    float linear[256];   /* light, 0 .. 1, of what is shown */
    uint8_t shown[4096]; /* what is shown of the root of light, in 4095ths: steps are finer than a quarter of one */
} tc_srgb;

/* The tables; thread-safe. */
const tc_srgb *tc_srgb_tables(void);

/* What is shown of light from 0 to 1, whose root is given. */
static inline uint8_t tc_srgb_shown(const tc_srgb *t, float root)
{
    return t->shown[(int)(root < 0 ? 0 : root > 1 ? 4095 : root * 4095 + 0.5f)];
}

#endif

/* synthesis_store.h - a fit as bytes, as packed files have it (docs/format.md, section 3.3), and back. */
#ifndef TC_SYNTHESIS_STORE_H
#define TC_SYNTHESIS_STORE_H

#include "common/base/byte_order.h"
#include "synthesis.h"

/* What is put; less is damaged, of a later form it may be more. */
enum { TC_SYNTHESIS_BYTES = 419 };

/* All its numbers as they are: what comes back makes the same heights. */
void tc_synthesis_put(const tc_synthesis_fit *fit, tc_byte_writer *writer);

/* A number of a fit, and what it lies between. */
typedef struct tc_synthesis_number {
    const char *name;
    double value, least, most;
} tc_synthesis_number;

/* Whether its numbers lie where those of a terrain's fit do: what is put must. Else *beyond_ret is the first that does
 * not; it may be NULL. */
bool tc_synthesis_can_put(const tc_synthesis_fit *fit, tc_synthesis_number *beyond_ret);

/* TC_ERR_UNSUPPORTED: of a form that this version does not know, so that it must fit anew. TC_ERR_FORMAT: damaged, or
 * numbers that no fit has. */
tc_status tc_synthesis_get(const uint8_t *bytes, size_t size, tc_synthesis_fit *fit_ret);

#endif

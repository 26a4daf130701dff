/* extreme.h - the rows of `make test-extreme`: one a case, with its figure.
 *
 * A program is a family of cases ("heights", "sizes", ...). It prints its rows and, where the environment names a
 * folder in TERRACLIP_EXTREME, leaves them there as FAMILY.csv for the report:
 * family,case,figure,value,limit,verdict,note. */
#ifndef EXTREME_H
#define EXTREME_H

#include "common/terraclip.h"

void extreme_begin(const char *family);

/* Passes where value <= limit (NAN fails). figure: what was measured, with its unit ("cracks, pixels"). note:
 * printf-like, what else there is to know of the case; "" for nothing. */
void extreme_at_most(const char *name, const char *figure, double value, double limit, const char *note, ...)
    __attribute__((format(printf, 5, 6)));

/* A value that was measured on so many; NAN where on none, since what has looked at nothing has not passed. */
double extreme_of(int64_t count, double value);

/* A case that must be refused: passes where it failed with `expected` and the text, which the row quotes without
 * the tests' own folder (made_files.h), is one line that is not empty. */
void extreme_refused(const char *name, tc_status status, tc_status expected, const char *text);

/* A case that cannot be run here, and why. Shown, not counted as passed. */
void extreme_skipped(const char *name, const char *why);

/* The program's exit code: 1 where a case failed, or none was run. */
int extreme_end(void);

#endif

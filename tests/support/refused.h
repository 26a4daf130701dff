/* refused.h - what is refused is so by its status and in one line. */
#ifndef REFUSED_H
#define REFUSED_H

#include "common/terraclip.h"

/* The test fails unless the status is the expected one and the error a line with the word in it. */
void assert_refused(tc_status status, tc_status expected, const tc_error *error, const char *word);

#endif

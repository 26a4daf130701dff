/* refused.c */
#include "refused.h"

#include <string.h>

#include "test.h"

void assert_refused(tc_status status, tc_status expected, const tc_error *error, const char *word)
{
    if (status != expected || !strstr(error->text, word) || strchr(error->text, '\n'))
        fail_msg("expected status %d and a line with \"%s\", found %d and \"%s\"", expected, word, status, error->text);
}

/* status.h - filling in a tc_error. */
#ifndef TC_STATUS_H
#define TC_STATUS_H

#include "common/terraclip.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sets *error (where not NULL) to status and the formatted line, and returns status:
 *     return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno)); */
tc_status tc_fail(tc_error *error, tc_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

#ifdef __cplusplus
}
#endif

#endif

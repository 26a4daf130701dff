/* numbers.h - numbers as they are written on command lines: decimal, finite, with nothing around them. */
#ifndef TC_NUMBERS_H
#define TC_NUMBERS_H

#include <stdbool.h>
#include <stdint.h>

/* All of text is one number within low .. high; else false, and *value_ret stays. */
bool tc_read_integer(const char *text, int64_t low, int64_t high, int64_t *value_ret);
bool tc_read_int(const char *text, int low, int high, int *value_ret);
bool tc_read_unsigned(const char *text, uint64_t low, uint64_t high, uint64_t *value_ret);
bool tc_read_number(const char *text, double low, double high, double *value_ret);

/* Takes a number off the front of *text and moves *text behind it. */
bool tc_take_number(const char **text, double *value_ret);

#endif

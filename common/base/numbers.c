/* numbers.c - strtod and its like also take spaces, hexadecimals, "inf" and "nan"; here only decimal numbers pass. */
#include "numbers.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool tc_read_integer(const char *text, int64_t low, int64_t high, int64_t *value_ret)
{
    if (!isdigit((unsigned char)text[text[0] == '-']))
        return false;
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (*end || errno || value < low || value > high)
        return false;
    *value_ret = value;
    return true;
}

bool tc_read_int(const char *text, int low, int high, int *value_ret)
{
    int64_t value;
    if (!tc_read_integer(text, low, high, &value))
        return false;
    *value_ret = (int)value;
    return true;
}

bool tc_read_unsigned(const char *text, uint64_t low, uint64_t high, uint64_t *value_ret)
{
    if (!isdigit((unsigned char)text[0]))
        return false;
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    if (*end || errno || value < low || value > high)
        return false;
    *value_ret = value;
    return true;
}

bool tc_take_number(const char **text, double *value_ret)
{
    size_t length = strspn(*text, "0123456789.eE+-");
    char *end;
    double value = strtod(*text, &end);
    if (length == 0 || end != *text + length || !isfinite(value))
        return false;
    *text = end;
    *value_ret = value;
    return true;
}

bool tc_read_number(const char *text, double low, double high, double *value_ret)
{
    double value;
    if (!tc_take_number(&text, &value) || *text || !(value >= low && value <= high))
        return false;
    *value_ret = value;
    return true;
}

/* wkt.c - ELLIPSOID["WGS 84",6378137,298.257223563], in older words SPHEROID[...]; brackets may be round. */
#include "wkt.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "numbers.h"

/* Behind the keyword; NULL: there is none. Names may say anything, but stand in quotes. */
static const char *find_keyword(const char *wkt)
{
    static const char *const words[] = {"ELLIPSOID", "SPHEROID"};
    bool quoted = false;
    for (const char *at = wkt; *at; at++) {
        quoted ^= *at == '"'; /* a quote in a name is two of them */
        for (int k = 0; k < 2 && !quoted; k++)
            if (strncmp(at, words[k], strlen(words[k])) == 0)
                return at + strlen(words[k]);
    }
    return NULL;
}

/* Behind a quoted name; NULL: there is none. */
static const char *skip_name(const char *at)
{
    if (*at++ != '"')
        return NULL;
    while (*at && (at[0] != '"' || at[1] == '"'))
        at += *at == '"' ? 2 : 1;
    return *at ? at + 1 : NULL;
}

static const char *skip_space(const char *at)
{
    return at + strspn(at, " \t\r\n");
}

/* Takes a comma and a number behind it. */
static bool take_next(const char **at, double *value_ret)
{
    *at = skip_space(*at);
    if (**at != ',')
        return false;
    *at = skip_space(*at + 1);
    return tc_take_number(at, value_ret);
}

double tc_wkt_inverse_flattening(const char *wkt)
{
    const char *at = find_keyword(wkt);
    double semi_major, inverse;
    at = at ? skip_space(at) : "";
    at = *at == '[' || *at == '(' ? skip_name(skip_space(at + 1)) : NULL;
    return at && take_next(&at, &semi_major) && take_next(&at, &inverse) && inverse > 1 ? inverse : 0;
}

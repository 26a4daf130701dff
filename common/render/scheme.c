/* scheme.c - finding schemes in lists of them. */
#include "scheme.h"

#include <string.h>

const tc_scheme *tc_scheme_at(const tc_scheme *const *lists, const tc_body_class *body, int k)
{
    for (; *lists; lists++)
        for (const tc_scheme *s = *lists; s->name; s++)
            if ((!body || tc_body_is(body, s->body)) && k-- == 0)
                return s;
    return NULL;
}

const tc_scheme *tc_scheme_named(const tc_scheme *const *lists, const tc_body_class *body, const char *name)
{
    const tc_scheme *s;
    for (int k = 0; (s = tc_scheme_at(lists, body, k)); k++)
        if (strcmp(s->name, name) == 0)
            return s;
    return NULL;
}

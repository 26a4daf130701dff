/* scheme.c - finding schemes in lists of them. */
#include "scheme.h"

#include <string.h>

#include "common/chart/atlas.h"

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

const tc_scheme *tc_scheme_by_error(const tc_scheme *const *lists)
{
    const tc_scheme *s;
    for (int k = 0; (s = tc_scheme_at(lists, NULL, k)); k++)
        if (s->by_error)
            return s;
    return NULL;
}

const tc_scheme *tc_scheme_for(const tc_scheme *const *lists, const tc_map *map)
{
    const tc_atlas *atlas = tc_atlas_of(map->chart[0].class);
    const tc_scheme *s;
    for (int k = 0; (s = tc_scheme_at(lists, map->body.class, k)); k++)
        if (tc_atlas_same(s->atlas, atlas))
            return s;
    return NULL;
}

/* points.c - lists of points.
 *
 * What could be read in two ways is no point: an answer to another question than was asked does not look wrong. */
#include "points.h"

#include "common/base/numbers.h"
#include "common/base/text.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

static const char blanks[] = " \t";

/* Whether the only comma among three columns may be a decimal one, as in 8,5 46 and in 8 46,5. */
static bool may_be_decimal(const char *x, const char *x_end, const char *y_end)
{
    const char *comma = *x_end == ',' ? x_end : y_end, *third = y_end + strspn(y_end, " \t,;");
    if ((*x_end == ',') == (*y_end == ',') || memchr(x, '.', (size_t)(y_end - x)))
        return false;
    return isdigit((unsigned char)comma[1]) && *third && strchr("-+0123456789", *third);
}

static bool parse_point(const char *text, double *x, double *y)
{
    const char *begin = text + strspn(text, blanks), *end = begin;
    if (!tc_take_number(&end, x))
        return false;
    const char *mark = end + strspn(end, blanks), *next = mark + (*mark == ',' || *mark == ';');
    next += strspn(next, blanks);
    if (next == end || !tc_take_number(&next, y) || may_be_decimal(begin, end, next))
        return false;
    return *next == '\0' || strchr(" \t,;", *next);
}

/* The next word of a line that names its columns: letters, and no number by another name. */
static bool take_word(const char **text)
{
    const char *t = *text + strspn(*text, " \t,;\"");
    size_t length = strcspn(t, " \t,;\"");
    *text = t + length;
    if (length == 0 || !(isalpha((unsigned char)*t) || (unsigned char)*t >= 0x80 || strchr("_([", *t)))
        return false;
    for (size_t i = 0; i < length; i++)
        if (isdigit((unsigned char)t[i]))
            return false;
    static const char *const numbers[] = {"nan", "inf", "infinity"};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (strlen(numbers[i]) == length && strncasecmp(t, numbers[i], length) == 0)
            return false;
    return true;
}

static bool names_columns(const char *text)
{
    return take_word(&text) && take_word(&text);
}

tc_points_line tc_points_next(tc_points *p, double *x, double *y)
{
    while (getline(&p->text, &p->room, p->file) > 0) {
        char *text = p->text;
        text[strcspn(text, "\r\n")] = '\0';
        if (p->number++ == 0)
            text += tc_text_mark(text);
        char first = text[strspn(text, blanks)];
        if (first == '\0' || first == '#')
            continue;
        bool may_name = !p->begun;
        p->begun = true;
        if (parse_point(text, x, y))
            return TC_POINTS_POINT;
        if (!may_name || !names_columns(text))
            return TC_POINTS_BAD;
    }
    return TC_POINTS_END;
}

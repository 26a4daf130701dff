/* display.c - words and lines of what a window tells; see display.h. */
#include "display.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Seconds that a line is there, a warning's longer, and of these the last ones in which it fades. */
static const double SHOWN = 5, WARNED = 9, FADING = 1.5;

/* Takes the begun character off the end of what was cut. */
static void mend_end(char *text, size_t length)
{
    size_t begin = length;
    while (begin > 0 && ((unsigned char)text[begin - 1] & 0xc0) == 0x80)
        begin--;
    if (begin == 0)
        return;
    const unsigned char lead = (unsigned char)text[begin - 1];
    const size_t whole = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc0 ? 2 : 1;
    if (length - (begin - 1) < whole)
        text[begin - 1] = '\0';
}

static void copy(char text[TC_DISPLAY_LENGTH], const char *from)
{
    snprintf(text, TC_DISPLAY_LENGTH, "%s", from);
    mend_end(text, strlen(text));
}

void tc_display_say(tc_display *display, tc_display_side side, bool warning, double opacity, const char *format, ...)
{
    if (display->texts == TC_DISPLAY_TEXTS)
        return;
    tc_display_text *t = &display->text[display->texts++];
    t->side = side, t->warning = warning, t->opacity = opacity;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(t->text, sizeof t->text, format, arguments);
    va_end(arguments);
    mend_end(t->text, strlen(t->text));
}

/* ---- Words ------------------------------------------------------------------------------------------------------- */

void tc_words_metres(double metres, char text[TC_WORDS])
{
    static const struct {
        double below, unit;
        const char *format;
    } forms[] = {{10, 1, "%.2f m"},     {100, 1, "%.1f m"},    {9999.5, 1, "%.0f m"},
                 {1e5, 1e3, "%.2f km"}, {1e6, 1e3, "%.1f km"}, {INFINITY, 1e3, "%.0f km"}};
    int k = 0;
    while (fabs(metres) >= forms[k].below && isfinite(forms[k].below))
        k++;
    snprintf(text, TC_WORDS, forms[k].format, metres / forms[k].unit);
}

void tc_words_degrees(double longitude, double latitude, int digits, char text[TC_WORDS])
{
    const double turned = longitude - 360 * round(longitude / 360);
    snprintf(text, TC_WORDS, "%.*f\u00b0 %c, %.*f\u00b0 %c", digits, fabs(latitude), latitude < 0 ? 'S' : 'N', digits,
             fabs(turned), turned < 0 ? 'W' : 'E');
}

double tc_words_scale(double metres_a_pixel, double most_pixels, char text[TC_WORDS / 2])
{
    const double most = metres_a_pixel * most_pixels;
    text[0] = '\0';
    if (!(most > 1e-6) || !(most < 1e15)) /* neither for what is no number */
        return 0;
    const double power = pow(10, floor(log10(most)));
    const double length = most >= 5 * power ? 5 * power : most >= 2 * power ? 2 * power : power;
    static const struct {
        double from, unit;
        const char *name;
    } units[] = {{999, 1e3, "km"}, {0.999, 1, "m"}, {0.00999, 0.01, "cm"}, {0, 0.001, "mm"}};
    int k = 0;
    while (length < units[k].from)
        k++;
    snprintf(text, TC_WORDS / 2, "%.6g %s", length / units[k].unit, units[k].name);
    return length / metres_a_pixel;
}

/* ---- What passes ------------------------------------------------------------------------------------------------- */

void tc_display_lines_add(tc_display_lines *lines, bool warning, double now, const char *text)
{
    struct tc_display_line line = {.warning = warning, .since = now};
    copy(line.text, text);
    if (lines->count > 0 && strcmp(lines->line[lines->count - 1].text, line.text) == 0)
        lines->count--;
    if (lines->count == TC_DISPLAY_LINES)
        memmove(lines->line, lines->line + 1, --lines->count * sizeof *lines->line);
    lines->line[lines->count++] = line;
}

void tc_display_lines_drop(tc_display_lines *lines, const char *text)
{
    int kept = 0;
    for (int i = 0; i < lines->count; i++)
        if (strcmp(lines->line[i].text, text) != 0)
            lines->line[kept++] = lines->line[i];
    lines->count = kept;
}

void tc_display_lines_show(tc_display_lines *lines, double now, tc_display *display)
{
    int kept = 0;
    for (int i = 0; i < lines->count; i++) {
        const struct tc_display_line *line = &lines->line[i];
        const double left = (line->warning ? WARNED : SHOWN) - (now - line->since) / 1e3;
        if (left <= 0)
            continue;
        tc_display_say(display, TC_SIDE_TOP, line->warning, fmin(1, left / FADING), "%s", line->text);
        if (kept != i)
            lines->line[kept] = *line;
        kept++;
    }
    lines->count = kept;
}

/* colour_file.c - reads height ramps: GDAL's color-relief text, which QGIS and GRASS write, too. */
#include "colour_file.h"

#include "common/base/numbers.h"
#include "common/base/status.h"
#include "common/base/text.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const struct {
    const char *name;
    uint8_t rgb[3];
} names[] = {
    {"white", {255, 255, 255}}, {"black", {0, 0, 0}},      {"red", {255, 0, 0}},       {"green", {0, 255, 0}},
    {"blue", {0, 0, 255}},      {"yellow", {255, 255, 0}}, {"magenta", {255, 0, 255}}, {"cyan", {0, 255, 255}},
    {"aqua", {0, 191, 191}},    {"grey", {191, 191, 191}}, {"gray", {191, 191, 191}},  {"orange", {255, 127, 0}},
    {"brown", {191, 127, 63}},  {"purple", {127, 0, 255}}, {"violet", {127, 0, 255}},  {"indigo", {0, 127, 255}}};
enum { NAMES = sizeof names / sizeof *names, WORDS = 5 };

static bool read_colour(char *const word[WORDS], int count, uint8_t rgba[4])
{
    rgba[3] = 255;
    for (int i = 0; i < NAMES && (count == 2 || count == 3); i++)
        if (strcasecmp(word[1], names[i].name) == 0) {
            int alpha = 255;
            memcpy(rgba, names[i].rgb, 3);
            bool good = count == 2 || tc_read_int(word[2], 0, 255, &alpha);
            rgba[3] = (uint8_t)alpha;
            return good;
        }
    for (int c = 0; c + 1 < count; c++) {
        int value;
        if (!tc_read_int(word[1 + c], 0, 255, &value))
            return false;
        rgba[c] = (uint8_t)value;
    }
    return count >= 4;
}

static bool read_height(char *text, tc_colour_stop *stop)
{
    size_t length = strlen(text);
    stop->share = length > 1 && text[length - 1] == '%';
    if (stop->share)
        text[length - 1] = '\0';
    bool good = tc_read_number(text, -1e9, 1e9, &stop->at);
    stop->at /= stop->share ? 100 : 1;
    return good;
}

/* False: the line makes no sense. *is_stop_ret: false for one that is left out. */
static bool read_line(char *line, tc_colour_stop *stop, bool *is_stop_ret)
{
    char *word[WORDS + 1], *rest = line;
    int count = 0;
    for (char *w; count <= WORDS && (w = strtok_r(count ? NULL : line, " \t,:\r\n", &rest));)
        word[count++] = w;
    *is_stop_ret = false;
    if (count == 0 || word[0][0] == '#' || strcasecmp(word[0], "nv") == 0 || strcasecmp(word[0], "default") == 0)
        return true;
    if (strcasecmp(word[0], "INTERPOLATION") == 0)
        return count == 2 && strcasecmp(word[1], "INTERPOLATED") == 0;
    *is_stop_ret = true;
    return count <= WORDS && read_height(word[0], stop) && read_colour(word, count, stop->rgba);
}

static tc_status read_all(FILE *file, const char *path, tc_colour_ramp *ramp, tc_error *error)
{
    enum { MOST = 4096 };
    char line[512], shown[64];
    for (int number = 1; fgets(line, sizeof line, file); number++) {
        tc_colour_stop stop;
        bool is_stop;
        char *text = line + (number == 1 ? tc_text_mark(line) : 0);
        snprintf(shown, sizeof shown, "%.*s", (int)strcspn(text, "\r\n"), text);
        for (char *c = shown; *c; c++)
            *c = isprint((unsigned char)*c) ? *c : '?';
        if (!strchr(line, '\n') && !feof(file))
            return tc_fail(error, TC_ERR_FORMAT, "%s: line %d: expected a height and a colour, found a line too long",
                           path, number);
        if (!read_line(text, &stop, &is_stop))
            return tc_fail(error, TC_ERR_FORMAT,
                           "%s: line %d: expected a height (or percentage) and a colour, as `gdaldem color-relief` "
                           "interpolates them, found '%s'",
                           path, number, shown);
        if (!is_stop)
            continue;
        if (ramp->count == MOST)
            return tc_fail(error, TC_ERR_FORMAT, "%s: expected at most %d colours, found more", path, MOST);
        tc_colour_stop *all = realloc(ramp->stop, (size_t)(ramp->count + 1) * sizeof *all);
        if (!all)
            return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
        ramp->stop = all;
        all[ramp->count++] = stop;
    }
    if (ferror(file))
        return tc_fail(error, TC_ERR_IO, "%s: cannot be read", path);
    return ramp->count > 0 ? TC_OK : tc_fail(error, TC_ERR_FORMAT, "%s: expected colours of heights, found none", path);
}

tc_status tc_colour_file_read(const char *path, tc_colour_ramp *ramp_ret, tc_error *error)
{
    tc_colour_ramp ramp = {0};
    FILE *file = fopen(path, "r");
    if (!file)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    tc_status status = read_all(file, path, &ramp, error);
    fclose(file);
    if (status)
        free(ramp.stop);
    else
        *ramp_ret = ramp;
    return status;
}

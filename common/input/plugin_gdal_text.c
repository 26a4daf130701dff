/* plugin_gdal_text.c - grids written as text, Esri's and GRASS's: whether the values are there, and are numbers.
 *
 * GDAL reads 0 for what is no number (a word, or GRASS's * for a void) and for a last value that is missing. So the
 * text is looked over once, before the first rows are read: whoever only opens a file does not wait for it. Whoever
 * reads one waits about a tenth longer, however large it is, since GDAL goes through all text before the rows that it
 * is asked for, a character at a time. */
#include "plugin_gdal.h"

#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1 << 16, LONGEST = 498 }; /* bytes: read at once; of a value, for GDAL */

/* Goes over the text, a chunk in memory after the other. */
typedef struct reader {
    VSILFILE *file;
    bool whole;           /* numbers alone: GDAL takes them for such, and would read 0 for a nan */
    char text[CHUNK + 1]; /* ended by a 0 */
    char *next, *end;     /* what is left of it */
    bool last;            /* there is no more in the file */
} reader;

/* More text behind what is left. A zero byte is the end, as it is for GDAL. */
static void read_on(reader *r)
{
    const size_t kept = (size_t)(r->end - r->next);
    memmove(r->text, r->next, kept);
    const size_t length = kept + VSIFReadL(r->text + kept, 1, CHUNK - kept, r->file);
    r->text[length] = '\0';
    r->next = r->text;
    r->end = r->text + kept + strlen(r->text + kept);
    r->last = r->end < r->text + CHUNK;
}

static bool is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool is_end(char c)
{
    return c == '\n' || c == '\r';
}

/* Values begin where GDAL has them begin: on the first line that does not begin with a letter, but for the "null" that
 * some programs write for voids. */
static void pass_head(reader *r)
{
    const char *t = r->text;
    for (size_t i = 2; t + i < r->end; i++)
        if ((is_end(t[i - 1]) || is_end(t[i - 2])) && !is_end(t[i]) &&
            (!isalpha((unsigned char)t[i]) || strncmp(t + i, "null ", 5) == 0)) {
            r->next = r->text + i;
            return;
        }
    r->next = r->end;
}

static const char *after_digits(const char *t)
{
    while (*t >= '0' && *t <= '9')
        t++;
    return t;
}

/* Behind a number as nearly all are written, at the begin of a text; NULL: there is none. */
static const char *after_plain(const char *t, bool whole)
{
    t += *t == '-' || *t == '+';
    const char *end = after_digits(t);
    bool digits = end > t;
    if (!whole && (*end == '.' || *end == ',')) {
        t = end + 1, end = after_digits(t);
        digits |= end > t;
    }
    if (!whole && (*end == 'e' || *end == 'E')) {
        t = end + 1, t += *t == '-' || *t == '+', end = after_digits(t);
        digits &= end > t;
    }
    return digits ? end : NULL;
}

/* What else GDAL makes a number of: none and infinite ones in all their spellings. */
static bool is_number(const char *value)
{
    const char mark = value[strcspn(value, ".,")];
    char *rest;
    CPLStrtodDelim(value, &rest, mark == ',' ? ',' : '.');
    return strcmp(value, "null") == 0 || (rest > value && !*rest);
}

/* The next value, of which there must be one in the text; false: it is no number, and value has it, cut. */
static bool take_value(reader *r, char value[LONGEST + 1])
{
    const char *begin = r->next, *end = after_plain(begin, r->whole);
    const bool plain = end && (is_blank(*end) || end == r->end);
    if (!plain)
        for (end = begin; *end && !is_blank(*end);)
            end++;
    r->next += end - begin;
    if (plain)
        return true;
    const size_t length = (size_t)(end - begin), kept = length < LONGEST ? length : LONGEST;
    memcpy(value, begin, kept);
    value[kept] = '\0';
    return !r->whole && length <= LONGEST && is_number(value);
}

/* A value that is cut off by the chunk's end is none yet: one is at most as long as room is made for. */
static bool find_value(reader *r)
{
    for (;;) {
        while (is_blank(*r->next))
            r->next++;
        if (r->end - r->next <= LONGEST && !r->last)
            read_on(r);
        else
            return r->next < r->end;
    }
}

static tc_status look_over(reader *r, const tc_gdal_text *text, const char *path, tc_error *error)
{
    char value[LONGEST + 1];
    read_on(r);
    pass_head(r);
    for (int64_t n = 0; n < text->columns * text->rows; n++) {
        if (!find_value(r))
            return tc_fail(error, TC_ERR_FORMAT,
                           "%s: damaged or truncated: expected %" PRId64 " values, found %" PRId64, path,
                           text->columns * text->rows, n);
        if (take_value(r, value))
            continue;
        for (char *c = value; *c; c++)
            *c = isprint((unsigned char)*c) ? *c : '?';
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: row %" PRId64 ", column %" PRId64 ": expected a %snumber, found '%.60s'", path,
                       n / text->columns + 1, n % text->columns + 1, text->whole ? "whole " : "", value);
    }
    return TC_OK;
}

tc_gdal_text tc_gdal_text_of(GDALDatasetH dataset)
{
    static const char *const formats[] = {"AAIGrid", "GRASSASCIIGrid"};
    const GDALDriverH driver = GDALGetDatasetDriver(dataset);
    tc_gdal_text text = {.name = NULL};
    for (size_t k = 0; k < sizeof formats / sizeof *formats && !text.name; k++)
        if (driver && EQUAL(GDALGetDriverShortName(driver), formats[k]))
            text = (tc_gdal_text){.name = CPLStrdup(GDALGetDescription(dataset)),
                                  .columns = GDALGetRasterXSize(dataset),
                                  .rows = GDALGetRasterYSize(dataset),
                                  .whole = GDALGetRasterDataType(GDALGetRasterBand(dataset, 1)) == GDT_Int32};
    return text;
}

tc_status tc_gdal_text_check(tc_gdal_text *text, const char *path, tc_error *error)
{
    if (!text->name)
        return TC_OK;
    reader *r = calloc(1, sizeof *r);
    if (!r)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to read it", path);
    r->whole = text->whole;
    r->next = r->end = r->text;
    r->file = VSIFOpenL(text->name, "rb");
    tc_status status = r->file ? look_over(r, text, path, error) : TC_OK; /* GDAL says why it cannot be read */
    if (r->file)
        VSIFCloseL(r->file);
    free(r);
    if (status == TC_OK)
        tc_gdal_text_free(text);
    return status;
}

void tc_gdal_text_free(tc_gdal_text *text)
{
    CPLFree(text->name);
    text->name = NULL;
}

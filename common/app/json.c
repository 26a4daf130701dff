/* json.c - values of JSON. */
#include "json.h"

#include <math.h>

void tc_json_string(const char *text, FILE *file)
{
    fputc('"', file);
    for (const char *c = text ? text : ""; *c; c++) {
        if (*c == '"' || *c == '\\')
            fprintf(file, "\\%c", *c);
        else if ((unsigned char)*c < 0x20)
            fprintf(file, "\\u%04x", *c);
        else
            fputc(*c, file);
    }
    fputc('"', file);
}

void tc_json_number(double value, FILE *file)
{
    if (isfinite(value))
        fprintf(file, "%.9g", value);
    else
        fputs("null", file);
}

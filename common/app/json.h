/* json.h - values of JSON. */
#ifndef TC_JSON_H
#define TC_JSON_H

#include <stdio.h>

/* A string, quotes included; NULL is empty. */
void tc_json_string(const char *text, FILE *file);

/* A number that reads back as it was to nine digits; null where it is not finite. */
void tc_json_number(double value, FILE *file);

#endif

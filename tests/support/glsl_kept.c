/* glsl_kept.c - what the preprocessor's conditions leave of a shader. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gl_record.h"

enum { NAMES = 64, DEPTH = 32 };

typedef struct reader {
    char names[NAMES][64]; /* defined */
    int count;
    const char *at; /* in a condition */
} reader;

static void give_up(const char *line)
{
    fprintf(stderr, "glsl_kept: cannot read '%.60s'\n", line);
    exit(99);
}

static const char *skip(const char *at)
{
    while (*at == ' ' || *at == '\t')
        at++;
    return at;
}

static size_t name_length(const char *at)
{
    size_t n = 0;
    while (isalnum((unsigned char)at[n]) || at[n] == '_')
        n++;
    return n;
}

static bool is_defined(const reader *r, const char *name, size_t length)
{
    for (int i = 0; i < r->count; i++)
        if (strlen(r->names[i]) == length && memcmp(r->names[i], name, length) == 0)
            return true;
    return false;
}

static bool either(reader *r);

static bool unary(reader *r)
{
    r->at = skip(r->at);
    if (*r->at == '!') {
        r->at++;
        return !unary(r);
    }
    if (*r->at == '(') {
        r->at++;
        bool value = either(r);
        r->at = skip(r->at);
        if (*r->at++ != ')')
            give_up(r->at);
        return value;
    }
    if (strncmp(r->at, "defined(", 8) != 0)
        give_up(r->at);
    const char *name = r->at + 8;
    size_t length = name_length(name);
    r->at = name + length + 1;
    return is_defined(r, name, length);
}

static bool both(reader *r)
{
    bool value = unary(r);
    while (strncmp(r->at = skip(r->at), "&&", 2) == 0) {
        r->at += 2;
        bool right = unary(r);
        value = value && right;
    }
    return value;
}

static bool either(reader *r)
{
    bool value = both(r);
    while (strncmp(r->at = skip(r->at), "||", 2) == 0) {
        r->at += 2;
        bool right = both(r);
        value = value || right;
    }
    return value;
}

/* A condition's line after "#if". */
static bool condition(reader *r, const char *line)
{
    bool negated = strncmp(line, "ndef ", 5) == 0;
    if (negated || strncmp(line, "def ", 4) == 0) {
        const char *name = skip(line + 4 + negated);
        return is_defined(r, name, name_length(name)) != negated;
    }
    r->at = line;
    bool value = either(r);
    if (*(r->at = skip(r->at)) != '\0')
        give_up(line);
    return value;
}

char *glsl_kept(const char *text)
{
    reader r = {.count = 0};
    bool taken[DEPTH] = {true}; /* of the innermost condition and all around it */
    int depth = 0;
    char *out = calloc(strlen(text) + 2, 1), *end = out;
    if (!out)
        exit(99);
    while (*text) {
        char line[1024];
        size_t length = strcspn(text, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, text);
        text += length + (text[length] == '\n');
        char *comment = strstr(line, "//");
        if (comment)
            *comment = '\0';
        for (size_t n = strlen(line); n > 0 && isspace((unsigned char)line[n - 1]); n--)
            line[n - 1] = '\0';
        if (strncmp(line, "#if", 3) == 0) {
            if (++depth == DEPTH)
                give_up(line);
            taken[depth] = condition(&r, line + 3) && taken[depth - 1];
        } else if (strcmp(line, "#else") == 0) {
            taken[depth] = !taken[depth] && taken[depth - 1];
        } else if (strcmp(line, "#endif") == 0) {
            depth--;
        } else if (strncmp(line, "#elif", 5) == 0 || strncmp(line, "#undef", 6) == 0) {
            give_up(line);
        } else if (taken[depth]) {
            if (strncmp(line, "#define ", 8) == 0 && r.count < NAMES)
                snprintf(r.names[r.count++], sizeof *r.names, "%.*s", (int)name_length(line + 8), line + 8);
            if (*line)
                end += sprintf(end, "%s\n", line);
        }
    }
    return out;
}

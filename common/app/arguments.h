/* arguments.h - command lines by a table of options, from which both parsing and the help are made. */
#ifndef TC_ARGUMENTS_H
#define TC_ARGUMENTS_H

#include "common/terraclip.h"
#include "common/input/source.h"

#include <stddef.h>
#include <stdio.h>

/* One option, or a heading of the help. `arguments` is the program's own structure of what was asked for. */
typedef struct tc_option {
    char letter;          /* 0 none */
    const char *name;     /* without dashes; NULL: a heading of the help */
    const char *argument; /* as the help shows it; NULL: a switch */
    const char *expected; /* as errors show it */
    const char *help;
    /* false: the value is not what is expected. Where it sets several members, `member` is the structure: offset 0. */
    bool (*set)(void *member, const char *value);
    size_t offset; /* of the member in the structure; of a switch a bool's, 0: help (with a letter) or version */
} tc_option;

/* A switch is a bool of a structure, by its place there, which must not be the first. */
#define TC_SWITCH(type, member, letter, name, help)                                                                    \
    {                                                                                                                  \
        letter, name, NULL, NULL, help, NULL, offsetof(type, member)                                                   \
    }
/* The last rows of a table. */
#define TC_HELP_AND_VERSION                                                                                            \
    {'h', "help", NULL, NULL, "print this", NULL, 0},                                                                  \
    {                                                                                                                  \
        0, "version", NULL, NULL, "print the version", NULL, 0                                                         \
    }

/* How a file is read where it does not say, or says it wrongly: members of a tc_source_options. */
#define TC_READING_ROWS(type, source)                                                                                  \
    {0,                                                                                                                \
     "spacing",                                                                                                        \
     "M",                                                                                                              \
     TC_EXPECTED_SPACING,                                                                                              \
     "between samples, whatever the file says",                                                                        \
     tc_read_spacing,                                                                                                  \
     offsetof(type, source.spacing)},                                                                                  \
        {0,                                                                                                            \
         "unit",                                                                                                       \
         "M",                                                                                                          \
         TC_EXPECTED_UNIT,                                                                                             \
         "per unit of height, whatever the file says; negative for depths",                                            \
         tc_read_unit,                                                                                                 \
         offsetof(type, source.unit)},                                                                                 \
        {0, "offset", "M", "metres of -1e9..1e9", "added to all heights", tc_read_offset, offsetof(type, source)},     \
        {0,                                                                                                            \
         "nodata",                                                                                                     \
         "V",                                                                                                          \
         TC_EXPECTED_NODATA,                                                                                           \
         "stored value that means no height, beside the file's own",                                                   \
         tc_read_nodata,                                                                                               \
         offsetof(type, source)},                                                                                      \
        {0, "band", "N", "1..65535", "of several (the first)", tc_read_band, offsetof(type, source.band)},             \
        {0,                                                                                                            \
         "layer",                                                                                                      \
         "NAME",                                                                                                       \
         "a name",                                                                                                     \
         "of a file or an archive that holds several",                                                                 \
         tc_read_text,                                                                                                 \
         offsetof(type, source.layer)},                                                                                \
    {                                                                                                                  \
        0, "crs", "DEF", "a name", "coordinate system, whatever the file says: EPSG:32633, a PROJ string, ...",        \
            tc_read_text, offsetof(type, source.crs)                                                                   \
    }

typedef struct tc_command_line {
    const tc_option *options;
    int count;
    const char *help; /* how to ask for it: "--help" */
    bool numbers;     /* -1.5 is no option but a number */
    /* Takes an argument that is no option, for the member at `offset`; 0: for the structure. */
    tc_status (*operand)(void *member, const char *operand, tc_error *error);
    size_t offset;
} tc_command_line;

typedef enum tc_action { TC_RUN = 0, TC_SHOW_HELP, TC_SHOW_VERSION } tc_action;

/* Reads argv[1] and on. On failure *error names the option, what it expects and what was found; status TC_ERR_USAGE.
 * With the help or the version asked for the rest is not looked at. */
tc_status tc_arguments_read(const tc_command_line *line, int argc, char **argv, void *arguments, tc_action *action_ret,
                            tc_error *error);

/* Prints the table. */
void tc_arguments_print(const tc_command_line *line, FILE *file);

/* Setters that several programs have, of members of these types; false where the value is not what is expected. */
bool tc_read_text(void *text, const char *value);        /* const char *; "" is not expected */
bool tc_read_level(void *level, const char *value);      /* int */
bool tc_read_synthesis(void *levels, const char *value); /* int */
bool tc_read_spacing(void *spacing, const char *value);  /* double */
bool tc_read_unit(void *unit, const char *value);        /* double */
bool tc_read_offset(void *source, const char *value);    /* tc_source_options */
bool tc_read_band(void *band, const char *value);        /* int */
bool tc_read_nodata(void *source, const char *value);    /* tc_source_options */
bool tc_read_voids(void *source, const char *value);     /* tc_source_options */
bool tc_read_threads(void *threads, const char *value);  /* int */

/* For the operand of a program that has one, FILE: a const char * at first NULL; more are errors. */
tc_status tc_take_file(void *file, const char *operand, tc_error *error);

/* What the setters expect. */
#define TC_EXPECTED_LEVEL "1..48"
#define TC_EXPECTED_SYNTHESIS "auto or 1..20"
#define TC_SYNTHESIS_HELP "of detail finer than the data, like its own; auto: until samples are 0.1 m apart (none)"
#define TC_EXPECTED_SPACING "metres of 1e-6..1e7"
#define TC_EXPECTED_UNIT "metres of 1e-9..1e9, or negative ones"
#define TC_EXPECTED_NODATA "a number"
#define TC_EXPECTED_VOIDS "fill, hole or constant=V"
#define TC_EXPECTED_THREADS "1..1024"

#endif

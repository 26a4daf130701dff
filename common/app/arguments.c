/* arguments.c - reads command lines and prints their help; see arguments.h. */
#include "arguments.h"

#include "common/base/status.h"
#include "common/base/numbers.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

/* The option that an argument names, and its value where it is part of the argument (--name=VALUE, -oVALUE). */
static const tc_option *find_option(const tc_command_line *line, const char *argument, const char **value_ret)
{
    *value_ret = NULL;
    for (int i = 0; i < line->count; i++) {
        const tc_option *option = &line->options[i];
        if (!option->name)
            continue;
        if (argument[1] == '-') {
            size_t length = strlen(option->name);
            if (strncmp(argument + 2, option->name, length) != 0)
                continue;
            char after = argument[2 + length];
            if (after != '\0' && after != '=')
                continue;
            *value_ret = after ? argument + 3 + length : NULL;
            return option;
        }
        if (option->letter && argument[1] == option->letter && (!argument[2] || option->argument)) {
            *value_ret = argument[2] ? argument + 2 : NULL;
            return option;
        }
    }
    return NULL;
}

static bool is_operand(const tc_command_line *line, const char *argument)
{
    return argument[0] != '-' || !argument[1] ||
           (line->numbers && (isdigit((unsigned char)argument[1]) || argument[1] == '.'));
}

tc_status tc_arguments_read(const tc_command_line *line, int argc, char **argv, void *arguments, tc_action *action_ret,
                            tc_error *error)
{
    bool only_operands = false;
    for (int i = 1; i < argc; i++) {
        const char *argument = argv[i];
        if (!only_operands && strcmp(argument, "--") == 0) {
            only_operands = true;
            continue;
        }
        if (only_operands || is_operand(line, argument)) {
            tc_status status = line->operand((char *)arguments + line->offset, argument, error);
            if (status != TC_OK)
                return status;
            continue;
        }
        const char *value;
        const tc_option *option = find_option(line, argument, &value);
        if (!option)
            return tc_fail(error, TC_ERR_USAGE, "%s: no such option; %s lists them", argument, line->help);
        if (!option->argument) {
            if (value)
                return tc_fail(error, TC_ERR_USAGE, "--%s: expected no value, found '%s'", option->name, value);
            if (option->offset) {
                *(bool *)((char *)arguments + option->offset) = true;
                continue;
            }
            *action_ret = option->letter == 'h' ? TC_SHOW_HELP : TC_SHOW_VERSION;
            return TC_OK;
        }
        if (!value && ++i < argc)
            value = argv[i];
        if (!value)
            return tc_fail(error, TC_ERR_USAGE, "--%s: expected %s, found nothing", option->name, option->expected);
        if (!option->set((char *)arguments + option->offset, value))
            return tc_fail(error, TC_ERR_USAGE, "--%s: expected %s, found '%s'", option->name, option->expected, value);
    }
    *action_ret = TC_RUN;
    return TC_OK;
}

/* ---- Help ------------------------------------------------------------------------------------------------------- */

/* Prints text from column `column` on, broken between words before column 100. The cursor is at `at`. */
static void print_wrapped(FILE *file, const char *text, int at, int column)
{
    enum { LINE_END = 100 };
    if (at > column - 2) {
        fputc('\n', file);
        at = 0;
    }
    fprintf(file, "%*s", column - at, "");
    at = column;
    while (*text) {
        int length = (int)strcspn(text, " ");
        if (at > column && at + 1 + length > LINE_END) {
            fprintf(file, "\n%*s", column, "");
            at = column;
        } else if (at > column) {
            fputc(' ', file);
            at++;
        }
        fprintf(file, "%.*s", length, text);
        at += length;
        text += length;
        text += *text == ' ';
    }
    fputc('\n', file);
}

void tc_arguments_print(const tc_command_line *line, FILE *file)
{
    for (int i = 0; i < line->count; i++) {
        const tc_option *option = &line->options[i];
        if (!option->name) {
            fprintf(file, "\n%s:\n", option->help);
            continue;
        }
        int at = option->letter ? fprintf(file, "  -%c, --%s", option->letter, option->name)
                                : fprintf(file, "      --%s", option->name);
        if (option->argument)
            at += fprintf(file, " %s", option->argument);
        print_wrapped(file, option->help, at, 30);
    }
}

/* ---- Values that several programs take -------------------------------------------------------------------------- */

bool tc_read_text(void *text, const char *value)
{
    *(const char **)text = value;
    return *value != '\0';
}

bool tc_read_level(void *level, const char *value)
{
    return tc_read_int(value, 1, 48, level);
}

bool tc_read_synthesis(void *levels, const char *value)
{
    if (strcmp(value, "auto") != 0)
        return tc_read_int(value, 1, TC_SYNTHESIS_MOST, levels);
    *(int *)levels = TC_SYNTHESIS_AUTO;
    return true;
}

bool tc_read_spacing(void *spacing, const char *value)
{
    return tc_read_number(value, 1e-6, 1e7, spacing);
}

bool tc_read_unit(void *unit, const char *value)
{
    return tc_read_number(value, -1e9, 1e9, unit) && fabs(*(double *)unit) >= 1e-9;
}

bool tc_read_offset(void *source, const char *value)
{
    tc_source_options *options = source;
    return options->has_offset = tc_read_number(value, -1e9, 1e9, &options->offset);
}

bool tc_read_band(void *band, const char *value)
{
    return tc_read_int(value, 1, 65535, band);
}

bool tc_read_nodata(void *source, const char *value)
{
    tc_source_options *options = source;
    return options->has_nodata = tc_read_number(value, -HUGE_VAL, HUGE_VAL, &options->nodata);
}

bool tc_read_voids(void *source, const char *value)
{
    tc_source_options *options = source;
    if (strcmp(value, "fill") == 0)
        options->voids = TC_VOIDS_FILL;
    else if (strcmp(value, "hole") == 0)
        options->voids = TC_VOIDS_HOLE;
    else if (strncmp(value, "constant=", 9) == 0 && tc_read_number(value + 9, -1e12, 1e12, &options->void_constant))
        options->voids = TC_VOIDS_CONSTANT;
    else
        return false;
    return options->has_voids = true;
}

bool tc_read_threads(void *threads, const char *value)
{
    return tc_read_int(value, 1, 1024, threads);
}

tc_status tc_take_file(void *file, const char *operand, tc_error *error)
{
    const char **name = file;
    if (*name)
        return tc_fail(error, TC_ERR_USAGE, "FILE: expected one file, found also '%s'", operand);
    *name = operand;
    return TC_OK;
}

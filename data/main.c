/* main.c - terraclip, the terrain tool: hands over to a subcommand. A new one is a row of the table.
 *
 * Help and version, and the one line that says why something failed, are the same for all of them and live here. */
#include "extract.h"
#include "height.h"
#include "info.h"
#include "pack.h"
#include "synth.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const struct command {
    const char *name, *summary;
    tc_status (*run)(int argc, char **argv, tc_error *error); /* argv[0] is the name */
    void (*help)(FILE *file);
} commands[] = {
    {"synth", "writes a synthetic terrain", tc_synth_main, tc_synth_help},
    {"pack", "compresses elevation models into one file", tc_pack_main, tc_pack_help},
    {"info", "shows what a packed terrain holds", tc_info_main, tc_info_help},
    {"extract", "writes a level of a packed terrain as a GeoTIFF", tc_extract_main, tc_extract_help},
    {"height", "tells heights at points", tc_height_main, tc_height_help},
};

enum { COMMANDS = sizeof commands / sizeof *commands };

static void help(FILE *file)
{
    fprintf(file, "Usage: terraclip COMMAND [OPTION]...\n"
                  "Makes and looks into terrains.\n"
                  "\n"
                  "Commands:\n");
    for (int i = 0; i < COMMANDS; i++)
        fprintf(file, "  %-8s %s\n", commands[i].name, commands[i].summary);
    fprintf(file, "\n"
                  "  -h, --help   also after a command\n"
                  "      --version\n");
}

/* What was to be said has been said, even into a full disk or a closed pipe. */
static int flushed(void)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    fprintf(stderr, "terraclip: standard output: cannot be written\n");
    return 1;
}

static bool is_help(const char *argument)
{
    return strcmp(argument, "-h") == 0 || strcmp(argument, "--help") == 0;
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "terraclip: command: expected one of 'terraclip --help', found none\n");
        return tc_exit_code(TC_ERR_USAGE);
    }
    const struct command *command = NULL;
    for (int i = 0; i < COMMANDS; i++)
        if (strcmp(argv[1], commands[i].name) == 0)
            command = &commands[i];
    for (int i = 1; i < argc && (i == 1 || command); i++) {
        if (strcmp(argv[i], "--version") == 0) {
            printf("terraclip %s\n", tc_version());
            return flushed();
        }
        if (is_help(argv[i])) {
            if (command)
                command->help(stdout);
            else
                help(stdout);
            return flushed();
        }
    }
    if (!command) {
        fprintf(stderr, "terraclip: %s: expected a command of 'terraclip --help', found none such\n", argv[1]);
        return tc_exit_code(TC_ERR_USAGE);
    }
    tc_error error = {TC_OK, ""};
    tc_status status = command->run(argc - 1, argv + 1, &error);
    if (status != TC_OK)
        fprintf(stderr, "terraclip: %s\n", error.text);
    return status == TC_OK ? flushed() : tc_exit_code(status);
}

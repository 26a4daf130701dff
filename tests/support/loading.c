/* loading.c - test files loaded as grids. */
#include "test.h"

#include "loading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void hear(void *context, bool warning, const char *line)
{
    sayings *s = context;
    if (strstr(line, "no georeference")) /* true of most test files, and beside the point of most tests */
        warning = false;
    *(warning ? &s->warnings : &s->notes) += 1;
    size_t used = strlen(s->text);
    snprintf(s->text + used, sizeof s->text - used, "%s\n", line);
}

tc_grid load(const char *path, tc_source_options options, sayings *said)
{
    static sayings unheard;
    said = said ? said : &unheard;
    *said = (sayings){0};
    options.say = hear;
    options.say_context = said;
    tc_grid grid = {0};
    tc_error error = {0};
    if (tc_grid_load(path, &options, &grid, &error) != TC_OK)
        fail_msg("%s", error.text);
    return grid;
}

tc_source *open_source(const char *path, tc_source_options options, sayings *said)
{
    *said = (sayings){0};
    options.say = hear;
    options.say_context = said;
    tc_source *source = NULL;
    tc_error error = {0};
    if (tc_source_open(path, &options, &source, &error) != TC_OK)
        fail_msg("%s", error.text);
    return source;
}

void refused_with(const char *path, tc_source_options options, tc_status status, const char *word)
{
    tc_grid grid = {0};
    tc_error error = {0};
    tc_status found = tc_grid_load(path, &options, &grid, &error);
    if (found == TC_OK)
        fail_msg("%s: expected to be refused (%s), was loaded", path, word);
    if (found != status || error.status != status || !strstr(error.text, word) || strchr(error.text, '\n'))
        fail_msg("expected status %d and \"%s\", found %d: %s", (int)status, word, (int)found, error.text);
    assert_null(grid.z);
    assert_int_equal(tc_grid_load(path, &options, &grid, NULL), status);
}

void refused(const char *path, tc_status status, const char *word)
{
    refused_with(path, (tc_source_options){0}, status, word);
}

float at(const tc_grid *g, int64_t column, int64_t row)
{
    return g->z[(g->height - 1 - row) * g->width + column];
}

bool void_at(const tc_grid *g, int64_t column, int64_t row)
{
    return g->voids && g->voids[(g->height - 1 - row) * g->width + column];
}

double value(int column, int row)
{
    return 10 + 3 * column + row;
}

/* W x H samples of a type, large enough for all. */
const void *samples_of(int bits, made_format format, double factor, double offset)
{
    static double store[COUNT];
    unsigned char *bytes = (unsigned char *)store;
    for (int i = 0; i < COUNT; i++) {
        double v = value(i % W, i / W) * factor + offset;
        float f = (float)v;
        int64_t n = (int64_t)v;
        if (format == MADE_FLOAT)
            memcpy(bytes + i * bits / 8, bits == 32 ? (void *)&f : (void *)&v, (size_t)bits / 8);
        else
            memcpy(bytes + i * bits / 8, &n, (size_t)bits / 8); /* the low bytes of a little-endian number */
    }
    return store;
}

made_tiff plain_tiff(void)
{
    return (made_tiff){
        .width = W, .height = H, .bits = 16, .format = MADE_INT, .samples = samples_of(16, MADE_INT, 1, 0)};
}

void assert_values(const tc_grid *g)
{
    assert_int_equal(g->width, W);
    assert_int_equal(g->height, H);
    for (int row = 0; row < H; row++)
        for (int column = 0; column < W; column++)
            if (fabs(at(g, column, row) + g->z_base - value(column, row)) > 1e-6)
                fail_msg("sample %d,%d: expected %g, found %g", column, row, value(column, row),
                         at(g, column, row) + g->z_base);
    assert_true(g->z_min + g->z_base == value(0, 0));
    assert_true(g->z_max + g->z_base == value(W - 1, H - 1));
}

int remove_folder(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

/* loading.h - test files loaded as grids: what must load, what must not, and a small grid with known values. */
#ifndef LOADING_H
#define LOADING_H

#include "common/app/load.h"
#include "made_files.h"

/* What a file's opening said. */
typedef struct sayings {
    int notes, warnings;
    char text[2048];
} sayings;

/* Loads a file that must load; said (may be NULL) gets what it said. */
tc_grid load(const char *path, tc_source_options options, sayings *said);

/* The same, opened only, which costs nothing however large it is. */
tc_source *open_source(const char *path, tc_source_options options, sayings *said);

/* A file that must not load, for a reason that names the file and holds word, in one line. */
void refused_with(const char *path, tc_source_options options, tc_status status, const char *word);
void refused(const char *path, tc_status status, const char *word);

/* Height of a sample counted from the file's upper left, and whether it is void. */
float at(const tc_grid *g, int64_t column, int64_t row);
bool void_at(const tc_grid *g, int64_t column, int64_t row);

/* The known grid: W x H samples of value(column, row), as bytes of a type, as a file, and found again. */
enum { W = 37, H = 23, COUNT = W * H };
double value(int column, int row);
const void *samples_of(int bits, made_format format, double factor, double offset);
made_tiff plain_tiff(void);
void assert_values(const tc_grid *g);

/* Group teardown: takes the folder of made files away. */
int remove_folder(void **state);

#endif

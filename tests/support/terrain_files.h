/* terrain_files.h - terrains packed into files by the public interface alone, and what comes back of them. */
#ifndef TERRAIN_FILES_H
#define TERRAIN_FILES_H

#include "datasets.h"
#include "terrains.h"

/* A dataset with what its stored values are. */
typedef struct terrain_file {
    dataset set;
    tc_sample_type type;
    double unit; /* metres a stored unit; 0: heights are no multiples of one */
} terrain_file;

/* Ends the program, saying why, on a failure. */
void terrain_must(tc_status status, const tc_error *error);

/* The part of a grid that begins x0 samples from its west and y0 from its north, at most size x size, on its own; voids
 * are filled with the nearest valid height, and are none any more. */
tc_grid terrain_crop(const tc_grid *grid, int64_t x0, int64_t y0, int64_t size);

/* The middle of a dataset, at most size x size, as terrain_crop() gives it; and what its file stores. Where those are
 * integers, the stored 0 is 0 m here and heights are multiples of the unit. False where dataset_load() says so. */
bool terrain_file_crop(const dataset *set, int64_t size, terrain_file *about_ret, tc_grid *crop_ret);

/* A file, and what it took to make it. */
typedef struct terrain_packed {
    double bytes; /* of the file on the disk */
    double wall, cpu;
} terrain_packed;

/* Packs the grid's valid samples into path. */
terrain_packed terrain_pack(const tc_grid *grid, const terrain_file *about, const tc_pack_options *options,
                            const char *path);

/* The same where a refusal is to be told. */
tc_status terrain_try_pack(const tc_grid *grid, const terrain_file *about, const tc_pack_options *options,
                           const char *path, terrain_packed *packed_ret, tc_error *error);

tc_field *terrain_open(const char *path);

/* Reads the whole finest level in blocks of 1024 x 1024. */
void terrain_read(const tc_field *field, float *z, uint8_t *voids);

typedef struct terrain_error {
    double rms, max;
} terrain_error;

/* Reads a packed file back, and holds it against the grid's valid samples and voids. */
terrain_error terrain_compare(const tc_grid *grid, const char *path);

/* `side` x `side` samples somewhere in a terrain that has as many. */
tc_rect terrain_place(test_random *random, int64_t width, int64_t height, int64_t side);

/* What decoding such a place takes of the next coarser level, whose filters reach for some samples beyond it: to be
 * read before, where only the place's own level is to be measured. Ends where the coarser level does. */
tc_rect terrain_coarser_place(tc_rect place, tc_level coarser);

/* Processor and wall-clock seconds. */
double terrain_cpu(void);
double terrain_wall(void);

#endif

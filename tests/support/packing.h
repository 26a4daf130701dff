/* packing.h - terrains packed into files, and read back whole. */
#ifndef PACKING_H
#define PACKING_H

#include "common/packed/file/packed_file.h"

typedef enum packing_kind {
    PACKING_HILLS,    /* hills with some noise */
    PACKING_INTEGERS, /* the same, rounded to multiples of the unit */
    PACKING_CONSTANT, /* 1234.5 m */
    PACKING_SLOPE,
    PACKING_NEEDLE, /* flat but for one sample */
    PACKING_WALLS,  /* -1e6 and 1e6 */
    PACKING_NOISE,
    PACKING_DUST,   /* a relief of 1e-3 m, at 1e6 m where z_base is not used */
    PACKING_SPIKES, /* hills with some noise, and one sample in 300 up to 120 m beside them */
    PACKING_KINDS
} packing_kind;

typedef enum packing_voids {
    PACKING_WHOLE,
    PACKING_LAKES,    /* a few discs, stripes and single samples */
    PACKING_ONE_LEFT, /* all but one sample */
    PACKING_ALL_VOID,
    PACKING_LAKE /* the largest of the discs alone, and half of one at the seam of what wraps */
} packing_voids;

/* A terrain and how it is to be packed; zero is the default everywhere but for width and height. */
typedef struct packing {
    int64_t width, height;
    packing_kind kind;
    packing_voids voids;
    tc_pack_mode mode;
    tc_pack_codec codec;
    double error, max_error; /* the latter 0: none beside the rms */
    tc_sample_type type;
    double unit;   /* 0: 1 */
    double offset; /* metres of the stored 0; z_base is the same where based */
    bool based, wraps, price_lossless, max_error_may_yield, synthesis_fit;
    int threads;
} packing;

/* Heights of the terrain (metres above z_base), and what is void; rows are width long. The caller's to free. */
float *packing_heights(const packing *p, uint8_t **voids_ret);
tc_pack_terrain packing_terrain(const packing *p);
tc_pack_options packing_options(const packing *p);

/* Packs in one put. */
tc_status packing_write(const packing *p, const char *path, tc_pack_result *result_ret, tc_error *error);

/* Fills voids as the packer does. */
void packing_fill(float *z, uint8_t *voids, int64_t width, int64_t height, bool wraps);

/* The true pyramid: of the same heights, with voids filled. */
tc_field *packing_truth(const packing *p);

/* A level read whole; the caller's to free. NULL where it cannot be read. */
float *packing_read(const tc_field *field, int level, uint8_t **voids_ret);

/* Errors of a level against the true one, over samples that are not void. */
void packing_error(const float *z, const float *truth, const uint8_t *voids, int64_t count, double *rms_ret,
                   double *most_ret);

/* A file's bytes; the caller's to free. NULL where there is none. */
uint8_t *packing_bytes(const char *path, size_t *size_ret);

#endif

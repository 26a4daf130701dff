/* pack_internal.h - what the files pack*.c share.
 *
 * Packing goes through the terrain level by level, and holds only strips of rows in memory:
 *     put       (pack_source.c)   heights in any order into a spool of the finest level
 *     fill      (pack_fill.c)     voids of what was put
 *     cascade   (pack_cascade.c)  heights become integers; each level's low band into a spool of its own, fine to
 * coarse levels    (pack_level.c)    coarse to fine: tiles encoded against the reconstructed coarser level, and decoded
 *                                 again, so that what the file will give is known and measured
 *     rate      (pack_rate.c)     which quantiser step reaches the target
 *     outliers  (pack_outliers.c) what corrections to a bound will take off the error
 *     lossless  (pack_lossless.c) what the heights would take without loss
 *     bound     (pack_bound.c)    or which coder keeps every height within a bound in the least bytes
 *     finish    (pack.c)          the order of all this
 *     synthesis (pack_synthesis.c) how detail goes on below the samples, where that is asked for
 *     caps      (pack_caps.c)     those of a planet, made from its heights and packed likewise
 *     faces     (pack_faces.c)    or the faces of another atlas, instead of its own levels and caps
 *     errors    (pack_errors.c)   how far levels are off the finest one, measured on what has been packed
 *     file      (pack_file.c)     head, levels, caps, and the file into its place */
#ifndef TC_PACK_INTERNAL_H
#define TC_PACK_INTERNAL_H

#include <pthread.h>

#include "common/packed/file/envelope.h"
#include "common/packed/file/level_coder.h"
#include "spool.h"

/* Logarithmic histogram of the magnitudes of a band's details, in height units. */
enum { TC_DETAIL_BINS = 128 };
typedef struct tc_detail_histogram {
    int64_t count[TC_DETAIL_BINS];
    unsigned __int128 square; /* sum of all squares: exact, so that the order of adding does not tell */
} tc_detail_histogram;

/* What coding a level came to. */
typedef struct tc_level_outcome {
    double square_error; /* square metres, sum over samples that are not void */
    int64_t samples;     /* of them */
    double max_error;    /* metres */
    int64_t bytes;
    int64_t modelled; /* tiles that the level's model decodes; the others are raw */
} tc_level_outcome;

struct tc_packer {
    char *path;
    tc_pack_options options;
    tc_container container;
    tc_pack_result result;
    /* Put. */
    bool filled;     /* heights under voids are given, in whole rows, each once */
    tc_spool source; /* floats; see pack_source.c */
    tc_spool mask;   /* bytes, 1 void; none where no sample is */
    tc_rect *given;  /* rectangles so far, where not of whole rows in order */
    size_t given_count, given_room;
    float z_min, z_max;
    unsigned lattices; /* of pack_source.c's candidates, those that all heights are multiples of */
    double done;       /* share of the work */
    double most;       /* share that its own levels take, the rest is for the caps */
    /* Cascade. */
    tc_spool truth[TC_MAX_FIELD_LEVELS]; /* [l - 1] height units, base <= l < m */
    tc_detail_histogram histogram[TC_MAX_FIELD_LEVELS][TC_BANDS];
    /* Levels: written here until their places in the file are known. */
    int body;
    int64_t body_size;
};

/* ---- pack_source.c -------------------------------------------------------------------------------------------- */

/* Rows of the finest level as they were given, or filled: metres above z_base; NaN where void and not filled. */
tc_status tc_pack_source_rows(const tc_packer *p, int64_t y0, int64_t y1, float *z, tc_error *error);

/* Mean and standard deviation of the heights as they were given; the same in whatever order that was. */
tc_status tc_pack_moments(tc_packer *p, double *mean_ret, double *deviation_ret, tc_error *error);

/* Puts other heights in their place. */
tc_status tc_pack_set_source(const tc_packer *p, tc_rect rect, const float *z, ptrdiff_t stride, tc_error *error);

/* Largest unit that all heights are multiples of, from the terrain's, the options' or a list; 0: none. Sets the height
 * of the multiple 0. */
double tc_pack_lattice(const tc_packer *p, double *origin_ret);

/* ---- pack_fill.c ----------------------------------------------------------------------------------------------- */

/* Notes which levels have a void in row y of the mask, a level's mask being the finest one's on the same spots. */
void tc_pack_note_voids(tc_packer *p, const uint8_t *row, int64_t y);

/* Makes the mask and fills the voids of the source. */
tc_status tc_pack_fill(tc_packer *p, tc_error *error);

/* ---- pack_synthesis.c ------------------------------------------------------------------------------------------ */

/* Fits what synthesis needs to the heights given, once they are filled, and has it stored. */
tc_status tc_pack_synthesis(tc_packer *p, tc_error *error);

/* ---- pack_cascade.c ------------------------------------------------------------------------------------------- */

/* True heights of level l over rect, in height units; beyond the sides those of the other one. */
tc_status tc_pack_truth(const tc_packer *p, int l, tc_rect rect, int32_t *z, ptrdiff_t stride, tc_error *error);
tc_status tc_pack_cascade(tc_packer *p, tc_error *error);

/* The magnitude that a bin of histograms stands for. */
double tc_detail_bin(int bin);

/* Adds a plane's details to a histogram. */
void tc_pack_count(const tc_plane *band, tc_detail_histogram *histogram);

/* Void mask of level l over rect, of which columns may stick out where the level wraps: a sample is void where that of
 * the finest level in its place is. Only where there are voids. */
tc_status tc_pack_mask(const tc_packer *p, int l, tc_rect rect, uint8_t *voids, ptrdiff_t stride, tc_error *error);

static inline float tc_pack_metres(const tc_container *c, int32_t k)
{
    return (float)(c->z_origin + c->z_unit * k);
}

/* ---- pack_level.c --------------------------------------------------------------------------------------------- */

/* How a level is to be coded. */
typedef struct tc_level_coding {
    int l;
    const tc_level_coder *coder;
    double lambda;
    int32_t bound;          /* height units: of the error, where the coder corrects it */
    const tc_spool *coarse; /* reconstructed level l - 1 */
    const tc_spool *fine;   /* reconstructed level l is written here; NULL: it is not */
    double share;           /* of the whole work, for progress */
} tc_level_coding;

/* Appends the level to the body; sets begin, end, lowest, highest and errors of its record. */
tc_status tc_pack_level(tc_packer *p, const tc_level_coding *coding, tc_level_outcome *outcome_ret, tc_error *error);

/* True details of a tile of level l, whose true heights around it `fine` holds: positions rect of the planes. */
size_t tc_pack_details_scratch(void);
void tc_pack_details(const tc_lifting_level *level, tc_rect tile, const tc_plane *fine, const tc_plane band[TC_BANDS],
                     int32_t *scratch);
/* Samples of the fine level that it looks at. */
tc_rect tc_pack_details_need(const tc_lifting_level *level, tc_rect tile);

/* ---- pack_sample.c --------------------------------------------------------------------------------------------- */

/* Tiles to learn from, spread over a level: true heights and details, and the coarser level around them. */
enum { TC_SAMPLE_TILES = 48 };
typedef struct tc_sample {
    tc_lifting_level level;
    int count;
    tc_training_tile tile[TC_SAMPLE_TILES];
    tc_plane fine[TC_SAMPLE_TILES];
} tc_sample;

/* Takes at most `wanted` tiles of level l. The sample is the caller's to free, also where this fails. */
tc_status tc_pack_sample(const tc_packer *p, int l, const tc_spool *coarse, int wanted, tc_sample **sample_ret,
                         tc_error *error);
void tc_sample_free(tc_sample *sample);

/* ---- pack_rate.c ---------------------------------------------------------------------------------------------- */

/* Codes all levels by the lifting so that the target is met. bound, lattice: as for tc_pack_to_bound(), by corrections
 * of what the step leaves too far off; a bound of 0: none. */
tc_status tc_pack_to_rms(tc_packer *p, int32_t bound, int32_t lattice, tc_error *error);

/* The same by LH04's pyramid of residuals. */
tc_status tc_pack_lh04(tc_packer *p, tc_error *error);

/* ---- pack_bound.c ---------------------------------------------------------------------------------------------- */

/* Codes all levels so that no height of the finest one is off by more than `bound` height units; 0: lossless, the
 * heights being multiples of `lattice` height units (1: of none). */
tc_status tc_pack_to_bound(tc_packer *p, int32_t bound, int32_t lattice, tc_error *error);

/* ---- pack_code.c ----------------------------------------------------------------------------------------------- */

/* What codes levels one after the other: the reconstructed ones at hand, and the last model. */
typedef struct tc_coding {
    tc_packer *p;
    tc_spool coarse;       /* reconstructed level below the one to be coded */
    tc_detail_model model; /* of the last level coded by the lifting */
    bool has_model;
    tc_level_outcome outcome; /* of the last level */
    double carried; /* square error that the levels kept leave in each sample of the next one, about; height units */
} tc_coding;

tc_status tc_coding_begin(tc_packer *p, tc_coding *coding, tc_error *error);
void tc_coding_end(tc_coding *coding);

/* Steps of level l for the step q of a band of norm 1. */
void tc_coding_steps(const tc_packer *p, int l, double q, int32_t step[TC_BANDS]);

/* Chooses a lifting model for level l and puts it into the level's record. */
tc_status tc_coding_choose(tc_coding *coding, int l, double q, const tc_sample *sample, tc_error *error);

/* Has level l, whose model is chosen, corrected to a bound, in height units; lattice: as for tc_pack_to_bound(). */
void tc_coding_correct(tc_coding *coding, int l, int32_t bound, int32_t lattice);

/* Codes level l as its record says. keep: what is reconstructed becomes `coarse`. */
tc_status tc_coding_level(tc_coding *coding, int l, int32_t bound, bool keep, double share, tc_error *error);

/* Codes levels base + 1 .. last by the lifting with step q, and keeps them. */
tc_status tc_coding_below(tc_coding *coding, int last, double q, tc_error *error);

/* Mean square error of the last level's samples, in squared height units. */
double tc_coding_error(const tc_coding *coding);

/* ---- pack_outliers.c ------------------------------------------------------------------------------------------- */

/* Share of the square error that corrections to a bound leave, of level l coded by its last model, in a sample of its
 * tiles. The level's record is then one of corrections. */
tc_status tc_pack_left_by_corrections(tc_coding *coding, int l, const tc_sample *sample, int32_t bound, int32_t lattice,
                                      double *left_ret, tc_error *error);

/* ---- pack_lossless.c ------------------------------------------------------------------------------------------- */

/* Sets p->result.lossless_bytes from a sample of the finest level, the levels below which the body has; 0 where it
 * cannot be told. */
void tc_pack_price_lossless(tc_packer *p, const tc_sample *sample);

/* ---- pack_caps.c ----------------------------------------------------------------------------------------------- */

/* Share of a planet's work that its caps are. */
double tc_pack_caps_share(const tc_pack_terrain *terrain);

/* The heights of a cap, in a file without a name that is mapped: it need not stay in memory. */
typedef struct tc_pack_caps_memory {
    void *bytes;
    size_t size;
    float *z;       /* row by row */
    uint8_t *voids; /* NULL where the planet has none */
} tc_pack_caps_memory;

/* Makes both caps of the planet whose heights have been put and filled. Released by the caller, also where this fails.
 */
tc_status tc_pack_make_caps(const tc_packer *p, const tc_lonlat *grid, tc_pack_caps_memory memory[2], tc_error *error);
void tc_pack_release_caps(tc_pack_caps_memory memory[2]);

/* How what was resampled from the planet's heights is packed. */
tc_pack_options tc_pack_resampled_options(tc_packer *p);

/* Packs the polar caps of a planet whose levels are packed, but for files of their own: packers for the caller to
 * destroy, also where this fails. None where a cap has no height. */
tc_status tc_pack_caps(tc_packer *p, tc_packer *cap[TC_CAP_CHARTS], tc_error *error);

/* ---- pack_faces.c ---------------------------------------------------------------------------------------------- */

/* Packs the faces of an atlas, which a planet's heights, put and filled, are resampled to, but for the file: packers
 * for the caller to destroy, also where this fails. The planet's own heights are let go of, and its result is that of
 * all. */
tc_status tc_pack_faces(tc_packer *p, const tc_atlas *atlas, tc_packer *face[TC_MOST_CHARTS], tc_error *error);

/* ---- pack_file.c ----------------------------------------------------------------------------------------------- */

/* Puts a file of what has been packed, charts in their order, into the place that p is to have; sets p->result.bytes.
 */
tc_status tc_pack_put_in_place(tc_packer *p, tc_packer *const chart[], int charts, tc_error *error);

tc_status tc_pack_write(int file, const void *bytes, size_t size, int64_t at, const char *path, tc_error *error);

/* ---- pack_errors.c --------------------------------------------------------------------------------------------- */

/* Measures the errors of a file that is whole but for them, and puts them behind its last level; its head is then to be
 * written again. */
tc_status tc_pack_errors(tc_packer *p, int file, tc_envelope *envelope, tc_error *error);

/* ---- pack.c --------------------------------------------------------------------------------------------------- */

/* The first failure of threads that work at the same, begun as {.mutex = PTHREAD_MUTEX_INITIALIZER}. */
typedef struct tc_pack_failure {
    pthread_mutex_t mutex;
    tc_status status;
    tc_error error;
} tc_pack_failure;

/* Keeps a failure where it is the first one; TC_OK is none. Any thread. */
void tc_pack_failure_keep(tc_pack_failure *failure, tc_status status, const tc_error *error);

/* When no thread works any more: tells what was kept. */
tc_status tc_pack_failure_end(tc_pack_failure *failure, tc_error *error);

/* Packs what was put, but for the file: settles what was put and fills its voids, then codes its levels. */
tc_status tc_pack_all_levels(tc_packer *p, tc_error *error);

/* Adds to the work done and says so; TC_ERR_IO where the caller wants to stop. */
tc_status tc_pack_progress(tc_packer *p, double share, tc_error *error);

/* Shares of the work. */
#define TC_SHARE_PUT 0.15
#define TC_SHARE_CASCADE 0.10
#define TC_SHARE_LEVELS 0.70
#define TC_SHARE_ERRORS 0.05

#endif

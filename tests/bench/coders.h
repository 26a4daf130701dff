/* coders.h - codecs of heights behind one interface, so that all are measured alike.
 *
 * Ours and OpenJPEG's are here (coders.c), those of GDAL's drivers in gdal_coders.c. All write files into one folder of
 * the test program's own. A coder's name is that of a curve: what is told apart by the layout of the file has names of
 * its own. */
#ifndef CODERS_H
#define CODERS_H

#include "jpeg2000.h"
#include "tests/support/terrain_files.h"

typedef enum coder_aim {
    CODER_RMS,   /* a root mean square of `value` metres */
    CODER_BOUND, /* no sample off by more than `value` metres */
    CODER_LOSSLESS,
    CODER_RATE /* `value` bits a sample */
} coder_aim;

typedef struct coder_goal {
    coder_aim aim;
    double value;
} coder_goal;

/* Heights without voids, in each form that a codec wants. */
typedef struct coder_input {
    terrain_file about;
    tc_grid grid;
    int32_t *stored; /* height / about.unit, where the file stores integers; else NULL */
    j2k_image image;
} coder_input;

/* Takes the grid over. */
coder_input coder_input_of(const terrain_file *about, tc_grid *grid);
void coder_input_free(coder_input *input);

enum { CODER_WHY = 256 };
typedef enum coded_type { CODED_INT16, CODED_UINT16, CODED_INT32, CODED_UINT32, CODED_FLOAT32 } coded_type;

typedef struct coder coder;

/* One encoding of an input. */
typedef struct coded {
    const coder *coder;
    const coder_input *input;
    coder_goal goal;
    char path[512];
    double bytes;        /* of all files there are */
    coded_type type;     /* of what is read back, row by row as the grid */
    double unit, base;   /* metres = base + unit * number read */
    bool quantised;      /* before a lossless codec, to keep a bound */
    void *source;        /* the coder's own: numbers and options, ready for encoding */
    char why[CODER_WHY]; /* of a failure, one line; "" where none is known */
} coded;

/* How much of it a measurement of many has time for. */
typedef enum coder_effort {
    CODER_ALWAYS,
    CODER_SLOW /* at every other rms */,
    CODER_IN_FULL /* not quickly */
} coder_effort;

struct coder {
    const char *name, *layout, *extension;
    unsigned aims; /* 1 << aim */
    coder_effort effort;
    const void *format; /* the coder's own */
    bool (*offered)(const coder *c, char why[CODER_WHY]);
    bool (*prepare)(coded *c);                                     /* what is not timed; may be NULL */
    bool (*encode)(coded *c);                                      /* into path */
    bool (*read)(const coded *c, tc_rect rect, void *samples_ret); /* opens the file, reads and closes it */
    void (*release)(coded *c);                                     /* may be NULL */
};

/* All of them, whether this machine offers them or not. */
int coder_count(void);
const coder *coder_at(int n);
const coder *coder_named(const char *name);
bool coder_offered(const coder *c, char why[CODER_WHY]);

/* What GDAL's GeoTIFF driver offers and no coder uses: names, separated by blanks. To be called, as all that is below,
 * once the terrain is loaded: GDAL is set up anew for one thread. */
const char *gdal_coders_unused(void);
void gdal_coders_set_up(void);
extern const coder gdal_coders[];
extern const int gdal_coders_count;

/* False, with c->why, where the codec cannot hold such heights. To be ended in either case. */
bool coded_begin(coded *c, const coder *with, const coder_input *input, coder_goal goal);
bool coded_encode(coded *c);
/* Reads all back, and holds it against the grid; an rms of NAN where that fails. */
terrain_error coded_error(coded *c);
/* Whether the goal was kept by what came back, but for the rounding of floats; true where it was not a promise. */
bool coded_kept(const coded *c, terrain_error e);
void coded_end(coded *c);

/* Takes the folder away; for atexit(). */
void coders_clean_up(void);

#endif

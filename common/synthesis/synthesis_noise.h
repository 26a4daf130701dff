/* synthesis_noise.h - noise by place, row after row: white, and smeared along a direction. In whole numbers. */
#ifndef TC_SYNTHESIS_NOISE_H
#define TC_SYNTHESIS_NOISE_H

#include "synthesis.h"
#include "synthesis_rows.h"

enum {
    TC_NOISE_REACH = 2, /* cells around one whose noise is smeared into it */
    TC_NOISE_ROWS = 24  /* rows of white noise that there is room for */
};

/* rms of white noise: the sum of two numbers, each of 0 .. 31 at random. */
#define TC_NOISE_RMS 13.05756f

/* How much of neighbours is added, in 1/64. */
typedef struct tc_smear {
    int16_t one, two; /* of those one and two cells away along the direction */
    int16_t spread;   /* along the axis that a band is low on; less along the others */
    float rms;        /* of the sum */
} tc_smear;

tc_smear tc_smear_of(const tc_synthesis_fit *fit);

/* Directions of a row of cells: -1 where the line to cells one and two away is the one of the number, else 0. */
enum { TC_LINES_ONE = 4, TC_LINES_TWO = 8 };
typedef struct tc_directions {
    int8_t one[TC_LINES_ONE][TC_ROW_PITCH]; /* (1, 0), (1, 1), (0, 1), (-1, 1), and their opposites */
    int8_t two[TC_LINES_TWO][TC_ROW_PITCH]; /* (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (-1, 2), (-2, 2), (-2, 1) */
} tc_directions;

/* Noise of the three bands, row after row. */
typedef struct tc_noise_rows {
    uint64_t seed;
    int64_t period;    /* columns of a level that wraps; else 0 */
    int64_t x0, cells; /* of a row, at most TC_ROW_CELLS */
    int rows;          /* of white noise that there are, the last of them row next - 1 */
    int64_t next;
    tc_smear smear;
    int8_t white[TC_DETAIL_BANDS][TC_NOISE_ROWS][TC_ROW_PITCH]; /* from column x0 - TC_NOISE_REACH on */
} tc_noise_rows;

/* From row `first` on. */
void tc_noise_begin(tc_noise_rows *n, uint64_t seed, int64_t period, int64_t x0, int64_t cells, int64_t first,
                    const tc_synthesis_fit *fit);

/* Smeared noise of the next row, band by band; of tc_thirty_twos() of the cells. */
void tc_noise_smeared(tc_noise_rows *n, const tc_directions *d, int16_t (*out)[TC_ROW_PITCH]);

/* A seed of chart and level. */
uint64_t tc_noise_seed(int chart, int level);

#endif

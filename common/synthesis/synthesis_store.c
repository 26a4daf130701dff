/* synthesis_store.c - a fit as bytes and back: one table of its numbers, for writing, reading and checking. */
#include "synthesis_store.h"

#include <math.h>

enum { FORM = 1 }; /* of what follows: how noise is made, and which numbers there are */

/* Numbers one after the other, and what they lie between. */
typedef struct row {
    const char *name;
    size_t at; /* in the struct */
    int count;
    bool wide; /* double, else float */
    double least, most;
} row;

static size_t size_of(const row *r)
{
    return r->wide ? sizeof(double) : sizeof(float);
}

#define ROWS_OF_FIT(ROW)                                                                                               \
    ROW("energy floor", energy_floor, 1, false, 0, 1e20)                                                               \
    ROW("slope floor", slope_floor, 1, false, 0, 1e20)                                                                 \
    ROW("noise of a band", band[0], TC_DETAIL_BANDS, false, 0, 1e6)                                                    \
    ROW("share of the second difference", curvature[0], 1, false, -1, 1)                                               \
    ROW("share of the sixth difference", curvature[1], 1, false, -4, 4)                                                \
    ROW("spread", spread, 1, false, -0.5, 1.5)                                                                         \
    ROW("smear", smear, 1, false, -1, 1)                                                                               \
    ROW("peak", peak, 1, false, 0, 1)                                                                                  \
    ROW("spacing", spacing, 1, true, 0, 1e20)                                                                          \
    ROW("rms", rms[0], 3, true, 0, 1e20)                                                                               \
    ROW("ratio", ratio, 1, true, 0, 1e6)                                                                               \
    ROW("anisotropy", anisotropy, 1, true, 0, 1e20)                                                                    \
    ROW("kurtosis", kurtosis, 1, true, 0, 1e20)
#define ROWS_OF_LEVEL(ROW)                                                                                             \
    ROW("a of a level", level[0].a, 1, false, -300, 300)                                                               \
    ROW("b of a level", level[0].b, 1, false, 0, 4)                                                                    \
    ROW("c of a level", level[0].c, 1, false, 0, 8)                                                                    \
    ROW("cap of a level", level[0].cap, 1, false, 0, 1e20)

#define AS_ROW(name, member, count, wide, least, most)                                                                 \
    {name, offsetof(tc_synthesis_fit, member), count, wide, least, most},
static const row rows[] = {ROWS_OF_FIT(AS_ROW)};
static const row level_rows[] = {ROWS_OF_LEVEL(AS_ROW)};

#define AS_BYTES(name, member, count, wide, least, most) +(count) * ((wide) ? 8 : 4)
_Static_assert(TC_SYNTHESIS_BYTES == 2 + 1 ROWS_OF_FIT(AS_BYTES) + TC_SYNTHESIS_MOST * (0 ROWS_OF_LEVEL(AS_BYTES)),
               "bytes of a fit");

enum {
    ROWS = sizeof rows / sizeof *rows,
    LEVEL_ROWS = sizeof level_rows / sizeof *level_rows,
    ALL_ROWS = ROWS + TC_SYNTHESIS_MOST * LEVEL_ROWS
};

/* Row n of all, in their order; from_ret: where its struct is in the fit. */
static const row *row_of(int n, size_t *from_ret)
{
    *from_ret = n < ROWS ? 0 : (size_t)((n - ROWS) / LEVEL_ROWS) * sizeof((tc_synthesis_fit *)0)->level[0];
    return n < ROWS ? &rows[n] : &level_rows[(n - ROWS) % LEVEL_ROWS];
}

static double number_at(const row *r, const uint8_t *at)
{
    float narrow;
    double wide;
    if (r->wide)
        return memcpy(&wide, at, sizeof wide), wide;
    return memcpy(&narrow, at, sizeof narrow), (double)narrow;
}

bool tc_synthesis_can_put(const tc_synthesis_fit *fit, tc_synthesis_number *beyond_ret)
{
    const float least = 1e-30f; /* of what logarithms are taken of */
    for (int n = 0; n < ALL_ROWS; n++) {
        size_t from;
        const row *r = row_of(n, &from);
        const bool floor =
            r->at == offsetof(tc_synthesis_fit, energy_floor) || r->at == offsetof(tc_synthesis_fit, slope_floor);
        tc_synthesis_number number = {r->name, 0, floor && !fit->none ? (double)least : r->least, r->most};
        for (int i = 0; i < r->count; i++) {
            number.value = number_at(r, (const uint8_t *)fit + from + r->at + (size_t)i * size_of(r));
            if (number.value >= number.least && number.value <= number.most) /* false of what is no number */
                continue;
            if (beyond_ret)
                *beyond_ret = number;
            return false;
        }
    }
    return true;
}

void tc_synthesis_put(const tc_synthesis_fit *fit, tc_byte_writer *w)
{
    tc_put(w, FORM, 2), tc_put(w, fit->none, 1);
    for (int n = 0; n < ALL_ROWS; n++) {
        size_t from;
        const row *r = row_of(n, &from);
        for (int i = 0; i < r->count; i++) {
            const double v = number_at(r, (const uint8_t *)fit + from + r->at + (size_t)i * size_of(r));
            if (r->wide)
                tc_put_f64(w, v);
            else
                tc_put_f32(w, (float)v);
        }
    }
}

tc_status tc_synthesis_get(const uint8_t *bytes, size_t size, tc_synthesis_fit *fit_ret)
{
    tc_byte_reader r = {bytes, bytes + size, false};
    *fit_ret = (tc_synthesis_fit){.none = true};
    unsigned form = (unsigned)tc_get(&r, 2);
    if (!r.failed && form != FORM)
        return TC_ERR_UNSUPPORTED;
    unsigned none = (unsigned)tc_get(&r, 1);
    for (int n = 0; n < ALL_ROWS; n++) {
        size_t from;
        const row *of = row_of(n, &from);
        for (int i = 0; i < of->count; i++) {
            uint8_t *to = (uint8_t *)fit_ret + from + of->at + (size_t)i * size_of(of);
            const double wide = of->wide ? tc_get_f64(&r) : 0;
            const float narrow = of->wide ? 0 : tc_get_f32(&r);
            if (of->wide)
                memcpy(to, &wide, sizeof wide);
            else
                memcpy(to, &narrow, sizeof narrow);
        }
    }
    fit_ret->none = none != 0;
    return none <= 1 && !r.failed && r.at == r.end && tc_synthesis_can_put(fit_ret, NULL) ? TC_OK : TC_ERR_FORMAT;
}

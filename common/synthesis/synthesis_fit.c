/* synthesis_fit.c - what a terrain's own levels tell of its detail.
 *
 * Level m's details are known, those of m - 1 too: how their energy follows from the coarser level's energy and slope
 * is a regression with a logarithmic link and errors that grow with the mean (gamma), so that it is the mean energy
 * that comes out right and not the mean of its logarithm. The whole rms of levels beyond follows the trend of the last
 * three. What is left, the smearing along the slope, the share of the bands and the kurtosis, is settled by rehearsal:
 * level m is synthesised from m - 1 and held against the true one (synthesis_rehearsal.c). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/same_math.h"
#include "common/base/status.h"
#include "synthesis_rehearsal.h"

enum { UNKNOWNS = 4, ROUNDS = 12 }; /* two intercepts, energy, slope */

/* Solves the symmetric system in place, by elimination; false where it is singular. */
static bool solve(double m[UNKNOWNS][UNKNOWNS + 1])
{
    for (int i = 0; i < UNKNOWNS; i++) {
        if (!(fabs(m[i][i]) > 1e-12))
            return false;
        for (int r = 0; r < UNKNOWNS; r++) {
            double q = r == i ? 0 : m[r][i] / m[i][i];
            for (int c = i; c <= UNKNOWNS && r != i; c++)
                m[r][c] -= q * m[i][c];
        }
    }
    for (int i = 0; i < UNKNOWNS; i++)
        m[i][UNKNOWNS] /= m[i][i];
    return true;
}

/* log2 of mean energies by log2 E and log2 S: coefficients of both, one intercept a pair of levels. */
static void regress(const tc_pair pairs[2], double x[UNKNOWNS])
{
    for (int p = 0; p < 2; p++)
        x[p] = tc_log2(fmax(pairs[p].energy / fmax((double)pairs[p].cells, 1), 1e-30));
    x[2] = x[3] = 0;
    for (int round = 0; round < ROUNDS; round++) {
        double m[UNKNOWNS][UNKNOWNS + 1] = {{0}};
        for (int p = 0; p < 2; p++)
            for (int64_t n = 0; n < pairs[p].cells; n++) {
                const tc_pair_cell *c = &pairs[p].cell[n];
                double v[UNKNOWNS] = {p == 0, p == 1, c->energy, c->slope};
                double eta = x[p] + x[2] * v[2] + x[3] * v[3];
                double off = fmin(c->detail / tc_exp2(eta) - 1, 20) / M_LN2; /* of outliers no more is heard */
                for (int i = 0; i < UNKNOWNS; i++) {
                    for (int j = 0; j < UNKNOWNS; j++)
                        m[i][j] += v[i] * v[j];
                    m[i][UNKNOWNS] += v[i] * (eta + off);
                }
            }
        for (int i = 0; i < UNKNOWNS; i++)
            m[i][i] += 1e-6 * (1 + m[i][i]); /* an empty pair, a terrain of one slope */
        if (!solve(m))
            break;
        double share = round < 4 ? 0.5 : 1;
        for (int i = 0; i < UNKNOWNS; i++)
            x[i] += share * (m[i][UNKNOWNS] - x[i]);
        x[2] = fmin(fmax(x[2], 0), 1), x[3] = fmin(fmax(x[3], 0), 1.5);
    }
    for (int p = 0; p < 2; p++) { /* the mean is right whatever was cut */
        double sum = 0;
        for (int64_t n = 0; n < pairs[p].cells; n++)
            sum += tc_exp2(x[2] * pairs[p].cell[n].energy + x[3] * pairs[p].cell[n].slope);
        if (sum > 0 && pairs[p].energy > 0)
            x[p] = tc_log2(pairs[p].energy / sum);
    }
}

/* Ratio of a level's rms to that of level m + k. Of the first two it is the trend. At scales of kilometres mountains'
 * slopes grow from level to level, though not for ever; at those of metres they no longer do: the ratio passes into one
 * a little above 2, at which they stay, between samples 200 m and 25 m apart. */
static double ratio_at(const tc_synthesis_fit *fit, int k)
{
    const double settled = 2.1, least = 1.5, from = 200, octaves = 3;
    double share = k <= 2 ? 0 : fmin(fmax(tc_log2(from / ldexp(fit->spacing, -k)) / octaves, 0), 1);
    double trend = k <= 2 ? fit->ratio : fmax(fit->ratio, least);
    return trend + share * (settled - trend);
}

/* a_k, b_k, c_k and caps of all levels from the regression of one, and whole energies. */
static void carry_on(const tc_pair *finest, const double x[UNKNOWNS], tc_synthesis_fit *fit)
{
    double b = x[2], c = x[3], bk = b, ck = c, target = fit->rms[2];
    for (int k = 1; k <= TC_SYNTHESIS_MOST; k++) {
        target /= ratio_at(fit, k);
        double sum = 0, most = 0;
        for (int64_t n = 0; n < finest->cells; n++) {
            double e = tc_exp2(bk * finest->cell[n].energy + ck * finest->cell[n].slope);
            sum += e, most = fmax(most, e);
        }
        double mean = sum / fmax((double)finest->cells, 1);
        fit->level[k - 1].a = (float)tc_log2(fmax(target * target / fmax(mean, 1e-30), 1e-30));
        fit->level[k - 1].b = (float)bk, fit->level[k - 1].c = (float)ck;
        fit->level[k - 1].cap = (float)(1.5 * target * sqrt(most / fmax(mean, 1e-30)));
        if (k < 2) /* contrast soon settles: from level to level it is the same terrain */
            ck = c + b * ck, bk *= b;
    }
}

tc_status tc_synthesis_learn(const tc_field *field, tc_synthesis_fit *fit_ret, tc_error *error)
{
    tc_synthesis_fit *fit = fit_ret;
    *fit = (tc_synthesis_fit){.band = {1, 1, 1}, .none = true};
    int m = tc_field_info(field)->levels;
    const tc_level finest = tc_field_level(field, m);
    fit->spacing = sqrt(finest.spacing_x * finest.spacing_y);
    tc_pair pairs[4] = {{0}}; /* of levels m - 3, m - 2, m - 1 with the next finer ones, and of m alone */
    const tc_pair *last = &pairs[2];
    tc_status status = TC_OK;
    for (int p = 0; p < 3 && !status && m >= 4; p++)
        status = tc_pair_read(field, m - 3 + p, 0, &pairs[p]);
    if (!status && last->cells > 0 && last->energy > 0)
        status = tc_pair_read(field, m, last->floor, &pairs[3]);
    if (!status && pairs[3].cell) {
        double x[UNKNOWNS];
        fit->none = false;
        for (int p = 0; p < 3; p++)
            fit->rms[p] = sqrt(pairs[p].energy / fmax((double)pairs[p].cells, 1));
        /* Trend of three: the line through their logarithms. */
        double trend = sqrt(fit->rms[0] / fit->rms[2]);
        fit->ratio = isfinite(trend) && trend > 0 ? fmin(fmax(trend, 1.3), 4) : 2;
        regress(&pairs[1], x);
        fit->energy_floor = last->floor, fit->slope_floor = TC_SLOPE_FLOOR;
        carry_on(&pairs[3], x, fit);
        status = tc_synthesis_rehearse(field, last, x[1], x[2], x[3], fit);
    }
    for (int p = 0; p < 4; p++)
        tc_pair_free(&pairs[p]);
    return status ? tc_fail(error, status, "synthesis: the terrain cannot be read: %s", tc_status_text(status)) : TC_OK;
}

void tc_synthesis_uniform(tc_synthesis_fit *fit)
{
    double target = fit->rms[2];
    for (int k = 1; k <= TC_SYNTHESIS_MOST; k++) {
        target /= ratio_at(fit, k);
        fit->level[k - 1].a = (float)(2 * tc_log2(fmax(target, 1e-30)));
        fit->level[k - 1].b = fit->level[k - 1].c = 0;
        fit->level[k - 1].cap = (float)(2 * target);
    }
    fit->smear = fit->peak = fit->spread = 0;
    fit->curvature[0] = fit->curvature[1] = 0;
    fit->band[TC_HIGH_X] = fit->band[TC_HIGH_Y] = fit->band[TC_HIGH_XY] = 0.577350269f;
}

/* plates.c - a sphere in plates that move.
 *
 * A Voronoi diagram of random points, each of which turns around an axis of its own. A boundary is told by the plane
 * between two points, whose distance is smooth everywhere; its weight fades where a third plate comes nearer than the
 * two, so that nothing jumps where three plates meet. Whoever wants boundaries that are not arcs of circles bends the
 * place before asking. */
#include "plates.h"

#include "noise.h"

#include <math.h>

static const double blend = 0.16;    /* over which plates' land goes over into each other, in distance of centres */
static const double junction = 0.07; /* over which boundaries fade at triple junctions */

/* The n-th random number of a seed, -1..1. */
static double chance(uint64_t seed, uint64_t n)
{
    return (double)(tc_hash64(seed, n) >> 11) * (2.0 / 9007199254740992.0) - 1;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A random point of the unit ball, none near its middle. */
static void in_ball(uint64_t seed, uint64_t *n, double v[3])
{
    double d2;
    do {
        for (int k = 0; k < 3; k++)
            v[k] = chance(seed, (*n)++);
        d2 = dot(v, v);
    } while (d2 > 1 || d2 < 0.1);
}

void tc_plates_make(tc_plates *plates, uint64_t seed)
{
    uint64_t n = 0;
    double spin[TC_PLATES][3];
    for (int i = 0; i < TC_PLATES; i++) {
        /* Not too near to another plate's, if that can be had. */
        double *c = plates->centre[i], near = 1;
        for (int attempt = 0; attempt < 40 && near > 0.86; attempt++) {
            in_ball(seed, &n, c);
            double d = sqrt(dot(c, c));
            for (int k = 0; k < 3; k++)
                c[k] /= d;
            near = -1;
            for (int j = 0; j < i; j++)
                near = fmax(near, dot(c, plates->centre[j]));
        }
        in_ball(seed, &n, spin[i]);
        plates->size[i] = 0.09 * chance(seed, n++);
        plates->land[i] = (float)chance(seed, n++);
    }
    for (int a = 0; a < TC_PLATES; a++)
        for (int b = 0; b < TC_PLATES; b++) {
            struct tc_plate_pair *pair = &plates->pair[a][b];
            double m[3], w[3], d2 = 0;
            for (int k = 0; k < 3; k++) {
                m[k] = plates->centre[b][k] - plates->centre[a][k];
                w[k] = spin[a][k] - spin[b][k];
                d2 += m[k] * m[k];
            }
            double d = pair->length = a == b ? 1 : sqrt(d2);
            for (int k = 0; k < 3; k++) {
                int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
                pair->normal[k] = (float)(m[k] / d);
                pair->approach[k] = (float)((m[k1] * w[k2] - m[k2] * w[k1]) / d);
            }
        }
}

void tc_plates_at(const tc_plates *plates, const double q[3], tc_plate_site *site)
{
    /* The nearest few, and the land of all around. */
    enum { NEAREST = 6 };
    double away[TC_PLATES], least[NEAREST + 1];
    int near[NEAREST + 1], count = 0;
    for (int i = 0; i < TC_PLATES; i++) {
        away[i] = -dot(plates->centre[i], q) - plates->size[i];
        int k = count < NEAREST ? count++ : NEAREST;
        for (; k > 0 && least[k - 1] > away[i]; k--) {
            least[k] = least[k - 1];
            near[k] = near[k - 1];
        }
        least[k] = away[i];
        near[k] = i;
    }
    double sum = 0, land = 0;
    for (int i = 0; i < TC_PLATES; i++) {
        double t = 1 - (away[i] - least[0]) / blend;
        if (t > 0) {
            sum += t * t;
            land += t * t * plates->land[i];
        }
    }
    site->land = (float)(land / sum);

    site->edges = 0;
    for (int i = 0; i < NEAREST; i++)
        for (int j = i + 1; j < NEAREST; j++) {
            int other = 0; /* the nearest of the rest */
            while (other == i || other == j)
                other++;
            float weight = tc_smoothstep(-1, 1, (float)((least[other] - least[j]) / junction));
            if (!(weight > 0))
                continue;
            /* From the plate that stays to the one that yields; not by which is nearer. */
            int a = near[i], b = near[j];
            if (plates->land[a] < plates->land[b]) {
                a = near[j];
                b = near[i];
            }
            const struct tc_plate_pair *pair = &plates->pair[a][b];
            const float *v = pair->approach;
            site->edge[site->edges++] = (tc_plate_edge){
                .distance = (float)((away[a] - away[b]) / pair->length),
                .weight = weight,
                .approach = v[0] * (float)q[0] + v[1] * (float)q[1] + v[2] * (float)q[2],
                .land = {plates->land[a], plates->land[b]},
                .number = (uint32_t)(a * TC_PLATES + b),
                .normal = pair->normal,
            };
        }
}

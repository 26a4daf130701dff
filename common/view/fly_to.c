/* fly_to.c - from one view to another in one sweep; see fly_to.h.
 *
 * The paper's w, the width of what is seen, is the eye's height above ground, u the way along the ground; their path
 * (u(s), w(s)) has the least perceived motion, with rho between moving and zooming. */
#include "fly_to.h"

#include <math.h>

static const double RHO = 1.42, PACE = 2.4; /* the paper's rho and V: units of s a second */

tc_fly_to tc_fly_to_begin(const tc_navigation *navigation, const tc_ground *ground, const tc_pose *from,
                          const tc_pose *to)
{
    tc_fly_to f = {.navigation = navigation, .ground = *ground, .from = *from, .to = *to};
    navigation->settle(&f.from), navigation->settle(&f.to);
    const tc_pose *const ends[2] = {&f.from, &f.to};
    for (int i = 0; i < 2; i++) {
        f.low[i] = ground->height(ground->context, ends[i]->x, ends[i]->y);
        f.high[i] = fmax(ends[i]->z - f.low[i], ground->clearance);
    }
    f.apart = navigation->apart(&ground->body, &f.from, &f.to);
    double u = f.apart, w0 = f.high[0], w1 = f.high[1];
    f.straight = !(u > 1e-3 * fmin(w0, w1));
    if (f.straight) {
        f.s = w1 >= w0 ? 1 : -1;
        f.length = fabs(log(w1 / w0)) / RHO;
    } else {
        double q = pow(RHO, 4) * u * u;
        double b0 = (w1 * w1 - w0 * w0 + q) / (2 * w0 * RHO * RHO * u);
        double b1 = (w1 * w1 - w0 * w0 - q) / (2 * w1 * RHO * RHO * u);
        f.r0 = asinh(-b0); /* the paper's ln(-b + sqrt(b^2 + 1)), without its cancellation */
        f.length = (asinh(-b1) - f.r0) / RHO;
    }
    double turned = fabs(remainder(to->heading - from->heading, 2 * M_PI)) + fabs(to->pitch - from->pitch);
    f.seconds = fmax(0.3, fmin(4, fmax(f.length / PACE, turned / 3)));
    return f;
}

bool tc_fly_to_step(tc_fly_to *f, double dt, tc_pose *view)
{
    f->at += fmax(0, fmin(0.1, dt));
    if (!(f->at < f->seconds)) {
        *view = f->to;
        return false;
    }
    double t = f->at / f->seconds;
    t = t * t * (3 - 2 * t); /* starts and lands gently */
    double s = t * f->length, share = t, w = f->high[0];
    if (f->straight) {
        w *= exp(f->s * RHO * s);
    } else {
        double c = cosh(f->r0) / cosh(RHO * s + f->r0);
        /* cosh(r0) tanh(rho s + r0) - sinh(r0) in the paper: the same. */
        double u = w / (RHO * RHO) * sinh(RHO * s) / cosh(RHO * s + f->r0);
        share = fmax(0, fmin(1, u / f->apart));
        w *= c;
    }
    *view = f->navigation->between(&f->from, &f->to, share);
    view->heading = f->from.heading + t * remainder(f->to.heading - f->from.heading, 2 * M_PI);
    view->pitch = f->from.pitch + t * (f->to.pitch - f->from.pitch);
    view->z = f->low[0] + share * (f->low[1] - f->low[0]) + w;
    double low = f->ground.height(f->ground.context, view->x, view->y);
    view->z = fmax(view->z, low + f->ground.clearance);
    return true;
}

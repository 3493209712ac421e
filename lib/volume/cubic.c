/*
 * cubic: roots by bracketing. A cubic is cut at its turning points. Between them it is monotone, so
 * a value between the ends has one root. Tangent roots, vanishing leading coefficients and
 * constants need no special cases.
 */
#include "volume/volume_int.h"

/* After a step this small the remaining error is its square, which does not change p. */
#define SQUARED 0x1p-27
#define STEPS_MAX 200 /* bisection alone needs 60 */

void cubic_part(const double p[4], double a, double b, double q[4])
{
    double h = b - a;
    q[0] = cubic_at(p, a);
    q[1] = h * (p[1] + a * (2 * p[2] + a * 3 * p[3]));
    q[2] = h * h * (p[2] + 3 * a * p[3]);
    q[3] = h * h * h * p[3];
}

/* fmin and fmax are calls of the C library, because they take NaN. */
static inline double least(double a, double b) { return a < b ? a : b; }
static inline double most(double a, double b) { return a > b ? a : b; }

void cubic_bounds(const double p[4], double *lo, double *hi)
{
    double b1 = p[0] + p[1] / 3, b2 = p[0] + (2 * p[1] + p[2]) / 3;
    double b3 = p[0] + p[1] + p[2] + p[3];
    *lo = least(least(p[0], b1), least(b2, b3));
    *hi = most(most(p[0], b1), most(b2, b3));
}

int cubic_monotone(const double p[4], double w[4])
{
    int n = 0;
    w[n++] = 0;
    /* Roots of 3 p3 w^2 + 2 p2 w + p1, in the form that loses no digits if a coefficient is
     * small. */
    double a = 3 * p[3], b = p[2], c = p[1], disc = b * b - a * c;
    if (disc > 0) {
        double q = -(b + copysign(sqrt(disc), b)), r0 = q / a, r1 = c / q;
        if (!(r0 < r1)) {
            double swap = r0;
            r0 = r1, r1 = swap;
        }
        /* a = 0 yields NaN, for which the comparisons are false. */
        if (r0 > 0 && r0 < 1) w[n++] = r0;
        if (r1 > 0 && r1 < 1 && r1 > w[n - 1]) w[n++] = r1;
    }
    w[n++] = 1;
    return n;
}

/* Newton's method. Bisects if a step leaves the bracket or gains little. */
double cubic_root(const double p[4], double a, double b, double y)
{
    double fa = cubic_at(p, a) - y, fb = cubic_at(p, b) - y;
    if (fa == 0) return a;
    if (fb == 0) return b;
    double w = a + (b - a) * (fa / (fa - fb)), last = b - a;
    if (!(w > a && w < b)) w = a + (b - a) / 2;
    for (int i = 0; i < STEPS_MAX && w > a && w < b; i++) {
        double f = cubic_at(p, w) - y, d = p[1] + w * (2 * p[2] + w * 3 * p[3]);
        if (f == 0) return w;
        if ((f < 0) == (fa < 0)) a = w;
        else b = w;
        double next = w - f / d, step = fabs(next - w);
        bool newton = next > a && next < b && step <= 0.5 * last;
        if (newton && step <= SQUARED) return next;
        if (!newton) next = a + (b - a) / 2;
        last = fabs(next - w);
        w = next;
    }
    return w;
}

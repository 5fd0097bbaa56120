/* A C library whose functions err in the last bits, to be loaded before the host's. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>

static double wrong(double result) { return result * (1.0 + 0x1p-51); }

#define ONE(name)                                            \
    double name(double x) {                                  \
        double (*right)(double) = dlsym(RTLD_NEXT, #name);   \
        return wrong(right(x));                              \
    }
#define TWO(name)                                                    \
    double name(double x, double y) {                                \
        double (*right)(double, double) = dlsym(RTLD_NEXT, #name);   \
        return wrong(right(x, y));                                   \
    }

ONE(sin) ONE(cos) ONE(tan) ONE(asin) ONE(acos) ONE(atan) TWO(atan2)
ONE(sinh) ONE(cosh) ONE(tanh) ONE(asinh) ONE(acosh) ONE(atanh)
ONE(exp) ONE(exp2) ONE(expm1) ONE(log) ONE(log2) ONE(log10) ONE(log1p)
TWO(pow) TWO(hypot) ONE(cbrt) ONE(erf) ONE(erfc) ONE(lgamma)

void sincos(double x, double *s, double *c) {
    *s = sin(x);
    *c = cos(x);
}

/* simd.h - code for processors with AVX2 beside code for all: a function marked TC_TARGET_AVX2 must only be called
 * where tc_have_avx2() is true. Where the compiler knows of no AVX2, or TC_NO_AVX2 is defined, TC_AVX2 is 0 and
 * nothing has it. */
#ifndef TC_SIMD_H
#define TC_SIMD_H

#include <stdbool.h>

#if defined __x86_64__ && defined __GNUC__ && !defined TC_NO_AVX2
#define TC_AVX2 1
#define TC_TARGET_AVX2 __attribute__((target("avx2,bmi,bmi2,popcnt")))

static inline bool tc_have_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
           __builtin_cpu_supports("popcnt");
}

#else
#define TC_AVX2 0
#define TC_TARGET_AVX2

static inline bool tc_have_avx2(void)
{
    return false;
}
#endif

#endif

/* hash.h - a hash that gives the same bits on every machine. */
#ifndef TC_HASH_H
#define TC_HASH_H

#include <stdint.h>

/* A well mixed value of a seed and a number: SplitMix64's finaliser over a Weyl step (Steele et al. 2014). */
static inline uint64_t tc_hash64(uint64_t seed, uint64_t number)
{
    uint64_t h = seed + (number + 1) * 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    return h ^ (h >> 31);
}

#endif

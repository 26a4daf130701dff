/* srgb.c - the tables, made once. */
#include "srgb.h"

#include <math.h>
#include <pthread.h>

static tc_srgb tables;

static void make(void)
{
    for (int i = 0; i < 256; i++) {
        double c = i / 255.0;
        tables.linear[i] = (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
    }
    for (int i = 0; i < 4096; i++) {
        double light = (i / 4095.0) * (i / 4095.0);
        double c = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
        tables.shown[i] = (uint8_t)(c * 255 + 0.5);
    }
}

const tc_srgb *tc_srgb_tables(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, make);
    return &tables;
}

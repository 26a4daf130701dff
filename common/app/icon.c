/* icon.c - see icon.h. */
#include "icon.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { SIDE = 256, CORNERS = 6, SAMPLES = 4 };

/* Over each other, in units of the drawing. */
static const struct area {
    uint8_t rgb[3];
    int corners;
    float corner[CORNERS][2];
} areas[] = {
    {{0x5b, 0x93, 0xc9}, 4, {{8, 8}, {248, 8}, {248, 150}, {8, 150}}},
    {{0x5f, 0x8a, 0x4a}, 4, {{8, 150}, {248, 150}, {248, 248}, {8, 248}}},
    {{0xee, 0xf5, 0xe4}, 4, {{8, 191}, {248, 191}, {248, 199}, {8, 199}}},
    {{0x8d, 0x7f, 0x6d}, 3, {{126, 38}, {36, 170}, {128, 174}}},
    {{0x5d, 0x53, 0x47}, 5, {{126, 38}, {128, 174}, {222, 166}, {184, 108}, {168, 112}}},
    {{0xff, 0xff, 0xff}, 5, {{126, 38}, {91, 88}, {105, 81}, {115, 96}, {126.6f, 80}}},
    {{0xc9, 0xd7, 0xe6}, 5, {{126, 38}, {126.6f, 80}, {140, 95}, {149, 84}, {158.6f, 95.3f}}},
};

static bool inside(const struct area *a, float x, float y)
{
    bool in = false;
    for (int i = 0, j = a->corners - 1; i < a->corners; j = i++) {
        const float *p = a->corner[i], *q = a->corner[j];
        in ^= (p[1] > y) != (q[1] > y) && x < p[0] + (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]);
    }
    return in;
}

/* The frame: a square with rounded corners. */
static bool framed(float x, float y)
{
    const float half = 120, round = 44, dx = fmaxf(fabsf(x - SIDE / 2) - half + round, 0),
                dy = fmaxf(fabsf(y - SIDE / 2) - half + round, 0);
    return dx * dx + dy * dy < round * round;
}

void tc_icon_draw(int size, uint8_t (*rgba)[4])
{
    const int most = (int)(sizeof areas / sizeof *areas);
    for (int k = 0; k < size * size; k++) {
        int sum[3] = {0}, count = 0;
        for (int s = 0; s < SAMPLES * SAMPLES; s++) {
            const float unit = (float)SIDE / (float)(size * SAMPLES);
            const float x = unit * ((float)(k % size * SAMPLES + s % SAMPLES) + 0.5f);
            const float y = unit * ((float)(k / size * SAMPLES + s / SAMPLES) + 0.5f);
            int top = most - 1;
            while (top > 0 && !inside(&areas[top], x, y))
                top--;
            for (int c = 0; c < 3 && framed(x, y); c++)
                sum[c] += areas[top].rgb[c];
            count += framed(x, y);
        }
        memset(rgba[k], 0, 4);
        for (int c = 0; c < 3 && count > 0; c++)
            rgba[k][c] = (uint8_t)(sum[c] / count);
        rgba[k][3] = (uint8_t)(255 * count / (SAMPLES * SAMPLES));
    }
}

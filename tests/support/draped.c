/* draped.c - pictures of a function. */
#include "draped.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/base/image_memory.h"
#include "common/base/rect.h"

void draped_waves(double column, double row, double width, double height, double rgba[4])
{
    double u = 2 * M_PI * column / width, v = M_PI * row / height, waves = floor(width / 24);
    rgba[0] = 0.5 + 0.25 * cos(u) * sin(v) + 0.12 * sin(waves * u);
    rgba[1] = 0.45 + 0.3 * sin(2 * u + v) * sin(v) + 0.12 * cos(height / 20 * v);
    rgba[2] = 0.5 + 0.3 * cos(v) + 0.1 * sin(waves * u + height / 16 * v);
    rgba[3] = 1;
}

void draped_globe(double column, double row, double width, double height, double rgba[4])
{
    double u = 2 * M_PI * column / width, v = M_PI * row / height, waves = width / 20;
    double p[3] = {cos(u) * sin(v), sin(u) * sin(v), cos(v)};
    for (int k = 0; k < 3; k++)
        rgba[k] = 0.5 + 0.2 * p[k] + 0.15 * sin(waves * (p[k] - 0.5 * p[(k + 1) % 3]));
    rgba[3] = 1;
}

/* Anything from 0 to 1 at corners `size` pixels apart, smoothly between them. */
static double patches(double column, double row, double size, uint64_t seed)
{
    double i = floor(column / size), j = floor(row / size), u = column / size - i, v = row / size - j, z[4];
    for (int k = 0; k < 4; k++)
        z[k] = (double)(tc_hash64(seed, (uint64_t)((int64_t)i + (k & 1) + ((int64_t)j + (k >> 1)) * 65536)) >> 11) *
               0x1p-53;
    u *= u * (3 - 2 * u), v *= v * (3 - 2 * v);
    return (1 - v) * ((1 - u) * z[0] + u * z[1]) + v * ((1 - u) * z[2] + u * z[3]);
}

void draped_land(double column, double row, double width, double height, double rgba[4])
{
    (void)width, (void)height;
    double bright = 0, green = 0, all = 0;
    for (int size = 512, k = 0; size >= 1; size /= 2, k++) {
        double share = sqrt(size);
        bright += share * patches(column, row, size, 2 * (uint64_t)k), all += share;
        green += share * patches(column, row, size, 2 * (uint64_t)k + 1);
    }
    bright = 0.15 + 0.7 * bright / all, green /= all;
    rgba[0] = bright * (1.25 - 0.5 * green), rgba[1] = bright, rgba[2] = bright * (0.9 - 0.4 * green), rgba[3] = 1;
}

void draped_noise(double column, double row, double width, double height, double rgba[4])
{
    (void)height;
    uint64_t bits = tc_hash64(7, (uint64_t)(row * width + column));
    for (int k = 0; k < 3; k++)
        rgba[k] = (double)(bits >> (8 * k) & 255) / 255;
    rgba[3] = 1;
}

void draped_half(double column, double row, double width, double height, double rgba[4])
{
    (void)row, (void)height;
    rgba[0] = 1, rgba[1] = rgba[2] = 0, rgba[3] = column < width / 2;
}

typedef struct function_rows {
    tc_image_rows base;
    draped_function f;
} function_rows;

static tc_status read_rows(tc_image_rows *rows, int64_t row, int64_t count, uint8_t (*rgba)[4], tc_error *error)
{
    const function_rows *r = (const function_rows *)rows;
    (void)error;
    for (int64_t j = 0; j < count; j++)
        for (int64_t i = 0; i < rows->width; i++) {
            double c[4];
            r->f((double)i + 0.5, (double)(row + j) + 0.5, (double)rows->width, (double)rows->height, c);
            for (int k = 0; k < 4; k++)
                rgba[j * rows->width + i][k] = (uint8_t)lrint(255 * fmin(fmax(c[k], 0), 1));
        }
    return TC_OK;
}

tc_image *draped_image(draped_function f, int64_t width, int64_t height)
{
    function_rows rows = {{.name = "a function", .width = width, .height = height, .read = read_rows}, f};
    tc_image *image;
    if (tc_image_in_memory(&rows.base, &image, NULL))
        exit(99);
    return image;
}

static double light_of(double shown)
{
    return shown <= 0.04045 ? shown / 12.92 : pow((shown + 0.055) / 1.055, 2.4);
}

void draped_colour(tc_image *image, double px, double py, bool around, double rgb[3])
{
    int64_t w = image->level[0].width, h = image->level[0].height;
    double i = floor(px - 0.5), j = floor(py - 0.5), u = px - 0.5 - i, v = py - 0.5 - j, light[3] = {0, 0, 0};
    for (int k = 0; k < 4; k++) {
        int64_t x = (int64_t)i + (k & 1), y = tc_clamp64((int64_t)j + (k >> 1), 0, h - 1);
        x = around ? (x % w + w) % w : tc_clamp64(x, 0, w - 1);
        uint8_t pixel[1][4];
        image->read(image, 0, (tc_rect){x, y, x + 1, y + 1}, pixel, 1, NULL);
        for (int c = 0; c < 3; c++)
            light[c] += (k & 1 ? u : 1 - u) * (k >> 1 ? v : 1 - v) * light_of(pixel[0][c] / 255.0);
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = 255 * (light[c] <= 0.0031308 ? 12.92 * light[c] : 1.055 * pow(light[c], 1 / 2.4) - 0.055);
}

void draped_bounds(tc_image *image, double px, double py, bool around, double lo[3], double hi[3])
{
    enum { STEPS = 8 };
    double w = (double)image->level[0].width, sine = sin(M_PI * py / (double)image->level[0].height);
    double reach = around ? fmin(0.5 / fmax(sine, 1e-9), w / 2) : 0.5;
    for (int c = 0; c < 3; c++)
        lo[c] = 255, hi[c] = 0;
    for (int k = 0; k < (STEPS + 1) * (STEPS + 1); k++) {
        double rgb[3], dx = reach * (2.0 * (k % (STEPS + 1)) / STEPS - 1), dy = (double)(k / (STEPS + 1)) / STEPS - 0.5;
        draped_colour(image, px + dx, py + dy, around, rgb);
        for (int c = 0; c < 3; c++)
            lo[c] = fmin(lo[c], rgb[c]), hi[c] = fmax(hi[c], rgb[c]);
    }
}

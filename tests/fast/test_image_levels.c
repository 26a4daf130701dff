/* test_image_levels.c - the levels of pictures: halves in linear light, weighed by alpha, held against double
 * precision; and where those of large pictures come from: the file, its overviews, the cache. */
#include "tests/support/test.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/base/image_levels.h"
#include "common/base/image_memory.h"
#include "common/base/rect.h"
#include "common/input/image.h"
#include "tests/support/loading.h"

typedef uint8_t rgba[4];

/* ---- Halves ------------------------------------------------------------------------------------------------------
 */

/* A picture that is computed. */
typedef struct computed {
    tc_image_rows base;
    void (*pixel)(int64_t x, int64_t y, rgba out);
} computed;

static tc_status give_rows(tc_image_rows *rows, int64_t row, int64_t count, uint8_t (*out)[4], tc_error *error)
{
    (void)error;
    for (int64_t i = 0; i < count * rows->width; i++)
        ((computed *)rows)->pixel(i % rows->width, row + i / rows->width, out[i]);
    return TC_OK;
}

static computed picture(int64_t width, int64_t height, void (*pixel)(int64_t x, int64_t y, rgba out))
{
    return (computed){{.name = "computed", .width = width, .height = height, .read = give_rows}, pixel};
}

static uint32_t noise(int64_t x, int64_t y)
{
    uint32_t n = (uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u;
    n = (n ^ n >> 13) * 0x5bd1e995u;
    return n ^ n >> 15;
}

/* Colours of all kinds, with holes and half transparent places; what is under a hole is bright. */
static void speckled(int64_t x, int64_t y, rgba out)
{
    uint32_t n = noise(x, y), kind = noise(x / 3, y / 5) % 4;
    for (int k = 0; k < 3; k++)
        out[k] = (uint8_t)(n >> 8 * k);
    out[3] = kind == 0 ? 0 : kind == 1 ? (uint8_t)(n >> 24) : 255;
    if (kind == 0)
        out[0] = out[1] = out[2] = 255;
}

static void opaque(int64_t x, int64_t y, rgba out)
{
    speckled(x, y, out);
    out[3] = 255;
}

/* Black and white, pixel by pixel: half the light is 188 of 255, not 128. */
static void checkered(int64_t x, int64_t y, rgba out)
{
    out[0] = out[1] = out[2] = (x + y) % 2 ? 255 : 0;
    out[3] = 255;
}

static void white(int64_t x, int64_t y, rgba out)
{
    (void)x, (void)y;
    memset(out, 255, 4);
}

static double light_of(uint8_t shown)
{
    double c = shown / 255.0;
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static double shown_of(double light)
{
    return 255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055);
}

/* The pixel that four make, of those that there are: a border goes on. */
static void check_half(const rgba *fine, tc_image_size size, const rgba found, int64_t x, int64_t y)
{
    double alpha = 0, sum[3] = {0, 0, 0};
    for (int k = 0; k < 4; k++) {
        const uint8_t *p =
            fine[tc_min64(2 * y + k / 2, size.height - 1) * size.width + tc_min64(2 * x + k % 2, size.width - 1)];
        alpha += p[3];
        for (int c = 0; c < 3; c++)
            sum[c] += p[3] * light_of(p[c]);
    }
    assert_true(fabs(found[3] - alpha / 4) <= 0.5);
    for (int c = 0; c < 3 && alpha > 0; c++)
        if (fabs(found[c] - shown_of(sum[c] / alpha)) > 0.63) /* rounded by a table of quarters */
            fail_msg("%lld, %lld: expected %g, found %d", (long long)x, (long long)y, shown_of(sum[c] / alpha),
                     found[c]);
}

/* All pixels of a level, to be freed. */
static rgba *level_of(tc_image *image, int level)
{
    const tc_image_size s = image->level[level];
    rgba *pixels = malloc((size_t)(s.width * s.height) * sizeof *pixels);
    tc_error error = {0};
    assert_non_null(pixels);
    if (image->read(image, level, (tc_rect){0, 0, s.width, s.height}, pixels, s.width, &error) != TC_OK)
        fail_msg("%s", error.text);
    return pixels;
}

static tc_image *in_memory(computed *p)
{
    tc_image *image = NULL;
    assert_int_equal(tc_image_in_memory(&p->base, &image, NULL), TC_OK);
    return image;
}

static void levels_are_halves_in_linear_light(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1},   {2, 1},    {1, 7},    {5, 3},    {37, 23},
                                   {64, 64}, {129, 65}, {1000, 3}, {255, 257}};
    static void (*const pixels[])(int64_t, int64_t, rgba) = {speckled, opaque, checkered};
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++)
        for (int k = 0; k < 3; k++) {
            computed p = picture(sizes[n][0], sizes[n][1], pixels[k]);
            tc_image *image = in_memory(&p);
            rgba *fine = level_of(image, 0);
            for (int level = 1; level < image->levels; level++) {
                const tc_image_size f = image->level[level - 1], s = image->level[level];
                assert_true(s.width == (f.width + 1) / 2 && s.height == (f.height + 1) / 2);
                rgba *half = level_of(image, level);
                for (int64_t i = 0; i < s.width * s.height; i++)
                    check_half((const rgba *)fine, f, half[i], i % s.width, i / s.width);
                free(fine);
                fine = half;
            }
            const tc_image_size last = image->level[image->levels - 1];
            assert_true(last.width == 1 && last.height == 1);
            free(fine);
            image->close(image);
        }
    computed p = picture(64, 64, checkered);
    tc_image *image = in_memory(&p);
    for (int level = 1; level < image->levels; level++) {
        rgba *half = level_of(image, level);
        assert_true(half[0][0] == 188 && half[0][3] == 255);
        free(half);
    }
    image->close(image);
    p = picture(999, 333, white); /* nothing is lost on the way */
    image = in_memory(&p);
    rgba *last = level_of(image, image->levels - 1);
    assert_true(last[0][0] == 255 && last[0][3] == 255);
    free(last);
    image->close(image);
}

/* ---- Large pictures ----------------------------------------------------------------------------------------------
 */

enum { WIDE = 4100, HIGH = 2101, BLOCKS = 256 };

/* Smooth enough to be written fast, and nowhere the same. */
static void waves(int64_t x, int64_t y, rgba out)
{
    out[0] = (uint8_t)(x / 8 + y), out[1] = (uint8_t)(y / 4 * 3 + x / 64), out[2] = (uint8_t)(x * y >> 12);
    out[3] = 255;
}

/* Writes it; more: of how it is written. */
static const char *write_large(const char *name, const char *const *more)
{
    const char *path = made_path(name);
    GDALDatasetH d = GDALCreate(GDALGetDriverByName("GTiff"), path, WIDE, HIGH, 3, GDT_Byte, (char **)more);
    assert_non_null(d);
    enum { ROWS = 64 };
    static rgba rows[ROWS * WIDE];
    computed p = picture(WIDE, HIGH, waves);
    for (int y = 0; y < HIGH; y += ROWS) {
        int count = HIGH - y < ROWS ? HIGH - y : ROWS;
        give_rows(&p.base, y, count, rows, NULL);
        assert_int_equal(
            GDALDatasetRasterIO(d, GF_Write, 0, y, WIDE, count, rows, WIDE, count, GDT_Byte, 3, NULL, 4, 4 * WIDE, 1),
            CE_None);
    }
    GDALClose(d);
    return path;
}

static const char *const tiled[] = {"TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256", "COMPRESS=LZW", NULL};
static const char *const striped[] = {"COMPRESS=LZW", NULL};

static tc_image *open_large(const char *path)
{
    const tc_source_options source = {0};
    const tc_image_options options = {.source = &source};
    const tc_image_map map = {0};
    tc_image *image = NULL;
    tc_error error = {0};
    if (tc_image_open(path, &map, &options, &image, &error) != TC_OK)
        fail_msg("%s", error.text);
    return image;
}

static const char *cache_folder(void)
{
    static char folder[600];
    snprintf(folder, sizeof folder, "%s/cache", made_folder());
    return folder;
}

/* Files in the cache; and their paths. */
static char **cached_files(int *count_ret)
{
    char **names = VSIReadDir(CPLSPrintf("%s/terraclip", cache_folder())), **paths = NULL;
    *count_ret = 0;
    for (char **name = names; name && *name; name++)
        if (**name != '.') {
            paths = CSLAddString(paths, CPLSPrintf("%s/terraclip/%s", cache_folder(), *name));
            (*count_ret)++;
        }
    CSLDestroy(names);
    return paths;
}

static int cached(void)
{
    int count;
    CSLDestroy(cached_files(&count));
    return count;
}

static void forget(void)
{
    VSIRmdirRecursive(cache_folder());
}

/* Bytes that this process has read from files. */
static int64_t bytes_read(void)
{
    long long bytes = -1;
    char line[80];
    FILE *file = fopen("/proc/self/io", "r");
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "rchar: %lld", &bytes) == 1)
            break;
    if (file)
        fclose(file);
    return bytes;
}

/* All levels are those that the same pixels have in memory. */
static void has_levels(tc_image *image, void (*pixel)(int64_t x, int64_t y, rgba out))
{
    computed p = picture(WIDE, HIGH, pixel);
    tc_image *truth = in_memory(&p);
    assert_true(image->levels >= 4 && image->levels <= truth->levels);
    const tc_image_size last = image->level[image->levels - 1];
    assert_true(last.width <= 512 && last.height <= 512);
    for (int level = 0; level < image->levels; level++) {
        const tc_image_size s = image->level[level];
        assert_true(s.width == truth->level[level].width && s.height == truth->level[level].height);
        rgba *a = level_of(image, level), *b = level_of(truth, level);
        if (memcmp(a, b, (size_t)(s.width * s.height) * 4) != 0)
            fail_msg("level %d is another one", level);
        free(a), free(b);
    }
    truth->close(truth);
}

/* Opens a picture, looks at all of it, and again by the next program. in_cache: files that are kept. */
static void check_large(const char *path, int in_cache)
{
    forget();
    tc_image *image = open_large(path);
    assert_int_equal(cached(), in_cache);
    has_levels(image, waves);
    image->close(image);
    int64_t before = bytes_read();
    image = open_large(path);
    if (bytes_read() - before > 200000)
        fail_msg("opening it again reads %lld bytes", (long long)(bytes_read() - before));
    has_levels(image, waves);
    image->close(image);
    assert_int_equal(cached(), in_cache);
}

static void striped_ones_are_cached(void **state)
{
    (void)state;
    check_large(write_large("striped.tif", striped), 5);
}

static void tiled_ones_get_overviews(void **state)
{
    (void)state;
    check_large(write_large("tiled.tif", tiled), 4);
}

int main(void)
{
    GDALAllRegister();
    setenv("XDG_CACHE_HOME", cache_folder(), 1);
    const struct CMUnitTest tests[] = {cmocka_unit_test(levels_are_halves_in_linear_light),
                                       cmocka_unit_test(striped_ones_are_cached),
                                       cmocka_unit_test(tiled_ones_get_overviews)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    forget();
    made_folder_remove();
    return failed;
}

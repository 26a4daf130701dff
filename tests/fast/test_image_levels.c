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
#include "tests/support/process.h"

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

/* ---- Parts -------------------------------------------------------------------------------------------------------
 */

static int64_t largest_part; /* of all that were read, pixels */

static tc_status give_part(tc_image_rows *rows, tc_rect r, uint8_t (*out)[4], tc_error *error)
{
    (void)error;
    assert_true(r.x0 >= 0 && r.y0 >= 0 && r.x1 <= rows->width && r.y1 <= rows->height);
    largest_part = tc_max64(largest_part, tc_rect_area(r));
    for (int64_t i = 0; i < tc_rect_area(r); i++)
        ((computed *)rows)->pixel(r.x0 + i % (r.x1 - r.x0), r.y0 + i / (r.x1 - r.x0), out[i]);
    return TC_OK;
}

/* Sums all that is given, by place. */
static tc_status sum_row(void *context, int level, int64_t y, uint8_t (*row)[4], tc_error *error)
{
    const tc_image_making *m = ((void **)context)[0];
    uint64_t *sum = ((void **)context)[1];
    (void)error;
    for (int64_t x = 0; x < m->size[level].width; x++)
        *sum = (*sum ^ (row[x][0] + 256u * row[x][3] + (uint64_t)(x + y) * 65536u)) * UINT64_C(0x100000001b3);
    return TC_OK;
}

static uint64_t sum_of_levels(computed *p, int64_t part_width, int64_t part_height)
{
    tc_image_size size[TC_IMAGE_LEVELS];
    uint64_t sum = 0;
    tc_image_making making = {.first = 1, .size = size, .give = sum_row};
    void *context[2] = {&making, &sum};
    making.levels = tc_image_sizes(p->base.width, p->base.height, 1, size), making.context = context;
    p->base.read_part = part_width ? give_part : NULL;
    p->base.part_width = part_width, p->base.part_height = part_height;
    tc_error error;
    assert_int_equal(tc_image_make_levels(&p->base, &making, &error), TC_OK);
    return sum;
}

/* Parts of any size make the levels that rows make; high ones of a wide picture are not kept as a whole. */
static void parts_make_the_same_levels(void **state)
{
    (void)state;
    static const int parts[][2] = {{16, 16}, {7, 5}, {64, 3}, {500, 500}, {1, 1}};
    computed p = picture(333, 257, speckled);
    const uint64_t rows = sum_of_levels(&p, 0, 0);
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        assert_true(sum_of_levels(&p, parts[k][0], parts[k][1]) == rows);
    p = picture(INT64_C(1) << 21, 64, white);
    largest_part = 0;
    sum_of_levels(&p, 1 << 16, 64); /* all rows of a part: 2^22 pixels, and 2^25 of level 1 */
    assert_int_equal(largest_part, 1 << 21);
}

/* ---- Large pictures ----------------------------------------------------------------------------------------------
 */

enum { WIDE = 4100, HIGH = 2101, BLOCKS = 256 };

/* Grey, smooth enough to be written fast, and nowhere the same. */
static void waves(int64_t x, int64_t y, rgba out)
{
    out[0] = out[1] = out[2] = (uint8_t)(x / 8 + y + (x * y >> 12));
    out[3] = 255;
}

static const char *const tiled[] = {"TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256", "COMPRESS=LZW", NULL};
static const char *const striped[] = {"COMPRESS=LZW", NULL};

/* Writes it, as told, where it is not there yet. */
static const char *write_large(const char *name, const char *const *how)
{
    const char *path = made_path(name);
    if (access(path, F_OK) == 0)
        return path;
    GDALDatasetH d = GDALCreate(GDALGetDriverByName("GTiff"), path, WIDE, HIGH, 1, GDT_Byte, (char **)how);
    assert_non_null(d);
    for (int y = 0; y < HIGH; y++) {
        static uint8_t row[WIDE];
        for (int x = 0; x < WIDE; x++) {
            rgba pixel;
            waves(x, y, pixel);
            row[x] = pixel[0];
        }
        assert_int_equal(GDALRasterIO(GDALGetRasterBand(d, 1), GF_Write, 0, y, WIDE, 1, row, WIDE, 1, GDT_Byte, 0, 0),
                         CE_None);
    }
    GDALClose(d);
    return path;
}

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

static tc_image *large_in_memory(void)
{
    static tc_image *image;
    computed p = picture(WIDE, HIGH, waves);
    return image ? image : (image = in_memory(&p));
}

/* All levels are those that the same pixels have in memory. */
static void has_levels(tc_image *image)
{
    tc_image *truth = large_in_memory();
    assert_true(image->levels >= 4 && image->levels <= truth->levels);
    const tc_image_size last = image->level[image->levels - 1];
    assert_true(last.width <= 512 && last.height <= 512);
    for (int level = 0; level < image->levels; level++) {
        const tc_image_size s = image->level[level];
        assert_true(s.width == truth->level[level].width && s.height == truth->level[level].height);
        rgba *a = level_of(image, level), *b = level_of(truth, level);
        bool same = memcmp(a, b, (size_t)(s.width * s.height) * 4) == 0;
        free(a), free(b);
        if (!same)
            fail_msg("level %d is another one", level);
    }
}

/* Opens a picture, and again as the next program does, which looks at all of it. in_cache: files that are kept. */
static void check_large(const char *path, int in_cache)
{
    forget();
    tc_image *image = open_large(path);
    assert_int_equal(cached(), in_cache);
    image->close(image);
    int64_t before = process_bytes_read(getpid());
    image = open_large(path);
    if (process_bytes_read(getpid()) - before > 200000)
        fail_msg("opening it again reads %lld bytes", (long long)(process_bytes_read(getpid()) - before));
    has_levels(image);
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

/* Blocks of which GDAL's cache does not hold a row are decoded once. */
static void nothing_is_read_twice(void **state)
{
    (void)state;
    static const char *const blocks[] = {"TILED=YES", "BLOCKXSIZE=1024", "BLOCKYSIZE=1024", "COMPRESS=LZW", NULL};
    static const char *const strips[] = {"BLOCKYSIZE=1024", "COMPRESS=LZW", NULL};
    const GIntBig usual = GDALGetCacheMax64();
    for (int k = 0; k < 2; k++) {
        const char *path = k ? write_large("strips.tif", strips) : write_large("blocks.tif", blocks);
        struct stat about;
        assert_int_equal(stat(path, &about), 0);
        forget();
        GDALSetCacheMax64(3 << 20);
        int64_t before = process_bytes_read(getpid());
        tc_image *image = open_large(path);
        int64_t bytes = process_bytes_read(getpid()) - before;
        GDALSetCacheMax64(usual);
        image->close(image);
        if ((double)bytes > 1.1 * (double)about.st_size + 5e5) /* and the heads of what was made */
            fail_msg("%lld bytes of %lld are read", (long long)bytes, (long long)about.st_size);
    }
}

/* Overviews of these factors. */
static void add_overviews(const char *path, int count)
{
    static int factors[] = {2, 4, 8, 16, 32};
    GDALDatasetH d = GDALOpen(path, GA_Update);
    assert_non_null(d);
    assert_int_equal(GDALBuildOverviews(d, "NEAREST", count, factors, 0, NULL, NULL, NULL), CE_None);
    GDALClose(d);
}

/* A level's pixels are those of an overview. */
static void is_overview(tc_image *image, int level, GDALDatasetH d, int overview)
{
    GDALRasterBandH band = GDALGetOverview(GDALGetRasterBand(d, 1), overview);
    for (int n = 0; n < 50; n++) {
        const tc_image_size s = image->level[level];
        int64_t x = n * 7919 % s.width, y = n * 104729 % s.height;
        uint8_t want;
        rgba found;
        assert_int_equal(GDALRasterIO(band, GF_Read, (int)x, (int)y, 1, 1, &want, 1, 1, GDT_Byte, 0, 0), CE_None);
        assert_int_equal(image->read(image, level, (tc_rect){x, y, x + 1, y + 1}, &found, 1, NULL), TC_OK);
        assert_true(found[0] == want && found[1] == want && found[2] == want && found[3] == 255);
    }
}

/* Its overviews are the picture's levels; coarser ones than it has are halves of the last. */
static void own_overviews_are_used(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const int count = k ? 5 : 2;
        const char *path = k ? write_large("with-five.tif", tiled) : write_large("with-two.tif", striped);
        add_overviews(path, count);
        forget();
        tc_image *image = open_large(path);
        assert_int_equal(cached(), k ? 0 : 1); /* striped, it can only be read as a whole */
        assert_true(image->levels > 4);
        GDALDatasetH d = GDALOpen(path, GA_ReadOnly);
        for (int level = 1; level < image->levels && level <= count; level++)
            is_overview(image, level, d, level - 1);
        GDALClose(d);
        if (count == 2) {
            const tc_image_size half_size = image->level[3];
            rgba *fine = level_of(image, 2), *half = level_of(image, 3);
            for (int64_t i = 0; i < half_size.width * half_size.height; i += 97)
                check_half((const rgba *)fine, image->level[2], half[i], i % half_size.width, i / half_size.width);
            free(fine), free(half);
        }
        image->close(image);
    }
}

/* Overviews that know nothing of the picture's mask are not. */
static void overviews_have_the_mask(void **state)
{
    (void)state;
    const char *path = write_large("masked.tif", tiled);
    add_overviews(path, 5); /* before it has one */
    GDALDatasetH d = GDALOpen(path, GA_Update);
    assert_int_equal(GDALCreateDatasetMaskBand(d, GMF_PER_DATASET), CE_None);
    GDALRasterBandH mask = GDALGetMaskBand(GDALGetRasterBand(d, 1));
    static uint8_t there[WIDE];
    memset(there, 255, WIDE / 2);
    for (int y = 0; y < HIGH; y++)
        assert_int_equal(GDALRasterIO(mask, GF_Write, 0, y, WIDE, 1, there, WIDE, 1, GDT_Byte, 0, 0), CE_None);
    GDALClose(d);
    forget();
    tc_image *image = open_large(path);
    for (int level = 0; level < image->levels; level++) {
        const tc_image_size s = image->level[level];
        rgba *pixels = level_of(image, level);
        for (int64_t y = 0; y < s.height; y += 50)
            for (int64_t x = 0; x < s.width; x++)
                if (llabs((x << level) - WIDE / 2) > 1 << level)
                    assert_int_equal(pixels[y * s.width + x][3], x << level < WIDE / 2 ? 255 : 0);
        free(pixels);
    }
    image->close(image);
}

static const char *write_vrt(const char *name, const char *source)
{
    char text[1000];
    snprintf(text, sizeof text,
             "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\"><VRTRasterBand dataType=\"Byte\" band=\"1\">"
             "<SimpleSource><SourceFilename relativeToVRT=\"1\">%s</SourceFilename></SimpleSource></VRTRasterBand>"
             "</VRTDataset>",
             WIDE, HIGH, source);
    make_bytes(made_path(name), text, strlen(text));
    return made_path(name);
}

/* A VRT can be read in parts where its files can; it is another picture where one of them is. */
static void vrts_are_what_their_files_are(void **state)
{
    (void)state;
    write_large("striped.tif", striped), write_large("tiled.tif", tiled);
    assert_int_equal(rename(write_large("part.tif", striped), made_path("a.tif")), 0);
    check_large(write_vrt("tiled.vrt", "tiled.tif"), 4);
    write_vrt("a.vrt", "a.tif");
    check_large(write_vrt("nested.vrt", "a.vrt"), 5);
    assert_int_equal(rename(made_path("tiled.tif"), made_path("a.tif")), 0); /* the VRTs are as they were */
    tc_image *image = open_large(made_path("nested.vrt"));
    assert_int_equal(cached(), 5 + 4);
    image->close(image);
}

static void spoil(const char *path, long at, const char *bytes, size_t count)
{
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, at, SEEK_SET), 0);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    assert_int_equal(fclose(file), 0);
}

/* Files of the cache that are not whole, or not there, are made anew. */
static void the_cache_mends_itself(void **state)
{
    (void)state;
    const char *path = write_large("mended.tif", tiled);
    forget();
    tc_image *image = open_large(path);
    image->close(image);
    for (int way = 0; way < 5; way++) {
        int count;
        char **files = cached_files(&count);
        struct stat about;
        assert_int_equal(count, 4);
        assert_int_equal(stat(files[way % 4], &about), 0);
        switch (way) {
        case 0: unlink(files[way % 4]); break;
        case 1: cut_file(files[way % 4], 0); break;
        case 2: cut_file(files[way % 4], -1); break;
        case 3: cut_file(files[way % 4], (long)about.st_size / 2); break;
        default: make_bytes(files[way % 4], "nonsense", 8); break;
        }
        CSLDestroy(files);
        image = open_large(path);
        if (way == 4)
            has_levels(image);
        image->close(image);
        assert_int_equal(cached(), 4);
    }
    /* What is damaged inside is found when it is read, and made anew by the next program. */
    int count;
    char **files = cached_files(&count);
    for (int k = 0; k < count; k++) {
        static char nonsense[4000];
        struct stat about;
        assert_int_equal(stat(files[k], &about), 0);
        memset(nonsense, 0x5a, sizeof nonsense);
        spoil(files[k], (long)about.st_size / 2, nonsense, sizeof nonsense);
    }
    CSLDestroy(files);
    image = open_large(path);
    const tc_image_size s = image->level[1];
    rgba *pixels = malloc(sizeof *pixels * (size_t)(s.width * s.height));
    tc_error error = {0};
    assert_int_equal(image->read(image, 1, (tc_rect){0, 0, s.width, s.height}, pixels, s.width, &error), TC_ERR_FORMAT);
    assert_non_null(strstr(error.text, "the next program makes them anew"));
    free(pixels);
    image->close(image);
    assert_int_equal(cached(), 0);
    image = open_large(path);
    has_levels(image);
    image->close(image);
}

/* Through OpenImageIO. */
static void tga_is_cached(void **state)
{
    (void)state;
    rgba *pixels = malloc(sizeof *pixels * WIDE * HIGH);
    computed p = picture(WIDE, HIGH, waves);
    give_rows(&p.base, 0, HIGH, pixels, NULL);
    make_tga(made_path("a.tga"), WIDE, HIGH, 4, *pixels);
    free(pixels);
    check_large(made_path("a.tga"), 5);
}

int main(void)
{
    GDALAllRegister();
    setenv("XDG_CACHE_HOME", cache_folder(), 1);
    const struct CMUnitTest tests[] = {cmocka_unit_test(levels_are_halves_in_linear_light),
                                       cmocka_unit_test(parts_make_the_same_levels),
                                       cmocka_unit_test(striped_ones_are_cached),
                                       cmocka_unit_test(tiled_ones_get_overviews),
                                       cmocka_unit_test(nothing_is_read_twice),
                                       cmocka_unit_test(own_overviews_are_used),
                                       cmocka_unit_test(overviews_have_the_mask),
                                       cmocka_unit_test(vrts_are_what_their_files_are),
                                       cmocka_unit_test(the_cache_mends_itself),
                                       cmocka_unit_test(tga_is_cached)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    large_in_memory()->close(large_in_memory());
    forget();
    made_folder_remove();
    return failed;
}

/* pack_sums.c - packs a few terrains and prints the CRC-32C of each file: compilers.sh builds it with several
 * compilers, which must agree. Heights are made of integers, so that only the library under test can differ.
 *
 *     pack_sums FOLDER */
#include <stdio.h>
#include <stdlib.h>

#include "common/base/crc32c.h"
#include "common/terraclip.h"

enum { WIDTH = 256, HEIGHT = 128 };

static void make(float *z, bool rough)
{
    uint32_t state = 12345;
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++) {
            int hill = (i * 37 + j * 11) % 600, slope = 3 * i - 2 * j;
            state = state * 1664525u + 1013904223u;
            z[j * WIDTH + i] =
                (float)((hill < 300 ? hill : 600 - hill) * 4 + slope + (int)(state >> (rough ? 22 : 29)));
        }
}

static void pack(const char *path, const float *z, tc_pack_mode mode, tc_pack_codec codec, double error, bool planet)
{
    tc_pack_terrain terrain = {.width = WIDTH,
                               .height = HEIGHT,
                               .wraps_x = planet,
                               .radius = planet ? 6371000 : 0,
                               .spacing_x = 30,
                               .spacing_y = 30,
                               .georef = {.known = planet, .geographic = planet},
                               .sample_type = TC_SAMPLE_INT16,
                               .unit = 1};
    const double t[6] = {-180, 360. / 256, 0, 90, 0, -180. / 128};
    for (int k = 0; k < 6; k++)
        terrain.georef.transform[k] = planet ? t[k] : 0;
    tc_pack_options options = {.mode = mode, .codec = codec, .error = error, .threads = 2};
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error text;
    tc_rect all = {0, 0, terrain.width, terrain.height};
    tc_status status = tc_packer_create(path, &terrain, &options, &packer, &text);
    if (!status)
        status = tc_packer_put(packer, all, z, NULL, WIDTH, &text);
    if (!status)
        status = tc_packer_finish(packer, &result, &text);
    tc_packer_destroy(packer);
    if (status) {
        fprintf(stderr, "pack_sums: %s\n", text.text);
        exit(1);
    }
}

static void print_sum(const char *path)
{
    static uint8_t bytes[1 << 20];
    FILE *file = fopen(path, "rb");
    size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    if (file)
        fclose(file);
    remove(path);
    printf("%zu:%08x ", size, (unsigned)tc_crc32c(0, bytes, size));
}

int main(int argc, char **argv)
{
    static float z[WIDTH * HEIGHT];
    static const struct {
        tc_pack_mode mode;
        tc_pack_codec codec;
        double error;
        bool planet;
    } way[] = {{TC_PACK_RMS, TC_CODEC_LIFTING, 2, false},       {TC_PACK_RMS, TC_CODEC_LIFTING, 0.05, false},
               {TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 8, false}, {TC_PACK_MAX_ERROR, TC_CODEC_LIFTING, 1, false},
               {TC_PACK_LOSSLESS, TC_CODEC_LIFTING, 0, false},  {TC_PACK_RMS, TC_CODEC_LH04, 3, false},
               {TC_PACK_RMS, TC_CODEC_LIFTING, 4, true}};
    if (argc != 2)
        return 2;
    char path[4096];
    snprintf(path, sizeof path, "%s/pack_sums-%p.tclip", argv[1], (void *)path);
    for (int k = 0; k < 7; k++) {
        make(z, k % 2);
        pack(path, z, way[k].mode, way[k].codec, way[k].error, way[k].planet);
        print_sum(path);
    }
    puts("");
    return 0;
}

/* fuzz_reader.c - a whole packed file of arbitrary bytes, flat or a planet: opened as a map, all of its charts asked
 * and read. Nothing may crash, hang or take much memory; heights are finite; a rectangle is the same part of the whole.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/packed/file/container.h"
#include "common/terraclip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { WHOLE = 300, PART = 40 }; /* samples along a side that are read at once */

static void expect(int good, const char *what)
{
    if (!good) {
        fprintf(stderr, "fuzz_reader: %s\n", what);
        abort();
    }
}

/* NULL where the rectangle cannot be read, which is fine. */
static float *read_rect(const tc_field *p, int l, tc_rect r, uint8_t **voids_ret)
{
    size_t samples = (size_t)tc_rect_area(r);
    float *z = malloc(samples * sizeof *z);
    *voids_ret = malloc(samples);
    expect(z && *voids_ret, "no memory");
    tc_range range = tc_field_range(p, l, r);
    expect(isfinite(range.lo) && isfinite(range.hi) && range.lo <= range.hi, "bounds are nonsense");
    expect(range.error >= 0, "an error is nonsense");
    if (tc_field_read(p, l, r, z, *voids_ret, r.x1 - r.x0)) {
        free(z);
        return NULL;
    }
    for (size_t i = 0; i < samples; i++)
        expect(isfinite(z[i]) && (*voids_ret)[i] <= 1, "a height that is not finite, or no mask");
    return z;
}

static void check_part(const tc_field *p, int l, tc_rect whole, const float *z, const uint8_t *voids)
{
    int64_t w = whole.x1 - whole.x0, h = whole.y1 - whole.y0;
    tc_rect part = {whole.x0 + w / 3, whole.y0 + h / 2, whole.x0 + w / 3 + tc_min64(w - w / 3, 37),
                    whole.y0 + h / 2 + tc_min64(h - h / 2, 21)};
    uint8_t *v = NULL;
    float *some = read_rect(p, l, part, &v);
    for (int64_t y = part.y0; y < part.y1 && some; y++)
        for (int64_t x = part.x0; x < part.x1; x++) {
            int64_t at = (y - part.y0) * (part.x1 - part.x0) + x - part.x0;
            int64_t of = (y - whole.y0) * w + x - whole.x0;
            expect(some[at] == z[of] && v[at] == voids[of], "a part is not the part of the whole");
        }
    expect(some || !z, "a part cannot be read");
    free(some), free(v);
}

/* Whether errors are read: without, they would be measured on all of it, however large. */
static bool tells_errors(const tc_field *p)
{
    const tc_container *c = tc_field_container(p);
    return c && c->errors && c->voids == 0 && c->info.levels_missing == 0;
}

/* Around a corner, of a field that goes on beyond its sides. */
static void read_beyond(const tc_field *p, int l)
{
    enum { BEYOND = 8, SIDE = BEYOND + 4 };
    tc_level level = tc_field_level(p, l);
    tc_rect r = {-BEYOND, level.height - 4, 4, level.height + BEYOND};
    float z[SIDE * SIDE];
    uint8_t voids[SIDE * SIDE];
    if (level.width < 4 || level.height < 4 || tc_field_read(p, l, r, z, voids, SIDE))
        return;
    for (int i = 0; i < SIDE * SIDE; i++)
        expect(isfinite(z[i]) && voids[i] <= 1, "a height beyond a side that is not finite, or no mask");
}

static void read_chart(const tc_field *p)
{
    if (tells_errors(p))
        tc_field_know_errors(p);
    for (int l = 1; l <= tc_field_info(p)->levels; l++) {
        tc_level level = tc_field_level(p, l);
        tc_rect all = {0, 0, level.width, level.height}, r = all;
        if (level.width > WHOLE || level.height > WHOLE) /* the last corner, and one in the middle */
            r = (tc_rect){tc_max64(all.x1 - PART, 0), tc_max64(all.y1 - PART, 0), all.x1, all.y1};
        for (int k = 0; k < (tc_rect_area(r) == tc_rect_area(all) ? 1 : 2); k++) {
            uint8_t *voids = NULL;
            float *z = read_rect(p, l, r, &voids);
            if (z)
                check_part(p, l, r, z, voids);
            free(z), free(voids);
            r = (tc_rect){all.x1 / 2, all.y1 / 2, tc_min64(all.x1 / 2 + PART, all.x1),
                          tc_min64(all.y1 / 2 + PART, all.y1)};
        }
        read_beyond(p, l);
        tc_field_packed_level(p, l);
    }
    double z;
    tc_field_height(p, 10, 10, &z);
    tc_field_packed_info(p);
    tc_field_tell(p);
}

/* A level that is made up by the fit that the file has. */
static void read_synthesised(tc_map *map)
{
    const tc_field *p = tc_map_field(map, 0);
    const tc_level level = tc_field_level(p, tc_field_info(p)->levels);
    if (!tc_field_packed_info(p)->synthesis_fit || level.width > WHOLE || level.height > WHOLE ||
        tc_map_synthesise(map, 1, NULL))
        return;
    const tc_field *finer = tc_map_field(map, 0);
    uint8_t *voids = NULL;
    float *z = read_rect(finer, tc_field_info(finer)->levels, (tc_rect){0, 0, level.width, level.height}, &voids);
    free(z), free(voids);
}

/* The input as a source of bytes; all that is read must lie within it. */
typedef struct input {
    const uint8_t *bytes;
    size_t size;
    int closed;
} input;

static tc_status read_input(void *context, int64_t offset, void *bytes, size_t size)
{
    const input *in = context;
    expect(offset >= 0 && (uint64_t)offset <= in->size && size <= in->size - (size_t)offset, "read beyond the end");
    memcpy(bytes, in->bytes + offset, size);
    return TC_OK;
}

static void close_input(void *context)
{
    ((input *)context)->closed++;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input in = {data, size, 0};
    tc_byte_source source = {&in, (int64_t)size, read_input, close_input};
    tc_map *map = NULL;
    tc_error error = {TC_OK, ""};
    tc_open_options options = {.cache_bytes = size % 2 ? 1 : 0, .flat = size % 8 == 7};
    tc_status status = tc_map_open_bytes("input", &source, &options, &map, &error);
    expect(!status == !error.text[0] && !strchr(error.text, '\n'), "no words for an error, or more than a line");
    if (!status) {
        for (int n = 0; n < tc_map_charts(map); n++)
            read_chart(tc_map_field(map, n));
        for (int k = -2; k <= 2; k++) {
            double z;
            if (!tc_map_height(map, 0.7 * k, 0.78 * k, &z))
                expect(!isinf(z), "a height without end");
        }
        read_synthesised(map);
        tc_map_destroy(map);
    }
    expect(in.closed == 1, "the input is not let go of once");
    return 0;
}

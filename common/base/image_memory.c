/* image_memory.c - levels in memory. */
#include "image_memory.h"

#include <stdlib.h>
#include <string.h>

#include "image_levels.h"
#include "status.h"

typedef struct memory_image {
    tc_image base;
    uint8_t (*pixels[TC_IMAGE_LEVELS])[4];
    char name[];
} memory_image;

static tc_status read_pixels(tc_image *image, int level, tc_rect r, uint8_t (*rgba)[4], ptrdiff_t stride,
                             tc_error *error)
{
    const memory_image *m = (const memory_image *)image;
    (void)error;
    for (int64_t y = r.y0; y < r.y1; y++)
        memcpy(rgba + (y - r.y0) * stride, m->pixels[level] + y * image->level[level].width + r.x0,
               (size_t)(r.x1 - r.x0) * 4);
    return TC_OK;
}

static tc_status keep_row(void *context, int level, int64_t y, uint8_t (*rgba)[4], tc_error *error)
{
    memory_image *m = context;
    (void)error;
    memcpy(m->pixels[level] + y * m->base.level[level].width, rgba, (size_t)m->base.level[level].width * 4);
    return TC_OK;
}

static void close_image(tc_image *image)
{
    memory_image *m = (memory_image *)image;
    for (int k = 0; k < image->levels; k++)
        free(m->pixels[k]);
    free(m);
}

tc_status tc_image_in_memory(tc_image_rows *rows, tc_image **image_ret, tc_error *error)
{
    memory_image *m = calloc(1, sizeof *m + strlen(rows->name) + 1);
    bool room = m != NULL;
    if (room) {
        strcpy(m->name, rows->name);
        m->base = (tc_image){.name = m->name, .read = read_pixels, .close = close_image};
        m->base.levels = tc_image_sizes(rows->width, rows->height, 1, m->base.level);
    }
    for (int k = 0; room && k < m->base.levels; k++)
        room = (m->pixels[k] = malloc((size_t)(m->base.level[k].width * m->base.level[k].height) * 4)) != NULL;
    const tc_image_making making = {
        .levels = room ? m->base.levels : 0, .size = room ? m->base.level : NULL, .give = keep_row, .context = m};
    tc_status status = room ? tc_image_make_levels(rows, &making, error)
                            : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", rows->name);
    if (status == TC_OK)
        *image_ret = &m->base;
    else if (m)
        close_image(&m->base);
    return status;
}

/* point.c - a level of a field between its samples. */
#include "point.h"

#include <math.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"

tc_cell tc_cell_at(const tc_field *field, int level, double u, double v)
{
    const tc_level l = tc_field_level(field, level);
    bool wraps = tc_field_wraps(field, level);
    if (!wraps)
        u = fmin(fmax(u, 0), (double)(l.width - 1));
    else if (!(fabs(u) < 0x1p62)) /* many more turns than a double counts: no column is more right than another */
        u = 0;
    v = fmin(fmax(v, 0), (double)(l.height - 1));
    int64_t i = (int64_t)floor(u), j = tc_min64((int64_t)v, tc_max64(l.height - 2, 0));
    if (!wraps)
        i = tc_min64(i, tc_max64(l.width - 2, 0));
    return (tc_cell){.rect = {i, j, wraps ? i + 2 : tc_min64(i + 2, l.width), tc_min64(j + 2, l.height)},
                     .tx = u - (double)i,
                     .ty = v - (double)j};
}

void tc_cell_complete(tc_cell *c)
{
    if (c->rect.x1 - c->rect.x0 < 2)
        c->z[1] = c->z[0], c->z[3] = c->z[2];
    if (c->rect.y1 - c->rect.y0 < 2)
        c->z[2] = c->z[0], c->z[3] = c->z[1];
}

double tc_cell_turn(const tc_field *field, int level, double u)
{
    double width = (double)tc_field_level(field, level).width;
    return tc_field_wraps(field, level) ? u - floor(u / width) * width : u;
}

tc_status tc_field_cell(const tc_field *field, int level, double u, double v, bool voids, tc_cell *cell_ret)
{
    tc_cell cell = tc_cell_at(field, level, u, v);
    tc_status status = tc_field_read(field, level, cell.rect, cell.z, voids ? cell.voids : NULL, 2);
    if (status)
        return status;
    tc_cell_complete(&cell);
    *cell_ret = cell;
    return TC_OK;
}

double tc_cell_mesh(const tc_cell *c)
{
    return tc_triangle_height(c->z[0], c->z[1], c->z[2], c->z[3], c->tx, c->ty);
}

double tc_cell_bilinear(const tc_cell *c)
{
    double south = c->z[0] + c->tx * ((double)c->z[1] - c->z[0]);
    return south + c->ty * (c->z[2] + c->tx * ((double)c->z[3] - c->z[2]) - south);
}

tc_status tc_field_mesh_height(const tc_field *field, int level, double u, double v, double *z_ret)
{
    tc_cell cell;
    tc_status status = tc_field_cell(field, level, tc_cell_turn(field, level, u), v, false, &cell);
    if (status == TC_OK)
        *z_ret = tc_cell_mesh(&cell);
    return status;
}

bool tc_cell_void(const tc_cell *c)
{
    bool lower = c->tx + c->ty <= 1;
    const double shares[4] = {lower ? 1 - c->tx - c->ty : 0, lower ? c->tx : 1 - c->ty, lower ? c->ty : 1 - c->tx,
                              lower ? 0 : c->tx + c->ty - 1};
    for (int k = 0; k < 4; k++)
        if (c->voids[k] && shares[k] > 0)
            return true;
    return false;
}

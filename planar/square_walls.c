/* square_walls.c - square grids: walls below the edge of the terrain, and the floor of the block that they make of it.
 *
 * A block at the edge has a strip of triangles there: its own vertices, from the same numbers by the same expressions,
 * and below each of them one at the walls' foot. So walls and terrain meet bit for bit, whichever levels are drawn.
 * Strips have no vertices of their own: shaders/square.glsl makes them from the number of the vertex, whose first one
 * says where it runs. */
#include <math.h>

#include "common/base/rect.h"
#include "square_internal.h"

enum { WEST, EAST, SOUTH, NORTH };

/* The first vertex of a strip, as wall_vertex() takes it apart: the coordinate that stays, and whether it is the row.
 */
static uint32_t first_vertex(int64_t stays, bool row)
{
    return (uint32_t)stays << 10 | (row ? 1u << 20 : 0);
}

/* Whether a wall on a side of the box can be seen: from beyond the edge, or from within where it is a sea's, which
 * stands above ground below it. */
static bool faces(const square_draws *a, int side, const double lo[3], const double hi[3])
{
    const tc_frame_options *o = &a->view->options;
    const bool beyond[] = {lo[0] >= 0, hi[0] <= 0, lo[1] >= 0, hi[1] <= 0};
    return o->no_cull || beyond[side] || lo[2] + a->view->culled.z < o->shore;
}

static void add_wall(square_draws *a, int level, tc_rect cells, const float corners[4], int side,
                     const double box[2][3])
{
    const tc_frame_options *o = &a->view->options;
    const int axis = side / 2, along = 1 - axis;
    double lo[3], hi[3];
    for (int i = 0; i < 3; i++)
        lo[i] = box[0][i], hi[i] = box[1][i];
    lo[axis] = hi[axis] = side & 1 ? hi[axis] : lo[axis];
    if (!faces(a, side, box[0], box[1]))
        return;
    lo[2] = fmin(lo[2], o->foot - a->view->culled.z), hi[2] = fmax(hi[2], o->shore - a->view->culled.z);
    if (!o->no_cull && !tc_square_in_view(a, lo, hi))
        return;
    if (a->walls == a->s->head.wall_capacity)
        return;
    const int64_t size[2] = {cells.x1 - cells.x0, cells.y1 - cells.y0};
    const int at = a->s->head.draw_capacity + a->walls++;
    a->frame->wall_triangles += 2 * size[along];
    a->frame->instances[at] = tc_square_instance(a, level, cells.x0, cells.y0, corners);
    a->frame->draws[at] = (tc_draw){.count = (uint32_t)(2 * (size[along] + 1)),
                                    1,
                                    .first_index = first_vertex(side & 1 ? size[axis] : 0, axis == 1)};
}

void tc_square_add_walls(square_draws *a, int level, tc_rect cells, const float corners[4])
{
    const tc_rect end = tc_clipmap_level(a->clipmap, level)->extent;
    const bool there[] = {cells.x0 <= end.x0, cells.x1 >= end.x1 - 1, cells.y0 <= end.y0, cells.y1 >= end.y1 - 1};
    double box[2][3];
    bool known = false;
    for (int side = WEST; side <= NORTH; side++)
        if (there[side]) {
            if (!known)
                tc_square_box(a, level, cells, box[0], box[1]);
            known = true;
            add_wall(a, level, cells, corners, side, box);
        }
}

/* Between the walls' feet, for an eye below them: two triangles, of the numbers of vertices beyond all walls'. Where
 * there is a sea they end in it. */
static void add_floor(square_draws *a)
{
    const tc_frame_options *o = &a->view->options;
    if (!o->walls || o->shore > -INFINITY || a->view->camera.z >= o->foot || a->walls == a->s->head.wall_capacity)
        return;
    const tc_rect whole = tc_clipmap_level(a->clipmap, 1)->extent;
    const int at = a->s->head.draw_capacity + a->walls++;
    a->frame->wall_triangles += 2;
    a->frame->instances[at] = tc_square_instance(a, 1, whole.x0, whole.y0, NULL);
    a->frame->draws[at] = (tc_draw){.count = 4, 1, .first_index = 1u << 21};
}

void tc_square_end_walls(square_draws *a)
{
    tc_frame *f = a->frame;
    add_floor(a);
    const int others = a->strips + a->lists;
    for (int i = 0; i < a->walls; i++) {
        f->draws[others + i] = f->draws[a->s->head.draw_capacity + i];
        f->instances[others + i] = f->instances[a->s->head.draw_capacity + i];
        f->draws[others + i].base_vertex = others + i; /* which of arrays is the instance's number */
    }
    f->wall_draws = a->walls;
}

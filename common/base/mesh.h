/* mesh.h - the one way a grid cell is split into triangles.
 *
 * Every cell of every level is cut along the diagonal from its south-east to its north-west corner. With one direction
 * everywhere a fine mesh whose vertices lie on the coarse mesh IS the coarse mesh, and diagonals stay where they are
 * in the world however the windows move. */
#ifndef TC_MESH_H
#define TC_MESH_H

/* Height at (tx, ty) in [0, 1]^2 of the cell with corners z00 (south-west), z10 (south-east), z01, z11. */
static inline double tc_triangle_height(double z00, double z10, double z01, double z11, double tx, double ty)
{
    return tx + ty <= 1 ? z00 + tx * (z10 - z00) + ty * (z01 - z00)
                        : z11 + (1 - tx) * (z01 - z11) + (1 - ty) * (z10 - z11);
}

#endif

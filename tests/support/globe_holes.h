/* globe_holes.h - background that shows through a planet, drawn in flat colours on magenta. */
#ifndef GLOBE_HOLES_H
#define GLOBE_HOLES_H

#include "scene.h"

/* Pixels of a frame. */
typedef struct globe_holes {
    int64_t terrain, sure;    /* that are not background; that surely are terrain */
    int64_t holes;            /* sure ones that are background */
    int64_t suspects, cracks; /* background below terrain; of these, where the surface drawn is crossed */
} globe_holes;

/* What is known of the mesh that a planet is drawn by. */
typedef struct globe_mesh globe_mesh;
struct globe_mesh {
    tc_body body;
    double z_lo, z_hi; /* of all that is drawn, metres above the body */
    /* How far a triangle's middle is from its corners at most, radians, so far from the foot point. */
    double (*half)(const globe_mesh *mesh, double theta);
    double apart[3]; /* what that goes by */
};

/* Of a surface of rings, or over faces, that has just been drawn with these options (NULL: zero). lagging: levels may
 * be coarser than the view calls for. */
globe_mesh globe_mesh_of_rings(const tc_surface *surface, const tc_frame_options *options);
globe_mesh globe_mesh_of_faces(const tc_surface *surface, const tc_camera *camera, const tc_frame_options *options,
                               bool lagging);

/* Of the frame that has just been drawn with these options (NULL: zero); at most so many suspects are looked into. */
globe_holes globe_holes_of(scene *s, const globe_mesh *mesh, const tc_camera *camera, const tc_frame_options *options,
                           int64_t most_suspects);

#endif

/* watertight.h - background that shows through a planar scene.
 *
 * Terrain is drawn in flat colours on magenta. In a vertical plane through an eye above a height field, sky begins
 * above the last hit and goes on for good. So a magenta pixel is suspect where terrain is drawn further up on the way
 * to the zenith's vanishing point; from outside the terrain's rectangle, where one can look below its rim, only if
 * there is terrain on the way down as well. Whether a suspect is a crack, and not sky in a gap between two spires less
 * than a pixel wide, the surface itself says: the pixel's ray must pass from clearly above to clearly below the drawn
 * surface, as computed in double, by more than a quarter of a pixel. */
#ifndef WATERTIGHT_H
#define WATERTIGHT_H

#include "scene.h"
#include "terrains.h"

/* Flat colours on magenta; the frame options are the caller's to set. */
tc_scene_options watertight_options(void);

/* Whether the camera is over the terrain's rectangle. */
bool watertight_over(const tc_field *field, const tc_camera *camera);

/* A view of the terrain from 1 to `highest` metres above its ground: over it, at its edges, from outside. */
tc_camera watertight_view(test_random *r, const tc_field *field, double highest, int width, int height);

/* Pixels of the frame, drawn with these options, that are cracks; terrain_ret, unless NULL: pixels of terrain. */
int watertight_cracks(scene *s, const uint8_t *rgb, const tc_camera *camera, const tc_frame_options *options,
                      int64_t *terrain_ret);

#endif

/* drape.h - imagery around one viewer: windows of its own over the charts' fields of colours, and their textures. */
#ifndef TC_DRAPE_H
#define TC_DRAPE_H

#include "common/imagery/imagery.h"
#include "frame_uniforms.h"
#include "level_textures.h"
#include "surface.h"

/* By which layers of imagery reach beyond what they hold, where the map ends there; more than a window is wide. */
#define TC_DRAPE_END 65536

typedef struct tc_drape tc_drape;
struct tc_drape {
    const tc_imagery *imagery;
    tc_windows windows;
    tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    tc_level_textures textures;
};

/* For a surface over the same map. Reads the coarsest levels. */
tc_status tc_drape_create(const tc_gl *gl, const tc_imagery *imagery, const tc_surface *surface, tc_drape *drape_ret,
                          tc_error *error);
void tc_drape_destroy(const tc_gl *gl, tc_drape *drape);

/* Moves the windows towards what the view wants, by as many texels as how->budget says, and uploads them until a time
 * as tc_level_textures_upload() has it. */
typedef struct tc_drape_update {
    int64_t texels, bytes;
    bool resident, failed;
} tc_drape_update;
tc_status tc_drape_move(const tc_gl *gl, tc_drape *drape, const tc_view *view, const tc_update *how, double until,
                        tc_drape_update *update_ret, tc_error *error);

/* What imagery.glsl needs to know. */
void tc_drape_uniforms(const tc_drape *drape, const tc_view *view, tc_frame_uniforms *uniforms);

/* Levels of all charts that hold colours; bytes on both sides of the driver. */
int tc_drape_levels(const tc_drape *drape);
size_t tc_drape_bytes(const tc_drape *drape);

#endif

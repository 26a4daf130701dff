/* scene_needs.h - what a scene needs, settled from its options and its terrain in one place: programs are assembled,
 * windows and textures made from it, and what is not needed is left out (the design's section 8). */
#ifndef TC_SCENE_NEEDS_H
#define TC_SCENE_NEEDS_H

#include <math.h>

#include "shade.h"
#include "surface.h"
#include "surroundings.h"
#include "common/imagery/imagery.h"
#include "common/terraclip.h"
#include "common/view/sun.h"

/* What may be asked of a scene. */
typedef struct tc_scene_options {
    bool unlit;            /* colours without light: no normal map */
    bool background_set;   /* flat background: no sky, no haze */
    uint8_t background[3]; /* RGB */
    bool holes;            /* voids, where there are any, are left out of the mesh */
    int samples;           /* a pixel; 0: 1. The most that the driver has where it has fewer */
    int64_t budget;        /* height samples updated a frame, at least n; 0: n * n; negative: no limit */
    int64_t budget_us;     /* microseconds that updating takes in a frame that waits for nothing, to within a small
                            * piece; 0: 4000 or, where a budget is given, no limit; negative: no limit */
    double ahead;          /* seconds on for which packed tiles are asked for, as the eye moves; 0: 1; negative:
                            * none */
    int ring;      /* uploads through a mapped buffer: 0 where the driver gains by it, 1 wherever it can, -1 not */
    bool throttle; /* frames may be throttled: what these need is made beforehand */
    const tc_colour_ramp *colours; /* of heights, in place of the terrain's own; outlives the renderer. NULL: those */
    const tc_imagery *imagery;     /* over the map; outlives the renderer. NULL: none */
    const tc_shade *shade;         /* NULL: natural colours */
    double contours;               /* metres between lines of equal height; 0: none */
    double exaggeration;    /* of the map's heights over the true ones, which colours and contours tell; 0: none */
    tc_surroundings around; /* what a map that ends is shown with; zero: nothing */
    tc_sea sea;             /* of the map; zero: what lies below 0 has its colours */
    bool level_colours;     /* may be switched while running, as may the next three */
    bool wireframe;
    tc_sun sun; /* of natural colours */
    tc_frame_options frame;
} tc_scene_options;

typedef struct tc_scene_needs {
    const tc_shade *shade; /* what colours say; never NULL */
    bool normals;          /* how the ground lies */
    bool fine_normals;     /* to a hundredth of a degree */
    bool light;            /* the sun of natural colours; else colours as they are, or a map's hillshade */
    bool hillshade;
    bool sky;               /* else a flat background */
    bool air;               /* of the body: its sky */
    bool haze;              /* air before the terrain */
    bool land;              /* rock and snow, not another body's dust */
    bool water;             /* some of it lies below the sea */
    bool given;             /* colours from a ramp over all values: a user's heights, a shade's degrees */
    bool imagery;           /* colours of pictures over those of heights */
    bool contours;          /* lines of equal height */
    bool exaggerated;       /* heights are not the true ones */
    bool holes;             /* the mask of voids */
    bool walls;             /* below a flat terrain's edge */
    bool flood;             /* a sea that is given, which heights are nowhere below */
    bool dry;               /* no sea is asked for */
    bool sea;               /* around it */
    bool plain;             /* the body around a part of a globe is shown as land or sea */
    bool stars;             /* where the sky is black */
    bool climate;           /* land by latitude */
    tc_surroundings around; /* of all five */
    double sea_level;       /* of the flood: metres, absolute, as it is drawn */
    bool detail;            /* levels finer than the data */
    bool throttle;          /* frames may be throttled */
    bool level_colours;     /* may be switched, as may the next */
    bool morph;             /* else levels meet abruptly */
    bool multisampled;      /* of the target, as are the next two */
    bool linear;            /* light is written, not what is shown */
    bool by_w;              /* the distance cannot be told by depth */
    bool throttled;         /* of the frame: and vertices have to do with it */
    int image_n;      /* size of the windows of imagery; and how many times as long as wide a pixel's area on it is */
    int image_taps;   /* taken to be, by so many of the shader's own readings, */
    int image_filter; /* or by the textures' filter, where that is above 1 */
} tc_scene_needs;

/* Heights over the true ones: 1 where there is no exaggeration. */
static inline double tc_scene_exaggeration(const tc_scene_options *options)
{
    return options->exaggeration > 0 ? options->exaggeration : 1;
}

/* How much is seen of stars in a sky above a plane, by the share of daylight. */
static inline double tc_stars_at_dusk(double day)
{
    const double dark = fmax(0, 1 - day / 0.3);
    return dark * dark;
}

tc_scene_needs tc_scene_needs_of(const tc_scene_options *options, const tc_terrain_info *info);

/* Of the terrain's programs, a line each ("#define LIT\n..."): those that the scene's shaders are assembled by. */
enum { TC_SCENE_DEFINES = 640 };
void tc_scene_needs_defines(const tc_scene_needs *needs, char text[TC_SCENE_DEFINES]);

/* What is not needed and why, one short line each ("void mask: no holes to show"); returns how many. */
enum { TC_SCENE_LEFT_OUT = 24 };
int tc_scene_needs_left_out(const tc_scene_needs *needs, const char *lines[TC_SCENE_LEFT_OUT]);

#endif

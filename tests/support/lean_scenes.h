/* lean_scenes.h - scenes that need little, and ones that need everything: of the test that what is not needed is not
 * there, and of the measurement of what that saves. */
#ifndef LEAN_SCENES_H
#define LEAN_SCENES_H

#include "gl_record.h"
#include "planet_scene.h"

/* Parts that a scene may need, one bit each. */
enum {
    LEAN_LIGHT = 1 << 0,
    LEAN_SKY = 1 << 1,
    LEAN_HAZE = 1 << 2,
    LEAN_HOLES = 1 << 3,
    LEAN_LAND = 1 << 4,
    LEAN_WATER = 1 << 5,
    LEAN_LEVEL_COLOURS = 1 << 6,
    LEAN_SAMPLES = 1 << 7,
    LEAN_CLOSERS = 1 << 8,
    LEAN_SPHERE = 1 << 9,
    LEAN_IMAGERY = 1 << 10,
    LEAN_DETAIL = 1 << 11,
    LEAN_NORMALS = 1 << 12,
    LEAN_FINE_NORMALS = 1 << 13,
    LEAN_ANGLES = 1 << 14,
    LEAN_HILLSHADE = 1 << 15,
    LEAN_CONTOURS = 1 << 16,
    LEAN_TOLERANCE = 1 << 17,
    LEAN_EXAGGERATION = 1 << 18,
    LEAN_WALLS = 1 << 19,
    LEAN_SEA = 1 << 20,
    LEAN_STARS = 1 << 21,
    LEAN_CLIMATE = 1 << 22,
    LEAN_PARTS = 23
};

/* Over what a scene is. */
typedef enum lean_ground {
    LEAN_COAST,  /* a flat terrain with mountains, plains and a sea */
    LEAN_HILLS,  /* all of it above the sea */
    LEAN_POND,   /* so small that one level holds it */
    LEAN_VOIDS,  /* the coast with voids */
    LEAN_PACKED, /* the coast, packed */
    LEAN_FINER,  /* that, with levels finer than its data */
    LEAN_EARTH,  /* a globe */
    LEAN_EARTH_VOIDS,
    LEAN_EARTH_FINER,
    LEAN_MOON, /* another body's */
    LEAN_GROUNDS
} lean_ground;

typedef struct lean_scene {
    const char *name;
    lean_ground ground;
    tc_scene_options options;
    double x, y;  /* shares of the terrain's width and height, or degrees */
    double above; /* metres above the ground there */
    double heading, pitch;
    unsigned needs; /* what must be there; nothing else may */
} lean_scene;
enum { LEAN_SCENES = 22 };
extern const lean_scene lean_scenes[LEAN_SCENES];

/* A ground, made when first asked for. free_all: of those asked for. */
const tc_map *lean_atlas(lean_ground ground);
void lean_free_all(void);
bool lean_sphere(lean_ground ground);

/* Levels of its data; it may have finer ones. */
int lean_data_levels(lean_ground ground);

tc_camera lean_camera(const lean_scene *s, int width, int height);

/* The scene, drawn by gl. needs: of its windows, else as the options need. */
scene lean_create(const tc_gl *gl, const lean_scene *s, const tc_scene_options *options, const tc_scene_needs *needs);

#endif

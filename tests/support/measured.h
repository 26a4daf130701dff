/* measured.h - what errors are measured on: flat terrains and whole globes, each from four heights. */
#ifndef MEASURED_H
#define MEASURED_H

#include "common/measure/view_error.h"
#include "common/app/load.h"
#include "datasets.h"
#include "planet_scene.h"

typedef struct measured {
    char name[64]; /* file name; "default", "default-planet" */
    bool round;
    tc_field *field; /* flat */
    tc_map *planet;  /* round */
} measured;

/* Calls measure with the default terrain, the default planet and what TERRACLIP_DATA holds: whole globes as planets,
 * all else flat. quick: with no more than one flat and one round one of them. */
void measured_all(bool quick, void (*measure)(void *context, const measured *m), void *context);

measured measured_default_planet(void);
void measured_close(measured *m);

enum { MEASURED_HEIGHTS = 4, MEASURED_PLACES = 2 };

/* Metres above ground, 0 the lowest: flat four of 2 m, 30 m, 300 m, 3 km, ... so that the highest one shows about all
 * of the terrain; of a planet as large as the Moon or larger 2 m, 10 km, 1,000 km, 10,000 km (CH06 section 5.2). */
double measured_height(const measured *m, int height);

/* NAME-30m, NAME-3km, ... */
void measured_scene_name(const measured *m, int height, char *text, size_t size);

/* A view from one of them; 90 degrees wide over a flat terrain, 60 over a planet. */
tc_camera measured_camera(const measured *m, int height, int place, int width, int height_px);

/* The finest level of *m, which must outlive it. */
tc_truth measured_truth(const measured *m);
tc_body measured_body(const measured *m);

/* Unlit before a flat background, without a budget. n: of squares or around the rings; rings: NULL for a flat one. */
scene measured_scene(const tc_context *context, const measured *m, int n, const tc_rings_options *rings,
                     const tc_scene_options *options);

#endif

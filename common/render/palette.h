/* palette.h - colours of a terrain by height, and of the air above it. */
#ifndef TC_PALETTE_H
#define TC_PALETTE_H

#include "shade.h"
#include "common/terraclip.h"

enum { TC_RAMP_SIZE = 512, TC_GIVEN_SIZE = 4096 };

typedef struct tc_palette {
    uint8_t ramp[TC_RAMP_SIZE][4]; /* squared colours: sea from deep to shallow, then land from shore to summit */
    float heights[4];              /* sea level above z_base, 1 / depth, 1 / height of the land, height of the shore;
                                    * of given colours the latter two: 1 / relief, lowest height above sea level, or
                                    * 1 / degrees, 0 */
    bool water;                    /* some of the terrain lies below the sea */
    bool natural;                  /* a land with soil, rock and snow, not another body's dust */
    bool air;                      /* else there is space above it */
    float horizon[3], zenith[3];   /* squared colours of the sky */
    float wall[3];                 /* likewise of ground that is cut */
} tc_palette;

/* How far above the sea heights may be that the data have at it, metres: of what was packed with an error, whose data
 * have no depths. Else 0. What lies so low is coloured as the sea, and all of that alike. */
double tc_sea_noise(const tc_terrain_info *info);

/* Colours for a terrain: an Earth-like land gets water below zero, green lowlands, rock and snow by absolute height;
 * another body, by its radius, shades of its own ground from its lowest to its highest point. */
tc_palette tc_palette_make(const tc_terrain_info *info);

/* What a palette is made for where heights are drawn so many times as high as they are: the true ones. And what makes
 * such a palette one of heights as they are drawn; colours of degrees stay. */
tc_terrain_info tc_palette_heights(const tc_terrain_info *drawn, double exaggeration);
void tc_palette_exaggerate(tc_palette *palette, double exaggeration, bool degrees);

/* Gives the degrees of a shade its colours. */
void tc_palette_give_degrees(tc_palette *palette, const tc_shade *shade, uint16_t ramp[TC_GIVEN_SIZE][4]);

/* Gives the heights of a terrain, from its lowest to its highest, a user's colours: squares in steps of 1/65535. */
void tc_palette_give(tc_palette *palette, const tc_terrain_info *info, const tc_colour_ramp *colours,
                     uint16_t ramp[TC_GIVEN_SIZE][4]);

#endif

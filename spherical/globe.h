/* globe.h - what surfaces of globes have in common. */
#ifndef TC_GLOBE_H
#define TC_GLOBE_H

/* A constant as GLSL is told it. */
#define TC_TEXT(constant) #constant
#define TC_TEXT_OF(constant) TC_TEXT(constant)

/* Spacing, metres, from which on normals are kept steeper than the terrain (tc_ground_options.relief). */
#define TC_GLOBE_RELIEF 60.0
#define TC_GLOBE_RELIEF_DEFINE "RELIEF " TC_TEXT_OF(TC_GLOBE_RELIEF)

#endif

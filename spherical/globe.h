/* globe.h - moving over a globe: x and y of a view are longitude and latitude, radians, z metres above the sphere. */
#ifndef TC_GLOBE_H
#define TC_GLOBE_H

#include "common/view/navigation.h"

extern const tc_navigation tc_globe_navigation;

#endif

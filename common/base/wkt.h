/* wkt.h - what coordinate systems in words (WKT) tell without a library. */
#ifndef TC_WKT_H
#define TC_WKT_H

/* Inverse flattening of the first ellipsoid named; 0: a sphere, or none is. */
double tc_wkt_inverse_flattening(const char *wkt);

#endif

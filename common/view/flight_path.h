/* flight_path.h - a flight through given views, the same each time: for measurements and films. No GL.
 *
 * A path file is one of views (views_file.h): each is a key that is flown through. On a globe flights go from key to
 * key about as great circles do, over a pole too: its key's heading counts along its longitude. */
#ifndef TC_FLIGHT_PATH_H
#define TC_FLIGHT_PATH_H

#include "flight.h"

typedef struct tc_flight_path {
    tc_pose *keys; /* owned; headings, and longitudes, unrolled: each within half a turn of the one before */
    int count;     /* at least 1 */
    const tc_navigation *navigation;
} tc_flight_path;

/* Reads a path file. Errors name the line. */
tc_status tc_flight_path_load(const tc_navigation *navigation, const char *path, tc_flight_path *path_ret,
                              tc_error *error);

/* The same from text in memory; name is what errors call it. */
tc_status tc_flight_path_parse(const tc_navigation *navigation, const char *name, const char *text,
                               tc_flight_path *path_ret, tc_error *error);

void tc_flight_path_free(tc_flight_path *path);

/* Frame `frame` of `frames`: the first is the first key, the last the last, and between keys always passes the same
 * time. */
tc_pose tc_flight_path_view(const tc_flight_path *path, int frame, int frames);

#endif

/* rings_views.c - where the precision of the rings is looked at. */
#include "rings_views.h"

#include <math.h>

#define DEGREE (M_PI / 180)

void rings_place_of(int i, int64_t width, double *longitude_ret, double *latitude_ret)
{
    const double near = 1e-9, d = 2 * M_PI / (double)width;
    const double special[][2] = {
        {0, M_PI / 2},
        {2, -M_PI / 2},
        {M_PI, M_PI / 2 - near},
        {0.3, M_PI / 2 - near},
        {0, -M_PI / 2 + near},
        {-2.5, -M_PI / 2 + near},
        {1, M_PI / 2 - 1e-5},
        {M_PI, 0},
        {-M_PI, 0.5},
        {M_PI - near, -0.7},
        {-M_PI + near, 0.2},
        {M_PI, 57 * DEGREE},
        {0, 0},
        {0, 0.8},
        {near, -0.3},
        {-near, -1},
        {0, -58 * DEGREE},
        {1.1, TC_CAP_BLEND_START * DEGREE},
        {1.2, TC_CAP_BLEND_END * DEGREE},
        {1.3, -TC_CAP_BLEND_START * DEGREE - near},
        {1.4, -TC_CAP_BLEND_END * DEGREE + near},
        {40 * d, 30.5 * d},
        {40 * d + near, 30.5 * d - near},
        {-17 * d - 1e-7, -12.5 * d + 1e-7},
        {-17.5 * d, 21.5 * d - 1e-12},
    };
    const int specials = sizeof special / sizeof special[0];
    if (i < specials) {
        *longitude_ret = special[i][0], *latitude_ret = special[i][1];
        return;
    }
    test_random r = {(uint64_t)i + 1};
    *longitude_ret = test_random_range(&r, -M_PI, M_PI);
    *latitude_ret = asin(test_random_range(&r, -1, 1));
}

double rings_altitude(int k, double radius)
{
    double least = fmin(0.1, 1e-3 * radius);
    return least * pow(10 * radius / least, (double)k / (RINGS_ALTITUDES - 1));
}

tc_camera rings_view_at(const tc_map *atlas, double longitude, double latitude, double altitude, test_random *r)
{
    tc_camera c = {.fov = (test_random_bits(r) & 1 ? 75 : 90) * DEGREE, .width = 1280, .height = 960};
    c.x = longitude, c.y = latitude;
    if (tc_map_height(atlas, c.x, c.y, &c.z))
        c.z = 0;
    c.z += altitude;
    double dip = acos(atlas->body.radius / (atlas->body.radius + fmax(0, c.z)));
    c.heading = test_random_range(r, -M_PI, M_PI);
    c.pitch = fmax(-M_PI / 2, 0.2 - dip - test_random_range(r, 0, 1) * (M_PI / 2 + 0.3 - dip));
    return c;
}

tc_camera rings_view_of(const tc_map *atlas, int place, int64_t width, double altitude, test_random *r)
{
    double longitude, latitude;
    rings_place_of(place, width, &longitude, &latitude);
    return rings_view_at(atlas, longitude, latitude, altitude, r);
}

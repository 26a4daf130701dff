/* flight.c - views in words, and what all ways of moving have in common; see flight.h. */
#include "flight.h"

#include "camera.h"
#include "common/base/numbers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180)

const double tc_flight_speed = 0.7;

/* ---- Views in words ----------------------------------------------------------------------------------------- */

bool tc_pose_parse(const tc_navigation *navigation, const char *text, tc_pose *view_ret)
{
    const double limits[5] = {navigation->x_limit, navigation->y_limit, TC_POSE_LIMIT, 360, 90};
    double v[5];
    for (int i = 0; i < 5; i++) {
        if (!tc_take_number(&text, &v[i]) || *text != (i < 4 ? ',' : '\0') || !(fabs(v[i]) <= limits[i]))
            return false;
        text++;
    }
    double unit = navigation->unit;
    *view_ret = (tc_pose){v[0] * unit, v[1] * unit, v[2], v[3] * DEGREE, v[4] * DEGREE};
    return true;
}

/* Appends a number; never "-0.000". */
static int append(char *text, int used, double value, int decimals, char after)
{
    char number[48];
    snprintf(number, sizeof number, "%.*f", decimals, value);
    bool minus_zero = number[0] == '-' && strtod(number, NULL) == 0;
    return used + snprintf(text + used, TC_POSE_TEXT - (size_t)used, "%s%c", number + minus_zero, after);
}

void tc_pose_format(const tc_navigation *navigation, tc_pose *view, double spacing, char text[TC_POSE_TEXT])
{
    int decimals = 3;
    if (spacing > 0 && spacing < 1)
        decimals += (int)fmin(9, ceil(-log10(spacing)));
    double heading = fmod(view->heading / DEGREE, 360);
    if (heading < 0)
        heading += 360;
    heading = round(heading * 1e4) / 1e4;
    if (heading >= 360)
        heading = 0;
    navigation->settle(view);
    double unit = navigation->unit;
    const double position[3] = {view->x / unit, view->y / unit, view->z};
    int used = 0;
    for (int i = 0; i < 3; i++)
        used = append(text, used, position[i], i < 2 && unit != 1 ? 9 : decimals, ',');
    used = append(text, used, heading, 4, ',');
    append(text, used, fmax(-90, fmin(90, view->pitch / DEGREE)), 4, '\0');
    tc_pose_parse(navigation, text, view);
}

void tc_pose_to_camera(const tc_pose *view, tc_camera *camera)
{
    camera->x = view->x;
    camera->y = view->y;
    camera->z = view->z;
    camera->heading = view->heading;
    camera->pitch = view->pitch;
}

/* ---- Free flight ------------------------------------------------------------------------------------------------- */

void tc_flight_faster(tc_flight *flight, double notches)
{
    flight->speed = fmax(0.01, fmin(100, flight->speed * pow(1.25, notches)));
}

double tc_flight_keeps(const tc_ground *ground, double above)
{
    return above > 0 ? fmin(above, ground->clearance) : ground->clearance;
}

void tc_flight_move(tc_flight *flight, const tc_flight_input *input, const tc_ground *ground, double above,
                    double move_ret[3])
{
    const double least = fmin(0.25, 5 * ground->clearance); /* metres: a lower eye moves as if it were as high */
    tc_pose *view = &flight->view;
    view->heading = fmod(view->heading + input->turn, 360 * DEGREE);
    view->pitch = fmax(-90 * DEGREE, fmin(90 * DEGREE, view->pitch + input->tilt));
    double way = fmax(above, least) * flight->speed * (input->fast ? 8 : 1) * fmax(0, fmin(0.1, input->dt));
    const tc_basis axes = tc_camera_basis(&(tc_camera){.heading = view->heading, .pitch = view->pitch});
    double length = 0;
    for (int i = 0; i < 3; i++) {
        move_ret[i] = input->right * axes.right[i] + input->forward * axes.forward[i] + (i == 2 ? input->up : 0);
        length += move_ret[i] * move_ret[i];
    }
    for (int i = 0; i < 3; i++)
        move_ret[i] *= way / fmax(1, sqrt(length)); /* two keys are no faster than one */
}

/* ---- Over ground ---------------------------------------------------------------------------------------------- */

double tc_flight_clearance(double spacing)
{
    return fmin(2, 0.5 * spacing);
}

double tc_highest_ground(const tc_ground *ground, double x, double y, double dx, double dy)
{
    double z = ground->height(ground->context, x, y);
    z = fmax(z, ground->height(ground->context, x - dx, y));
    z = fmax(z, ground->height(ground->context, x + dx, y));
    z = fmax(z, ground->height(ground->context, x, y - dy));
    return fmax(z, ground->height(ground->context, x, y + dy));
}

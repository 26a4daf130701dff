// shade.glsl - what maps show (common/render/shade.h): angles of the ground, a hillshade, lines of equal height.
//
//     float shade_degrees(Ground)        the angle that colours are of; SHADE_SLOPE, SHADE_ASPECT
//     vec3  shade_flat(vec3, Ground)     its colour where ground is too flat to have that angle; SHADE_ASPECT
//     float hillshade(Ground)            light, 1 on flat ground; HILLSHADE
//     vec3  contoured(vec3, Ground)      a colour under lines; CONTOURS
//
// Colours are squares of what is shown, as in renderer.frag.

#if defined(SHADE_SLOPE) || defined(SHADE_ASPECT)
// How steep the ground is, metres a metre, of true heights.
float steepness(Ground ground)
{
#ifdef EXAGGERATED
    return length(ground.fall) / beyond.y;
#else
    return length(ground.fall);
#endif
}
#endif

#ifdef SHADE_SLOPE
float shade_degrees(Ground ground)
{
    return degrees(atan(steepness(ground)));
}
#endif

#ifdef SHADE_ASPECT
float shade_degrees(Ground ground)
{
    float clockwise = ground.fall == vec2(0.0) ? 0.0 : degrees(atan(ground.fall.x, ground.fall.y));
    return clockwise < 0.0 ? clockwise + 360.0 : clockwise;
}

vec3 shade_flat(vec3 c, Ground ground)
{
    const float GREY = 0.64, DIRECTED = 0.05; // as shown; metres a metre, of a slope that is not flat (3 degrees)
    return mix(vec3(GREY * GREY), c, min(steepness(ground) / DIRECTED, 1.0));
}
#endif

#ifdef HILLSHADE
// From the north-west, 45 degrees above the ground's own horizon. On a globe that is the viewer's north-west, carried
// along to where the ground is: at a pole light does not turn with the meridians. Slopes that are small in the picture are
// gentle ones: as maps of small scale do, they are shaded steeper than they are.
float hillshade(Ground ground)
{
    const vec3 LIGHT = vec3(-0.5, 0.5, 0.70710678);
    const float TRUE = 60.0; // metres a pixel up to which slopes are as they are
    vec3 up = ground.up;
    float steeper = sqrt(max(lens.x / (TRUE * gl_FragCoord.w), 1.0));
    vec3 n = normalize(mix(up * dot(up, ground.normal), ground.normal, steeper));
    // As if the ground were below the viewer.
    vec3 both = up + vec3(0.0, 0.0, 1.0);
    n += vec3(0.0, 0.0, 2.0 * dot(up, n)) - both * (dot(both, n) / max(1.0 + up.z, 1e-3));
    const float SKY = 0.15; // what a slope away from the light still has
    return SKY + (1.0 - SKY) * max(dot(n, LIGHT), 0.0) / LIGHT.z;
}
#endif

#ifdef CONTOURS
// How much of a pixel a line covers that lies where `number` is whole, by what `number` changes in a pixel.
float line(float number, float a_pixel, float width)
{
    float away = abs(fract(number + 0.5) - 0.5) / a_pixel;
    return clamp(0.5 * width + 0.5 - away, 0.0, 1.0);
}

// Lines fade where they come too near to each other.
float shown(float a_pixel)
{
    return smoothstep(3.0, 6.5, 1.0 / a_pixel); // pixels between lines
}

vec3 contoured(vec3 c, Ground ground)
{
    const float THIN = 1.2, HEAVY = 2.0; // pixels
    const vec3 INK = vec3(0.20, 0.13, 0.08); // over white
    // Lines lie that much below their heights, so that flat ground of just such a height has none.
    const float ROUNDING = 6e-6;
    float lines = ground.rise * contours.x, a_pixel = max(length(vec2(dFdx(lines), dFdy(lines))), 1e-8);
    float number = lines + ROUNDING * (abs(lines) + 5.0) + mod(surface_datum() * contours.x + contours.y, 5.0);
    float others = shown(a_pixel), heavy = line(0.2 * number, 0.2 * a_pixel, mix(THIN, HEAVY, others));
    float ink = max(0.8 * others * line(number, a_pixel, THIN), shown(0.2 * a_pixel) * heavy);
#ifdef WATER
    // Depths are drawn more lightly; and the shore is where colours change.
    float above_sea = ground.height - heights.x;
    ink *= above_sea > heights.w ? 1.0 : 0.55;
    ink *= step(0.5, abs(above_sea) * contours.x);
#endif
    return mix(c, c * INK, ink);
}
#endif

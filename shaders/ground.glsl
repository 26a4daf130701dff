// ground.glsl - the ground at a place: what a surface's fragment part answers to renderer.frag by
//
//     Ground surface_ground()    at this fragment
//     float  surface_haze()      squared optical depth of the air before it; HAZE
//     float  surface_datum()     what a ground's rise is measured from, metres above the eye; CONTOURS
//
// Of what a scene does not need there is nothing.
struct Ground {
    float height; // metres above z_base
    vec4 colour;  // what covers the colours of heights, in squares of what is shown; a: how much of them it covers
#ifdef CONTOURS
    float rise; // the height once more, metres above surface_datum(): with more digits
#endif
#ifdef NORMALS
    vec3 normal, up; // unit, in the eye's axes
    vec2 fall;       // metres a metre to the east and to the north: where the ground falls to
#endif
#if defined(LIT) && defined(CLIMATE)
    float day;       // share of daylight: the sun sets
    float snow_line; // height from which snow stays, metres above the sea
#endif
#ifdef LEVEL_COLOURS
    float level; // that is seen, from 0 on
#endif
#ifdef HOLES
    bool hole;
#endif
};

#ifdef LIT
// The sun, light of the sky from above and of the ground around from the side (softer than Lambert's law alone), on
// ground whose normal has these cosines to the sun and to up. Where the sun sets, the sky's light goes with it.
vec3 daylight(float facing, float upright, float day)
{
    float direct = max(facing, 0.0) * sun.w;
    float ambient = 0.34 + 0.14 * upright + 0.12 * facing;
#ifdef CLIMATE
    direct *= day;
    ambient *= 0.06 + 0.94 * day;
#endif
#ifndef NATURAL_LAND
    // Without air there is no light from the sky.
    direct *= 1.5;
    ambient *= 0.18;
#endif
    return direct * vec3(1.0, 0.96, 0.88) + ambient * vec3(0.82, 0.91, 1.0);
}
#endif

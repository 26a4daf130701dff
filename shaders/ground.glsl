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
#ifdef FLOOD
    float above_sea; // the height once more, metres above the sea that is given: of its surface 0 to the last digits
#endif
#ifdef CONTOURS
    float rise; // the height once more, metres above surface_datum(): with more digits
#endif
#ifdef NORMALS
    vec3 normal, up; // unit, in the eye's axes
    vec2 fall;       // metres a metre to the east and to the north: where the ground falls to
#endif
#if defined(LIT) && defined(CLIMATE)
    float day;       // share of daylight: the sun sets; tc_sun_day()
    float snow_line; // height from which snow stays, metres above the sea
#endif
#ifdef ZONES
    float sine; // of the latitude
#endif
#ifdef LEVEL_COLOURS
    float level; // that is seen, from 0 on
#endif
#ifdef HOLES
    bool hole;
#endif
};

#if defined(ZONES) || (defined(LIT) && defined(CLIMATE))
// Height from which snow stays into the summer, metres above the sea: about that of the Earth's mountains at the equator,
// highest in the belts of dry air beside it, the sea near the poles.
float snow_line(float sine)
{
    float belt = (asin(min(abs(sine), 1.0)) - 0.49) / 0.175;
    return 5100.0 * (1.0 - pow(abs(sine) / 0.965, 3.0)) + 1200.0 * exp(-belt * belt);
}
#endif

#ifdef ZONES
// Land by latitude and height: the greens of a land that is warm and wet enough, steppe and desert in the belts of dry
// air, meadows, tundra and rock where it is too cold for trees. All of it is about that of the Earth's means.
vec3 zoned(vec3 green, float height, float sine)
{
    const vec3 STEPPE = vec3(0.315, 0.27, 0.135), DESERT = vec3(0.48, 0.36, 0.22), TUNDRA = vec3(0.235, 0.21, 0.125),
               ROCK = vec3(0.255, 0.22, 0.18);
    float s = min(abs(sine), 1.0), warm = 27.0 - 44.0 * pow(s, 2.8) - 0.0065 * max(height, 0.0); // degrees Celsius
    float belt = (asin(s) - 0.45) / 0.22, dry = exp(-belt * belt) * (1.0 - 0.75 * smoothstep(1300.0, 2600.0, height));
    vec3 c = mix(green, mix(STEPPE, DESERT, smoothstep(0.3, 0.9, dry)), smoothstep(0.06, 0.5, dry));
    c = mix(c, TUNDRA, 1.0 - smoothstep(-4.5, -0.5, warm));
    return mix(c, ROCK, (1.0 - smoothstep(-9.0, -4.5, warm)) * smoothstep(600.0, 2000.0, height));
}
#endif

#ifdef LIT
// The sun, light of the sky from above and of the ground around from the side (softer than Lambert's law alone), on
// ground whose normal has these cosines to the sun and to up. Where the sun sets, the sky's light goes with it. Eyes that
// are used to the dark see by what is there at night.
vec3 daylight(float facing, float upright, float day, float night)
{
    float direct = max(facing, 0.0) * sun.w;
    float ambient = 0.34 + 0.14 * upright + 0.12 * facing;
    direct *= day;
    ambient *= 0.06 + 0.94 * day;
#ifndef UNDER_AIR
    // Without air there is no light from the sky.
    direct *= 1.5;
    ambient *= 0.18;
#endif
    ambient += night * upright * upright;
    return direct * vec3(1.0, 0.96, 0.88) + ambient * vec3(0.82, 0.91, 1.0);
}
#endif

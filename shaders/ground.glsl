// ground.glsl - the ground at a place: what a surface's fragment part answers to renderer.frag by
//
//     Ground surface_ground()    at this fragment
//     float  surface_haze()      squared optical depth of the air before it; HAZE
//
// Of what a scene does not need there is nothing.
struct Ground {
    float height; // metres above z_base
    vec4 colour;  // what covers the colours of heights, in squares of what is shown; a: how much of them it covers
#ifdef LIT
    vec3 normal, up; // unit, in the eye's axes
#ifdef CLIMATE
    float day;       // share of daylight: the sun sets
    float snow_line; // height from which snow stays, metres above the sea
#endif
#endif
#ifdef LEVEL_COLOURS
    float level; // that is seen, from 0 on
#endif
#ifdef HOLES
    bool hole;
#endif
};
